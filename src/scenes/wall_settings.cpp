#include "impinge/scenes/wall_settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "impinge/scenes/check_names.hpp"

namespace impinge {
namespace {

bool closed(const WallEntry& entry) { return entry.mesh ? entry.mesh->closed() : entry.has_inside(); }

/// The sides that such a shape has, beside both.
std::array<Wet, 2> sides_of(const WallEntry& entry, int dimension) {
  if (closed(entry)) return {Wet::outside, Wet::inside};
  return dimension == 2 ? std::array{Wet::left, Wet::right} : std::array{Wet::front, Wet::back};
}

void make_surface(WallEntry& wall) {
  wall.mesh_mistakes.clear();
  wall.mesh_warnings.clear();
  std::optional<Facets> facets = scaled_facets(wall, wall.mesh_mistakes);
  if (!facets) return;
  const Transform<3> placement = placement_of<3>(wall);
  for (Vector<3>& point : facets->points) point = placement(point);
  if (std::optional<Mesh> mesh = make_mesh(*facets, wall.mesh_mistakes, wall.mesh_warnings))
    wall.mesh = std::make_shared<const Mesh>(std::move(*mesh));
}

/// A wall's length over the spacing, or its area over the spacing's square; nothing, and what is wrong with its
/// numbers, if there is no such wall.
std::optional<double> size_of(const WallEntry& wall, int dimension, double spacing,
                              std::vector<std::string>& mistakes) {
  if (dimension == 3) {
    mistakes = wall.mesh_mistakes;
    return wall.mesh ? std::optional(wall.mesh->area() / (spacing * spacing)) : std::nullopt;
  }
  const std::optional<Outline> outline = outline_of(wall, mistakes);
  return outline ? std::optional(outline->length() / spacing) : std::nullopt;
}

template <int Dim>
std::shared_ptr<const Surface<Dim>> surface_of(const WallEntry& entry) {
  if constexpr (Dim == 3) {
    return entry.mesh;
  } else {
    std::vector<std::string> mistakes;
    std::optional<Outline> outline = outline_of(entry, mistakes);
    return outline ? std::make_shared<const Outline>(std::move(*outline)) : nullptr;
  }
}

}  // namespace

void declare_walls(Keys& keys, std::vector<WallEntry>& walls) {
  keys.list("wall", walls, "a wall", {.fixed = true}, [](Keys& inner, WallEntry& wall) {
    inner.add("name", wall.name, "name of the wall", {.fallback = "wall_<number>"});
    declare_shape(inner, wall, ShapeKind::any);
    inner.add("wet", wall.wet,
              "where fluid may be: outside or inside a shape with an inside, to the left or the right of the way along "
              "a line, in front of an open surface (where its corners are seen counter-clockwise) or at its back, or "
              "on both sides",
              {.fallback = "outside; of a line or an open surface both"});
    inner.add("slip", wall.slip, "a viscous fluid slips along the wall; false: it sticks to it");
    inner.add("motion", wall.motion, "name of the [[motion]] that moves it; several walls may have one");
  });
}

void derive_walls(const Keys& keys, int dimension, std::vector<WallEntry>& walls) {
  for (std::size_t k = 0; k < walls.size(); ++k) {
    WallEntry& wall = walls[k];
    if (!keys.given(wall.name)) wall.name = fmt::format("wall_{}", k + 1);
    derive_shape(keys, dimension, wall);
    const ShapeSettings& shape = wall;
    if (dimension == 3 && is_usable(keys, shape)) make_surface(wall);
    if (!keys.given(wall.wet) && keys.usable(wall.shape)) wall.wet = closed(wall) ? Wet::outside : Wet::both;
  }
}

void check_walls(Keys& keys, int dimension, double spacing, const std::vector<WallEntry>& walls,
                 const std::vector<MotionEntry>& motions) {
  check_names(keys, walls);
  for (const WallEntry& wall : walls) {
    if (keys.usable(wall.shape, wall.wet) && wall.wet != Wet::both) {
      const auto sides = sides_of(wall, dimension);
      if (std::ranges::find(sides, wall.wet) == sides.end())
        keys.mistake(wall.wet, fmt::format("{} has no such side; allowed: {}, {}, \"both\"",
                                           closed(wall)     ? "a shape with an inside"
                                           : dimension == 2 ? "a line"
                                                            : "an open surface",
                                           in_quotes(word_of(sides[0])), in_quotes(word_of(sides[1]))));
    }
    check_shape(keys, dimension, ShapeKind::any, wall);
    if (keys.usable(wall.motion) && wall.motion != no_motion && !motion_named(wall.motion, motions)) {
      std::vector<std::string> names{in_quotes(no_motion)};
      for (const MotionEntry& motion : motions) names.push_back(in_quotes(motion.name));
      keys.mistake(wall.motion, fmt::format("no [[motion]] has this name; allowed: {}", fmt::join(names, ", ")));
    }
    if (!is_usable(keys, wall)) continue;
    std::vector<std::string> mistakes;
    if (const auto count = size_of(wall, dimension, spacing, mistakes)) {
      constexpr int most = std::numeric_limits<std::int32_t>::max();
      if (!(*count <= most))
        mistakes.push_back(fmt::format("makes some {:.2g} wall particles; allowed: at most {}", *count, most));
      if (*count < 1.0)
        mistakes.push_back(dimension == 2 ? fmt::format("shorter than a spacing, {:.3g} m; allowed: at least {} m",
                                                        *count * spacing, spacing)
                                          : fmt::format("smaller than the square of a spacing, {:.3g} m^2; allowed: at "
                                                        "least {:.6g} m^2",
                                                        *count * spacing * spacing, spacing * spacing));
    }
    for (const std::string& what : mistakes) keys.mistake(wall.shape, what);
  }
}

bool is_usable(const Keys& keys, const WallEntry& wall, const std::vector<MotionEntry>& motions) {
  const ShapeSettings& shape = wall;
  if (!is_usable(keys, shape) || !keys.usable(wall.motion)) return false;
  const MotionEntry* motion = motion_named(wall.motion, motions);
  return motion ? is_usable(keys, *motion) : wall.motion == no_motion;
}

const MotionEntry* motion_named(const std::string& name, const std::vector<MotionEntry>& motions) {
  const auto found = std::ranges::find(motions, name, &MotionEntry::name);
  return found == motions.end() ? nullptr : &*found;
}

template <int Dim>
std::optional<Wall<Dim>> wall_of(const WallEntry& entry, const std::vector<MotionEntry>& motions) {
  const std::shared_ptr<const Surface<Dim>> surface = surface_of<Dim>(entry);
  if (!surface) return {};
  std::shared_ptr<const Motion<Dim>> motion;
  if (const MotionEntry* named = motion_named(entry.motion, motions)) {
    std::optional<Motion<Dim>> made = motion_of<Dim>(*named);
    if (!made) return {};
    motion = std::make_shared<const Motion<Dim>>(std::move(*made));
  }
  const auto is_wet = [&](auto... words) { return entry.wet == Wet::both || ((entry.wet == words) || ...); };
  return Wall<Dim>{.name = entry.name,
                   .surface = surface,
                   .wet_front = is_wet(Wet::outside, Wet::right, Wet::front),
                   .wet_back = is_wet(Wet::inside, Wet::left, Wet::back),
                   .slip = entry.slip,
                   .motion = std::move(motion)};
}

template <int Dim>
std::vector<Wall<Dim>> walls_of(const std::vector<WallEntry>& entries, const std::vector<MotionEntry>& motions) {
  std::vector<Wall<Dim>> walls;
  std::map<std::string, std::shared_ptr<const Motion<Dim>>> shared;
  for (const WallEntry& entry : entries) {
    auto wall = wall_of<Dim>(entry, motions);
    if (!wall) continue;
    if (wall->motion) wall->motion = shared.emplace(entry.motion, wall->motion).first->second;
    walls.push_back(std::move(*wall));
  }
  return walls;
}

template std::optional<Wall<2>> wall_of(const WallEntry&, const std::vector<MotionEntry>&);
template std::optional<Wall<3>> wall_of(const WallEntry&, const std::vector<MotionEntry>&);
template std::vector<Wall<2>> walls_of(const std::vector<WallEntry>&, const std::vector<MotionEntry>&);
template std::vector<Wall<3>> walls_of(const std::vector<WallEntry>&, const std::vector<MotionEntry>&);

}  // namespace impinge
