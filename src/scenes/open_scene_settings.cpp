#include "impinge/scenes/open_scene_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "impinge/scenes/wall_crossing.hpp"
#include "impinge/scenes/wet_space.hpp"

namespace impinge {
namespace {

/// The smallest box around what was added, in two or three dimensions.
class Bounds {
 public:
  template <int Dim>
  void add(const Box<Dim>& box) {
    for (int k = 0; k < Dim; ++k) {
      box_.low[k] = empty_ ? box.low[k] : std::min(box_.low[k], box.low[k]);
      box_.high[k] = empty_ ? box.high[k] : std::max(box_.high[k], box.high[k]);
    }
    empty_ = false;
  }
  bool empty() const { return empty_; }
  const Box<3>& box() const { return box_; }
  double longest_side() const {
    const Vector<3> size = box_.high - box_.low;
    return std::max({size[0], size[1], size[2]});
  }

 private:
  Box<3> box_;
  bool empty_ = true;
};

void add_fluid(const SceneSettings& s, const SceneInputs& in, Bounds& bounds) {
  for (const FluidRegion& region : s.regions) {
    if (!has_shape(region, in.dimension)) continue;
    if (in.dimension == 2) bounds.add(PlacedRegion<2>(region, in.spacing).bounds());
    if (in.dimension == 3) bounds.add(PlacedRegion<3>(region, in.spacing).bounds());
  }
}

/// A wall that exists, and where it comes from.
template <int Dim>
struct SoundWall {
  const WallEntry* entry;
  Wall<Dim> wall;
};

/// Length in spacings, or area in their squares.
double size_of(const Wall<2>& wall, double spacing) { return wall.surface->length() / spacing; }
double size_of(const Wall<3>& wall, double spacing) { return wall.surface->area() / (spacing * spacing); }

/// The walls that exist.
template <int Dim>
std::vector<SoundWall<Dim>> sound_walls(const Keys& keys, const SceneSettings& s, const SceneInputs& in) {
  std::vector<SoundWall<Dim>> walls;
  if (!keys.usable(in.dimension, in.spacing) || in.dimension != Dim) return walls;
  constexpr double most = std::numeric_limits<std::int32_t>::max();  // particles, as in check_walls
  for (const WallEntry& entry : s.scene_walls) {
    if (!is_usable(keys, entry, s.motions)) continue;
    auto wall = wall_of<Dim>(entry, s.motions);
    if (wall && size_of(*wall, in.spacing) <= most) walls.push_back({&entry, std::move(*wall)});
  }
  return walls;
}

/// Times that tell a wall's motion; 0 alone where it does not move.
std::vector<double> times_of(const Keys& keys, const WallEntry& wall, const SceneSettings& s, const SceneInputs& in,
                             std::size_t most) {
  const MotionEntry* motion = motion_named(wall.motion, s.motions);
  return motion && keys.usable(in.time.end) ? times_of(*motion, in.time.end, most) : std::vector{0.0};
}

constexpr std::size_t many_times = 4000;  // for speeds
constexpr std::size_t some_times = 400;   // for places

/// The bounds of a wall in its place at a time.
Box<2> bounds_at(const Wall<2>& wall, double time) { return outline_at(wall, time).bounds(); }
Box<3> bounds_at(const Wall<3>& wall, double time) {
  if (!wall.motion) return wall.surface->bounds();
  const Pose<3> pose = (*wall.motion)(time);
  Bounds bounds;
  for (const auto& patch : wall.surface->patches()) {
    for (const Vector<3>& point : patch->points()) {
      const Vector<3> place = pose.of_position(point);
      bounds.add(Box<3>{place, place});
    }
  }
  return bounds.box();
}

/// What a wall moves over.
template <int Dim>
Bounds bounds_of(const Keys& keys, const SoundWall<Dim>& wall, const SceneSettings& s, const SceneInputs& in) {
  Bounds bounds;
  for (const double time : times_of(keys, *wall.entry, s, in, some_times)) bounds.add(bounds_at(wall.wall, time));
  return bounds;
}

void add_walls(const Keys& keys, const SceneSettings& s, const SceneInputs& in, Bounds& bounds) {
  for (const SoundWall<2>& wall : sound_walls<2>(keys, s, in)) bounds.add(bounds_of(keys, wall, s, in).box());
  for (const SoundWall<3>& wall : sound_walls<3>(keys, s, in)) bounds.add(bounds_of(keys, wall, s, in).box());
}

/// An inlet and its entry.
template <int Dim>
struct SoundInlet {
  const InletEntry* entry;
  Inlet<Dim> inlet;
};

/// A box around an inlet's rows and the one that may still be behind them.
Box<2> bounds_of(const SoundInlet<2>& sound) {
  const Inlet<2>& inlet = sound.inlet;
  return way_of(inlet, sound.entry->width, -(inlet.rows + 1) * inlet.spacing, 0.0, 0.0).bounds();
}
Box<3> bounds_of(const SoundInlet<3>& sound) {
  const Inlet<3>& inlet = sound.inlet;
  Bounds bounds;
  for (const double past : {-(inlet.rows + 1) * inlet.spacing, 0.0}) {
    if (inlet.radius > 0.0) {
      Box<3> ring{inlet.at(past, {}), inlet.at(past, {})};
      for (int k = 0; k < 3; ++k) {
        const double along = inlet.direction[k], size = inlet.radius * std::sqrt(std::max(0.0, 1.0 - along * along));
        ring.low[k] -= size;
        ring.high[k] += size;
      }
      bounds.add(ring);
    } else {
      for (const double a : {0.0, sound.entry->width})
        for (const double b : {0.0, sound.entry->height})
          bounds.add(Box<3>{inlet.at(past, {a, b}), inlet.at(past, {a, b})});
    }
  }
  return bounds.box();
}

/// The inlets that exist.
template <int Dim>
std::vector<SoundInlet<Dim>> sound_inlets(const Keys& keys, const SceneSettings& s, const SceneInputs& in) {
  std::vector<SoundInlet<Dim>> inlets;
  if (!keys.usable(in.dimension, in.spacing, in.kernel.radius, in.kernel.laplacian_radius) || in.dimension != Dim)
    return inlets;
  for (const InletEntry& entry : s.inlets)
    if (is_usable(keys, Dim, in.spacing, entry))
      inlets.push_back({&entry, inlet_of<Dim>(entry, in.spacing, in.kernel)});
  return inlets;
}

void add_inlets(const Keys& keys, const SceneSettings& s, const SceneInputs& in, Bounds& bounds) {
  for (const SoundInlet<2>& inlet : sound_inlets<2>(keys, s, in)) bounds.add(bounds_of(inlet));
  for (const SoundInlet<3>& inlet : sound_inlets<3>(keys, s, in)) bounds.add(bounds_of(inlet));
}

/// Where an outline comes into another that has an inside.
std::optional<Vector<2>> common_place(const Outline& area, const Outline& outline) {
  if (const Gap gap = narrowest_gap(area, outline); gap.width == 0.0) return gap.begin;
  const Vector<2> point = outline.edges().front().begin;
  if (area.contains(point)) return point;
  return {};
}

/// What is wrong with an inlet between walls that stand as they do at a time; nothing if all is well.
std::string inlet_problem(const SoundInlet<2>& inlet, const std::vector<SoundWall<2>>& walls, double time,
                          const SceneInputs& in) {
  constexpr double beside = 0.25;  // so near to a side, a wall is along it [dp]
  const double margin = beside * in.spacing, reach = in.kernel.largest() * in.spacing, width = inlet.entry->width;
  const Outline block = way_of(inlet.inlet, width, -inlet.inlet.rows * inlet.inlet.spacing, 0.0, margin);
  const Outline before = way_of(inlet.inlet, width, 0.0, reach, margin);
  std::vector<Wall<2>> all;
  for (const SoundWall<2>& wall : walls) {
    const Outline outline = outline_at(wall.wall, time);
    if (const auto place = common_place(block, outline))
      return fmt::format("the inlet is cut by the wall \"{}\", at ({:.4g}, {:.4g}) m", wall.wall.name, (*place)[0],
                         (*place)[1]);
    if (outline.closed() && !wall.wall.wet_back && outline.contains(vector_of<2>(inlet.entry->center)))
      return fmt::format("the inlet is inside the wall \"{}\"", wall.wall.name);
    if (const auto place = common_place(before, outline))
      return fmt::format(
          "blows into the wall \"{}\", at ({:.4g}, {:.4g}) m; allowed: a wall farther away than {:.4g} m, "
          "or along its sides",
          wall.wall.name, (*place)[0], (*place)[1], reach);
    all.push_back(wall.wall);
  }
  if (!WetSpace<2>(all, time, in.spacing).contains(vector_of<2>(inlet.entry->center)))
    return "the inlet is on the dry side of the walls";
  return "";
}

std::string inlet_problem(const SoundInlet<3>& sound, const std::vector<SoundWall<3>>& walls, double time,
                          const SceneInputs& in) {
  const Inlet<3>& inlet = sound.inlet;
  const double reach = in.kernel.largest() * in.spacing;
  std::vector<Wall<3>> all;
  for (const SoundWall<3>& wall : walls) all.push_back(wall.wall);
  const WetSpace<3> wet(all, time, in.spacing);
  const auto text = [](const Vector<3>& x) { return fmt::format("({:.4g}, {:.4g}, {:.4g}) m", x[0], x[1], x[2]); };
  for (std::size_t k = 0; k < inlet.section.size(); ++k) {
    const Vector<3> hindmost = inlet.at(-inlet.rows * inlet.spacing, inlet.section[k]);
    const Vector<3> from = inlet.at(0.0, inlet.section[k]);
    if (!wet.contains(from)) return fmt::format("the inlet is on the dry side of the walls, at {}", text(from));
    for (const Wall<3>& wall : all) {
      const Pose<3> pose = wall.motion ? (*wall.motion)(time) : Pose<3>{};
      if (wall.surface->meets(pose.origin_of(hindmost), pose.origin_of(from)))
        return fmt::format("the inlet is cut by the wall \"{}\", before {}", wall.name, text(from));
      if (wall.surface->meets(pose.origin_of(from), pose.origin_of(from + reach * inlet.direction)))
        return fmt::format(
            "blows into the wall \"{}\", before {}; allowed: a wall farther away than {:.4g} m, or along "
            "its sides",
            wall.name, text(from), reach);
    }
  }
  return "";
}

/// Notes inlets that walls are in the way of, at the start or later.
template <int Dim>
void check_inlets_and_walls(Keys& keys, const SceneSettings& s, const SceneInputs& in) {
  const std::vector<SoundWall<Dim>> walls = sound_walls<Dim>(keys, s, in);
  for (const SoundInlet<Dim>& inlet : sound_inlets<Dim>(keys, s, in)) {
    const double start = std::max(inlet.entry->start, 0.0);
    std::vector<double> times{start};
    for (const SoundWall<Dim>& wall : walls)
      for (const double time : times_of(keys, *wall.entry, s, in, some_times))
        if (time > start && time <= inlet.entry->stop) times.push_back(time);
    for (const double time : times) {
      const std::string problem = inlet_problem(inlet, walls, time, in);
      if (problem.empty()) continue;
      keys.mistake(inlet.entry->center, time > 0.0 ? fmt::format("at t = {:.4g} s {}", time, problem) : problem);
      break;
    }
  }
}

/// Notes inlets that are faster than particles may be, or whose rows are out of the bounds.
template <int Dim>
void check_inlets_in_domain(Keys& keys, const SceneSettings& s, const SceneInputs& in) {
  for (const SoundInlet<Dim>& inlet : sound_inlets<Dim>(keys, s, in)) {
    const double speed = largest_speed(*inlet.entry);
    if (keys.usable(in.time.max_speed, inlet.entry->speed, inlet.entry->speeds, inlet.entry->profile) &&
        speed > in.time.max_speed)
      keys.mistake(inlet.entry->center, fmt::format("blows at {:.4g} m/s; allowed: up to time.max_speed, {} (m/s)",
                                                    speed, number_text(in.time.max_speed)));
    if (!keys.usable(s.domain.low, s.domain.high)) continue;
    const Box<Dim> box = bounds_of(inlet);
    for (int k = 0; k < Dim; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      if (box.low[k] >= s.domain.low[axis] && box.high[k] <= s.domain.high[axis]) continue;
      keys.mistake(inlet.entry->center,
                   fmt::format("its rows reach from {0} = {1:.6g} to {2:.6g} m, out of the bounds; allowed: [{3:.6g}, "
                               "{4:.6g}] (m), and domain",
                               "xyz"[k], box.low[k], box.high[k], s.domain.low[axis], s.domain.high[axis]));
      break;
    }
  }
}

/// The largest speed of a wall's points, and when it is so.
struct FastestMoment {
  double speed = 0.0, time = 0.0;
};

/// Points that tell how fast a wall is. Of many, corners of the box around them do: no point inside is faster.
std::vector<Vector<2>> corners_of(const Outline& outline) {
  std::vector<Vector<2>> points;
  for (const OutlineEdge& edge : outline.edges())
    for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0})
      if (!edge.straight() || share == 0.0 || share == 1.0) points.push_back(edge.at(share));
  return points;
}
std::vector<Vector<3>> corners_of(const Mesh& mesh) {
  constexpr std::size_t many = 1000;
  std::vector<Vector<3>> points;
  for (const auto& patch : mesh.patches()) points.insert(points.end(), patch->points().begin(), patch->points().end());
  if (points.size() <= many) return points;
  points.clear();
  for (int k = 0; k < 8; ++k) points.push_back(mesh.bounds().corner(k));
  return points;
}

template <int Dim>
FastestMoment fastest_moment(const Wall<Dim>& wall, const std::vector<double>& times) {
  FastestMoment fastest;
  if (!wall.motion) return fastest;
  const std::vector<Vector<Dim>> points = corners_of(*wall.surface);
  for (const double time : times) {
    const Pose<Dim> pose = (*wall.motion)(time);
    for (const Vector<Dim>& point : points) {
      const double speed = norm(pose.velocity_at(pose.of_position(point)));
      if (speed > fastest.speed) fastest = {speed, time};
    }
  }
  return fastest;
}

/// Notes walls that are faster than particles may be, and walls that move through others.
template <int Dim>
void check_motion(Keys& keys, const SceneSettings& s, const SceneInputs& in) {
  const std::vector<SoundWall<Dim>> walls = sound_walls<Dim>(keys, s, in);
  if (!keys.usable(in.time.end)) return;
  for (std::size_t b = 0; b < walls.size(); ++b) {
    const auto& [entry, wall] = walls[b];
    const std::vector<double> times = times_of(keys, *entry, s, in, some_times);
    if (keys.usable(in.time.max_speed)) {
      const auto [speed, time] = fastest_moment(wall, times_of(keys, *entry, s, in, many_times));
      if (speed > in.time.max_speed)
        keys.mistake(
            entry->motion,
            fmt::format("moves the wall at {:.4g} m/s at t = {:.4g} s; allowed: up to time.max_speed, {} (m/s)", speed,
                        time, number_text(in.time.max_speed)));
    }
    if constexpr (Dim == 2) {
      for (std::size_t a = 0; a < b; ++a) {
        if (walls[a].entry->motion == entry->motion) continue;
        std::vector<double> of_both = times_of(keys, *walls[a].entry, s, in, some_times);
        of_both.insert(of_both.end(), times.begin(), times.end());
        std::ranges::sort(of_both);
        const auto crossing = first_crossing(wall, walls[a].wall, of_both, in.spacing);
        if (!crossing) continue;
        const auto& [mover, other] =
            entry->motion != no_motion ? std::pair(entry, walls[a].entry) : std::pair(walls[a].entry, entry);
        keys.mistake(
            mover->motion,
            fmt::format("the wall \"{}\" moves through the wall \"{}\", at t = {:.4g} s at ({:.4g}, {:.4g}) m; "
                        "it may touch it and slide along",
                        mover->name, other->name, crossing->time, crossing->place[0], crossing->place[1]));
      }
    }
  }
}

void derive_domain(const Keys& keys, SceneSettings& s, const SceneInputs& in) {
  if (!keys.usable(in.dimension, in.spacing)) return;
  Bounds bounds;
  add_fluid(s, in, bounds);
  const double of_fluid = bounds.longest_side();
  add_walls(keys, s, in, bounds);
  add_inlets(keys, s, in, bounds);
  if (bounds.empty()) return;
  const double margin = of_fluid > 0.0 ? of_fluid : bounds.longest_side();
  for (int k = 0; k < in.dimension; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    if (!keys.given(s.domain.low)) s.domain.low[axis] = bounds.box().low[k] - margin;
    if (!keys.given(s.domain.high)) s.domain.high[axis] = bounds.box().high[k] + margin;
  }
}

/// Notes bounds that hold no fluid.
void check_domain(Keys& keys, const SceneSettings& s, const SceneInputs& in) {
  const bool has_low = keys.given(s.domain.low), has_high = keys.given(s.domain.high);
  for (std::size_t k = 0; k < static_cast<std::size_t>(in.dimension); ++k) {
    const double low = s.domain.low[k], high = s.domain.high[k];
    if (high - low > 2.0 * in.spacing || (!has_low && !has_high)) continue;  // the default has room around any fluid
    constexpr const char* what = "the bounds are narrower than two particles; allowed: {} {} (m)";
    if (has_high) {
      keys.mistake(s.domain.high, fmt::format(what, "above", number_text(low + 2.0 * in.spacing)));
    } else {
      keys.mistake(s.domain.low, fmt::format(what, "below", number_text(high - 2.0 * in.spacing)));
    }
    return;
  }
}

/// Notes walls that reach out of the bounds: their particles would be lost.
template <int Dim>
void check_walls_in_domain(Keys& keys, const SceneSettings& s, const SceneInputs& in) {
  for (const SoundWall<Dim>& wall : sound_walls<Dim>(keys, s, in)) {
    const Box<3> box = bounds_of(keys, wall, s, in).box();
    for (int k = 0; k < Dim; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      const double low = s.domain.low[axis] + in.spacing, high = s.domain.high[axis] - in.spacing;
      if (box.low[k] >= low && box.high[k] <= high) continue;
      keys.mistake(wall.entry->shape,
                   fmt::format("the wall reaches from {0} = {1:.6g} to {2:.6g} m, nearer to the bounds than "
                               "a spacing or out of them; allowed: [{3:.6g}, {4:.6g}] (m), and domain",
                               "xyz"[k], box.low[k], box.high[k], low, high));
      break;
    }
  }
}

}  // namespace

double open_scene_speed(const Keys& keys, const SceneSettings& s, const SceneInputs& in, double gravity) {
  if (!keys.usable(in.dimension, in.spacing)) return 0.0;
  Bounds fluid;
  add_fluid(s, in, fluid);
  double fastest = 0.0;
  for (const FluidRegion& region : s.regions) {
    double rate = std::abs(region.spin);
    for (const double slope : region.gradient) rate = std::max(rate, std::abs(slope));
    fastest = std::max(
        fastest, std::hypot(region.velocity[0], region.velocity[1], region.velocity[2]) + rate * fluid.longest_side());
  }
  const auto add_fastest = [&](const auto& walls) {
    for (const auto& [entry, wall] : walls)
      fastest = std::max(fastest, fastest_moment(wall, times_of(keys, *entry, s, in, many_times)).speed);
  };
  add_fastest(sound_walls<2>(keys, s, in));
  add_fastest(sound_walls<3>(keys, s, in));
  for (const InletEntry& inlet : s.inlets)
    if (keys.usable(inlet.speed, inlet.speeds, inlet.profile)) fastest = std::max(fastest, largest_speed(inlet));
  Bounds all = fluid;
  add_walls(keys, s, in, all);
  add_inlets(keys, s, in, all);
  const double side = all.longest_side();
  const double pull = in.fluid.central_force * in.fluid.central_force * side;
  return std::sqrt(fastest * fastest + 2.0 * (gravity + pull) * side);
}

void derive_open_scene(const Keys& keys, SceneSettings& s, const SceneInputs& in) {
  derive_motions(keys, s.motions);
  if (keys.usable(in.dimension)) derive_walls(keys, in.dimension, s.scene_walls);
  derive_openings(keys, in.dimension, s.inlets, s.outlets);
  derive_domain(keys, s, in);
}

void check_open_scene(Keys& keys, const SceneSettings& s, const SceneInputs& in) {
  const bool has_walls = keys.usable(s.scene_walls) && !s.scene_walls.empty();
  if (has_walls && keys.usable(in.walls.model) && in.walls.model != WallModel::mirror)
    keys.mistake(s.scene_walls, "walls of any shape are no particles; allowed: walls.model = \"mirror\"");
  const bool has_inlets = keys.usable(s.inlets) && !s.inlets.empty();
  if (!keys.usable(in.dimension, in.spacing)) return;
  if (keys.usable(s.outlets)) check_outlets(keys, in.dimension, s.outlets);
  if (keys.usable(s.motions)) check_motions(keys, in.dimension, s.motions);
  if (has_walls) {
    check_walls(keys, in.dimension, in.spacing, s.scene_walls, s.motions);
    in.dimension == 2 ? check_motion<2>(keys, s, in) : check_motion<3>(keys, s, in);
  }
  if (has_inlets) {
    check_inlets(keys, in.dimension, in.spacing, in.kernel, s.inlets);
    in.dimension == 2 ? check_inlets_and_walls<2>(keys, s, in) : check_inlets_and_walls<3>(keys, s, in);
    in.dimension == 2 ? check_inlets_in_domain<2>(keys, s, in) : check_inlets_in_domain<3>(keys, s, in);
  }
  if (!keys.usable(s.regions, s.inlets, s.domain.low, s.domain.high)) return;
  if (s.regions.empty() && s.inlets.empty()) {
    keys.mistake(s.geometry, "no fluid and no inlet; allowed: at least one [[fluid.region]] or [[inlet]]");
    return;
  }
  check_domain(keys, s, in);
  if (has_walls) in.dimension == 2 ? check_walls_in_domain<2>(keys, s, in) : check_walls_in_domain<3>(keys, s, in);
}

void check_count(Keys& keys, const SceneInputs& in, double volume) {
  if (!keys.usable(in.spacing, in.dimension)) return;
  constexpr int most = std::numeric_limits<std::int32_t>::max();
  const double count = volume / std::pow(in.spacing, in.dimension);
  if (count <= most) return;
  keys.mistake(in.spacing, fmt::format("makes some {:.2g} particles; allowed: at most {}", count, most));
}

}  // namespace impinge
