#include "impinge/validation/space_target.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "impinge/scenes/scenes.hpp"
#include "impinge/validation/round_jet.hpp"
#include "impinge/validation/target_search.hpp"

namespace impinge {
namespace {

using std::numbers::pi;

constexpr double on_plane = 1e-3;     // off it [dp]
constexpr double right_angle = 1e-4;  // a jet is perpendicular to a wall at least so nearly [rad]
constexpr double in_gap = 1e-2;       // a jet fills a gap at least so nearly [dp]
constexpr double large = 2.75;        // a wall is, that reaches so far [footprints]
constexpr int azimuths = 360;         // in which the ends of a wall are looked for

/// Flat faces of walls at rest in one plane, wet on the same side.
struct FlatWall {
  Vector<3> point, normal;  // the normal into the fluid
  double tolerance;         // [m]
  std::vector<std::shared_ptr<const Patch>> patches{};

  double height(const Vector<3>& place) const { return dot(place - point, normal); }
  /// True where the foot of a place is on a face.
  bool holds(const Vector<3>& place) const {
    const Vector<3> foot = place - height(place) * normal;
    return std::ranges::any_of(patches,
                               [&](const auto& patch) { return patch->distance(foot, 2.0 * tolerance) <= tolerance; });
  }
};

/// Where a ray meets a wall.
struct Meeting {
  double distance = std::numeric_limits<double>::infinity();  // [m]
  const Wall<3>* wall = nullptr;
  const Patch* patch = nullptr;
  Vector<3> normal;  // of the wall's front
};

class SpaceTargetSearch {
 public:
  explicit SpaceTargetSearch(const Case& config)
      : config_(config), dp_(config.particles.spacing), scene_(make_scene<3>(config, config)) {}

  JetTarget target() {
    const InletEntry& entry = config_.inlets.front();
    direction_ = scene_.inlets.front().direction;
    from_ = vector_of<3>(entry.center);
    target_.speed = entry.speed;
    target_.density = config_.fluid.density;
    target_.spacing = dp_;
    if (entry.section == InletSection::annulus) refuse("the section of its inlet is an annulus");
    meet_wall();
    if (entry.section == InletSection::circle) {
      target_.width = 2.0 * entry.radius;
      meet_round();
    } else {
      target_.width = entry.height;
      meet_slot(scene_.inlets.front().across[0], entry.width);
    }
    return std::move(target_);
  }

 private:
  [[noreturn]] void refuse(const std::string& reason) const { refuse_target(config_, reason); }

  bool is_outside(const Vector<3>& place) const {
    for (int k = 0; k < 3; ++k)
      if (!(place[k] > scene_.bounds.low[k] && place[k] < scene_.bounds.high[k])) return true;
    return std::ranges::any_of(scene_.outlets, [&](const Outlet<3>& outlet) { return outlet.has_passed(place); });
  }

  /// The first facet in a direction, a unit vector.
  Meeting meeting(const Vector<3>& from, const Vector<3>& direction) const {
    Meeting first;
    for (const Wall<3>& wall : scene_.walls) {
      for (const auto& patch : wall.surface->patches()) {
        for (const Facet& facet : patch->facets()) {
          const auto corner = [&](std::size_t k) { return patch->points()[static_cast<std::size_t>(facet[k])]; };
          const std::array corners{corner(0), corner(1), corner(2)};
          const Vector<3> normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
          const double slope = dot(normal, direction);
          if (slope == 0.0) continue;
          const double distance = dot(normal, corners[0] - from) / slope;
          if (!(distance > 0.0 && distance < first.distance)) continue;
          const Vector<3> place = from + distance * direction;
          if (norm(nearest_on_facet(corners, place).point - place) > on_plane * dp_) continue;
          first = {distance, &wall, patch.get(), 1.0 / norm(normal) * normal};
        }
      }
    }
    return first;
  }

  /// The flat wall of a meeting from its wet side, and the faces in line with it.
  FlatWall flat_wall(const Meeting& meeting, const Vector<3>& from, const Vector<3>& direction) const {
    const Wall<3>& wall = *meeting.wall;
    if (wall.motion) refuse(fmt::format("the wall {} that its jet meets moves", wall.name));
    if (!meeting.patch->is_flat()) refuse(fmt::format("the wall {} is not flat where its jet meets it", wall.name));
    const bool front = dot(meeting.normal, direction) < 0.0;
    if (!(front ? wall.wet_front : wall.wet_back))
      refuse(fmt::format("its jet meets the dry side of the wall {}", wall.name));
    FlatWall flat{.point = from + meeting.distance * direction,
                  .normal = (front ? 1.0 : -1.0) * meeting.patch->normal(),
                  .tolerance = on_plane * dp_};
    for (const Wall<3>& other : scene_.walls) {
      if (other.motion) continue;
      for (const auto& patch : other.surface->patches()) {
        if (!patch->is_flat()) continue;
        const bool same_side = dot(patch->normal(), flat.normal) > 0.0;
        if ((same_side ? other.wet_front : other.wet_back) &&
            std::ranges::all_of(patch->points(), [&](const Vector<3>& corner) {
              return std::abs(flat.height(corner)) <= flat.tolerance;
            }))
          flat.patches.push_back(patch);
      }
    }
    return flat;
  }

  /// Finds wall, distance, angle and the axes of the frame.
  void meet_wall() {
    const Meeting first = meeting(from_, direction_);
    if (!first.wall) refuse("its inlet's axis meets no wall");
    plate_ = flat_wall(first, from_, direction_);
    target_.distance = first.distance;
    SpacePlate& space = target_.space.emplace();
    space.z = plate_.normal;
    Vector<3> along = direction_ - dot(direction_, space.z) * space.z;
    double angle = std::atan2(-dot(direction_, space.z), norm(along));
    if (angle < grazing) refuse("its jet grazes a wall, at less than 1 degree");
    if (0.5 * pi - angle < right_angle) {
      angle = 0.5 * pi;
      int least = 0;  // the axis that the wall is most along
      for (int k = 1; k < 3; ++k)
        if (std::abs(space.z[k]) < std::abs(space.z[least]) - on_plane) least = k;
      along = {};
      along[least] = 1.0;
      along -= dot(along, space.z) * space.z;
    }
    target_.angle = angle;
    space.x = 1.0 / norm(along) * along;
    space.y = cross(space.z, space.x);
  }

  /// How far a wall goes from the stagnation point in a direction, up to its end, an outlet or another wall.
  /// `is_channel`: what else must be true of a place.
  template <class IsChannel>
  double reach(const Vector<3>& way, IsChannel&& is_channel) const {
    const Vector<3> above = target_.space->origin + outlet_height * dp_ * target_.space->z;
    const double step = search_step * dp_, longest = norm(scene_.bounds.high - scene_.bounds.low);
    return distance_until(longest, step, [&](double distance) {
      const Vector<3> place = above + distance * way;
      if (is_outside(place) || !plate_.holds(place) || !is_channel(place)) return true;
      const Vector<3> before = above + std::max(distance - step, 0.0) * way;
      return std::ranges::any_of(
          scene_.walls, [&](const Wall<3>& wall) { return !wall.motion && wall.surface->meets(before, place); });
    });
  }

  /// Calls add(id, place in the frame, area) for the wall particles on the plate.
  template <class Add>
  void for_points(Add&& add) const {
    const SpacePlate& space = *target_.space;
    for (std::size_t k = 0; k < scene_.wall_points.size(); ++k) {
      const WallPoint<3>& point = scene_.wall_points[k];
      const Vector<3> place = space.of_position(point.position);
      if (std::abs(place[2]) > plate_.tolerance || dot(point.normal, space.z) < 0.5) continue;
      if (scene_.walls[static_cast<std::size_t>(point.wall)].motion) continue;
      add(static_cast<std::int64_t>(k), place, point.area);
    }
  }

  void meet_round() {
    SpacePlate& space = *target_.space;
    const double radius = 0.5 * target_.width, angle = target_.angle;
    space.origin = from_ + target_.distance * direction_ - radius / std::tan(angle) * space.x;
    target_.type = TargetType::flat_wall;
    std::vector<double> reaches;
    for (int k = 0; k < azimuths; ++k) {
      const double azimuth = 2.0 * pi * k / azimuths;
      const double longest =
          reach(std::cos(azimuth) * space.x + std::sin(azimuth) * space.y, [](const Vector<3>&) { return true; });
      if (longest < large * footprint(angle, azimuth) * radius)
        refuse(
            fmt::format("the wall that its jet meets at {:.4g} degrees reaches {:.3g} jet diameters from the "
                        "stagnation point, at {:.3g} degrees from the direction of the flow, up to the outlets; "
                        "needed are {:.3g}",
                        angle * 180.0 / pi, longest / target_.width, azimuth * 180.0 / pi,
                        0.5 * large * footprint(angle, azimuth)));
      reaches.push_back(longest);
      const double film = radius * radius * film_law(angle, azimuth), turn = 2.0 * pi / azimuths;
      const double beyond = film * film / (radius * radius * pi) * turn;
      space.force_beyond += beyond / (2.0 * longest * longest);
      space.moment_beyond += beyond * std::cos(azimuth) / longest;
    }
    space.reach = std::ranges::min(reaches);
    target_.end = reaches.front();
    target_.begin = -reaches[azimuths / 2];
    for_points([&](std::int64_t id, const Vector<3>& place, double area) {
      const double azimuth = std::atan2(place[1], place[0]);
      const auto nearest = static_cast<std::size_t>(std::lround(azimuth * azimuths / (2.0 * pi)) + azimuths) % azimuths;
      if (std::hypot(place[0], place[1]) <= reaches[nearest]) space.points[id] = {place[0], place[1], area};
    });
  }

  void meet_slot(const Vector<3>& across, double depth) {
    SpacePlate& space = *target_.space;
    constexpr double parallel = 1e-4;  // [rad]
    const Vector<3> start = from_ + search_step * dp_ * direction_;
    std::array<FlatWall, 2> sides;
    for (const double sign : {1.0, -1.0}) {
      const Vector<3> way = sign * across;
      const Meeting side = meeting(start, way);
      if (!side.wall || std::abs(side.distance - 0.5 * depth) > in_gap * dp_)
        refuse("the width of its rectangular inlet is not the gap between two walls beside it");
      FlatWall& flat = sides[sign > 0.0 ? 0 : 1];
      flat = flat_wall(side, start, way);
      if (norm(flat.normal + way) > parallel) refuse("the walls beside its rectangular inlet are not parallel");
    }
    if (std::abs(dot(space.z, across)) > parallel)
      refuse("the wall that its jet meets is not perpendicular to those beside its inlet");
    const auto is_channel = [&](const Vector<3>& place) { return sides[0].holds(place) && sides[1].holds(place); };
    const double beside = distance_until(target_.distance, search_step * dp_,
                                         [&](double distance) { return !is_channel(from_ + distance * direction_); });
    if (beside < target_.distance) refuse("the walls beside its jet do not reach from the inlet to the wall it meets");
    if (target_.angle == 0.5 * pi) space.x = cross(across, space.z);
    space.y = cross(space.z, space.x);
    space.depth = depth;
    const AnalyticJet jet(target_.width, target_.speed, target_.density, target_.angle);
    space.origin = from_ + target_.distance * direction_ - jet.axis_position() * space.x;
    target_.type = TargetType::plate;
    target_.begin = -reach(-1.0 * space.x, is_channel);
    target_.end = reach(space.x, is_channel);
    if (!is_long_enough(jet, target_.begin, target_.end))
      refuse(
          fmt::format("the wall that its jet meets at {:.4g} degrees reaches from {:.3g} to {:.3g} jet widths from "
                      "the stagnation point, up to the outlets, and has a pressure there",
                      target_.angle * 180.0 / pi, target_.begin / target_.width, target_.end / target_.width));
    add_columns();
  }

  /// Adds the wall particles of a slot, and the columns that stand for them.
  void add_columns() {
    SpacePlate& space = *target_.space;
    target_.points.emplace();
    for_points([&](std::int64_t id, const Vector<3>& place, double area) {
      if (!(place[0] > target_.begin && place[0] < target_.end) || std::abs(place[1]) > 0.5 * space.depth) return;
      space.points[id] = {place[0], place[1], area};
      const auto column = static_cast<std::int64_t>((place[0] - target_.begin) / dp_);
      JetTarget::Point& point = target_.points->try_emplace(column, JetTarget::Point{0.0, 0.0, 1.0}).first->second;
      point.x += place[0] * area;
      point.length += area;
    });
    for (auto& [column, point] : *target_.points) {
      point.x /= point.length;
      point.length /= space.depth;
    }
  }

  const Case& config_;
  double dp_;
  Scene<3> scene_;
  Vector<3> from_, direction_;  // of the jet
  FlatWall plate_{};
  JetTarget target_;
};

}  // namespace

JetTarget space_target(const Case& config) {
  check_inlets_of_target(config, 1);
  return SpaceTargetSearch(config).target();
}

Particles<2> in_frame(const JetTarget& target, const Particles<3>& particles) {
  struct Sum {
    double area = 0.0, pressure = 0.0, impulse = 0.0;  // the others weighted with the area
  };
  const SpacePlate& space = *target.space;
  Particles<2> result;
  std::map<std::int64_t, Sum> columns;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.type[i] == ParticleType::wall) {
      const auto found = space.points.find(particles.id[i]);
      if (found == space.points.end()) continue;
      const SpacePlate::Point& point = found->second;
      Sum& column = columns[static_cast<std::int64_t>((point.x - target.begin) / target.spacing)];
      column.area += point.area;
      column.pressure += point.area * particles.pressure[i];
      column.impulse += point.area * particles.pressure_impulse[i];
      continue;
    }
    const Vector<3> position = space.of_position(particles.position[i]);
    const Vector<3> velocity = space.of_direction(particles.velocity[i]);
    result.append({{{position[0], position[2]}},
                   {{velocity[0], velocity[2]}},
                   particles.pressure[i],
                   particles.pressure_impulse[i],
                   particles.id[i],
                   particles.type[i]});
    result.free_surface.back() = particles.free_surface[i];
  }
  for (const auto& [column, sum] : columns)
    result.append({{{target.points->at(column).x, 0.0}},
                   {},
                   sum.pressure / sum.area,
                   sum.impulse / sum.area,
                   column,
                   ParticleType::wall});
  return result;
}

}  // namespace impinge
