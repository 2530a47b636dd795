#include <algorithm>
#include <cmath>
#include <memory>

#include "impinge/core/mpi.hpp"
#include "impinge/scenes/region_between_walls.hpp"
#include "impinge/scenes/scenes.hpp"
#include "impinge/scenes/wet_space.hpp"

namespace impinge {
namespace {

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

std::vector<WallPoint> points_at(const Scene<2>& scene, double time) {
  std::vector<WallPoint> points = scene.wall_points;
  for (WallPoint& point : points) {
    const Wall& wall = scene.walls[static_cast<std::size_t>(point.wall)];
    if (!wall.motion) continue;
    const Pose<2> pose = (*wall.motion)(time);
    point.position = pose.of_position(point.position);
    point.normal = pose.of_direction(point.normal);
  }
  return points;
}

/// Puts walls, their points and the fluid between them into a scene.
void add_walls(double spacing, const SceneSettings& settings, const std::vector<PlacedRegion<2>>& fluid,
               const std::function<bool(const Vector<2>&)>& is_inside, Scene<2>& scene) {
  scene.walls = walls_of(settings.scene_walls, settings.motions);
  scene.wall_points = wall_points(scene.walls, spacing);
  const std::vector<WallPoint> points = points_at(scene, 0.0);
  const auto of_walls = static_cast<std::int64_t>(points.size());
  scene.next_id += of_walls;
  const WetSpace wet(scene.walls, 0.0, spacing);
  std::vector<RegionBetweenWalls> between;
  for (const PlacedRegion<2>& region : fluid) {
    between.emplace_back(region, wet, spacing);
    scene.settles |= between.back().is_cut();
  }
  scene.fill = [=](int rank, int ranks, Particles<2>& particles) {
    for_share(of_walls, rank, ranks, [&](std::int64_t k) {
      particles.append({points[static_cast<std::size_t>(k)].position, {}, 0.0, 0.0, k, ParticleType::wall});
    });
    std::int64_t first_id = of_walls;
    for (std::size_t r = 0; r < fluid.size(); ++r) {
      for_share(fluid[r].points(), rank, ranks, [&](std::int64_t k) {
        Vector<2> position;
        if (between[r].point(k, position) && is_inside(position))
          particles.append({position, fluid[r].velocity(position), 0.0, 0.0, first_id + k, ParticleType::fluid});
      });
      first_id += fluid[r].points();
    }
  };
  const auto by_place = std::make_shared<const PointsByPlace>(points);
  scene.wall_normal = [by_place](const Vector<2>& place) { return by_place->nearest(place).normal; };
  scene.on_floor = [](const Vector<2>&) { return false; };
}

}  // namespace

template <int Dim>
Scene<Dim> make_open_scene(const MethodSettings& method, const SceneSettings& settings) {
  Scene<Dim> scene;
  scene.bounds = {vector_of<Dim>(settings.domain.low), vector_of<Dim>(settings.domain.high)};
  const auto is_inside = [bounds = scene.bounds](const Vector<Dim>& position) {
    for (int k = 0; k < Dim; ++k)
      if (position[k] < bounds.low[k] || position[k] >= bounds.high[k]) return false;
    return true;
  };
  const std::vector<PlacedRegion<Dim>> fluid = placed<Dim>(settings.regions, method.particles.spacing);
  scene.next_id = count_points(fluid);
  if constexpr (Dim == 2) {
    if (!settings.scene_walls.empty()) {
      add_walls(method.particles.spacing, settings, fluid, is_inside, scene);
      return scene;
    }
  }
  scene.fill = [fluid, is_inside](int rank, int ranks, Particles<Dim>& particles) {
    fill_regions<Dim>(fluid, 0, rank, ranks, is_inside, particles);
  };
  return scene;
}

template <int Dim>
RegionVolume volume_between_walls(const MethodSettings& method, const SceneSettings& settings,
                                  const FluidRegion& region) {
  const double spacing = method.particles.spacing;
  const double of_particle = std::pow(spacing, Dim);
  const PlacedRegion<Dim> placed_region(region, spacing);
  if constexpr (Dim == 2) {
    if (!settings.scene_walls.empty()) {
      const WetSpace wet(walls_of(settings.scene_walls, settings.motions), 0.0, spacing);
      const RegionBetweenWalls between(placed_region, wet, spacing);
      return {between.volume(), static_cast<double>(between.count()) * of_particle};
    }
  }
  return {placed_region.volume(), static_cast<double>(placed_region.count()) * of_particle};
}

template RegionVolume volume_between_walls<2>(const MethodSettings&, const SceneSettings&, const FluidRegion&);
template RegionVolume volume_between_walls<3>(const MethodSettings&, const SceneSettings&, const FluidRegion&);
template Scene<2> make_open_scene(const MethodSettings&, const SceneSettings&);
template Scene<3> make_open_scene(const MethodSettings&, const SceneSettings&);

}  // namespace impinge
