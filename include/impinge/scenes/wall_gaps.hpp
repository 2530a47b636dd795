#pragma once
// Narrow places between the walls of a scene.

#include <vector>

#include "impinge/boundaries/wall.hpp"

namespace impinge {

/// The narrowest throat between two walls, or of one with itself.
struct WallGap {
  std::size_t one, other;  ///< numbers of the walls; equal: of one with itself
  double width;            ///< [dp]
  Vector<2> place;         ///< its middle [m]
  double time;             ///< when it is so narrow [s]
};

/// The gap of each pair of walls, and of each wall with itself, that has one: where both sides are wet and nothing
/// stands in between. Faces that touch and corners that they run into are no gaps. `times`: at which walls that move
/// against each other are looked at [s]; of many, some are left out if the walls have many edges. `spacing`: dp [m].
std::vector<WallGap> wall_gaps(const std::vector<Wall<2>>& walls, const std::vector<double>& times, double spacing);

}  // namespace impinge
