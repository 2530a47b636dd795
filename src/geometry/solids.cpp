#include "impinge/geometry/solids.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace impinge {
namespace {

constexpr double on_surface = 1e-9;  // distance that counts as none, in lengths of the shape

/// A polygon that is symmetric about its axis: as wide as the radii at height 0 and at the other.
Outline profile_of(double height, double radius, double end_radius) {
  std::vector<Vector<2>> corners{{{radius, 0.0}}, {{end_radius, height}}};
  if (end_radius > 0.0) corners.push_back({{-end_radius, height}});
  if (radius > 0.0) corners.push_back({{-radius, 0.0}});
  std::vector<std::string> mistakes;
  return make_polygon(std::move(corners), mistakes).value();
}

}  // namespace

Vector<3> Sphere::normal(const Vector<3>& point) const {
  const Vector<3> offset = point - center_;
  const double length = norm(offset);
  return length > 0.0 ? 1.0 / length * offset : Vector<3>{{1.0, 0.0, 0.0}};
}

Box<3> Sphere::bounds() const {
  Vector<3> reach;
  reach.component.fill(radius_);
  return {center_ - reach, center_ + reach};
}

double Sphere::volume() const { return 4.0 / 3.0 * std::numbers::pi * radius_ * radius_ * radius_; }

Block::Block(const Box<3>& box, const Transform<3>& transform)
    : center_(transform(0.5 * (box.low + box.high))), half_(0.5 * transform.scale * (box.high - box.low)) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      axes_.row[static_cast<std::size_t>(r)][c] = transform.rotation.row[static_cast<std::size_t>(c)][r];
}

Vector<3> Block::beyond_faces(const Vector<3>& place) const {
  Vector<3> beyond;
  for (int k = 0; k < 3; ++k) beyond[k] = std::abs(place[k]) - half_[k];
  return beyond;
}

double Block::distance(const Vector<3>& point) const {
  Vector<3> beyond = beyond_faces(axes_ * (point - center_));
  const double farthest = *std::ranges::max_element(beyond.component);
  if (farthest <= 0.0) return farthest;
  for (double& x : beyond.component) x = std::max(x, 0.0);
  return norm(beyond);
}

Vector<3> Block::normal(const Vector<3>& point) const {
  const Vector<3> place = axes_ * (point - center_);
  const Vector<3> beyond = beyond_faces(place);
  const double farthest = *std::ranges::max_element(beyond.component);
  const double margin = on_surface * norm(half_);
  Vector<3> sum;
  for (int k = 0; k < 3; ++k) {
    const double share =
        farthest > margin ? std::max(beyond[k], 0.0) : static_cast<double>(beyond[k] >= farthest - margin);
    sum += std::copysign(share, place[k]) * axes_.row[static_cast<std::size_t>(k)];
  }
  return 1.0 / norm(sum) * sum;
}

Box<3> Block::bounds() const {
  Vector<3> reach;
  for (int k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis)
      reach[k] += half_[axis] * std::abs(axes_.row[static_cast<std::size_t>(axis)][k]);
  return {center_ - reach, center_ + reach};
}

double Block::volume() const { return 8.0 * half_[0] * half_[1] * half_[2]; }

Frustum::Frustum(const Vector<3>& begin, const Vector<3>& end, double radius, double end_radius)
    : begin_(begin),
      end_(end),
      axis_(1.0 / norm(end - begin) * (end - begin)),
      radius_(radius),
      end_radius_(end_radius),
      profile_(profile_of(norm(end - begin), radius, end_radius)) {}

Vector<2> Frustum::in_profile(const Vector<3>& point) const {
  const Vector<3> offset = point - begin_;
  const double along = dot(offset, axis_);
  return {{norm(offset - along * axis_), along}};
}

Vector<3> Frustum::normal(const Vector<3>& point) const {
  const auto [across, along] = profile_.normal(in_profile(point)).component;
  const Vector<3> offset = point - begin_;
  Vector<3> outward = offset - dot(offset, axis_) * axis_;
  if (!(norm(outward) > on_surface * (radius_ + end_radius_))) {  // on the axis, any direction
    int least = 0;
    for (int k = 1; k < 3; ++k)
      if (std::abs(axis_[k]) < std::abs(axis_[least])) least = k;
    Vector<3> other;
    other[least] = 1.0;
    outward = cross(axis_, other);
  }
  return across / norm(outward) * outward + along * axis_;
}

Box<3> Frustum::bounds() const {
  Box<3> box;
  for (int k = 0; k < 3; ++k) {
    const double share = std::sqrt(std::max(0.0, 1.0 - axis_[k] * axis_[k]));  // of a disc's radius
    box.low[k] = std::min(begin_[k] - share * radius_, end_[k] - share * end_radius_);
    box.high[k] = std::max(begin_[k] + share * radius_, end_[k] + share * end_radius_);
  }
  return box;
}

double Frustum::volume() const {
  return std::numbers::pi / 3.0 * norm(end_ - begin_) *
         (radius_ * radius_ + radius_ * end_radius_ + end_radius_ * end_radius_);
}

}  // namespace impinge
