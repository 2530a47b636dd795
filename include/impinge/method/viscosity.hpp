#pragma once
// What viscosity changes of the velocities.

#include <vector>

#include "impinge/method/settings.hpp"
#include "impinge/method/state.hpp"

namespace impinge {

/// Change of the owned particles' velocities by viscosity in a step [m/s], by the pairs of the last step: dt nu lap u
/// (11), or with fluid.corrected_viscosity (11a). Empty without viscosity. `n0`: number density of the full lattice
/// [-], `laplacian_factor`: 2 Dim/(n0 lambda) [1/m^2]. Collective.
template <int Dim>
std::vector<Vector<Dim>> viscous_change(const MethodSettings& settings, double dt, double n0, double laplacian_factor,
                                        State<Dim>& state);

}  // namespace impinge
