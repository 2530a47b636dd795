#pragma once
// Velocities without the noise of single particles; docs/method.md (21).

#include "impinge/method/settings.hpp"
#include "impinge/method/state.hpp"

namespace impinge {

/// True if something reads the gradients of the velocities.
inline bool needs_velocity_gradients(const MethodSettings& settings) {
  return settings.smoothing.rate > 0.0 || (settings.shifting.coefficient > 0.0 && settings.shifting.correct_velocity);
}

/// Velocity gradients of the moving particles [1/s]: zero for spray and where neighbours are too few. For owned
/// particles and halo. `n0`: number density of the full lattice [-]. Collective.
template <int Dim>
std::vector<Matrix<Dim>> velocity_gradients(double n0, State<Dim>& state);

/// Change of the owned particles' velocities [m/s]: rate (speed dt/dp) 1/n0 sum (u_j - u_i - (G_i + G_j) r_ij/2) W,
/// with half of such a mean at most. What neighbours have in common with a linear field stays, and so does the
/// momentum. This is the dissipation of a Riemann problem between particles whose states are reconstructed linearly
/// (Parshikov & Medin 2002; Frontiere et al. 2017), at a speed of the flow. `speed`: u [m/s]; `spacing`: dp [m].
template <int Dim>
std::vector<Vector<Dim>> smoothing_of(const SmoothingSettings& smoothing, double speed, double dt, double spacing,
                                      double n0, std::span<const Matrix<Dim>> gradient, const State<Dim>& state);

}  // namespace impinge
