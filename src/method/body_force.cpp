#include "impinge/method/body_force.hpp"

#include <algorithm>

#include "impinge/core/mpi.hpp"

namespace impinge {
namespace {

Numbers gravity_at(const FluidSettings& fluid, double time) {
  const auto& table = fluid.gravity_at;
  if (table.empty()) return fluid.gravity;
  const auto after = std::ranges::upper_bound(table, time, {}, &GravityEntry::time);
  if (after == table.begin()) return table.front().value;
  if (after == table.end()) return table.back().value;
  const auto before = std::prev(after);
  const double share = (time - before->time) / (after->time - before->time);
  Numbers gravity = before->value;
  for (std::size_t k = 0; k < gravity.size(); ++k) gravity[k] += share * (after->value[k] - gravity[k]);
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
