#include "impinge/method/costs.hpp"

#include "impinge/method/density.hpp"
#include "impinge/method/pressure/two_level.hpp"
#include "impinge/method/smoothing.hpp"
#include "impinge/parallel/decomposition.hpp"
#include "impinge/particles/fields.hpp"

namespace impinge {

template <int Dim>
std::size_t bytes_per_particle() {
  return 2 * field_bytes<Dim> + sizeof(PressureRole) + 6 * sizeof(double) + 5 * sizeof(Vector<Dim>) +
         sizeof(Matrix<Dim>) + sizeof(PetscInt);
}

template <int Dim>
UnitCosts unit_costs(const MethodSettings& settings) {
  const int near = lattice_sums<Dim>(settings.kernel.type, settings.kernel.radius).neighbours;
  const int far = lattice_sums<Dim>(settings.kernel.type, settings.kernel.laplacian_radius).neighbours;
  constexpr double pair = sizeof(int) + sizeof(double);
  constexpr double entry = sizeof(PetscInt) + sizeof(double);
  // A step builds the halo, refreshes role and pressure, and the marks of the search for pockets at least twice; the
  // consistent scheme also surface marks, asymmetry, velocity, its gradient and its change, twice the crowding, and
  // four times the depth of the surface.
  double traffic = sizeof(typename Decomposition<Dim>::HaloRecord) + sizeof(PressureRole) + sizeof(double) + 2.0;
  if (is_viscous(settings.fluid)) traffic += sizeof(Vector<Dim>);
  if (settings.fluid.smagorinsky > 0.0) traffic += sizeof(double);
  if (settings.collision.distance > 0.0) traffic += 2.0 * sizeof(Vector<Dim>);
  if (settings.pressure.packing) traffic += 2.0 * sizeof(double);
  if (needs_asymmetry(settings)) traffic += sizeof(Vector<Dim>) + 1.0;
  if (settings.free_surface.zero_outside) traffic += 4.0 * sizeof(double);
  if (needs_velocity_gradients(settings)) traffic += sizeof(Vector<Dim>) + sizeof(Matrix<Dim>);
  if (settings.shifting.coefficient > 0.0 && settings.shifting.correct_velocity &&
      settings.shifting.least_distance > 0.0)
    traffic += sizeof(Vector<Dim>);
  return {.particle_memory = static_cast<double>(bytes_per_particle<Dim>()) + 2.0 * sizeof(int) +
                             sizeof(Vector<Dim>),  // with the cells' order
          .row_memory = near * pair + (0.5 * far + 1.0) * entry + TwoLevelPreconditioner<Dim>::bytes_per_row,
          .halo_traffic = traffic};
}

template std::size_t bytes_per_particle<2>();
template std::size_t bytes_per_particle<3>();
template UnitCosts unit_costs<2>(const MethodSettings&);
template UnitCosts unit_costs<3>(const MethodSettings&);

}  // namespace impinge
