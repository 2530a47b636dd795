#pragma once
// The keys of geometry = "scene": regions of fluid and walls, together.

#include "impinge/scenes/settings.hpp"

namespace impinge {

/// The fastest start, and a fall over the scene's longest side [m/s]; of a tank's regions, too. `gravity`: the largest
/// [m/s^2].
double open_scene_speed(const Keys& keys, const SceneSettings& settings, const SceneInputs& inputs, double gravity);

/// Sets what is not given: names, wet sides, fixed points, the bounds.
void derive_open_scene(const Keys& keys, SceneSettings& settings, const SceneInputs& inputs);

/// Notes where the scene's keys contradict each other or those of other modules. The regions are checked before.
void check_open_scene(Keys& keys, const SceneSettings& settings, const SceneInputs& inputs);

/// Notes a spacing that makes too many particles in a volume [m^3, m^2 in 2D]: they are counted by 32-bit integers.
void check_count(Keys& keys, const SceneInputs& inputs, double volume);

}  // namespace impinge
