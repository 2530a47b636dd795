#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

#include "impinge/core/mpi.hpp"
#include "impinge/scenes/region_between_walls.hpp"
#include "impinge/scenes/scenes.hpp"
#include "impinge/scenes/wet_space.hpp"

namespace impinge {
namespace {

constexpr double least_gap = 0.25;  // between a region's particles and the block of an inlet [dp]

/// Wall points in their places, sorted so that the nearest one is found quickly.
template <int Dim>
class PointsByPlace {
 public:
  explicit PointsByPlace(std::vector<WallPoint<Dim>> points) : points_(std::move(points)) {
    std::ranges::stable_sort(points_, {}, [](const WallPoint<Dim>& point) { return point.position[0]; });
  }

  const WallPoint<Dim>& nearest(const Vector<Dim>& place) const {
    const auto x = [](const WallPoint<Dim>& point) { return point.position[0]; };
    auto right = std::ranges::lower_bound(points_, place[0], {}, x);
    auto left = right;
    const WallPoint<Dim>* best = nullptr;
    double least = std::numeric_limits<double>::infinity();
    const auto consider = [&](const WallPoint<Dim>& point) {
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
  std::vector<WallPoint<Dim>> points_;
};

template <int Dim>
bool contains(const Box<Dim>& bounds, const Vector<Dim>& position) {
  for (int k = 0; k < Dim; ++k)
    if (position[k] < bounds.low[k] || position[k] >= bounds.high[k]) return false;
  return true;
}

/// True in the block of an inlet that blows at the start, or nearer to it than `gap` [m].
template <int Dim>
bool is_in_block(const std::vector<Inlet<Dim>>& inlets, const Vector<Dim>& place, double gap) {
  return std::ranges::any_of(inlets, [&](const Inlet<Dim>& inlet) {
    return inlet.blows && inlet.distance_past(place) < 0.0 && inlet.distance_from_block(place) <= gap;
  });
}

template <int Dim>
std::vector<Inlet<Dim>> inlets_of(const MethodSettings& method, const SceneSettings& settings) {
  std::vector<Inlet<Dim>> inlets;
  for (const InletEntry& entry : settings.inlets)
    std::ranges::move(parts_of<Dim>(entry, method.particles.spacing, method.kernel), std::back_inserter(inlets));
  return inlets;
}

/// The rows of the inlets that blow at the start, numbered from `id` on.
template <int Dim>
void fill_inlets(const std::vector<Inlet<Dim>>& inlets, std::int64_t id, int rank, int ranks,
                 Particles<Dim>& particles) {
  for (const Inlet<Dim>& inlet : inlets) {
    if (!inlet.blows) continue;
    const auto of_row = static_cast<std::int64_t>(inlet.section.size());
    for_share(inlet.rows * of_row, rank, ranks, [&](std::int64_t k) {
      const double behind = inlet.last_row + static_cast<double>(k / of_row) * inlet.spacing;
      particles.append({inlet.in_row(behind, static_cast<std::size_t>(k % of_row), id + k - k % of_row),
                        inlet.velocity(), 0.0, 0.0, id + k, ParticleType::inlet});
    });
    id += inlet.rows * of_row;
  }
}

template <int Dim>
std::int64_t count_rows(const std::vector<Inlet<Dim>>& inlets) {
  std::int64_t count = 0;
  for (const Inlet<Dim>& inlet : inlets)
    if (inlet.blows) count += inlet.rows * static_cast<std::int64_t>(inlet.section.size());
  return count;
}

template <int Dim>
std::vector<WallPoint<Dim>> points_at(const Scene<Dim>& scene, double time) {
  std::vector<WallPoint<Dim>> points = scene.wall_points;
  for (WallPoint<Dim>& point : points) {
    const Wall<Dim>& wall = scene.walls[static_cast<std::size_t>(point.wall)];
    if (!wall.motion) continue;
    const Pose<Dim> pose = (*wall.motion)(time);
    point.position = pose.of_position(point.position);
    point.normal = pose.of_direction(point.normal);
  }
  return points;
}

/// Leaves out points that stand in another wall, where none of them moves.
void leave_out_dry(Scene<3>& scene, double spacing) {
  constexpr double before = 0.25;  // the points, it must be wet [dp]
  if (std::ranges::any_of(scene.walls, [](const Wall<3>& wall) { return wall.motion != nullptr; })) return;
  const WetSpace<3> wet(scene.walls, 0.0, spacing);
  std::erase_if(scene.wall_points, [&](const WallPoint<3>& point) {
    return wet.depth(point.position + before * spacing * point.normal) <= 0.0;
  });
}

}  // namespace

template <int Dim>
Scene<Dim> make_open_scene(const MethodSettings& method, const SceneSettings& settings) {
  const double spacing = method.particles.spacing;
  Scene<Dim> scene;
  scene.bounds = {vector_of<Dim>(settings.domain.low), vector_of<Dim>(settings.domain.high)};
  for (const OutletEntry& entry : settings.outlets)
    if (auto outlet = outlet_of<Dim>(entry)) scene.outlets.push_back(std::move(*outlet));
  scene.walls = walls_of<Dim>(settings.scene_walls, settings.motions);
  scene.wall_points = wall_points(scene.walls, spacing);
  if constexpr (Dim == 3) leave_out_dry(scene, spacing);
  scene.inlets = inlets_of<Dim>(method, settings);
  const WetSpace<Dim> wet(scene.walls, 0.0, spacing);
  const std::vector<PlacedRegion<Dim>> regions = placed<Dim>(settings.regions, spacing);
  std::vector<RegionBetweenWalls<Dim>> fluid;
  for (const PlacedRegion<Dim>& region : regions) {
    fluid.emplace_back(region, wet, spacing);
    scene.settles |= fluid.back().is_cut();
  }
  const std::vector<WallPoint<Dim>> points = points_at(scene, 0.0);
  const auto of_walls = static_cast<std::int64_t>(points.size());
  const std::int64_t of_fluid = count_points(regions);
  scene.next_id = of_walls + of_fluid + count_rows(scene.inlets);
  scene.fill = [=, bounds = scene.bounds, inlets = scene.inlets](int rank, int ranks, Particles<Dim>& particles) {
    for_share(of_walls, rank, ranks, [&](std::int64_t k) {
      particles.append({points[static_cast<std::size_t>(k)].position, {}, 0.0, 0.0, k, ParticleType::wall});
    });
    std::int64_t first_id = of_walls;
    for (std::size_t r = 0; r < fluid.size(); ++r) {
      for_share(regions[r].points(), rank, ranks, [&](std::int64_t k) {
        Vector<Dim> position;
        if (fluid[r].point(k, position) && contains(bounds, position) &&
            !is_in_block(inlets, position, least_gap * spacing))
          particles.append({position, regions[r].velocity(position), 0.0, 0.0, first_id + k, ParticleType::fluid});
      });
      first_id += regions[r].points();
    }
    fill_inlets(inlets, of_walls + of_fluid, rank, ranks, particles);
  };
  if (points.empty()) return scene;
  const auto by_place = std::make_shared<const PointsByPlace<Dim>>(points);
  scene.wall_normal = [by_place](const Vector<Dim>& place) { return by_place->nearest(place).normal; };
  scene.on_floor = [](const Vector<Dim>&) { return false; };
  return scene;
}

template <int Dim>
RegionVolume volume_between_walls(const MethodSettings& method, const SceneSettings& settings,
                                  const FluidRegion& region) {
  const double spacing = method.particles.spacing;
  const double of_particle = std::pow(spacing, Dim);
  const PlacedRegion<Dim> placed_region(region, spacing);
  if (!settings.scene_walls.empty() || !settings.inlets.empty()) {
    const WetSpace<Dim> wet(walls_of<Dim>(settings.scene_walls, settings.motions), 0.0, spacing);
    const std::vector<Inlet<Dim>> inlets = inlets_of<Dim>(method, settings);
    const RegionBetweenWalls<Dim> between(placed_region, wet, spacing);
    std::int64_t taken = 0;  // by inlets
    Vector<Dim> position;
    for (std::int64_t k = 0; k < placed_region.points(); ++k)
      taken += between.point(k, position) && is_in_block(inlets, position, least_gap * spacing) ? 1 : 0;
    const double in_blocks = static_cast<double>(taken) * of_particle;
    return {between.volume() - in_blocks, static_cast<double>(between.count()) * of_particle - in_blocks};
  }
  return {placed_region.volume(), static_cast<double>(placed_region.count()) * of_particle};
}

template RegionVolume volume_between_walls<2>(const MethodSettings&, const SceneSettings&, const FluidRegion&);
template RegionVolume volume_between_walls<3>(const MethodSettings&, const SceneSettings&, const FluidRegion&);
template Scene<2> make_open_scene(const MethodSettings&, const SceneSettings&);
template Scene<3> make_open_scene(const MethodSettings&, const SceneSettings&);

}  // namespace impinge
