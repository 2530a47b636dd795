#pragma once
// Where things are in a scene whose walls move and whose bounds may repeat.

#include <vector>

#include "impinge/boundaries/scene.hpp"
#include "impinge/config/key.hpp"

namespace impinge {

/// Offsets between points, by the shortest way where the bounds repeat.
template <int Dim>
class Offsets {
 public:
  explicit Offsets(const Scene<Dim>& scene) {
    for (int k = 0; k < Dim; ++k)
      if (scene.periodic[static_cast<std::size_t>(k)]) period_[k] = scene.bounds.high[k] - scene.bounds.low[k];
  }

  Vector<Dim> operator()(const Vector<Dim>& from, const Vector<Dim>& to) const {
    Vector<Dim> offset = to - from;
    for (int k = 0; k < Dim; ++k)
      if (period_[k] > 0.0) offset[k] -= period_[k] * std::round(offset[k] / period_[k]);
    return offset;
  }

 private:
  Vector<Dim> period_;  // 0: the axis does not repeat [m]
};

/// The pose of each wall at a time [s].
std::vector<Pose<2>> poses_of(const std::vector<Wall>& walls, double time);

/// The point of a body that is at x in this pose.
Vector<2> origin_of(const Pose<2>& pose, const Vector<2>& x);

/// True where a wall in its pose stands between two points. Walls that touch the first point do not count.
bool is_hidden(const std::vector<Wall>& walls, const std::vector<Pose<2>>& poses, const Vector<2>& from,
               const Vector<2>& to);

}  // namespace impinge
