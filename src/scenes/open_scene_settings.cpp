#include "impinge/scenes/open_scene_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

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

/// The walls whose keys are usable, in two dimensions.
std::vector<Wall> sound_walls(const Keys& keys, const SceneSettings& s, const SceneInputs& in) {
  std::vector<Wall> walls;
  if (!keys.usable(in.dimension) || in.dimension != 2) return walls;
  for (const WallEntry& entry : s.scene_walls)
    if (is_usable(keys, entry))
      if (auto wall = wall_of(entry)) walls.push_back(std::move(*wall));
  return walls;
}

void add_walls(const Keys& keys, const SceneSettings& s, const SceneInputs& in, Bounds& bounds) {
  for (const Wall& wall : sound_walls(keys, s, in)) bounds.add(outline_at(wall, 0.0).bounds());
}

void derive_domain(const Keys& keys, SceneSettings& s, const SceneInputs& in) {
  if (!keys.usable(in.dimension, in.spacing)) return;
  Bounds bounds;
  add_fluid(s, in, bounds);
  const double of_fluid = bounds.longest_side();
  add_walls(keys, s, in, bounds);
  if (bounds.empty()) return;
  const double margin = of_fluid > 0.0 ? of_fluid : bounds.longest_side();
  for (int k = 0; k < in.dimension; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    if (!keys.given(s.domain.low)) s.domain.low[axis] = bounds.box().low[k] - margin;
    if (!keys.given(s.domain.high)) s.domain.high[axis] = bounds.box().high[k] + margin;
  }
}

/// Notes bounds that hold no fluid, or more than can be counted.
void check_domain(Keys& keys, const SceneSettings& s, const SceneInputs& in) {
  const bool has_low = keys.given(s.domain.low), has_high = keys.given(s.domain.high);
  double volume = 1.0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(in.dimension); ++k) {
    const double low = s.domain.low[k], high = s.domain.high[k];
    volume *= high - low;
    if (high - low > 2.0 * in.spacing || (!has_low && !has_high)) continue;  // the default has room around any fluid
    constexpr const char* what = "the bounds are narrower than two particles; allowed: {} {} (m)";
    if (has_high) {
      keys.mistake(s.domain.high, fmt::format(what, "above", number_text(low + 2.0 * in.spacing)));
    } else {
      keys.mistake(s.domain.low, fmt::format(what, "below", number_text(high - 2.0 * in.spacing)));
    }
    return;
  }
  check_count(keys, in, volume);
}

/// Notes walls that reach out of the bounds: their particles would be lost.
void check_walls_in_domain(Keys& keys, const SceneSettings& s, const SceneInputs& in) {
  for (const WallEntry& entry : s.scene_walls) {
    if (!is_usable(keys, entry)) continue;
    const auto wall = wall_of(entry);
    if (!wall) continue;
    const Box<2> box = outline_at(*wall, 0.0).bounds();
    for (int k = 0; k < 2; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      const double low = s.domain.low[axis] + in.spacing, high = s.domain.high[axis] - in.spacing;
      if (box.low[k] >= low && box.high[k] <= high) continue;
      keys.mistake(entry.shape,
                   fmt::format("the wall reaches from {0} = {1:.6g} to {2:.6g} m, nearer to the bounds than "
                               "a spacing or out of them; allowed: [{3:.6g}, {4:.6g}] (m), and domain",
                               k == 0 ? "x" : "y", box.low[k], box.high[k], low, high));
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
  Bounds all = fluid;
  add_walls(keys, s, in, all);
  const double side = all.longest_side();
  const double pull = in.fluid.central_force * in.fluid.central_force * side;
  return std::sqrt(fastest * fastest + 2.0 * (gravity + pull) * side);
}

void derive_open_scene(const Keys& keys, SceneSettings& s, const SceneInputs& in) {
  derive_walls(keys, s.scene_walls);
  derive_domain(keys, s, in);
}

void check_open_scene(Keys& keys, const SceneSettings& s, const SceneInputs& in) {
  const bool has_walls = keys.usable(s.scene_walls) && !s.scene_walls.empty();
  if (has_walls && keys.usable(in.dimension) && in.dimension != 2)
    keys.mistake(s.scene_walls, "walls of any shape exist in two dimensions; allowed: dimension = 2");
  if (has_walls && keys.usable(in.walls.model) && in.walls.model != WallModel::mirror)
    keys.mistake(s.scene_walls, "walls of any shape are no particles; allowed: walls.model = \"mirror\"");
  if (!keys.usable(in.dimension, in.spacing)) return;
  const bool plane_walls = has_walls && in.dimension == 2;
  if (plane_walls) check_walls(keys, in.spacing, s.scene_walls);
  if (!keys.usable(s.regions, s.domain.low, s.domain.high)) return;
  if (s.regions.empty()) {
    keys.mistake(s.geometry, "no fluid; allowed: at least one [[fluid.region]]");
    return;
  }
  check_domain(keys, s, in);
  if (plane_walls) check_walls_in_domain(keys, s, in);
}

void check_count(Keys& keys, const SceneInputs& in, double volume) {
  if (!keys.usable(in.spacing, in.dimension)) return;
  constexpr int most = std::numeric_limits<std::int32_t>::max();
  const double count = volume / std::pow(in.spacing, in.dimension);
  if (count <= most) return;
  keys.mistake(in.spacing, fmt::format("makes some {:.2g} particles; allowed: at most {}", count, most));
}

}  // namespace impinge
