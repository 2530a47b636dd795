#pragma once
// What viscosity changes of the velocities.

#include <vector>

#include "impinge/method/settings.hpp"
#include "impinge/method/state.hpp"

namespace impinge {

/// Viscosity of the eddies that are smaller than a spacing, length^2 sqrt(2 D:D) [m^2/s] (11b) (Smagorinsky 1963). D is
/// the rate of strain of the velocity gradient `gradient` [1/s], `length` C_s dp [m].
template <int Dim>
double eddy_viscosity(const Matrix<Dim>& gradient, double length);

/// Change of the owned particles' velocities by viscosity in a step [m/s], by the pairs of the last step: dt nu lap u
/// (11), or with fluid.corrected_viscosity (11a), that of the eddies (11b) included. Empty without viscosity. `n0`:
/// number density of the full lattice [-], `laplacian_factor`: 2 Dim/(n0 lambda) [1/m^2]. Collective.
template <int Dim>
std::vector<Vector<Dim>> viscous_change(const MethodSettings& settings, double dt, double n0, double laplacian_factor,
                                        State<Dim>& state);

}  // namespace impinge
