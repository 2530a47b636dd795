#include "impinge/method/density.hpp"

#include "impinge/method/operators.hpp"
#include "impinge/method/smoothing.hpp"

namespace impinge {
namespace {

// One particle that misses few neighbours among others that miss none is disorder, not a surface. In a closed container
// it would be the only place where the pressure is zero.
template <int Dim>
void leave_out_lone(double n0, State<Dim>& state) {
  constexpr double least_density = 0.6;  // [n0]
  Particles<Dim>& particles = state.particles;
  const PairList& near = state.near();
  const int first_image = state.walls.first_image();
  state.refresh(particles.free_surface);
  const auto is_lone = [&](int i) {
    for (int k = near.begin(i); k < near.end(i); ++k) {
      const int j = near.index[static_cast<std::size_t>(k)];
      if (!particles.free_surface[static_cast<std::size_t>(j)]) continue;
      if (j < first_image || state.walls.originals()[static_cast<std::size_t>(j - first_image)] != i) return false;
    }
    return true;
  };
  std::vector<int> lone;
  for (int i = 0; i < particles.owned; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (particles.free_surface[self] && particles.number_density[self] > least_density * n0 && is_lone(i))
      lone.push_back(i);
  }
  for (const int i : lone) particles.free_surface[static_cast<std::size_t>(i)] = 0;
}

}  // namespace

template <int Dim>
void measure_density(const MethodSettings& settings, const LatticeSums& lattice, State<Dim>& state) {
  Particles<Dim>& particles = state.particles;
  const PairList& near = state.near();
  const double n0 = lattice.number_density;
  const FreeSurfaceSettings& limits = settings.free_surface;
  const bool walls_measure = settings.walls.model == WallModel::mirror;
  const PressureSettings& pressure = settings.pressure;
  const bool corrects = pressure.corrected_divergence || pressure.corrected_gradient ||
                        needs_velocity_gradients(settings) ||
                        (is_viscous(settings.fluid) && settings.fluid.corrected_viscosity);
  const bool needs_all_asymmetries = needs_asymmetry(settings);
  number_density(near, particles.number_density);
  state.role.assign(static_cast<std::size_t>(state.walls.first_image()), PressureRole::absent);
  state.asymmetry.assign(particles.position.size(), {});
  if (corrects) state.correction.assign(state.owned(), {});
  for (int i = 0; i < particles.owned; ++i) {
    const auto self = static_cast<std::size_t>(i);
    const ParticleType type = particles.type[self];
    particles.free_surface[self] = 0;
    if (type == ParticleType::inlet) state.role[self] = PressureRole::zero;
    if (type != ParticleType::fluid && (type != ParticleType::wall || walls_measure)) continue;
    const double n = particles.number_density[self];
    const bool undecided = n >= limits.surface_density * n0 && n <= limits.interior_density * n0;
    if (undecided || needs_all_asymmetries) state.asymmetry[self] = asymmetry<Dim>(near, particles.position, n0, i);
    if (corrects && type == ParticleType::fluid)
      state.correction[self] = moment_correction<Dim>(near, particles.position, n0, i);
    const bool surface = n < limits.surface_density * n0 ||
                         (undecided && norm(state.asymmetry[self]) > limits.asymmetry * lattice.surface_asymmetry);
    particles.free_surface[self] = surface;
    const bool zero = limits.zero_outside && type == ParticleType::fluid ? is_spray(particles, n0, self) : surface;
    state.role[self] = zero ? PressureRole::zero : PressureRole::unknown;
    if (type == ParticleType::wall) state.asymmetry[self] = {};  // the free surface is the fluid's
  }
  if (limits.zero_outside) leave_out_lone(n0, state);
  const Halo& halo = state.decomposition.halo();
  if (!needs_all_asymmetries) {
    halo.refresh_together(particles.owned, state.role, particles.free_surface);
  } else {
    halo.refresh_together(particles.owned, state.role, particles.free_surface, state.asymmetry);
    state.walls.copy_directions(state.asymmetry);
  }
  state.walls.copy(particles.free_surface);
}

template void measure_density(const MethodSettings&, const LatticeSums&, State<2>&);
template void measure_density(const MethodSettings&, const LatticeSums&, State<3>&);

}  // namespace impinge
