#include <algorithm>
#include <cmath>
#include <memory>

#include "impinge/core/mpi.hpp"
#include "impinge/scenes/scenes.hpp"
#include "impinge/scenes/wet_space.hpp"

namespace impinge {
namespace {

constexpr double least_gap = 0.25;  // between a region's particles and a wall [dp]

/// Wall points in their places, sorted so that the nearest one is found quickly.
class PointsByPlace {
 public:
  explicit PointsByPlace(std::vector<WallPoint> points) : points_(std::move(points)) {
    std::ranges::stable_sort(points_, {}, [](const WallPoint& point) { return point.position[0]; });
  }

  const WallPoint& nearest(const Vector<2>& place) const {
    const auto x = [](const WallPoint& point) { return point.position[0]; };
    auto right = std::ranges::lower_bound(points_, place[0], {}, x);
    auto left = right;
    const WallPoint* best = nullptr;
    double least = std::numeric_limits<double>::infinity();
    const auto consider = [&](const WallPoint& point) {
      const double distance = norm(point.position - place);
      if (distance < least) {
        least = distance;
        best = &point;
      }
    };
    while (true) {
      const bool go_right = right != points_.end() && x(*right) - place[0] < least;
      const bool go_left = left != points_.begin() && place[0] - x(*(left - 1)) < least;
      if (!go_right && !go_left) return *best;
      if (go_right) consider(*right++);
      if (go_left) consider(*--left);
    }
  }

 private:
  std::vector<WallPoint> points_;
};

/// Where a scene may have fluid at the start: between its walls and out of the way of its inlets.
class Room {
 public:
  Room(const std::vector<Wall>& walls, const std::vector<Inlet<2>>& inlets, double spacing)
      : wet_(walls, 0.0, spacing), inlets_(inlets) {}

  bool contains(const Vector<2>& place, double gap) const {
    for (const Inlet<2>& inlet : inlets_)
      if (inlet.blows && inlet.distance_past(place) < 0.0 && inlet.distance_from_block(place) <= gap) return false;
    return wet_.contains(place, gap);
  }

 private:
  WetSpace wet_;
  std::vector<Inlet<2>> inlets_;
};

std::vector<Inlet<2>> inlets_of(const MethodSettings& method, const SceneSettings& settings) {
  std::vector<Inlet<2>> inlets;
  for (const InletEntry& entry : settings.inlets)
    inlets.push_back(inlet_of(entry, method.particles.spacing, method.kernel));
  return inlets;
}

/// The rows of the inlets that blow at the start, numbered from `id` on.
void fill_inlets(const std::vector<Inlet<2>>& inlets, std::int64_t id, int rank, int ranks, Particles<2>& particles) {
  for (const Inlet<2>& inlet : inlets) {
    if (!inlet.blows) continue;
    const auto of_row = static_cast<std::int64_t>(inlet.section.size());
    for_share(inlet.rows * of_row, rank, ranks, [&](std::int64_t k) {
      const double behind = inlet.last_row + static_cast<double>(k / of_row) * inlet.spacing;
      particles.append({inlet.at(behind, inlet.section[static_cast<std::size_t>(k % of_row)]), inlet.velocity(), 0.0,
                        0.0, id + k, ParticleType::inlet});
    });
    id += inlet.rows * of_row;
  }
}

std::int64_t count_rows(const std::vector<Inlet<2>>& inlets) {
  std::int64_t count = 0;
  for (const Inlet<2>& inlet : inlets)
    if (inlet.blows) count += inlet.rows * static_cast<std::int64_t>(inlet.section.size());
  return count;
}

std::vector<WallPoint> points_at(const Scene<2>& scene, double time) {
  std::vector<WallPoint> points = scene.wall_points;
  for (WallPoint& point : points) {
    const Wall& wall = scene.walls[static_cast<std::size_t>(point.wall)];
    if (!wall.motion) continue;
    const Pose<2> pose = wall.motion(time);
    point.position = pose.of_position(point.position);
    point.normal = pose.of_direction(point.normal);
  }
  return points;
}

}  // namespace

template <int Dim>
Scene<Dim> make_open_scene(const MethodSettings& method, const SceneSettings& settings) {
  const double spacing = method.particles.spacing;
  Scene<Dim> scene;
  scene.bounds = {vector_of<Dim>(settings.domain.low), vector_of<Dim>(settings.domain.high)};
  for (const OutletEntry& entry : settings.outlets)
    if (auto outlet = outlet_of<Dim>(entry)) scene.outlets.push_back(std::move(*outlet));
  std::vector<WallPoint> points;  // in their places at the start
  std::vector<Inlet<2>> inlets;
  if constexpr (Dim == 2) {
    scene.walls = walls_of(settings.scene_walls, settings.motions);
    scene.wall_points = wall_points(scene.walls, spacing);
    points = points_at(scene, 0.0);
    inlets = inlets_of(method, settings);
    scene.inlets = inlets;
  }
  const auto of_walls = static_cast<std::int64_t>(points.size());
  const Room room(scene.walls, inlets, spacing);
  const std::vector<PlacedRegion<Dim>> fluid = placed<Dim>(settings.regions, spacing);
  const std::int64_t of_fluid = count_points(fluid);
  scene.next_id = of_walls + of_fluid + count_rows(inlets);
  scene.fill = [=, bounds = scene.bounds](int rank, int ranks, Particles<Dim>& particles) {
    if constexpr (Dim == 2) {
      for_share(of_walls, rank, ranks, [&](std::int64_t k) {
        particles.append({points[static_cast<std::size_t>(k)].position, {}, 0.0, 0.0, k, ParticleType::wall});
      });
    }
    const auto is_inside = [&](const Vector<Dim>& position) {
      for (int k = 0; k < Dim; ++k)
        if (position[k] < bounds.low[k] || position[k] >= bounds.high[k]) return false;
      if constexpr (Dim == 2) return room.contains(position, least_gap * spacing);
      return true;
    };
    fill_regions<Dim>(fluid, of_walls, rank, ranks, is_inside, particles);
    if constexpr (Dim == 2) fill_inlets(inlets, of_walls + of_fluid, rank, ranks, particles);
  };
  if constexpr (Dim == 2) {
    if (points.empty()) return scene;
    const auto by_place = std::make_shared<const PointsByPlace>(points);
    scene.wall_normal = [by_place](const Vector<2>& place) { return by_place->nearest(place).normal; };
    scene.on_floor = [](const Vector<2>&) { return false; };
  }
  return scene;
}

template <int Dim>
RegionVolume volume_between_walls(const MethodSettings& method, const SceneSettings& settings,
                                  const FluidRegion& region) {
  const double spacing = method.particles.spacing;
  const PlacedRegion<Dim> placed_region(region, spacing);
  if constexpr (Dim == 2) {
    if (!settings.scene_walls.empty() || !settings.inlets.empty()) {
      const Room room(walls_of(settings.scene_walls, settings.motions), inlets_of(method, settings), spacing);
      const auto volume = [&](double step, double gap) {
        const PlacedRegion<2> lattice(region, step);
        std::int64_t count = 0;
        Vector<2> position;
        for (std::int64_t k = 0; k < lattice.points(); ++k)
          count += lattice.point(k, position) && room.contains(position, gap) ? 1 : 0;
        return static_cast<double>(count) * step * step;
      };
      constexpr double fine = 0.2;  // [dp]
      return {volume(fine * spacing, 0.0), volume(spacing, least_gap * spacing)};
    }
  }
  return {placed_region.volume(), static_cast<double>(placed_region.count()) * std::pow(spacing, Dim)};
}

template RegionVolume volume_between_walls<2>(const MethodSettings&, const SceneSettings&, const FluidRegion&);
template RegionVolume volume_between_walls<3>(const MethodSettings&, const SceneSettings&, const FluidRegion&);
template Scene<2> make_open_scene(const MethodSettings&, const SceneSettings&);
template Scene<3> make_open_scene(const MethodSettings&, const SceneSettings&);

}  // namespace impinge
