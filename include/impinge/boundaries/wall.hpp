#pragma once
// Walls.

#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "impinge/boundaries/motion.hpp"
#include "impinge/core/vector.hpp"
#include "impinge/geometry/mesh.hpp"
#include "impinge/geometry/outline.hpp"

namespace impinge {

/// Rows of a wall: one of wall particles and the ghosts behind it, enough for a Laplacian radius of 4.01 dp.
constexpr int wall_layers = 4;

/// What walls are made of: lines in two dimensions, facets in three.
template <int Dim>
using Surface = std::conditional_t<Dim == 2, Outline, Mesh>;

/// A wall of any shape, at the place where its motion's pose is the identity. Its front is the side that the surface's
/// normals point to: the outside of a closed one, in two dimensions the right of the way along the line.
template <int Dim>
struct Wall {
  std::string name;
  std::shared_ptr<const Surface<Dim>> surface;
  bool wet_front = true;                        ///< there is fluid before it
  bool wet_back = false;                        ///< there is fluid behind it
  bool slip = false;                            ///< a viscous fluid slips along it, too
  std::shared_ptr<const Motion<Dim>> motion{};  ///< none: at rest. Walls that move as one body share it
};

/// A point of a wall's surface where the pressure is measured.
template <int Dim>
struct WallPoint {
  Vector<Dim> position;  ///< where the pose is the identity, just off the surface on its wet side [m]
  Vector<Dim> normal;    ///< likewise, into the fluid [-]
  double area = 0.0;     ///< length [m] or area [m^2] of surface that it stands for
  int wall = 0;          ///< number of its wall
};

/// Points at about a spacing [m] from each other on every wet side of the walls, in the order of the walls. In three
/// dimensions the sum of normal and area over a patch is that over its facets.
template <int Dim>
std::vector<WallPoint<Dim>> wall_points(const std::vector<Wall<Dim>>& walls, double spacing);

}  // namespace impinge
