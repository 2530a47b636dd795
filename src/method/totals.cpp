#include "impinge/method/totals.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace impinge {

template <int Dim>
bool measure_totals(MPI_Comm comm, const MethodSettings& settings, const Particles<Dim>& particles,
                    const std::function<bool(const Vector<Dim>&)>& on_floor, StepReport& report) {
  const double spacing = settings.particles.spacing;
  const double mass = settings.fluid.density * std::pow(spacing, Dim);
  const double area = std::pow(spacing, Dim - 1);
  std::array<double, 4> sums{};    // particles, fluid, kinetic energy, floor force
  std::array<double, 3> maxima{};  // speed squared, pressure, not a number
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    sums[0] += 1.0;
    const double pressure = particles.pressure[i];
    maxima[1] = std::max(maxima[1], pressure);
    if (!std::isfinite(pressure) || !std::isfinite(norm(particles.velocity[i]))) maxima[2] = 1.0;
    if (particles.type[i] == ParticleType::fluid) {
      const double speed2 = dot(particles.velocity[i], particles.velocity[i]);
      sums[1] += 1.0;
      sums[2] += 0.5 * mass * speed2;
      maxima[0] = std::max(maxima[0], speed2);
    } else if (particles.type[i] == ParticleType::wall) {
      if (on_floor(particles.position[i])) sums[3] += area * pressure;
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, comm);
  MPI_Allreduce(MPI_IN_PLACE, maxima.data(), static_cast<int>(maxima.size()), MPI_DOUBLE, MPI_MAX, comm);
  report.particles = static_cast<std::int64_t>(sums[0]);
  report.fluid = static_cast<std::int64_t>(sums[1]);
  report.kinetic_energy = sums[2];
  report.floor_force = sums[3];
  report.max_speed = std::sqrt(maxima[0]);
  report.max_pressure = maxima[1];
  return maxima[2] == 0.0;
}

template <int Dim>
void average_wall_pressure(const StepReport& report, AveragingWindow& window, Particles<Dim>& particles) {
  const double before = report.time - report.dt;
  if (before - window.end > 0.5 * report.dt) {  // none yet, or a restart that averages from a later time on
    std::ranges::fill(particles.pressure_impulse, 0.0);
    window.begin = before;
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
    if (particles.type[i] == ParticleType::wall) particles.pressure_impulse[i] += report.dt * particles.pressure[i];
  window.end = report.time;
}

template bool measure_totals(MPI_Comm, const MethodSettings&, const Particles<2>&,
                             const std::function<bool(const Vector<2>&)>&, StepReport&);
template bool measure_totals(MPI_Comm, const MethodSettings&, const Particles<3>&,
                             const std::function<bool(const Vector<3>&)>&, StepReport&);
template void average_wall_pressure(const StepReport&, AveragingWindow&, Particles<2>&);
template void average_wall_pressure(const StepReport&, AveragingWindow&, Particles<3>&);

}  // namespace impinge
