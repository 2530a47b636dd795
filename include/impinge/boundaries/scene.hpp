#pragma once
// What a run takes place in: walls, fluid at the start, where it enters and leaves. Data alone, made before the run.

#include <array>
#include <functional>
#include <vector>

#include "impinge/boundaries/inlet.hpp"
#include "impinge/boundaries/mirror_walls.hpp"
#include "impinge/boundaries/wall.hpp"

namespace impinge {

template <int Dim>
struct Scene {
  Box<Dim> bounds;                   ///< the region that particles may occupy [m]
  std::array<bool, Dim> periodic{};  ///< axes along which the bounds repeat

  std::vector<Face<Dim>> mirrors;           ///< walls by images; empty where walls are particles
  std::vector<Wall<Dim>> walls;             ///< likewise, of finite size
  std::vector<WallPoint<Dim>> wall_points;  ///< of these walls; the wall particle with the id k stands on point k
  bool settles = false;  ///< the particles are no lattice at the walls: they are shifted before the first step

  std::vector<Inlet<Dim>> inlets;  ///< as they stand at the start
  std::vector<Outlet<Dim>> outlets;
  std::int64_t next_id = 0;  ///< of the first particle that enters

  /// Appends the share of one of `ranks` ranks in the initial particles, anywhere in space; the shares of all ranks
  /// make the whole, the same for every number of ranks.
  std::function<void(int rank, int ranks, Particles<Dim>&)> fill;

  /// Unit normal of the wall, into the fluid, at one of its wall particles [-]; between the walls' normals in a corner.
  std::function<Vector<Dim>(const Vector<Dim>&)> wall_normal;

  /// True for a wall particle of the plate or floor, whose force the history gives.
  std::function<bool(const Vector<Dim>&)> on_floor;
};

}  // namespace impinge
