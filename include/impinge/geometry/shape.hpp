#pragma once
// A region of space, or a curve or surface without thickness.

#include "impinge/core/vector.hpp"

namespace impinge {

template <int Dim>
class Shape {
 public:
  virtual ~Shape() = default;

  /// Distance of a point to the shape's surface [m]: negative inside, positive outside. A shape without thickness has
  /// no inside.
  virtual double distance(const Vector<Dim>& point) const = 0;

  /// The distance's gradient, a unit vector [-]: on the surface its normal out of the shape, at a corner between the
  /// normals of the faces that meet there.
  virtual Vector<Dim> normal(const Vector<Dim>& point) const = 0;

  /// The smallest axis-aligned box around the shape [m].
  virtual Box<Dim> bounds() const = 0;

  /// Area in two dimensions [m^2], volume in three [m^3]; 0 for a shape without thickness.
  virtual double volume() const = 0;

  /// True inside; false on the surface.
  bool contains(const Vector<Dim>& point) const { return distance(point) < 0.0; }
};

}  // namespace impinge
