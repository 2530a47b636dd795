#pragma once
// Pressure and velocity at points, fixed or riding on walls.

#include <mpi.h>

#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "impinge/observe/place.hpp"
#include "impinge/observe/settings.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

template <int Dim>
class Probes {
 public:
  /// `spacing`: dp [m].
  Probes(const std::vector<ProbeSettings>& settings, const Scene<Dim>& scene, double spacing);

  bool empty() const { return probes_.empty(); }

  /// Names and units of the values.
  std::vector<std::string> columns() const;

  /// Pressure [Pa] and velocity [m/s] of each probe at a time [s], the same on all ranks; not a number where there is
  /// no fluid. Collective.
  ///
  /// A value at a point is a FluidFit of the fluid that no wall hides. On a face it is the mean over points at most a
  /// spacing apart: dry ones have no pressure, and do not count for the velocity. A riding probe's pressure is that of
  /// the wall particles nearest.
  std::vector<double> measure(MPI_Comm comm, const Particles<Dim>& particles, double time) const;

 private:
  struct Probe {
    std::string name;
    int wall = -1;                    // that it rides on; -1: none
    std::vector<Vector<Dim>> points;  // of the face, where the pose is the identity [m]
    double reach = 0.0;               // of the points around the first [m]
  };

  void ride(const ProbeSettings& settings, const Scene<Dim>& scene, Probe& probe);

  double spacing_;
  Offsets<Dim> offsets_;
  std::vector<Wall<Dim>> walls_;
  std::vector<Probe> probes_;
  // Of each wall particle by its id: the riding probes that it counts for, and its weights there.
  std::unordered_map<std::int64_t, std::vector<std::pair<std::size_t, double>>> riders_;
};

}  // namespace impinge
