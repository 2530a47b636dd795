#include "impinge/method/viscosity.hpp"

#include <mpi.h>

#include <array>
#include <cmath>
#include <span>

#include "impinge/method/operators.hpp"

namespace impinge {
namespace {

template <int Dim>
Matrix<Dim> gradient_at(const State<Dim>& state, double n0, int i) {
  return velocity_gradient<Dim>(state.near(), state.particles.position, state.particles.velocity, state.wall_normal,
                                state.correction[static_cast<std::size_t>(i)], n0, i);
}

// nu + nu_t [m^2/s] of all particles. Collective.
template <int Dim>
std::vector<double> total_viscosity(double viscosity, double length, double n0, const State<Dim>& state) {
  std::vector<double> total(state.particles.position.size(), viscosity);
  for (std::size_t i = 0; i < state.owned(); ++i)
    if (state.moves(i)) total[i] += eddy_viscosity(gradient_at(state, n0, static_cast<int>(i)), length);
  state.refresh(total);
  return total;
}

// dt times (11a). A pair has the mean of its viscosities, which are `viscosity` if there are none of `total`.
template <int Dim>
std::vector<Vector<Dim>> corrected_change(double dt, double viscosity, std::span<const double> total, double inside,
                                          double n0, double laplacian_factor, State<Dim>& state) {
  const Particles<Dim>& particles = state.particles;
  std::vector<Vector<Dim>> change(state.owned());
  std::array<double, 2> whole{};  // sum W r^2 [m^2] of the particles that are whole, and their number
  std::vector<double> weight;
  state.search.for_far_rows([&](int i, const PairRow& row) {
    const auto self = static_cast<std::size_t>(i);
    ViscousSums<Dim> sums = viscous_sums<Dim>(row, particles.position, particles.velocity, i);
    const double spread = sums.spread;
    if (!total.empty()) {
      weight.assign(row.weight.begin(), row.weight.end());
      for (std::size_t k = 0; k < weight.size(); ++k)
        weight[k] *= 0.5 * (total[self] + total[static_cast<std::size_t>(row.index[k])]);
      sums = viscous_sums<Dim>({row.index, weight}, particles.position, particles.velocity, i);
    }
    const Matrix<Dim> gradient = gradient_at(state, n0, i);
    change[self] = sums.differences;
    for (int k = 0; k < Dim; ++k) change[self] += sums.offsets[k] * gradient.row[static_cast<std::size_t>(k)];
    if (!state.moves(self) || particles.free_surface[self] || particles.number_density[self] < inside * n0) return;
    whole[0] += spread;
    whole[1] += 1.0;
  });
  MPI_Allreduce(MPI_IN_PLACE, whole.data(), static_cast<int>(whole.size()), MPI_DOUBLE, MPI_SUM,
                state.decomposition.comm());
  const double factor = whole[1] > 0.0 ? 2.0 * Dim * whole[1] / whole[0] : laplacian_factor;
  const double diffusion = total.empty() ? viscosity * dt : dt;
  for (Vector<Dim>& one : change) one *= diffusion * factor;
  return change;
}

}  // namespace

template <int Dim>
double eddy_viscosity(const Matrix<Dim>& gradient, double length) {
  double square = 0.0;  // 2 D:D
  for (int k = 0; k < Dim; ++k)
    for (int l = 0; l < Dim; ++l) {
      const double twice = gradient.row[static_cast<std::size_t>(k)][l] + gradient.row[static_cast<std::size_t>(l)][k];
      square += 0.5 * twice * twice;
    }
  return length * length * std::sqrt(square);
}

template <int Dim>
std::vector<Vector<Dim>> viscous_change(const MethodSettings& settings, double dt, double n0, double laplacian_factor,
                                        State<Dim>& state) {
  if (!is_viscous(settings.fluid)) return {};
  Particles<Dim>& particles = state.particles;
  state.decomposition.halo().refresh(particles.velocity, particles.owned);
  state.walls.copy_held_velocities(particles.position, particles.velocity);
  if (settings.fluid.corrected_viscosity) {
    state.refresh_positions();
    std::vector<double> total;
    if (settings.fluid.smagorinsky > 0.0) {
      const double length = settings.fluid.smagorinsky * settings.particles.spacing;
      total = total_viscosity(settings.fluid.viscosity, length, n0, state);
    }
    return corrected_change(dt, settings.fluid.viscosity, total, settings.free_surface.interior_density, n0,
                            laplacian_factor, state);
  }
  const double diffusion = settings.fluid.viscosity * dt;
  std::vector<Vector<Dim>> change(state.owned());
  state.search.for_far_rows([&](int i, const PairRow& row) {
    change[static_cast<std::size_t>(i)] =
        diffusion * velocity_laplacian<Dim>(row, particles.velocity, laplacian_factor, i);
  });
  return change;
}

template double eddy_viscosity(const Matrix<2>&, double);
template double eddy_viscosity(const Matrix<3>&, double);
template std::vector<Vector<2>> viscous_change(const MethodSettings&, double, double, double, State<2>&);
template std::vector<Vector<3>> viscous_change(const MethodSettings&, double, double, double, State<3>&);

}  // namespace impinge
