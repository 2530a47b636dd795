#pragma once
// Walls of any shape: [[wall]] of a case file.

#include <optional>
#include <string>
#include <vector>

#include "impinge/boundaries/wall.hpp"
#include "impinge/config/key.hpp"
#include "impinge/scenes/motion_settings.hpp"
#include "impinge/scenes/shape_settings.hpp"

namespace impinge {

/// The sides of a wall that have fluid: of a closed one, of a line on the way along it, or of an open surface that it
/// faces or not.
enum class Wet { outside, inside, left, right, front, back, both };
constexpr auto words(Wet) {
  return std::to_array<std::string_view>({"outside", "inside", "left", "right", "front", "back", "both"});
}

/// One table of [[wall]].
struct WallEntry : ShapeSettings {
  std::string name;
  Wet wet = Wet::outside;
  bool slip = false;                            ///< a viscous fluid slips along it, too
  std::string motion = std::string(no_motion);  ///< name of a [[motion]]

  /// In three dimensions, made of the numbers: the surface in its place, or what is wrong with them.
  std::shared_ptr<const Mesh> mesh{};
  std::vector<std::string> mesh_mistakes{}, mesh_warnings{};
};

/// Declares [[wall]].
void declare_walls(Keys& keys, std::vector<WallEntry>& walls);

/// Sets names, wet sides and fixed points that are not given, and makes surfaces in three dimensions.
void derive_walls(const Keys& keys, int dimension, std::vector<WallEntry>& walls);

/// Notes shapes that do not exist, wet sides that a shape has not, names that are used twice, motions that do not
/// exist, and walls of too many particles. `spacing`: dp [m]. The keys of `dimension` and `spacing` are usable.
void check_walls(Keys& keys, int dimension, double spacing, const std::vector<WallEntry>& walls,
                 const std::vector<MotionEntry>& motions);

/// True where all that the wall's shape, place and motion depend on has allowed values.
bool is_usable(const Keys& keys, const WallEntry& wall, const std::vector<MotionEntry>& motions);

/// The motion that a wall names; null if there is none.
const MotionEntry* motion_named(const std::string& name, const std::vector<MotionEntry>& motions);

/// The wall; nothing if its numbers, or those of its motion, make none.
template <int Dim>
std::optional<Wall<Dim>> wall_of(const WallEntry& entry, const std::vector<MotionEntry>& motions);

/// All that exist.
template <int Dim>
std::vector<Wall<Dim>> walls_of(const std::vector<WallEntry>& entries, const std::vector<MotionEntry>& motions);

}  // namespace impinge
