#pragma once
// Water levels along lines.

#include <mpi.h>

#include <span>
#include <string>
#include <vector>

#include "impinge/method/settings.hpp"
#include "impinge/observe/place.hpp"
#include "impinge/observe/settings.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

template <int Dim>
class Gauges {
 public:
  Gauges(const std::vector<GaugeSettings>& settings, const Scene<Dim>& scene, const MethodSettings& method);

  bool empty() const { return gauges_.empty(); }

  /// Names and units of the values.
  std::vector<std::string> columns() const;

  /// The level of each gauge [m], the same on all ranks: the largest distance along the line, from where it begins, of
  /// the fluid particles within 0.75 dp of it, and the particle's depth; at most the length, 0 on a dry line. Spray
  /// does not count. `depth`: below the surface, of the owned particles [dp]; empty: half a spacing. Collective.
  std::vector<double> measure(MPI_Comm comm, const Particles<Dim>& particles, std::span<const double> depth) const;

 private:
  struct Gauge {
    std::string name;
    Vector<Dim> point, direction;  // direction: a unit vector
    double length = 0.0;
  };

  double spacing_;
  double n0_;  // number density of the full lattice
  Offsets<Dim> offsets_;
  std::vector<Gauge> gauges_;
};

}  // namespace impinge
