#pragma once
// Particle shifting keeps the cloud regular; docs/method.md (19), (20).

#include "impinge/method/settings.hpp"
#include "impinge/method/state.hpp"

namespace impinge {

/// What shifting does to the owned particles.
template <int Dim>
struct Shift {
  std::vector<Vector<Dim>> displacement;     ///< [m]
  std::vector<Vector<Dim>> velocity_change;  ///< [m/s]
};

/// Particles drift to where neighbours are missing, delta = C u_ref dt F_i, at most 0.1 dp. They do not drift through
/// the free surface; beside it, they push each other apart where they are too near. They take the velocity of the
/// place that they drift to, within the range of their neighbours', and of that they are pushed to as far as momentum
/// allows. `speed`: u_ref [m/s]; `spacing`: dp [m]; `n0`: number density of the full lattice [-]; `gradient`: of the
/// velocities [1/s]. Collective.
template <int Dim>
Shift<Dim> shift_of(const ShiftingSettings& shifting, double speed, double dt, double spacing, double n0,
                    std::span<const Matrix<Dim>> gradient, const State<Dim>& state);

}  // namespace impinge
