#include "impinge/observe/probes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "impinge/observe/fluid_value.hpp"

namespace impinge {
namespace {

/// Points on a face around its centre that stand for equal parts of it, at most about a spacing apart.
template <int Dim>
std::vector<Vector<Dim>> points_on_face(const Vector<Dim>& centre, const Vector<Dim>& normal, double diameter,
                                        double spacing) {
  if (diameter == 0.0) return {centre};
  const int count = std::max(1, static_cast<int>(std::ceil(diameter / spacing)));
  const auto at = [&](int k) { return ((k + 0.5) / count - 0.5) * diameter; };
  std::vector<Vector<Dim>> points;
  if constexpr (Dim == 2) {
    const Vector<2> along = 1.0 / norm(normal) * Vector<2>{{-normal[1], normal[0]}};
    for (int k = 0; k < count; ++k) points.push_back(centre + at(k) * along);
  } else {
    const auto cross = [](const Vector<3>& a, const Vector<3>& b) {
      return Vector<3>{{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
    };
    // The axis that the normal is farthest from.
    const auto least = std::ranges::min_element(normal.component, {}, [](double x) { return std::abs(x); });
    Vector<3> axis;
    axis[static_cast<int>(least - normal.component.begin())] = 1.0;
    Vector<3> first = cross(normal, axis);
    first *= 1.0 / norm(first);
    const Vector<3> second = 1.0 / norm(normal) * cross(normal, first);
    for (int k = 0; k < count; ++k)
      for (int l = 0; l < count; ++l)
        if (std::hypot(at(k), at(l)) <= 0.5 * diameter) points.push_back(centre + at(k) * first + at(l) * second);
  }
  return points;
}

}  // namespace

template <int Dim>
Probes<Dim>::Probes(const std::vector<ProbeSettings>& settings, const Scene<Dim>& scene, double spacing)
    : spacing_(spacing), offsets_(scene), walls_(scene.walls) {
  for (const ProbeSettings& one : settings) {
    Probe probe;
    probe.name = one.name;
    const Vector<Dim> position = vector_of<Dim>(one.position);
    for (std::size_t w = 0; w < walls_.size(); ++w)
      if (walls_[w].name == one.wall) probe.wall = static_cast<int>(w);
    probe.points = probe.wall < 0 ? points_on_face(position, vector_of<Dim>(one.normal), one.diameter, spacing)
                                  : std::vector{position};
    for (const Vector<Dim>& point : probe.points) probe.reach = std::max(probe.reach, norm(point - probe.points[0]));
    if (probe.wall >= 0) ride(one, scene, probe);
    probes_.push_back(std::move(probe));
  }
}

// The wall particles of the same side that lie on the face, or, for a point, those within a spacing, linear in their
// distances.
template <int Dim>
void Probes<Dim>::ride(const ProbeSettings& settings, const Scene<Dim>& scene, Probe& probe) {
  const Vector<Dim> position = probe.points[0];
  const WallPoint<Dim>* nearest = nullptr;
  for (const WallPoint<Dim>& point : scene.wall_points)
    if (point.wall == probe.wall && (!nearest || norm(point.position - position) < norm(nearest->position - position)))
      nearest = &point;
  if (!nearest) return;
  constexpr double same_side = 0.5;  // least cosine of the angle between the normals
  double sum = 0.0;
  for (std::size_t k = 0; k < scene.wall_points.size(); ++k) {
    const WallPoint<Dim>& point = scene.wall_points[k];
    if (point.wall != probe.wall || dot(point.normal, nearest->normal) < same_side) continue;
    const double distance = norm(point.position - position);
    const double weight = settings.diameter > 0.0 ? (2.0 * distance <= settings.diameter ? point.area : 0.0)
                                                  : std::max(0.0, 1.0 - distance / spacing_);
    if (weight == 0.0) continue;
    riders_[static_cast<std::int64_t>(k)].emplace_back(probes_.size(), weight);
    sum += weight;
  }
  if (sum == 0.0) riders_[nearest - scene.wall_points.data()].emplace_back(probes_.size(), 1.0);
  // The velocity is that of the fluid in front of the surface.
  constexpr double off_surface = 1e-3;  // [dp]
  probe.points[0] += off_surface * spacing_ * nearest->normal;
}

template <int Dim>
std::vector<std::string> Probes<Dim>::columns() const {
  std::vector<std::string> columns;
  for (const Probe& probe : probes_) {
    columns.push_back(fmt::format("p_{} [Pa]", probe.name));
    for (int k = 0; k < Dim; ++k) columns.push_back(fmt::format("u{}_{} [m/s]", "xyz"[k], probe.name));
  }
  return columns;
}

template <int Dim>
std::vector<double> Probes<Dim>::measure(MPI_Comm comm, const Particles<Dim>& particles, double time) const {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Pose<Dim>> poses = poses_of(walls_, time);
  std::vector<Vector<Dim>> points;       // of all probes, now
  std::vector<std::size_t> first_point;  // of each probe
  for (const Probe& probe : probes_) {
    first_point.push_back(points.size());
    for (Vector<Dim> point : probe.points) {
      if (probe.wall >= 0) point = poses[static_cast<std::size_t>(probe.wall)].of_position(point);
      points.push_back(point);
    }
  }
  first_point.push_back(points.size());

  std::vector<FluidFit<Dim>> fits(points.size());
  std::vector<double> riding(2 * probes_.size());  // weighted pressure and weight of the wall particles
  const double radius = FluidFit<Dim>::radius * spacing_;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.type[i] == ParticleType::wall && !riders_.empty()) {
      if (const auto found = riders_.find(particles.id[i]); found != riders_.end()) {
        for (const auto& [probe, weight] : found->second) {
          riding[2 * probe] += weight * particles.pressure[i];
          riding[2 * probe + 1] += weight;
        }
      }
    }
    if (particles.type[i] != ParticleType::fluid) continue;
    const FluidValue<Dim> value{particles.pressure[i], particles.velocity[i]};
    for (std::size_t p = 0; p < probes_.size(); ++p) {
      const double reach = radius + probes_[p].reach;
      const Vector<Dim> way = offsets_(points[first_point[p]], particles.position[i]);
      if (dot(way, way) > reach * reach) continue;
      for (std::size_t k = first_point[p]; k < first_point[p + 1]; ++k) {
        const Vector<Dim> offset = offsets_(points[k], particles.position[i]);
        if (dot(offset, offset) > radius * radius) continue;
        if (is_hidden(walls_, poses, points[k], points[k] + offset)) continue;
        fits[k].add(1.0 / spacing_ * offset, value);
      }
    }
  }
  std::vector<double> sums = riding;
  for (const FluidFit<Dim>& fit : fits) sums.insert(sums.end(), fit.sums.begin(), fit.sums.end());
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, comm);
  for (std::size_t k = 0; k < fits.size(); ++k)
    std::copy_n(sums.begin() + static_cast<std::ptrdiff_t>(riding.size() + k * FluidFit<Dim>::size),
                FluidFit<Dim>::size, fits[k].sums.begin());

  std::vector<double> values;
  for (std::size_t p = 0; p < probes_.size(); ++p) {
    FluidValue<Dim> total;
    int wet = 0;
    for (std::size_t k = first_point[p]; k < first_point[p + 1]; ++k) {
      const auto value = fits[k].value();
      if (!value) continue;
      ++wet;
      total.pressure += value->pressure;
      total.velocity += value->velocity;
    }
    const auto all = static_cast<double>(first_point[p + 1] - first_point[p]);
    const double weight = sums[2 * p + 1];
    if (probes_[p].wall >= 0) {
      values.push_back(weight > 0.0 ? sums[2 * p] / weight : nothing);
    } else {
      values.push_back(wet > 0 ? total.pressure / all : nothing);
    }
    for (int k = 0; k < Dim; ++k) values.push_back(wet > 0 ? total.velocity[k] / wet : nothing);
  }
  return values;
}

template class Probes<2>;
template class Probes<3>;

}  // namespace impinge
