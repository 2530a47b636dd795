#include <algorithm>
#include <cmath>
#include <memory>

#include "impinge/core/mpi.hpp"
#include "impinge/scenes/region_between_walls.hpp"
#include "impinge/scenes/scenes.hpp"
#include "impinge/scenes/wet_space.hpp"

namespace impinge {
namespace {

constexpr double least_gap = 0.25;  // between a region's particles and the block of an inlet [dp]

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

template <int Dim>
bool contains(const Box<Dim>& bounds, const Vector<Dim>& position) {
  for (int k = 0; k < Dim; ++k)
    if (position[k] < bounds.low[k] || position[k] >= bounds.high[k]) return false;
  return true;
}

/// True in the block of an inlet that blows at the start, or nearer to it than `gap` [m].
bool is_in_block(const std::vector<Inlet<2>>& inlets, const Vector<2>& place, double gap) {
  return std::ranges::any_of(inlets, [&](const Inlet<2>& inlet) {
    return inlet.blows && inlet.distance_past(place) < 0.0 && inlet.distance_from_block(place) <= gap;
  });
}

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
    const Pose<2> pose = (*wall.motion)(time);
    point.position = pose.of_position(point.position);
    point.normal = pose.of_direction(point.normal);
  }
  return points;
}

/// Puts walls, their points, inlets and the fluid between them into a scene.
void fill_plane_scene(const MethodSettings& method, const SceneSettings& settings, Scene<2>& scene) {
  const double spacing = method.particles.spacing;
  scene.walls = walls_of(settings.scene_walls, settings.motions);
  scene.wall_points = wall_points(scene.walls, spacing);
  scene.inlets = inlets_of(method, settings);
  const WetSpace wet(scene.walls, 0.0, spacing);
  const std::vector<PlacedRegion<2>> regions = placed<2>(settings.regions, spacing);
  std::vector<RegionBetweenWalls> fluid;
  for (const PlacedRegion<2>& region : regions) {
    fluid.emplace_back(region, wet, spacing);
    scene.settles |= fluid.back().is_cut();
  }
  const std::vector<WallPoint> points = points_at(scene, 0.0);
  const auto of_walls = static_cast<std::int64_t>(points.size());
  const std::int64_t of_fluid = count_points(regions);
  scene.next_id = of_walls + of_fluid + count_rows(scene.inlets);
  scene.fill = [=, bounds = scene.bounds, inlets = scene.inlets](int rank, int ranks, Particles<2>& particles) {
    for_share(of_walls, rank, ranks, [&](std::int64_t k) {
      particles.append({points[static_cast<std::size_t>(k)].position, {}, 0.0, 0.0, k, ParticleType::wall});
    });
    std::int64_t first_id = of_walls;
    for (std::size_t r = 0; r < fluid.size(); ++r) {
      for_share(regions[r].points(), rank, ranks, [&](std::int64_t k) {
        Vector<2> position;
        if (fluid[r].point(k, position) && contains(bounds, position) &&
            !is_in_block(inlets, position, least_gap * spacing))
          particles.append({position, regions[r].velocity(position), 0.0, 0.0, first_id + k, ParticleType::fluid});
      });
      first_id += regions[r].points();
    }
    fill_inlets(inlets, of_walls + of_fluid, rank, ranks, particles);
  };
  if (points.empty()) return;
  const auto by_place = std::make_shared<const PointsByPlace>(points);
  scene.wall_normal = [by_place](const Vector<2>& place) { return by_place->nearest(place).normal; };
  scene.on_floor = [](const Vector<2>&) { return false; };
}

}  // namespace

template <int Dim>
Scene<Dim> make_open_scene(const MethodSettings& method, const SceneSettings& settings) {
  Scene<Dim> scene;
  scene.bounds = {vector_of<Dim>(settings.domain.low), vector_of<Dim>(settings.domain.high)};
  for (const OutletEntry& entry : settings.outlets)
    if (auto outlet = outlet_of<Dim>(entry)) scene.outlets.push_back(std::move(*outlet));
  if constexpr (Dim == 2) {
    fill_plane_scene(method, settings, scene);
  } else {
    const std::vector<PlacedRegion<Dim>> fluid = placed<Dim>(settings.regions, method.particles.spacing);
    scene.next_id = count_points(fluid);
    scene.fill = [fluid, bounds = scene.bounds](int rank, int ranks, Particles<Dim>& particles) {
      const auto is_inside = [&](const Vector<Dim>& position) { return contains(bounds, position); };
      fill_regions<Dim>(fluid, 0, rank, ranks, is_inside, particles);
    };
  }
  return scene;
}

template <int Dim>
RegionVolume volume_between_walls(const MethodSettings& method, const SceneSettings& settings,
                                  const FluidRegion& region) {
  const double spacing = method.particles.spacing;
  const double of_particle = std::pow(spacing, Dim);
  const PlacedRegion<Dim> placed_region(region, spacing);
  if constexpr (Dim == 2) {
    if (!settings.scene_walls.empty() || !settings.inlets.empty()) {
      const WetSpace wet(walls_of(settings.scene_walls, settings.motions), 0.0, spacing);
      const std::vector<Inlet<2>> inlets = inlets_of(method, settings);
      const RegionBetweenWalls between(placed_region, wet, spacing);
      std::int64_t taken = 0;  // by inlets
      Vector<2> position;
      for (std::int64_t k = 0; k < placed_region.points(); ++k)
        taken += between.point(k, position) && is_in_block(inlets, position, least_gap * spacing) ? 1 : 0;
      const double in_blocks = static_cast<double>(taken) * of_particle;
      return {between.volume() - in_blocks, static_cast<double>(between.count()) * of_particle - in_blocks};
    }
  }
  return {placed_region.volume(), static_cast<double>(placed_region.count()) * of_particle};
}

template RegionVolume volume_between_walls<2>(const MethodSettings&, const SceneSettings&, const FluidRegion&);
template RegionVolume volume_between_walls<3>(const MethodSettings&, const SceneSettings&, const FluidRegion&);
template Scene<2> make_open_scene(const MethodSettings&, const SceneSettings&);
template Scene<3> make_open_scene(const MethodSettings&, const SceneSettings&);

}  // namespace impinge
