#pragma once
// Walls of any shape: [[wall]] of a case file, in two dimensions.

#include <optional>
#include <string>
#include <vector>

#include "impinge/boundaries/wall.hpp"
#include "impinge/config/key.hpp"
#include "impinge/scenes/shape_settings.hpp"

namespace impinge {

/// The sides of a wall that have fluid: of a closed one, or of a line on the way along it.
enum class Wet { outside, inside, left, right, both };
constexpr auto words(Wet) { return std::to_array<std::string_view>({"outside", "inside", "left", "right", "both"}); }

/// One table of [[wall]].
struct WallEntry : ShapeSettings {
  std::string name;
  Wet wet = Wet::outside;
  bool slip = false;  ///< a viscous fluid slips along it, too
};

/// Declares [[wall]].
void declare_walls(Keys& keys, std::vector<WallEntry>& walls);

/// Sets names, wet sides and fixed points that are not given.
void derive_walls(const Keys& keys, std::vector<WallEntry>& walls);

/// Notes shapes that do not exist, wet sides that a shape has not, names that are used twice, and walls of too many
/// particles. `spacing`: dp [m]. The keys of the dimension, 2, and of `spacing` are usable.
void check_walls(Keys& keys, double spacing, const std::vector<WallEntry>& walls);

/// The wall; nothing if its numbers make none.
std::optional<Wall> wall_of(const WallEntry& entry);

/// All that exist.
std::vector<Wall> walls_of(const std::vector<WallEntry>& entries);

}  // namespace impinge
