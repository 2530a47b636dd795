#pragma once
// Shapes in two dimensions: closed outlines with an inside, and open lines without thickness.

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "impinge/geometry/shape.hpp"
#include "impinge/geometry/transform.hpp"

namespace impinge {

/// A straight segment or a circular arc.
struct OutlineEdge {
  Vector<2> begin, end;  ///< [m]
  Vector<2> center{};    ///< of an arc [m]
  double radius = 0.0;   ///< of an arc [m]
  double sweep = 0.0;    ///< angle of an arc from begin to end [rad], counter-clockwise positive; 0: straight

  bool straight() const { return sweep == 0.0; }
  double length() const;
  /// The point at a share of the length, 0 at the begin and 1 at the end [m].
  Vector<2> at(double share) const;
  /// Unit normal to the right of the way from begin to end [-].
  Vector<2> normal(double share) const;
  /// Where the edge is nearest to a point, as a share of its length [-].
  double nearest_share(const Vector<2>& point) const;
  Vector<2> nearest(const Vector<2>& point) const { return at(nearest_share(point)); }
};

/// The point of an outline that is nearest to another.
struct NearestPoint {
  Vector<2> point;  ///< [m]
  std::size_t edge = 0;
  double distance = std::numeric_limits<double>::infinity();  ///< not negative [m]
};

/// The first point that a segment has in common with an outline.
struct Hit {
  Vector<2> point;  ///< [m]
  std::size_t edge = 0;
  double share = 0.0;  ///< of the segment's length before the point [-]
};

/// The shortest connection of two outlines.
struct Gap {
  double width = std::numeric_limits<double>::infinity();  ///< 0 where they meet [m]
  Vector<2> begin, end;                                    ///< on the first and on the second outline [m]
};

/// Edges in order, each from the end of the one before. A closed outline runs counter-clockwise: its normals to the
/// right point out of it. An open one has no inside: its distance is not negative, its area 0.
class Outline final : public Shape<2> {
 public:
  /// The edges must be those of one of the functions below.
  Outline(std::vector<OutlineEdge> edges, bool closed);

  double distance(const Vector<2>& point) const override;
  Vector<2> normal(const Vector<2>& point) const override;
  Box<2> bounds() const override { return bounds_; }
  double volume() const override { return area_; }

  const std::vector<OutlineEdge>& edges() const { return edges_; }
  bool closed() const { return closed_; }
  double length() const;
  NearestPoint nearest(const Vector<2>& point) const;
  /// The segment runs from one point to another; touching counts.
  std::optional<Hit> first_hit(const Vector<2>& from, const Vector<2>& to) const;
  bool meets(const Vector<2>& from, const Vector<2>& to) const { return first_hit(from, to).has_value(); }

 private:
  bool encloses(const Vector<2>& point) const;

  std::vector<OutlineEdge> edges_;
  bool closed_;
  Box<2> bounds_;
  double area_ = 0.0;
};

// Each of these gives the shape, or appends to `mistakes` what is wrong with its numbers. Lengths in m, angles in
// degrees.

std::optional<Outline> make_box(const Vector<2>& low, const Vector<2>& high, std::vector<std::string>& mistakes);

std::optional<Outline> make_circle(const Vector<2>& center, double radius, std::vector<std::string>& mistakes);

/// A part of a circle, without thickness, from one angle to another; clockwise if the second is smaller.
std::optional<Outline> make_arc(const Vector<2>& center, double radius, double from, double to,
                                std::vector<std::string>& mistakes);

/// Corners in either direction; the last is joined to the first. Edges in line with each other become one.
std::optional<Outline> make_polygon(std::vector<Vector<2>> points, std::vector<std::string>& mistakes);

/// A line without thickness. Edges in line with each other become one.
std::optional<Outline> make_polyline(std::vector<Vector<2>> points, std::vector<std::string>& mistakes);

Outline transformed(const Outline& outline, const Transform<2>& transform);

/// Of outlines one of which is inside the other, too.
Gap narrowest_gap(const Outline& first, const Outline& second);

/// The narrowest throat between two outlines, or of one with itself, that is wider than `least` [m] and of which
/// `counts` says so. In a throat they are nearer to each other than at any point beside it, or as near: where two faces
/// run into a corner is none.
std::optional<Gap> narrowest_throat(const Outline& first, const Outline& second, double least,
                                    const std::function<bool(const Gap&)>& counts);

}  // namespace impinge
