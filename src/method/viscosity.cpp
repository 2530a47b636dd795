#include "impinge/method/viscosity.hpp"

#include <mpi.h>

#include <array>

#include "impinge/method/operators.hpp"

namespace impinge {
namespace {

// dt nu times (11a).
template <int Dim>
std::vector<Vector<Dim>> corrected_change(double diffusion, double inside, double n0, double laplacian_factor,
                                          State<Dim>& state) {
  const Particles<Dim>& particles = state.particles;
  state.refresh_positions();
  std::vector<Vector<Dim>> change(state.owned());
  std::array<double, 2> whole{};  // sum W r^2 [m^2] of the particles that are whole, and their number
  state.search.for_far_rows([&](int i, const PairRow& row) {
    const auto self = static_cast<std::size_t>(i);
    const ViscousSums<Dim> sums = viscous_sums<Dim>(row, particles.position, particles.velocity, i);
    const Matrix<Dim> gradient = velocity_gradient<Dim>(state.near(), particles.position, particles.velocity,
                                                        state.wall_normal, state.correction[self], n0, i);
    change[self] = sums.differences;
    for (int k = 0; k < Dim; ++k) change[self] += sums.offsets[k] * gradient.row[static_cast<std::size_t>(k)];
    if (!state.moves(self) || particles.free_surface[self] || particles.number_density[self] < inside * n0) return;
    whole[0] += sums.spread;
    whole[1] += 1.0;
  });
  MPI_Allreduce(MPI_IN_PLACE, whole.data(), static_cast<int>(whole.size()), MPI_DOUBLE, MPI_SUM,
                state.decomposition.comm());
  const double factor = whole[1] > 0.0 ? 2.0 * Dim * whole[1] / whole[0] : laplacian_factor;
  for (Vector<Dim>& one : change) one *= diffusion * factor;
  return change;
}

}  // namespace

template <int Dim>
std::vector<Vector<Dim>> viscous_change(const MethodSettings& settings, double dt, double n0, double laplacian_factor,
                                        State<Dim>& state) {
  if (settings.fluid.viscosity == 0.0) return {};
  const double diffusion = settings.fluid.viscosity * dt;
  Particles<Dim>& particles = state.particles;
  state.decomposition.halo().refresh(particles.velocity, particles.owned);
  state.walls.copy_held_velocities(particles.position, particles.velocity);
  if (settings.fluid.corrected_viscosity)
    return corrected_change(diffusion, settings.free_surface.interior_density, n0, laplacian_factor, state);
  std::vector<Vector<Dim>> change(state.owned());
  state.search.for_far_rows([&](int i, const PairRow& row) {
    change[static_cast<std::size_t>(i)] =
        diffusion * velocity_laplacian<Dim>(row, particles.velocity, laplacian_factor, i);
  });
  return change;
}

template std::vector<Vector<2>> viscous_change(const MethodSettings&, double, double, double, State<2>&);
template std::vector<Vector<3>> viscous_change(const MethodSettings&, double, double, double, State<3>&);

}  // namespace impinge
