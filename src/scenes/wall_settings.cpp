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

bool closed(const WallEntry& entry) { return !entry.is_open(); }

/// True if such a shape has such a side.
bool has_side(const WallEntry& entry) {
  return entry.wet == Wet::both || closed(entry) == (entry.wet == Wet::outside || entry.wet == Wet::inside);
}

}  // namespace

void declare_walls(Keys& keys, std::vector<WallEntry>& walls) {
  keys.list("wall", walls, "a wall, 2D", {.fixed = true}, [](Keys& inner, WallEntry& wall) {
    inner.add("name", wall.name, "name of the wall", {.fallback = "wall_<number>"});
    declare_shape(inner, wall, ShapeKind::any);
    inner.add("wet", wall.wet,
              "where fluid may be: outside or inside a shape with an inside, to the left or the right of the way along "
              "a line, or on both sides",
              {.fallback = "outside; of a line both"});
    inner.add("slip", wall.slip, "a viscous fluid slips along the wall; false: it sticks to it");
    inner.add("motion", wall.motion, "name of the [[motion]] that moves it; several walls may have one");
  });
}

void derive_walls(const Keys& keys, std::vector<WallEntry>& walls) {
  for (std::size_t k = 0; k < walls.size(); ++k) {
    WallEntry& wall = walls[k];
    if (!keys.given(wall.name)) wall.name = fmt::format("wall_{}", k + 1);
    if (!keys.given(wall.wet) && keys.usable(wall.shape)) wall.wet = closed(wall) ? Wet::outside : Wet::both;
    derive_shape(keys, 2, wall);
  }
}

void check_walls(Keys& keys, double spacing, const std::vector<WallEntry>& walls,
                 const std::vector<MotionEntry>& motions) {
  check_names(keys, walls);
  for (const WallEntry& wall : walls) {
    if (keys.usable(wall.shape, wall.wet) && !has_side(wall)) {
      keys.mistake(wall.wet, closed(wall)
                                 ? "a shape with an inside has no such side; allowed: \"outside\", \"inside\", \"both\""
                                 : "a line has no such side; allowed: \"left\", \"right\", \"both\"");
    }
    check_shape(keys, 2, ShapeKind::any, wall);
    if (keys.usable(wall.motion) && wall.motion != no_motion && !motion_named(wall.motion, motions)) {
      std::vector<std::string> names{in_quotes(no_motion)};
      for (const MotionEntry& motion : motions) names.push_back(in_quotes(motion.name));
      keys.mistake(wall.motion, fmt::format("no [[motion]] has this name; allowed: {}", fmt::join(names, ", ")));
    }
    if (!is_usable(keys, wall)) continue;
    std::vector<std::string> mistakes;
    if (const auto outline = outline_of(wall, mistakes)) {
      constexpr int most = std::numeric_limits<std::int32_t>::max();
      const double count = outline->length() / spacing;
      if (!(count <= most))
        mistakes.push_back(fmt::format("makes some {:.2g} wall particles; allowed: at most {}", count, most));
      if (count < 1.0)
        mistakes.push_back(
            fmt::format("shorter than a spacing, {:.3g} m; allowed: at least {} m", outline->length(), spacing));
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

std::optional<Wall> wall_of(const WallEntry& entry, const std::vector<MotionEntry>& motions) {
  std::vector<std::string> mistakes;
  std::optional<Outline> outline = outline_of(entry, mistakes);
  if (!outline) return {};
  std::shared_ptr<const Motion<2>> motion;
  if (const MotionEntry* named = motion_named(entry.motion, motions)) {
    std::optional<Motion<2>> made = motion_of(*named);
    if (!made) return {};
    motion = std::make_shared<const Motion<2>>(std::move(*made));
  }
  return Wall{.name = entry.name,
              .outline = std::move(*outline),
              .wet_right = entry.wet == Wet::outside || entry.wet == Wet::right || entry.wet == Wet::both,
              .wet_left = entry.wet == Wet::inside || entry.wet == Wet::left || entry.wet == Wet::both,
              .slip = entry.slip,
              .motion = std::move(motion)};
}

std::vector<Wall> walls_of(const std::vector<WallEntry>& entries, const std::vector<MotionEntry>& motions) {
  std::vector<Wall> walls;
  std::map<std::string, std::shared_ptr<const Motion<2>>> shared;
  for (const WallEntry& entry : entries) {
    auto wall = wall_of(entry, motions);
    if (!wall) continue;
    if (wall->motion) wall->motion = shared.emplace(entry.motion, wall->motion).first->second;
    walls.push_back(std::move(*wall));
  }
  return walls;
}

}  // namespace impinge
