#include "impinge/scenes/wet_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "impinge/geometry/transform.hpp"

namespace impinge {
namespace {

constexpr double line_reach = 3.0;  // [dp]

/// Distance of a point from a box, 0 inside [m].
double distance(const Box<2>& box, const Vector<2>& point) {
  Vector<2> off;
  for (int k = 0; k < 2; ++k) off[k] = std::max({box.low[k] - point[k], point[k] - box.high[k], 0.0});
  return norm(off);
}

}  // namespace

Outline outline_at(const Wall& wall, double time) {
  if (!wall.motion) return wall.outline;
  const Pose<2> pose = (*wall.motion)(time);
  return transformed(wall.outline, {.rotation = pose.rotation, .translate = pose.shift});
}

WetSpace::WetSpace(const std::vector<Wall>& walls, double time, double spacing) : reach_(line_reach * spacing) {
  for (const Wall& wall : walls) parts_.push_back({outline_at(wall, time), wall.wet_right, wall.wet_left});
}

bool WetSpace::is_behind(const Part& line, const Vector<2>& point) const {
  const NearestPoint near = line.outline.nearest(point);
  const auto& edges = line.outline.edges();
  const double share = edges[near.edge].nearest_share(point);
  const bool at_end = (near.edge == 0 && share == 0.0) || (near.edge + 1 == edges.size() && share == 1.0);
  if (at_end || near.distance > reach_) return false;
  return dot(point - near.point, edges[near.edge].normal(share)) > 0.0 ? !line.wet_right : !line.wet_left;
}

double WetSpace::depth(const Vector<2>& point) const {
  bool has_inside = false;
  double least = std::numeric_limits<double>::infinity(), inside = -std::numeric_limits<double>::infinity();
  for (const Part& part : parts_) {
    const bool closed = part.outline.closed();
    const bool inside_only = closed && !part.wet_right;
    has_inside |= inside_only;
    if (!inside_only && distance(part.outline.bounds(), point) > reach_) {
      least = std::min(least, reach_);
      continue;
    }
    const double distance = part.outline.distance(point);
    if (inside_only) {
      inside = std::max(inside, -distance);
    } else if (closed) {
      least = std::min(least, part.wet_left ? std::abs(distance) : distance);
    } else {
      least = std::min(least, is_behind(part, point) ? -distance : distance);
    }
  }
  return has_inside ? std::min(inside, least) : least;
}

bool WetSpace::contains(const Vector<2>& point, double margin) const {
  bool has_inside = false, is_inside = false;
  for (const Part& part : parts_) {
    const bool closed = part.outline.closed();
    const bool inside_only = closed && !part.wet_right;
    has_inside |= inside_only;
    if (distance(part.outline.bounds(), point) > reach_) continue;
    const double distance = part.outline.distance(point);
    if (std::abs(distance) < margin) return false;
    if (closed && distance < 0.0 && !part.wet_left) return false;
    if (inside_only && distance < 0.0) is_inside = true;
    if (!closed && part.wet_right != part.wet_left && is_behind(part, point)) return false;
  }
  return is_inside || !has_inside;
}

}  // namespace impinge
