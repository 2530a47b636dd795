#pragma once
// What a scene's walls, motions, inlets and outlets are like, as texts.

#include <string>
#include <vector>

#include "impinge/method/settings.hpp"
#include "impinge/scenes/settings.hpp"

namespace impinge {

struct SceneReport {
  /// One for each wall, motion, inlet and outlet: length, area, faces and the narrowest gap of a wall until the run's
  /// end; how far a motion goes; what enters when.
  std::vector<std::string> lines;
  /// What is allowed but may not work: gaps narrower than two particles, each with its place and time.
  std::vector<std::string> warnings;
};

/// The settings have passed check_scene.
SceneReport report_scene(const MethodSettings& method, const SceneSettings& settings);

}  // namespace impinge
