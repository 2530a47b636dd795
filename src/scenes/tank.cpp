#include <algorithm>
#include <cmath>

#include "impinge/boundaries/wall.hpp"
#include "impinge/core/mpi.hpp"
#include "impinge/scenes/box_lattice.hpp"
#include "impinge/scenes/scenes.hpp"

namespace impinge {
namespace {

constexpr double least_gap = 0.25;  // between a region's particles and a wall [dp]

/// How far a position lies inside the side walls and the floor [m]; 0 between them.
template <int Dim>
double depth_in_walls(const Vector<Dim>& position, const Vector<Dim>& size) {
  double depth = 0.0;
  for (int axis = 0; axis < Dim; ++axis) {
    depth = std::max(depth, -position[axis]);
    if (axis < Dim - 1) depth = std::max(depth, position[axis] - size[axis]);
  }
  return depth;
}

/// -1 at the low wall along an axis, 1 at the high one, 0 at none; for wall particles.
template <int Dim>
int wall_side(const Vector<Dim>& position, const Vector<Dim>& size, double spacing, int axis) {
  if (axis < Dim - 1 && position[axis] > size[axis] - 1e-9 * spacing) return 1;
  return position[axis] <= 0.0 ? -1 : 0;
}

}  // namespace

template <int Dim>
Scene<Dim> make_tank(const MethodSettings& method, const TankSettings& tank, const std::vector<FluidRegion>& regions) {
  const bool mirror = method.walls.model == WallModel::mirror;
  const double fluid_height = tank.fluid_height;
  BoxLattice<Dim> lattice{.spacing = method.particles.spacing};
  Vector<Dim> size;
  for (int k = 0; k < Dim; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    size[k] = tank.size[axis];
    lattice.low[k] = -wall_layers * lattice.spacing;
    lattice.extent[axis] = std::lround(size[k] / lattice.spacing) + (k == Dim - 1 ? 1 : 2) * wall_layers;
  }

  Scene<Dim> scene;
  scene.bounds = {mirror ? Vector<Dim>{} : lattice.low, size};
  if (!mirror)
    for (int k = 0; k < Dim - 1; ++k) scene.bounds.high[k] += wall_layers * lattice.spacing;
  scene.bounds.high[Dim - 1] += size[Dim - 1];
  for (int k = 0; mirror && k < Dim; ++k) {
    Face<Dim> low, high;
    low.normal[k] = 1.0;
    high.normal[k] = -1.0;
    high.point[k] = size[k];
    scene.mirrors.push_back(low);
    if (k < Dim - 1) scene.mirrors.push_back(high);
  }

  const std::vector<PlacedRegion<Dim>> fluid = placed<Dim>(regions, lattice.spacing);
  scene.next_id = lattice.count() + count_points(fluid);
  scene.fill = [=](int rank, int ranks, Particles<Dim>& particles) {
    for_share(lattice.count(), rank, ranks, [&](std::int64_t k) {
      Vector<Dim> position = lattice.point(k);
      const double depth = depth_in_walls(position, size);
      if (depth == 0.0 && position[Dim - 1] > fluid_height) return;
      const ParticleType type = depth == 0.0              ? ParticleType::fluid
                                : depth < lattice.spacing ? ParticleType::wall
                                                          : ParticleType::ghost;
      if (mirror && type == ParticleType::ghost) return;
      if (mirror)  // wall particles stand on the surface
        for (int axis = 0; axis < Dim; ++axis)
          position[axis] = std::clamp(position[axis], 0.0, std::nextafter(size[axis], 0.0));
      particles.append({position, {}, 0.0, 0.0, k, type});
    });
    const auto is_inside = [&](const Vector<Dim>& position) {
      const double gap = least_gap * lattice.spacing;
      for (int axis = 0; axis < Dim; ++axis)
        if (position[axis] < gap || position[axis] > size[axis] - (axis < Dim - 1 ? gap : 0.0)) return false;
      return true;
    };
    fill_regions<Dim>(fluid, lattice.count(), rank, ranks, is_inside, particles);
  };
  scene.wall_normal = [=, spacing = lattice.spacing](const Vector<Dim>& position) {
    Vector<Dim> normal;
    for (int axis = 0; axis < Dim; ++axis) normal[axis] = -wall_side(position, size, spacing, axis);
    return 1.0 / norm(normal) * normal;
  };
  scene.on_floor = [=, spacing = lattice.spacing](const Vector<Dim>& position) {
    for (int axis = 0; axis < Dim - 1; ++axis)
      if (wall_side(position, size, spacing, axis) != 0) return false;
    return wall_side(position, size, spacing, Dim - 1) != 0;
  };
  return scene;
}

template Scene<2> make_tank(const MethodSettings&, const TankSettings&, const std::vector<FluidRegion>&);
template Scene<3> make_tank(const MethodSettings&, const TankSettings&, const std::vector<FluidRegion>&);

}  // namespace impinge
