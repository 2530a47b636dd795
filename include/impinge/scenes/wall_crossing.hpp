#pragma once
// Walls that move through others.

#include <optional>
#include <vector>

#include "impinge/boundaries/wall.hpp"

namespace impinge {

struct Crossing {
  double time;      ///< [s]
  Vector<2> place;  ///< [m]
};

/// Where one of two walls is first on both sides of the other, at one of the times or between two. Touching and sliding
/// along are no crossing, up to a quarter of the spacing [m].
std::optional<Crossing> first_crossing(const Wall<2>& one, const Wall<2>& other, const std::vector<double>& times,
                                       double spacing);

}  // namespace impinge
