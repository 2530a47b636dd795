#include "impinge/observe/wall_forces.hpp"

#include <fmt/format.h>

#include "impinge/observe/column.hpp"
#include "impinge/observe/place.hpp"

namespace impinge {
template <int Dim>
std::vector<std::string> WallForces<Dim>::columns() const {
  std::vector<std::string> columns;
  for (const Wall& wall : walls_) {
    const std::string name = in_column(wall.name);
    columns.push_back(fmt::format("fx_{} [N/m]", name));
    columns.push_back(fmt::format("fy_{} [N/m]", name));
    columns.push_back(fmt::format("torque_{} [N]", name));
  }
  return columns;
}

template <int Dim>
std::vector<double> WallForces<Dim>::measure(MPI_Comm comm, const Particles<Dim>& particles, double time) const {
  std::vector<double> values(3 * walls_.size());
  if constexpr (Dim == 2) {
    const std::vector<Pose<2>> poses = poses_of(walls_, time);
    for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
      const auto id = static_cast<std::size_t>(particles.id[i]);
      if (particles.type[i] != ParticleType::wall || id >= points_.size()) continue;
      const WallPoint& point = points_[id];
      const auto wall = static_cast<std::size_t>(point.wall);
      const Pose<2>& pose = poses[wall];
      const Vector<2> force = -particles.pressure[i] * point.area * pose.of_direction(point.normal);
      const Vector<2> arm = pose.of_direction(point.position);
      values[3 * wall] += force[0];
      values[3 * wall + 1] += force[1];
      values[3 * wall + 2] += arm[0] * force[1] - arm[1] * force[0];
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm);
  return values;
}

template class WallForces<2>;
template class WallForces<3>;

}  // namespace impinge
