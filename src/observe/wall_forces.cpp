#include "impinge/observe/wall_forces.hpp"

#include <fmt/format.h>

#include "impinge/observe/column.hpp"
#include "impinge/observe/place.hpp"

namespace impinge {
namespace {

std::array<double, 1> torque_of(const Vector<2>& arm, const Vector<2>& force) { return {cross(arm, force)}; }
std::array<double, 3> torque_of(const Vector<3>& arm, const Vector<3>& force) { return cross(arm, force).component; }

/// Components of a force and a torque.
template <int Dim>
constexpr std::size_t components = Dim == 2 ? 3 : 6;

}  // namespace

template <int Dim>
std::vector<std::string> WallForces<Dim>::columns() const {
  std::vector<std::string> columns;
  for (const Wall<Dim>& wall : walls_) {
    const std::string name = in_column(wall.name);
    for (int k = 0; k < Dim; ++k) columns.push_back(fmt::format("f{}_{} [{}]", "xyz"[k], name, Dim == 2 ? "N/m" : "N"));
    if constexpr (Dim == 2) columns.push_back(fmt::format("torque_{} [N]", name));
    if constexpr (Dim == 3)
      for (const char axis : {'x', 'y', 'z'}) columns.push_back(fmt::format("torque_{}_{} [N m]", axis, name));
  }
  return columns;
}

template <int Dim>
std::vector<double> WallForces<Dim>::measure(MPI_Comm comm, const Particles<Dim>& particles, double time) const {
  std::vector<double> values(components<Dim> * walls_.size());
  const std::vector<Pose<Dim>> poses = poses_of(walls_, time);
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    const auto id = static_cast<std::size_t>(particles.id[i]);
    if (particles.type[i] != ParticleType::wall || id >= points_.size()) continue;
    const WallPoint<Dim>& point = points_[id];
    const auto wall = static_cast<std::size_t>(point.wall);
    const Pose<Dim>& pose = poses[wall];
    const Vector<Dim> force = -particles.pressure[i] * point.area * pose.of_direction(point.normal);
    const auto torque = torque_of(pose.of_direction(point.position), force);
    double* const of_wall = &values[components<Dim> * wall];
    for (int k = 0; k < Dim; ++k) of_wall[k] += force[k];
    for (std::size_t k = 0; k < torque.size(); ++k) of_wall[static_cast<std::size_t>(Dim) + k] += torque[k];
  }
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm);
  return values;
}

template class WallForces<2>;
template class WallForces<3>;

}  // namespace impinge
