#pragma once
// Shapes in three dimensions.

#include "impinge/geometry/outline.hpp"
#include "impinge/geometry/shape.hpp"
#include "impinge/geometry/transform.hpp"

namespace impinge {

/// A ball.
class Sphere final : public Shape<3> {
 public:
  /// The radius must be positive [m].
  Sphere(const Vector<3>& center, double radius) : center_(center), radius_(radius) {}

  double distance(const Vector<3>& point) const override { return norm(point - center_) - radius_; }
  Vector<3> normal(const Vector<3>& point) const override;
  Box<3> bounds() const override;
  double volume() const override;

 private:
  Vector<3> center_;
  double radius_;
};

/// A box, placed by a transform.
class Block final : public Shape<3> {
 public:
  /// Every length of the box must be positive [m].
  explicit Block(const Box<3>& box, const Transform<3>& transform = {});

  double distance(const Vector<3>& point) const override;
  Vector<3> normal(const Vector<3>& point) const override;
  Box<3> bounds() const override;
  double volume() const override;

 private:
  /// Distances beyond the faces, positive outside, of a place relative to the centre; both along the box's edges [m].
  Vector<3> beyond_faces(const Vector<3>& place) const;

  Vector<3> center_;
  Vector<3> half_;  // half the lengths [m]
  Matrix<3> axes_;  // rows: unit vectors along the box's edges
};

/// What is between two discs that face each other: a cylinder, a cone, or a part of one.
class Frustum final : public Shape<3> {
 public:
  /// The middles of the discs must differ. No radius may be negative, and one must be positive [m].
  Frustum(const Vector<3>& begin, const Vector<3>& end, double radius, double end_radius);

  double distance(const Vector<3>& point) const override { return profile_.distance(in_profile(point)); }
  Vector<3> normal(const Vector<3>& point) const override;
  Box<3> bounds() const override;
  double volume() const override;

 private:
  /// Distance from the axis and place along it [m].
  Vector<2> in_profile(const Vector<3>& point) const;

  Vector<3> begin_, end_, axis_;  // axis: a unit vector from begin to end
  double radius_, end_radius_;
  Outline profile_;  // the whole section through the axis
};

}  // namespace impinge
