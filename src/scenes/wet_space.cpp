#include "impinge/scenes/wet_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "impinge/geometry/transform.hpp"

namespace impinge {
namespace {

constexpr double open_reach = 3.0;  // [dp]

/// Distance of a point from a box, 0 inside [m].
template <int Dim>
double distance(const Box<Dim>& box, const Vector<Dim>& point) {
  Vector<Dim> off;
  for (int k = 0; k < Dim; ++k) off[k] = std::max({box.low[k] - point[k], point[k] - box.high[k], 0.0});
  return norm(off);
}

/// Where an open surface is nearest to a point: how far, whether the point is before it, and whether it ends there.
struct Side {
  double distance;
  bool is_in_front, is_at_end;
};

Side side_of(const Outline& line, const Vector<2>& point) {
  const NearestPoint near = line.nearest(point);
  const auto& edges = line.edges();
  const double share = edges[near.edge].nearest_share(point);
  const bool at_end = (near.edge == 0 && share == 0.0) || (near.edge + 1 == edges.size() && share == 1.0);
  return {near.distance, dot(point - near.point, edges[near.edge].normal(share)) > 0.0, at_end};
}

Side side_of(const Mesh& mesh, const Vector<3>& point) {
  const Mesh::Nearest near = mesh.nearest(point);
  return {near.distance, near.is_in_front, near.is_at_end};
}

}  // namespace

Outline outline_at(const Wall<2>& wall, double time) {
  if (!wall.motion) return *wall.surface;
  const Pose<2> pose = (*wall.motion)(time);
  return transformed(*wall.surface, {.rotation = pose.rotation, .translate = pose.shift});
}

template <int Dim>
WetSpace<Dim>::WetSpace(const std::vector<Wall<Dim>>& walls, double time, double spacing)
    : reach_(open_reach * spacing) {
  for (const Wall<Dim>& wall : walls)
    parts_.push_back({wall.surface, wall.motion ? (*wall.motion)(time) : Pose<Dim>{}, wall.wet_front, wall.wet_back});
}

template <int Dim>
bool WetSpace<Dim>::is_far(const Part& part, const Vector<Dim>& at_rest) const {
  return distance(part.surface->bounds(), at_rest) > reach_;
}

template <int Dim>
bool WetSpace<Dim>::is_behind(const Part& line, const Vector<Dim>& at_rest) const {
  const Side side = side_of(*line.surface, at_rest);
  if (side.is_at_end || side.distance > reach_) return false;
  return side.is_in_front ? !line.wet_front : !line.wet_back;
}

template <int Dim>
double WetSpace<Dim>::depth(const Vector<Dim>& point) const {
  bool has_inside = false;
  double least = std::numeric_limits<double>::infinity(), inside = -std::numeric_limits<double>::infinity();
  for (const Part& part : parts_) {
    const Vector<Dim> at_rest = part.pose.origin_of(point);
    const bool closed = part.surface->closed();
    const bool inside_only = closed && !part.wet_front;
    has_inside |= inside_only;
    if (!inside_only && is_far(part, at_rest)) {
      least = std::min(least, reach_);
      continue;
    }
    const double distance = part.surface->distance(at_rest);
    if (inside_only) {
      inside = std::max(inside, -distance);
    } else if (closed) {
      least = std::min(least, part.wet_back ? std::abs(distance) : distance);
    } else {
      least = std::min(least, is_behind(part, at_rest) ? -distance : distance);
    }
  }
  return has_inside ? std::min(inside, least) : least;
}

template <int Dim>
bool WetSpace<Dim>::contains(const Vector<Dim>& point, double margin) const {
  bool has_inside = false, is_inside = false;
  for (const Part& part : parts_) {
    const Vector<Dim> at_rest = part.pose.origin_of(point);
    const bool closed = part.surface->closed();
    const bool inside_only = closed && !part.wet_front;
    has_inside |= inside_only;
    if (is_far(part, at_rest)) continue;
    const double distance = part.surface->distance(at_rest);
    if (std::abs(distance) < margin) return false;
    if (closed && distance < 0.0 && !part.wet_back) return false;
    if (inside_only && distance < 0.0) is_inside = true;
    if (!closed && part.wet_front != part.wet_back && is_behind(part, at_rest)) return false;
  }
  return is_inside || !has_inside;
}

template class WetSpace<2>;
template class WetSpace<3>;

}  // namespace impinge
