// Inlets and outlets of a scene: their rows, what passes them in time, and what can be wrong with them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "impinge/method/motion.hpp"
#include "impinge/particles/kernel.hpp"
#include "scene_case.hpp"

namespace impinge {
namespace {

constexpr double dp = 0.05;
const std::string nozzle = "[[inlet]]\nname = \"nozzle\"\ncenter = [3, 2]\ndirection = [2, -1]\nwidth = 0.33\n";

/// What an inlet lets in and an outlet out while the particles move on their ways.
class Flow {
 public:
  explicit Flow(const std::string& text, int parts = 1) : scene(scene_of(scene_case(text))), parts_(parts) {
    scene.fill(0, 1, particles);
    for (const std::int64_t id : particles.id) EXPECT_TRUE(ids_.insert(id).second);
  }

  void run_until(double end, double dt) {
    for (; time < end - 1e-9; time += dt) {
      set_inlets(time + 0.5 * dt, scene.inlets, particles);
      for (const double share : {0.5, 0.5}) {
        advance(share * dt, scene.inlets, particles);
        if (share_ = !share_; share_) pass();
      }
      for (const Inlet<2>& inlet : scene.inlets) EXPECT_TRUE(inlet.is_in_place() || inlet.blows) << inlet.last_row;
    }
  }

  std::int64_t count(ParticleType type) const { return std::ranges::count(particles.type, type); }

  Scene<2> scene;
  Particles<2> particles;
  double time = 0.0;
  std::int64_t entered = 0;

 private:
  void pass() {
    const auto everywhere = [](const Vector<2>&) { return true; };
    const int before = particles.owned;
    const BoundaryFlow flow =
        pass_open_boundaries<2>(scene.inlets, scene.outlets, scene.next_id, particles, everywhere);
    entered += flow.entered;
    for (std::size_t k = 0; k < scene.outlets.size(); ++k) scene.outlets[k].out += flow.left_by[k];
    EXPECT_LE(particles.owned, before + 1000);
  }

  std::set<std::int64_t> ids_;
  int parts_;
  bool share_ = false;
};

TEST(SceneInlet, HasRowsOfItsWidthAtAnyAngle) {
  const Case config = scene_case(nozzle + "speed = 2\n");
  const Scene<2> scene = scene_of(config);
  const Particles<2> particles = particles_of(scene);
  ASSERT_EQ(scene.inlets.size(), 1u);
  const Inlet<2>& inlet = scene.inlets[0];
  EXPECT_EQ(inlet.section.size(), 7u);
  EXPECT_NEAR(inlet.spacing * 0.33 / 7, dp * dp, 1e-15);  // each particle stands for dp^2
  EXPECT_GE(inlet.rows * inlet.spacing, config.kernel.largest() * dp + inlet.spacing * 0.99);
  EXPECT_EQ(particles.owned, 7 * inlet.rows);
  const Vector<2> along = 1.0 / std::sqrt(5.0) * Vector<2>{{2.0, -1.0}};
  Vector<2> middle;
  for (std::size_t i = 0; i < particles.position.size(); ++i) {
    EXPECT_EQ(particles.type[i], ParticleType::inlet);
    EXPECT_NEAR(norm(particles.velocity[i] - 2.0 * along), 0.0, 1e-14);
    middle += 1.0 / particles.owned * particles.position[i];
    EXPECT_LT(inlet.distance_past(particles.position[i]), 0.0);
    EXPECT_LT(particles.id[i], scene.next_id);
  }
  EXPECT_NEAR(norm(middle + 0.5 * inlet.rows * inlet.spacing * along - Vector<2>{{3.0, 2.0}}), 0.0, 1e-13);
  for (const int ranks : {2, 3, 7}) {
    const Particles<2> parts = particles_of(scene, ranks);
    EXPECT_EQ(std::set(parts.id.begin(), parts.id.end()), std::set(particles.id.begin(), particles.id.end()));
  }
  EXPECT_NEAR(config.time.max_speed, 20.0 * std::sqrt(4.0 + 2.0 * 9.81 * 0.3), 40.0);
}

TEST(SceneInlet, SharesMakeTheWholeWithWallsAndFluid) {
  const Case config =
      scene_case(unit_square + nozzle + "speed = 2\n[[inlet]]\ncenter = [-1, 0]\ndirection = [0, 1]\n" +
                 "width = 0.5\nspeed = 1\n[[wall]]\nshape = \"circle\"\ncenter = [0.5, 0.5]\nradius = 0.2\n");
  const Scene<2> scene = scene_of(config);
  const Particles<2> whole = particles_of(scene);
  const std::set<std::int64_t> ids(whole.id.begin(), whole.id.end());
  EXPECT_EQ(ids.size(), whole.id.size());
  EXPECT_EQ(*ids.rbegin() + 1, scene.next_id);
  for (const int ranks : {2, 3, 7}) {
    const Particles<2> parts = particles_of(scene, ranks);
    EXPECT_EQ(parts.owned, whole.owned);
    EXPECT_EQ(std::set(parts.id.begin(), parts.id.end()), ids);
  }
}

TEST(SceneInlet, LetsInWhatItsSpeedTellsInTime) {
  Flow steady(nozzle + "speed = 2\n");
  steady.run_until(1.0, 0.004);
  EXPECT_NEAR(static_cast<double>(steady.entered) * dp * dp, 2.0 * 0.33, 7.1 * dp * dp);
  EXPECT_EQ(steady.count(ParticleType::fluid), steady.entered);
  Flow rising(nozzle + "times = [0.2, 0.8, 1.2]\nspeeds = [0.5, 2, 0]\n");
  rising.run_until(1.5, 0.004);
  const double length = 0.2 * 0.5 + 0.6 * 1.25 + 0.4 * 1.0;
  EXPECT_NEAR(static_cast<double>(rising.entered) * dp * dp, length * 0.33, 7.1 * dp * dp);
  // It stands now, and its rows with it.
  EXPECT_EQ(rising.scene.inlets[0].speed, 0.0);
  EXPECT_EQ(rising.count(ParticleType::inlet) % 7, 0);
  for (std::size_t i = 0; i < rising.particles.position.size(); ++i) {
    if (rising.particles.type[i] != ParticleType::inlet) continue;
    EXPECT_EQ(norm(rising.particles.velocity[i]), 0.0);
    EXPECT_LE(rising.scene.inlets[0].distance_past(rising.particles.position[i]), 0.0);
  }
}

TEST(SceneInlet, LetsInWhatItsProfileTells) {
  // In the middle third u = 3, outside of it falling to 0 at the ends: a mean of 2.
  const std::string profile = "profile_at = [-0.165, -0.055, 0.055, 0.165]\nprofile = [0, 1.5, 1.5, 0]\n";
  Flow flow(nozzle + profile + "speed = 2\n");
  ASSERT_EQ(flow.scene.inlets.size(), 7u);
  double all = 0.0;
  for (const Inlet<2>& part : flow.scene.inlets) {
    EXPECT_EQ(part.section.size(), 1u);
    all += part.speed / 7.0;
  }
  EXPECT_NEAR(all, 2.0, 1e-12);
  EXPECT_NEAR(flow.scene.inlets[3].speed, 3.0, 1e-12);
  flow.run_until(1.0, 0.004);
  EXPECT_NEAR(static_cast<double>(flow.entered) * dp * dp, 2.0 * 0.33, 7.1 * dp * dp);
  for (std::size_t i = 0; i < flow.particles.position.size(); ++i) {
    if (flow.particles.type[i] != ParticleType::inlet) continue;
    const auto own = std::ranges::min(flow.scene.inlets, {}, [&](const Inlet<2>& part) {
      return part.distance_from_block(flow.particles.position[i]);
    });
    EXPECT_NEAR(norm(flow.particles.velocity[i]), own.speed, 1e-14);
  }
  // Where it stands still, nothing is: the profile is a step here.
  const Scene<2> half = scene_of(scene_case(nozzle + "speed = 2\nprofile_at = [0, 1e-9]\nprofile = [0, 1]\n"));
  EXPECT_EQ(half.inlets.size(), 4u);
}

TEST(SceneInlet, ARoundProfileIsMadeOfRings) {
  const auto flow_of = [](const std::string& section, double& area) {
    const Case config =
        parse_case({{"case.toml",
                     "dimension = 3\ngeometry = \"scene\"\nparticles.spacing = 0.1\ntime = {end = 1, dt = 1e-3}\n"
                     "[[inlet]]\ncenter = [0, 0, 0]\ndirection = [0, 1, 1]\nspeed = 1\n" +
                         section}});
    double flow = 0.0;
    area = 0.0;
    for (const Inlet<3>& part : make_scene<3>(config, config).inlets) {
      const double own = static_cast<double>(part.section.size()) * 1e-3 / part.spacing;
      EXPECT_GE(part.rows * part.spacing, 0.26);
      if (part.radius > 0.0) {
        EXPECT_NEAR(own, std::numbers::pi * (std::pow(part.radius, 2) - std::pow(part.inner_radius, 2)), 1e-12);
      }
      area += own;
      flow += own * part.speed;
    }
    return flow;
  };
  double area = 0.0;
  // u = 1 - r: a cone, a third of the cylinder.
  EXPECT_NEAR(flow_of("section = \"circle\"\nradius = 1\nprofile_at = [0, 1]\nprofile = [1, 0]\n", area),
              std::numbers::pi / 3.0, 1e-12);
  EXPECT_NEAR(area, std::numbers::pi, 1e-12);
  EXPECT_NEAR(
      flow_of("section = \"annulus\"\nradius = 1\ninner_radius = 0.5\nprofile_at = [0.5]\nprofile = [2]\n", area),
      1.5 * std::numbers::pi, 1e-12);
  EXPECT_NEAR(flow_of("section = \"rectangle\"\nwidth = 1\nheight = 0.5\nacross = [1, 0, 0]\n"
                      "profile_at = [-0.5, 0.5]\nprofile = [0, 3]\n",
                      area),
              0.75, 1e-12);
  EXPECT_NEAR(area, 0.5, 1e-12);
}

TEST(SceneInlet, HasRowsOnlyWhileItBlows) {
  Flow flow(nozzle + "speed = 1\nstart = 0.3\nstop = 0.8\n");
  EXPECT_EQ(flow.particles.owned, 0);
  flow.run_until(0.296, 0.004);
  EXPECT_EQ(flow.particles.owned, 0);
  flow.run_until(0.304, 0.004);
  const Inlet<2>& inlet = flow.scene.inlets[0];
  EXPECT_GE(flow.count(ParticleType::inlet), 7 * inlet.rows);
  flow.run_until(0.796, 0.004);
  EXPECT_GT(flow.count(ParticleType::inlet), 0);
  flow.run_until(1.0, 0.004);
  EXPECT_EQ(flow.count(ParticleType::inlet), 0);
  EXPECT_TRUE(inlet.is_in_place());
  EXPECT_NEAR(static_cast<double>(flow.entered) * dp * dp, 0.5 * 0.33, 7.1 * dp * dp);
  EXPECT_EQ(std::set(flow.particles.id.begin(), flow.particles.id.end()).size(), flow.particles.id.size());
}

TEST(SceneInlet, SeveralKeepTheirOwnRows) {
  const std::string other = "[[inlet]]\ncenter = [4, 2]\ndirection = [-1, 0]\nwidth = 0.2\n";
  Flow flow(nozzle + "speed = 1\n" + other + "times = [0, 1]\nspeeds = [0.5, 1.5]\nstart = 0.1\n");
  flow.run_until(1.0, 0.004);
  EXPECT_NEAR(static_cast<double>(flow.entered) * dp * dp, 0.33 + (0.9 * 1.05) * 0.2, 14.0 * dp * dp);
  for (std::size_t i = 0; i < flow.particles.position.size(); ++i) {
    const bool is_second = std::abs(flow.particles.velocity[i][1]) == 0.0;
    if (flow.particles.type[i] != ParticleType::inlet) continue;
    EXPECT_LT(flow.scene.inlets[is_second ? 1 : 0].distance_from_block(flow.particles.position[i]), 1e-9);
  }
}

TEST(SceneInlet, RowsThatRanksAddAreThoseOfOne) {
  const auto rows_of = [](int ranks) {
    std::set<std::pair<std::int64_t, double>> all;
    for (int rank = 0; rank < ranks; ++rank) {
      Scene<2> scene = scene_of(scene_case(nozzle + "speed = 1\nstart = 0.1\n"));
      Particles<2> particles;
      set_inlets(0.2, scene.inlets, particles);
      const auto owns = [&](const Vector<2>& x) {
        return static_cast<int>(std::floor(std::fmod(std::abs(x[0] * 1e4), ranks))) == rank;
      };
      pass_open_boundaries<2>(scene.inlets, scene.outlets, scene.next_id, particles, owns);
      for (std::size_t i = 0; i < particles.id.size(); ++i) all.emplace(particles.id[i], particles.position[i][0]);
      EXPECT_EQ(scene.next_id, 7 * scene.inlets[0].rows);
    }
    return all;
  };
  EXPECT_EQ(rows_of(1).size(), 7u * 4u);
  EXPECT_EQ(rows_of(3), rows_of(1));
}

TEST(SceneInlet, StandsInAFluidThatMakesRoom) {
  const Case config =
      scene_case(unit_square + "[[inlet]]\ncenter = [0.5, 0.5]\ndirection = [1, 0]\nwidth = 0.2\nspeed = 1\n");
  const Particles<2> particles = particles_of(scene_of(config));
  double least = 1.0;
  for (std::size_t i = 0; i < particles.position.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, norm(particles.position[i] - particles.position[j]));
  EXPECT_NEAR(least, dp, 1e-9);
  EXPECT_EQ(particles.owned, 400);
  const RegionVolume volume = volume_between_walls<2>(config, config, config.regions[0]);
  EXPECT_NEAR(volume.of_particles, volume.expected, 0.005);
}

TEST(SceneOutlet, EachCountsWhatItSwallows) {
  Flow flow(
      "domain = {low = [-2, -2], high = [7, 7]}\n[[inlet]]\ncenter = [0, 0]\ndirection = [1, 0]\nwidth = 0.2\nspeed = "
      "1\n"
      "[[inlet]]\ncenter = [0, 2]\ndirection = [1, 0]\nwidth = 0.1\nspeed = 2\n"
      "[[outlet]]\nshape = \"box\"\nlow = [0, -1]\nhigh = [0.1, 1]\nrotate = 90\nabout = [0, 0]\ntranslate = [0.6, 0]\n"
      "[[outlet]]\nname = \"drain\"\nshape = \"circle\"\ncenter = [1, 2]\nradius = 0.5\n"
      "[[outlet]]\nshape = \"polygon\"\npoints = [[5, 5], [6, 5], [5, 6]]\n");
  EXPECT_EQ(flow.scene.outlets[1].name, "drain");
  flow.run_until(1.0, 0.004);
  // The first outlet reaches from x = -0.4 to 1.6 at y = 0 to 0.1: half of the first inlet's rows pass it at once.
  const double area = dp * dp;
  EXPECT_NEAR(static_cast<double>(flow.scene.outlets[0].out) * area, 0.1, 4.1 * area);
  EXPECT_NEAR(static_cast<double>(flow.scene.outlets[1].out) * area, 0.1 * (2.0 - 0.5), 4.1 * area);
  EXPECT_EQ(flow.scene.outlets[2].out, 0);
  EXPECT_EQ(flow.entered - flow.count(ParticleType::fluid), flow.scene.outlets[0].out + flow.scene.outlets[1].out);
}

TEST(SceneOutlet, ExistsInSpace) {
  const Case config = parse_case(
      {{"case.toml",
        "dimension = 3\ngeometry = \"scene\"\nparticles.spacing = 0.1\ntime = {end = 1, dt = 1e-3}\n[[fluid.region]]\n"
        "shape = \"box\"\nlow = [0, 0, 0]\nhigh = [1, 1, 1]\n[[outlet]]\nshape = \"sphere\"\ncenter = [3, 0, 0]\n"
        "radius = 1\nscale = 2\ntranslate = [0, 0, 1]\n"}});
  const Scene<3> scene = make_scene<3>(config, config);
  ASSERT_EQ(scene.outlets.size(), 1u);
  EXPECT_TRUE(scene.outlets[0].has_passed({{3.0, 0.0, 2.9}}));
  EXPECT_FALSE(scene.outlets[0].has_passed({{3.0, 0.0, 3.1}}));
}

TEST(SceneOpenings, ReadBackFromTheResolvedCase) {
  const Case config = scene_case(nozzle + "times = [0, 1]\nspeeds = [1, 2]\nstart = 0.5\n" +
                                 "[[inlet]]\ncenter = [0, 0]\ndirection = [0, 1]\nwidth = 1\nspeed = 1\nstop = 3\n"
                                 "[[outlet]]\nshape = \"circle\"\ncenter = [9, 0]\nradius = 1\n");
  const Case again = parse_case({{"resolved.toml", config.resolved_text}});
  EXPECT_EQ(again.resolved_text, config.resolved_text);
  const NamedText stored{"a.checkpoint", config.resolved_text};
  EXPECT_NO_THROW(parse_restart(stored, {"time.end=2"}, "out"));
  for (const std::string change : {"inlet[1].speeds=[1,3]", "inlet[2].stop=4", "outlet[1].radius=2"})
    EXPECT_THROW(parse_restart(stored, {change}, "out"), InputError) << change;
}

TEST(SceneInlet, WhatIsWrongWithItIsTold) {
  const auto mistakes = [](const std::string& inlet, const std::vector<std::string>& settings = {}) {
    return scene_mistakes("[[inlet]]\n" + inlet, settings);
  };
  const std::string place = "center = [0, 0]\ndirection = [1, 0]\nwidth = 0.5\n";
  expect_mistake(mistakes(place),
                 "case.toml:5: inlet[1].speed = 0.0: nothing enters; allowed: > 0 (m/s), or times with");
  expect_mistake(mistakes(place + "speed = -1\n"),
                 "case.toml:9: inlet[1].speed = -1: out of range; allowed: >= 0 (m/s)");
  expect_mistake(mistakes(place + "speed = 1\ntimes = [0, 1]\nspeeds = [1, 1]\n"), "is given by times and speeds, too");
  expect_mistake(mistakes(place + "times = [0, 1]\nspeeds = [1]\n"),
                 "1 speeds, but 2 times; allowed: one for each time");
  expect_mistake(mistakes(place + "times = [1, 1]\nspeeds = [1, 2]\n"),
                 "the times do not rise: 1.0 after 1.0; allowed: > 1.0");
  expect_mistake(mistakes(place + "speed = 1\nprofile_at = [0, 0]\nprofile = [1, 1]\n"),
                 "inlet[1].profile_at = [0.0, 0.0]: the places do not rise: 0.0 after 0.0; allowed: > 0.0 (m)");
  expect_mistake(mistakes(place + "speed = 1\nprofile_at = [0, 1]\nprofile = [1]\n"),
                 "inlet[1].profile = [1.0]: 1 factors, but 2 places; allowed: one for each place");
  expect_mistake(mistakes(place + "speed = 1\nprofile_at = [0, 9]\nprofile = [0, 0]\n"),
                 "nothing enters; allowed: factors > 0 within the section");
  expect_mistake(mistakes(place + "speed = 1\nprofile_at = [0]\nprofile = [-1]\n"), "inlet[1].profile");
  expect_mistake(mistakes(place + "speed = 1\nprofile_at = [0]\nprofile = [3]\n", {"time.max_speed=2"}),
                 "blows at 3 m/s; allowed: up to time.max_speed");
  expect_mistake(mistakes(place + "speed = 1\nstart = 2\nstop = 1\n"), "stops before it starts; allowed: > 2.0 (s)");
  expect_mistake(mistakes("center = [0, 0]\ndirection = [0, 0]\nwidth = 1\nspeed = 1\n"),
                 "no direction; allowed: any vector but 0");
  expect_mistake(mistakes("center = [0, 0]\ndirection = [0, 1]\nwidth = 0.02\nspeed = 1\n"),
                 "case.toml:8: inlet[1].width = 0.02: less than a particle wide; allowed: [0.05, 50000] (m)");
  expect_mistake(mistakes(place + "speed = 3\n", {"time.max_speed=2"}),
                 "case.toml:6: inlet[1].center = [0.0, 0.0]: blows at 3 m/s; allowed: up to time.max_speed, 2.0 (m/s)");
  expect_mistake(mistakes(place + "speed = 3\n", {"domain.low=[-0.1,-1]", "domain.high=[1,1]"}),
                 "its rows reach from x = -0.25 to 0 m, out of the bounds; allowed: [-0.1, 1] (m), and domain");
  expect_mistake(
      mistakes(place +
               "speed = 3\n[[inlet]]\nspeed = 3\nname = \"inlet_1\"\ncenter = [5, 5]\ndirection = [1, 0]\nwidth = 1\n"),
      "case.toml:12: inlet[2].name = \"inlet_1\": the name is used twice");
  const auto beside = [&](const std::string& center) {
    return mistakes(place + "speed = 3\n[[inlet]]\nspeed = 3\ndirection = [1, 0]\nwidth = 0.5\ncenter = " + center);
  };
  EXPECT_EQ(beside("[0, 0.5]"), std::vector<std::string>{});
  expect_mistake(beside("[0.1, 0.4]"), "its rows overlap those of the inlet \"inlet_1\", given at case.toml:6");
  expect_mistake(beside("[0, 0]"), "its rows overlap those of the inlet");
  expect_mistake(scene_mistakes(""), "no fluid and no inlet");
  expect_mistake(scene_mistakes(unit_square + "[[outlet]]\nshape = \"polyline\"\n"), "a line has no inside");
  const std::string drain = "[[outlet]]\nname = \"drain\"\nshape = \"circle\"\ncenter = [0, 0]\nradius = 1\n";
  expect_mistake(scene_mistakes(unit_square + drain + drain),
                 "case.toml:15: outlet[2].name = \"drain\": the name is used twice, first at case.toml:10");
  expect_mistake(scene_mistakes(unit_square + "[[outlet]]\nshape = \"box\"\nlow = [0, 0]\nhigh = [0, 1]\n"),
                 "outlet[1].shape = \"box\": the box has no width");
  try {
    parse_case({{"case.toml",
                 "dimension = 3\ngeometry = \"scene\"\nparticles.spacing = 0.1\ntime = {end = 1, dt = 1e-3}\n"
                 "[[inlet]]\ncenter = [0, 0, 0]\ndirection = [0, 0, 1]\nwidth = 1\nspeed = 1\n"}});
    ADD_FAILURE();
  } catch (const InputError& error) {
    expect_mistake(error.mistakes(),
                   "inlet[1].section = \"line\": a line has two dimensions; allowed: \"circle\", \"annulus\"");
  }
}

TEST(SceneOpenings, AllMistakesOfASceneAreFoundAtOnceInTheirOrder) {
  const auto found = scene_mistakes(R"([[wall]]
name = "a"
shape = "polygon"
points = [[0, 0], [1, 1], [1, 0], [0, 1]]
[[wall]]
name = "a"
shape = "polyline"
points = [[0, -5], [1, -5]]
wet = "inside"
motion = "away"
[[motion]]
type = "table"
times = [0, 1, 1]
angles = [0, 1, 0]
[[inlet]]
center = [9, 9]
direction = [0, 0]
width = 1
[[outlet]]
shape = "circle"
center = [5, 5]
radius = 0
)");
  const std::vector<std::string> expected{"case.toml:7: wall[1].shape",       "case.toml:10: wall[2].name",
                                          "case.toml:13: wall[2].wet",        "case.toml:14: wall[2].motion",
                                          "case.toml:17: motion[1].times",    "case.toml:19: inlet[1].speed",
                                          "case.toml:21: inlet[1].direction", "case.toml:26: outlet[1].radius"};
  ASSERT_EQ(found.size(), expected.size()) << testing::PrintToString(found);
  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_TRUE(found[k].starts_with(expected[k])) << found[k];
}

TEST(SceneOpenings, AbsurdNumbersAreMistakes) {
  const std::string wall = "[[wall]]\nshape = \"circle\"\ncenter = [0, 0]\nwet = \"inside\"\nmotion = \"m\"\n";
  for (const std::string& text :
       {"[[motion]]\nname = \"m\"\ntype = \"constant\"\nspin = 1e300\n" + wall + "radius = 1e300\n",
        "[[motion]]\nname = \"m\"\ntype = \"harmonic\"\namplitude = [1e300, 1e300]\nfrequency = 1e300\n" + wall +
            "radius = 1\n",
        std::string("[[inlet]]\ncenter = [1e300, 0]\ndirection = [1e-300, 1e300]\nwidth = 1e300\nspeed = 1e300\n")})
    EXPECT_FALSE(scene_mistakes(unit_square + text).empty()) << text;
}

TEST(SceneInlet, WallsMustNotBeInItsWay) {
  const std::string inlet = "[[inlet]]\ncenter = [0, 0.25]\ndirection = [1, 0]\nwidth = 0.5\nspeed = 1\n";
  const auto with = [&](const std::string& wall) { return scene_mistakes(inlet + "[[wall]]\nname = \"w\"\n" + wall); };
  const auto line = [&](const std::string& points) { return with("shape = \"polyline\"\npoints = " + points + "\n"); };
  // Along its sides, behind it, far before it.
  EXPECT_EQ(line("[[-1, 0], [1, 0]]"), std::vector<std::string>{});
  EXPECT_EQ(line("[[-1, 0.5], [1, 0.5]]"), std::vector<std::string>{});
  EXPECT_EQ(line("[[-0.3, -1], [-0.3, 1]]"), std::vector<std::string>{});
  EXPECT_EQ(line("[[0.15, 0.1], [0.15, 0.4]]"), std::vector<std::string>{});
  EXPECT_EQ(with("shape = \"box\"\nlow = [-1, 0]\nhigh = [2, 0.5]\nwet = \"inside\"\n"), std::vector<std::string>{});
  const std::string at = "case.toml:6: inlet[1].center = [0.0, 0.25]: ";
  expect_mistake(line("[[-0.1, 0.1], [-0.1, 0.2]]"), at + "the inlet is cut by the wall \"w\", at (-0.1, 0.");
  expect_mistake(line("[[0, -1], [0, 1]]"), at + "the inlet is cut by the wall \"w\"");
  expect_mistake(with("shape = \"circle\"\ncenter = [0, 0.25]\nradius = 3\n"),
                 at + "the inlet is inside the wall \"w\"");
  expect_mistake(with("shape = \"circle\"\ncenter = [9, 0.25]\nradius = 3\nwet = \"inside\"\n"),
                 at + "the inlet is on the dry side of the walls");
  expect_mistake(line("[[0.1, 0.1], [0.1, 0.4]]"),
                 at + "blows into the wall \"w\", at (0.1, 0.1) m; allowed: a wall farther away than 0.13 m, or along");
  // A wall that comes into the way later, and one that does so after the inlet has stopped.
  const std::string gate =
      "shape = \"polyline\"\npoints = [[0.05, 2], [0.05, 1]]\nmotion = \"down\"\n[[motion]]\nname = "
      "\"down\"\ntype = \"constant\"\nvelocity = [0, -1]\n";
  expect_mistake(with(gate), at + "at t = 0.5");
  EXPECT_EQ(scene_mistakes(inlet + "stop = 0.4\n[[wall]]\n" + gate), std::vector<std::string>{});
}

/// The places of particles in the first rows behind a round inlet's plane, in dp; its axis is z.
std::vector<Vector<3>> rows_of_ring(double radius, double inner_radius, int rows) {
  InletEntry entry;
  entry.direction = {0.0, 0.0, 1.0};
  entry.section = inner_radius > 0.0 ? InletSection::annulus : InletSection::circle;
  entry.radius = radius;
  entry.inner_radius = inner_radius;
  const Inlet<3> inlet = inlet_of<3>(entry, 1.0, {});
  const auto count = static_cast<std::int64_t>(inlet.section.size());
  std::vector<Vector<3>> places;
  for (int row = 0; row < rows; ++row)
    for (std::size_t k = 0; k < inlet.section.size(); ++k)
      places.push_back(inlet.in_row(row * inlet.spacing, k, row * count));
  return places;
}

TEST(SceneInlet, RoundSectionsAreAsDenseAsTheLattice) {
  constexpr double reach = 2.6;
  const LatticeSums full = lattice_sums<3>(KernelType::non_singular, reach);
  for (const auto& [radius, inner_radius] : {std::pair(5.0, 0.0), std::pair(10.0, 0.0), std::pair(12.0, 6.0)}) {
    const std::vector<Vector<3>> places = rows_of_ring(radius, inner_radius, 8);
    const std::size_t first = places.size() / 2, last = first + places.size() / 8;  // of the row in the middle
    double nearest = reach, sum = 0.0, number = 0.0, farthest = 0.0;
    int inner = 0;
    for (std::size_t i = first; i < last; ++i) {
      double packing = 0.0;
      const double r = std::hypot(places[i][0], places[i][1]);
      EXPECT_TRUE(r < radius - 0.25 && (inner_radius == 0.0 || r > inner_radius + 0.25));  // room for a wall
      for (std::size_t j = 0; j < places.size(); ++j) {
        if (j == i) continue;
        const double distance = norm(places[i] - places[j]), weight = NonSingularKernel::weight(distance, reach);
        nearest = std::min(nearest, distance);
        if (r > radius - reach || (inner_radius > 0.0 && r < inner_radius + reach)) continue;
        packing += packing_weight<3, NonSingularKernel>(weight) / full.packing;
        number += weight / full.number_density;
      }
      if (packing == 0.0) continue;
      ++inner;
      sum += packing;
      farthest = std::max(farthest, std::abs(packing - 1.0));
    }
    ASSERT_GT(inner, 0);
    EXPECT_GT(nearest, 0.75) << radius;                // 0.78 to 0.87
    EXPECT_NEAR(sum / inner, 1.0, 5e-3) << radius;     // 0.997 to 1.000
    EXPECT_LT(farthest, 0.02) << radius;               // 0.012
    EXPECT_NEAR(number / inner, 1.0, 0.03) << radius;  // 0.980 to 0.987
  }
}

TEST(SceneInlet, ParticlesOfRoundSectionsMakeNoThreads) {
  constexpr double behind = 0.2;  // so far from the line along the flow, a particle stands behind another [dp]
  const std::vector<Vector<3>> places = rows_of_ring(10.0, 0.0, 2);
  const std::size_t count = places.size() / 2;
  int threads = 0;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = count; j < places.size(); ++j)
      threads += std::hypot(places[i][0] - places[j][0], places[i][1] - places[j][1]) < behind;
  EXPECT_LT(threads / static_cast<double>(count), 0.13);  // 0; by chance it would be pi 0.2^2
}

TEST(SceneInlet, InSpaceTheKeyThatIsWrongIsTold) {
  const std::string place = "[[inlet]]\ncenter = [0, 0, 0]\ndirection = [0, 0, 1]\nspeed = 1\n";
  const auto found = [](const std::string& text) {
    return case_mistakes({{"case.toml",
                           "geometry = \"scene\"\ndimension = 3\nparticles.spacing = 0.1\n"
                           "time = {end = 1, dt = 1e-3}\n" +
                               text}});
  };
  const std::string slot = place + "section = \"rectangle\"\nacross = [1, 0, 0]\n";
  expect_mistake(found(slot + "width = 1\nheight = 0.05\n"),
                 "case.toml:12: inlet[1].height = 0.05: less than a particle wide, 0.05 m; allowed: >= 0.1 (m)");
  expect_mistake(found(slot + "width = 0.05\nheight = 1\n"), "case.toml:11: inlet[1].width = 0.05: less than");
  // A thin inlet between particles of the wide one.
  const auto round = [](const std::string& center, const std::string& radius) {
    return "[[inlet]]\nsection = \"circle\"\ndirection = [0, 0, 1]\nspeed = 1\ncenter = " + center +
           "\nradius = " + radius + "\n";
  };
  const std::string wide = round("[0, 0, 0]", "0.55"), thin = round("[-0.04, 0.03, 0]", "0.05");
  for (const std::string& text : {wide + thin, thin + wide})
    expect_mistake(found(text), "its rows overlap those of the inlet \"inlet_1\", given at case.toml:9");
}

}  // namespace
}  // namespace impinge
