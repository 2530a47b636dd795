#pragma once
// Walls.

#include <memory>
#include <string>
#include <vector>

#include "impinge/boundaries/motion.hpp"
#include "impinge/core/vector.hpp"
#include "impinge/geometry/outline.hpp"

namespace impinge {

/// Rows of a wall: one of wall particles and the ghosts behind it, enough for a Laplacian radius of 4.01 dp.
constexpr int wall_layers = 4;

/// A wall of any shape in two dimensions, at the place where its motion's pose is the identity.
struct Wall {
  std::string name;
  Outline outline;
  bool wet_right = true;                      ///< fluid on the right of the way along the outline: outside a closed one
  bool wet_left = false;                      ///< likewise on the left
  bool slip = false;                          ///< a viscous fluid slips along it, too
  std::shared_ptr<const Motion<2>> motion{};  ///< none: at rest. Walls that move as one body share it
};

/// A point of a wall's surface where the pressure is measured.
struct WallPoint {
  Vector<2> position;  ///< where the pose is the identity, just off the surface on its wet side [m]
  Vector<2> normal;    ///< likewise, into the fluid [-]
  double area = 0.0;   ///< length of surface that it stands for [m]
  int wall = 0;        ///< number of its wall
};

/// Points at about a spacing [m] from each other on every wet side of the walls, in the order of the walls.
std::vector<WallPoint> wall_points(const std::vector<Wall>& walls, double spacing);

}  // namespace impinge
