#include "impinge/scenes/wall_crossing.hpp"

#include <algorithm>
#include <cmath>

namespace impinge {
namespace {

constexpr double depth = 0.25;  // that counts as beyond a wall [dp]

std::vector<Vector<2>> points_along(const Outline& outline, double spacing) {
  constexpr double most = 400.0;
  const double step = std::max(0.5 * spacing, outline.length() / most);
  std::vector<Vector<2>> points;
  for (const OutlineEdge& edge : outline.edges()) {
    const int count = std::max(1, static_cast<int>(std::ceil(edge.length() / step)));
    for (int k = 0; k < count; ++k) points.push_back(edge.at(static_cast<double>(k) / count));
  }
  points.push_back(outline.edges().back().end);
  return points;
}

enum class Side { left, right, on, unknown };

/// The side of an outline that a point is on: of a line, unknown beyond its ends.
Side side_of(const Outline& outline, const Vector<2>& point, double margin) {
  const bool is_far = !outline.bounds().contains(point, margin);
  if (is_far && outline.closed()) return Side::right;
  if (outline.closed()) {
    const double distance = outline.distance(point);
    return std::abs(distance) < margin ? Side::on : distance < 0.0 ? Side::left : Side::right;
  }
  const NearestPoint near = outline.nearest(point);
  const auto& edges = outline.edges();
  const double share = edges[near.edge].nearest_share(point);
  if ((near.edge == 0 && share == 0.0) || (near.edge + 1 == edges.size() && share == 1.0)) return Side::unknown;
  if (near.distance < margin) return Side::on;
  return dot(point - near.point, edges[near.edge].normal(share)) > 0.0 ? Side::right : Side::left;
}

/// Follows a path: true where it has gone from one side to the other through the outline.
class Path {
 public:
  bool goes_through(const Outline& outline, const Vector<2>& point, Side side) {
    const bool hit = has_last_ && side != Side::unknown && outline.first_hit(last_, point).has_value();
    last_ = point;
    has_last_ = true;
    if (side == Side::unknown) {
      definite_ = Side::unknown;
      met_ = false;
      return false;
    }
    met_ |= hit || side == Side::on;
    if (side == Side::on) return false;
    const bool through = met_ && definite_ != Side::unknown && definite_ != side;
    definite_ = side;
    met_ = false;
    return through;
  }

 private:
  Vector<2> last_;
  bool has_last_ = false, met_ = false;
  Side definite_ = Side::unknown;
};

/// The point of another body, in the first body's frame.
Vector<2> in_frame(const Pose<2>& own, const Pose<2>& other, const Vector<2>& point) {
  const Vector<2> offset = other.of_position(point) - own.shift;
  Vector<2> result;
  for (int k = 0; k < 2; ++k) result += offset[k] * own.rotation.row[static_cast<std::size_t>(k)];
  return result;
}

Pose<2> pose_at(const Wall<2>& wall, double time) { return wall.motion ? (*wall.motion)(time) : Pose<2>{}; }

/// Where points of one wall are beyond the other.
std::optional<Crossing> crossing_of(const Wall<2>& one, const Wall<2>& other, const std::vector<double>& times,
                                    double spacing) {
  const std::vector<Vector<2>> points = points_along(*one.surface, spacing);
  std::vector<Path> in_time(points.size());
  for (const double time : times) {
    const Pose<2> pose = pose_at(one, time), frame = pose_at(other, time);
    Path along;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vector<2> point = in_frame(frame, pose, points[k]);
      const Side side = side_of(*other.surface, point, depth * spacing);
      const bool through_now = along.goes_through(*other.surface, point, side);
      const bool through_since = in_time[k].goes_through(*other.surface, point, side);
      if (through_now || through_since) return Crossing{time, pose.of_position(points[k])};
    }
  }
  return {};
}

}  // namespace

std::optional<Crossing> first_crossing(const Wall<2>& one, const Wall<2>& other, const std::vector<double>& times,
                                       double spacing) {
  const auto first = crossing_of(one, other, times, spacing), second = crossing_of(other, one, times, spacing);
  if (first && second) return first->time <= second->time ? first : second;
  return first ? first : second;
}

}  // namespace impinge
