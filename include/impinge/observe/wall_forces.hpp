#pragma once
// Force and torque of the fluid on each wall of a scene.

#include <mpi.h>

#include <string>
#include <vector>

#include "impinge/boundaries/scene.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

template <int Dim>
class WallForces {
 public:
  explicit WallForces(const Scene<Dim>& scene) : walls_(scene.walls), points_(scene.wall_points) {}

  bool empty() const { return walls_.empty(); }

  /// Names and units of the values.
  std::vector<std::string> columns() const;

  /// Of each wall at a time [s], the same on all ranks: the pressure's force, -p n area summed over its wall particles,
  /// and its torque about the origin of the wall's frame; in two dimensions per length across, [N/m] and [N],
  /// counter-clockwise. Collective.
  std::vector<double> measure(MPI_Comm comm, const Particles<Dim>& particles, double time) const;

 private:
  std::vector<Wall<Dim>> walls_;
  std::vector<WallPoint<Dim>> points_;
};

}  // namespace impinge
