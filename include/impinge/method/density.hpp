#pragma once
// What the neighbours say of a particle: density, free surface, corrections of the operators, role in the pressure;
// docs/method.md (4) to (8).

#include "impinge/method/settings.hpp"
#include "impinge/method/state.hpp"
#include "impinge/particles/kernel.hpp"

namespace impinge {

/// True for spray: a fluid particle with so few neighbours that its pressure is 0 and it is not shifted. `n0`: number
/// density of the full lattice [-].
template <int Dim>
bool is_spray(const Particles<Dim>& particles, double n0, std::size_t i) {
  constexpr double spray_density = 0.5;  // [n0]
  return particles.number_density[i] < spray_density * n0;
}

/// True if something reads the asymmetries of a particle's neighbours.
inline bool needs_asymmetry(const MethodSettings& settings) {
  return settings.free_surface.zero_outside || settings.shifting.coefficient > 0.0 ||
         settings.pressure.corrected_gradient;
}

/// Measures number density, free surface (Zhang & Wan 2012), asymmetry F_i, correction L_i and role of every particle
/// with its neighbours. `lattice`: sums of the near radius. Collective.
template <int Dim>
void measure_density(const MethodSettings& settings, const LatticeSums& lattice, State<Dim>& state);

}  // namespace impinge
