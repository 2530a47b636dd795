#pragma once
// What a scene's walls, inlets and outlets are like, as texts.

#include <string>
#include <vector>

#include "impinge/method/settings.hpp"
#include "impinge/scenes/settings.hpp"

namespace impinge {

/// A line for each wall, inlet and outlet: length, area and faces, the narrowest gap to another wall at the start, what
/// enters when.
std::vector<std::string> scene_lines(const MethodSettings& method, const SceneSettings& settings);

/// What is allowed but may not work: gaps between walls, on their wet sides at the start, that are narrower than two
/// particles. Walls that touch have no gap.
std::vector<std::string> scene_warnings(const MethodSettings& method, const SceneSettings& settings);

}  // namespace impinge
