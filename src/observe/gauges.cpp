#include "impinge/observe/gauges.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "impinge/method/density.hpp"

namespace impinge {

template <int Dim>
Gauges<Dim>::Gauges(const std::vector<GaugeSettings>& settings, const Scene<Dim>& scene, const MethodSettings& method)
    : spacing_(method.particles.spacing),
      n0_(lattice_sums<Dim>(method.kernel.type, method.kernel.radius).number_density),
      offsets_(scene) {
  for (const GaugeSettings& one : settings) {
    const Vector<Dim> direction = vector_of<Dim>(one.direction);
    gauges_.push_back({one.name, vector_of<Dim>(one.point), 1.0 / norm(direction) * direction, one.length});
  }
}

template <int Dim>
std::vector<std::string> Gauges<Dim>::columns() const {
  std::vector<std::string> columns;
  for (const Gauge& gauge : gauges_) columns.push_back(fmt::format("{} [m]", gauge.name));
  return columns;
}

template <int Dim>
std::vector<double> Gauges<Dim>::measure(MPI_Comm comm, const Particles<Dim>& particles,
                                         std::span<const double> depth) const {
  const double width = 0.75 * spacing_;
  const double half = 0.5 * spacing_;
  std::vector<double> levels(gauges_.size(), 0.0);
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.type[i] != ParticleType::fluid || is_spray(particles, n0_, i)) continue;
    for (std::size_t k = 0; k < gauges_.size(); ++k) {
      const Gauge& gauge = gauges_[k];
      const Vector<Dim> offset = offsets_(gauge.point, particles.position[i]);
      const double along = dot(offset, gauge.direction);
      if (along < -half || along > gauge.length + half) continue;
      const Vector<Dim> across = offset - along * gauge.direction;
      if (dot(across, across) > width * width) continue;
      const double above = depth.empty() ? half : depth[i] * spacing_;
      levels[k] = std::max(levels[k], std::min(along + above, gauge.length));
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, levels.data(), static_cast<int>(levels.size()), MPI_DOUBLE, MPI_MAX, comm);
  return levels;
}

template class Gauges<2>;
template class Gauges<3>;

}  // namespace impinge
