#pragma once
// Cases of scenes with walls, motions, inlets and outlets.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "case_mistakes.hpp"
#include "impinge/scenes/scenes.hpp"

namespace impinge {

inline const std::string scene_head =
    "geometry = \"scene\"\nparticles.spacing = 0.05\nfluid.gravity = [0, -9.81]\ntime = {end = 1.0, dt = 1e-3}\n";
inline const std::string unit_square = "[[fluid.region]]\nshape = \"box\"\nlow = [0, 0]\nhigh = [1, 1]\n";

inline Case scene_case(const std::string& text, const std::vector<std::string>& settings = {}) {
  return parse_case({{"case.toml", scene_head + text}}, settings);
}

inline std::vector<std::string> scene_mistakes(const std::string& text, const std::vector<std::string>& settings = {}) {
  return case_mistakes({{"case.toml", scene_head + text}}, settings);
}

/// The one mistake has the text in it.
inline void expect_mistake(const std::vector<std::string>& found, const std::string& text) {
  ASSERT_EQ(found.size(), 1u) << testing::PrintToString(found) << " instead of " << text;
  EXPECT_NE(found[0].find(text), std::string::npos) << found[0] << " has no \"" << text << "\"";
}

inline Scene<2> scene_of(const Case& config) { return make_scene<2>(config, config); }

inline Particles<2> particles_of(const Scene<2>& scene, int ranks = 1) {
  Particles<2> particles;
  for (int rank = 0; rank < ranks; ++rank) scene.fill(rank, ranks, particles);
  return particles;
}

}  // namespace impinge
