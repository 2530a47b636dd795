#include "impinge/method/body_force.hpp"

#include <algorithm>
#include <cmath>

#include "impinge/core/mpi.hpp"
#include "impinge/core/table.hpp"

namespace impinge {
namespace {

Numbers gravity_at(const FluidSettings& fluid, double time) {
  const auto& table = fluid.gravity_at;
  if (table.empty()) return fluid.gravity;
  const auto [before, after, share] = place_in(table, time, &GravityEntry::time);
  Numbers gravity = table[before].value;
  for (std::size_t k = 0; k < gravity.size(); ++k) gravity[k] = std::lerp(gravity[k], table[after].value[k], share);
  return gravity;
}

}  // namespace

template <int Dim>
BodyForce<Dim>::BodyForce(const FluidSettings& fluid, double time) : pull_(fluid.central_force * fluid.central_force) {
  const Numbers gravity = impinge::gravity_at(fluid, time);
  for (int k = 0; k < Dim; ++k) {
    gravity_[k] = gravity[static_cast<std::size_t>(k)];
    centre_[k] = fluid.force_center[static_cast<std::size_t>(k)];
  }
}

template <int Dim>
double BodyForce<Dim>::largest(MPI_Comm comm, const Particles<Dim>& particles) const {
  if (pull_ == 0.0) return norm(gravity_);
  double largest = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
    if (particles.type[i] == ParticleType::fluid) largest = std::max(largest, norm(at(particles.position[i])));
  return max_over_ranks(comm, largest);
}

template class BodyForce<2>;
template class BodyForce<3>;

}  // namespace impinge
