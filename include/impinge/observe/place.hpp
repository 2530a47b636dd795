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
template <int Dim>
std::vector<Pose<Dim>> poses_of(const std::vector<Wall<Dim>>& walls, double time);

/// True where a wall in its pose stands between two points. Walls that touch the first point do not count.
template <int Dim>
bool is_hidden(const std::vector<Wall<Dim>>& walls, const std::vector<Pose<Dim>>& poses, const Vector<Dim>& from,
               const Vector<Dim>& to);

}  // namespace impinge
