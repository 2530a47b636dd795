// Regions full of fluid: their particles, velocities, and what can be wrong with them.

#include "impinge/scenes/fluid_region.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "impinge/cases/case.hpp"
#include "impinge/core/errors.hpp"
#include "impinge/scenes/scenes.hpp"

namespace impinge {
namespace {

constexpr const char* head = "geometry = \"scene\"\nparticles.spacing = 0.05\ntime = {end = 1.0, dt = 1e-3}\n";

Case scene_case(const std::string& regions, const std::string& before = head) {
  return parse_case({{"case.toml", before + regions}});
}

std::vector<std::string> mistakes_in(const std::string& regions, const std::string& before = head) {
  try {
    scene_case(regions, before);
  } catch (const InputError& error) {
    return error.mistakes();
  }
  return {};
}

template <int Dim>
Particles<Dim> fill(const Case& config, int ranks = 1) {
  const Scene<Dim> scene = make_scene<Dim>(config, config);
  Particles<Dim> particles;
  for (int rank = 0; rank < ranks; ++rank) scene.fill(rank, ranks, particles);
  return particles;
}

template <int Dim>
std::set<std::array<double, Dim>> positions(const Particles<Dim>& particles) {
  std::set<std::array<double, Dim>> all;
  for (const auto& position : particles.position) all.insert(position.component);
  return all;
}

TEST(FluidRegion, BoxIsALatticeHalfASpacingInsideItsFaces) {
  const auto box = fill<2>(scene_case("[[fluid.region]]\nshape = \"box\"\nlow = [0.1, -0.2]\nhigh = [0.3, 0.1]\n"));
  EXPECT_EQ(box.owned, 4 * 6);
  for (const auto& position : box.position) {
    for (int k = 0; k < 2; ++k) {
      const double steps = (position[k] - (k == 0 ? 0.1 : -0.2)) / 0.05 - 0.5;
      EXPECT_NEAR(steps, std::round(steps), 1e-12);
    }
  }
}

TEST(FluidRegion, HasTheVolumeOfItsShape) {
  const auto count = [](const std::string& region, const std::string& before = head) {
    const Case config = scene_case("[[fluid.region]]\n" + region, before);
    return config.dimension == 2 ? fill<2>(config).owned : fill<3>(config).owned;
  };
  const double area = 0.05 * 0.05;
  EXPECT_NEAR(count("shape = \"circle\"\ncenter = [3, 4]\nradius = 1\n") * area, std::numbers::pi, 0.03);
  EXPECT_NEAR(count("shape = \"polygon\"\npoints = [[0, 0], [2, 0], [0, 1]]\n") * area, 1.0, 0.03);
  EXPECT_NEAR(count("shape = \"circle\"\ncenter = [3, 4]\nradius = 1\nscale = 0.5\n") * area, 0.25 * std::numbers::pi,
              0.02);
  const std::string space = std::string("dimension = 3\n") + head;
  EXPECT_NEAR(count("shape = \"sphere\"\ncenter = [0, 0, 1]\nradius = 0.5\n", space) * area * 0.05,
              std::numbers::pi / 6.0, 0.01);
  EXPECT_EQ(count("shape = \"box\"\nlow = [0, 0, 0]\nhigh = [0.2, 0.1, 0.05]\n", space), 4 * 2);
}

TEST(FluidRegion, TurnsWithItsLatticeAndIsThenMoved) {
  const std::string box = "[[fluid.region]]\nshape = \"box\"\nlow = [0, 0]\nhigh = [0.4, 0.2]\n";
  const auto straight = fill<2>(scene_case(box));
  const auto turned = fill<2>(scene_case(box + "about = [0, 0]\nrotate = 90\ntranslate = [1, 2]\n"));
  ASSERT_EQ(straight.owned, turned.owned);
  for (std::size_t i = 0; i < straight.position.size(); ++i) {
    EXPECT_NEAR(turned.position[i][0], 1.0 - straight.position[i][1], 1e-14);
    EXPECT_NEAR(turned.position[i][1], 2.0 + straight.position[i][0], 1e-14);
  }
}

TEST(FluidRegion, StartsWithAUniformVelocityARotationAndAGradient) {
  const auto fluid = fill<2>(scene_case(
      "[[fluid.region]]\nshape = \"box\"\nlow = [0, 0]\nhigh = [0.4, 0.2]\nabout = [0.1, 0]\ntranslate = [1, 1]\n"
      "velocity = [3, -1]\nspin = 2\ngradient = [0.5, 0.25, 0, -0.5]\n"));
  for (std::size_t i = 0; i < fluid.position.size(); ++i) {
    const double x = fluid.position[i][0] - 1.1, y = fluid.position[i][1] - 1.0;
    EXPECT_NEAR(fluid.velocity[i][0], 3.0 + 0.5 * x + 0.25 * y - 2.0 * y, 1e-14);
    EXPECT_NEAR(fluid.velocity[i][1], -1.0 - 0.5 * y + 2.0 * x, 1e-14);
  }
}

TEST(FluidRegion, SharesMakeTheWholeForAnyNumberOfRanks) {
  const Case config = scene_case(
      "[[fluid.region]]\nshape = \"circle\"\ncenter = [0, 0]\nradius = 0.5\n"
      "[[fluid.region]]\nshape = \"box\"\nlow = [0.6, 0]\nhigh = [1, 0.5]\n");
  const auto whole = fill<2>(config);
  const std::set<std::int64_t> ids(whole.id.begin(), whole.id.end());
  EXPECT_EQ(ids.size(), whole.id.size());
  EXPECT_GE(make_scene<2>(config, config).next_id, *ids.rbegin() + 1);
  for (const int ranks : {2, 3, 7}) {
    const auto parts = fill<2>(config, ranks);
    EXPECT_EQ(positions(parts), positions(whole));
    EXPECT_EQ(std::set(parts.id.begin(), parts.id.end()), ids);
  }
}

TEST(FluidRegion, InATankIsCutAtItsWallsAndHasIdsOfItsOwn) {
  for (const char* scheme : {"consistent", "paper"}) {
    const Case config = parse_case(
        {{"case.toml",
          std::string("geometry = \"tank\"\nparticles.spacing = 0.05\ntime = {end = 1.0, dt = 1e-3}\n") +
              "tank.size = [1.0, 0.5]\n[[fluid.region]]\nshape = \"box\"\nlow = [-1, 0]\nhigh = [0.25, 2]\n"}},
        {std::string("scheme=") + scheme});
    const auto particles = fill<2>(config);
    EXPECT_EQ(std::ranges::count(particles.type, ParticleType::fluid), 5 * 10) << scheme;
    EXPECT_EQ(std::set(particles.id.begin(), particles.id.end()).size(), particles.id.size()) << scheme;
    for (std::size_t i = 0; i < particles.position.size(); ++i) {
      if (particles.type[i] != ParticleType::fluid) continue;
      EXPECT_GT(particles.position[i][0], 0.0);
    }
  }
}

TEST(FluidRegion, ReadsBackFromTheResolvedCase) {
  const Case config = scene_case(
      "domain = {low = [-2, -2], high = [2, 2], outside = \"error\"}\n"
      "fluid.central_force = 0.5\nfluid.force_center = [0.1, 0.2]\n"
      "[[fluid.region]]\nname = \"left\"\nshape = \"polygon\"\npoints = [[0, 0], [1, 0], [0.5, 1]]\nrotate = 10\n"
      "[[fluid.gravity_at]]\ntime = 0\nvalue = [0, -9.81]\n[[fluid.gravity_at]]\ntime = 1\nvalue = [1, -9.81]\n");
  const Case again = parse_case({{"resolved.toml", config.resolved_text}});
  EXPECT_EQ(again.resolved_text, config.resolved_text);
  EXPECT_EQ(positions(fill<2>(again)), positions(fill<2>(config)));
  EXPECT_EQ(again.outside, Outside::error);
  ASSERT_EQ(again.fluid.gravity_at.size(), 2u);
  const NamedText stored{"a.checkpoint", config.resolved_text};
  EXPECT_NO_THROW(parse_restart(stored, {"time.end=2"}, "out"));
  EXPECT_THROW(parse_restart(stored, {"fluid.region[1].rotate=20"}, "out"), InputError);
}

TEST(FluidRegion, AllMistakesAreFoundAtOnce) {
  const auto found = mistakes_in(R"([[fluid.region]]
name = "one"
shape = "box"
low = [0, 0]
high = [1, 1]
[[fluid.region]]
name = "one"
shape = "circle"
center = [1, 1]
radius = 0.5
[[fluid.region]]
shape = "polygon"
points = [[3, 0], [4, 1], [4, 0], [3, 1]]
[[fluid.region]]
shape = "sphere"
center = [9, 9]
radius = 1
[[fluid.region]]
shape = "box"
low = [5, 0]
high = [5.01, 0.01]
gradient = [1, 2]
[[fluid.region]]
shape = "box"
low = [7, 0]
hgih = [8, 1]
[[fluid.gravity_at]]
time = 1
value = [0, -9.81]
[[fluid.gravity_at]]
time = 0.5
value = [0, -9.81]
)");
  std::string all;
  for (const std::string& mistake : found) all += mistake + "\n";
  const auto expect = [&](const std::string& text) {
    EXPECT_NE(all.find(text), std::string::npos) << text << "\n" << all;
  };
  expect("case.toml:10: fluid.region[2].name = \"one\": the name is used twice, first at case.toml:5");
  expect("case.toml:11: fluid.region[2].shape = \"circle\": overlaps the fluid \"one\", given at case.toml:6, at (");
  expect("case.toml:15: fluid.region[3].shape = \"polygon\": ");
  expect("case.toml:18: fluid.region[4].shape = \"sphere\": a sphere has three dimensions");
  expect("case.toml:22: fluid.region[5].shape = \"box\": holds no particle; its area is 0.0001 m^2");
  expect("case.toml:25: fluid.region[5].gradient = [1.0, 2.0]: has 2 numbers; allowed: 4");
  expect("case.toml:29: fluid.region[6].hgih = [8, 1]: unknown key; did you mean fluid.region[6].high?");
  expect("fluid.region[6].high: required key is missing");
  expect("case.toml:34: fluid.gravity_at[2].time = 0.5: the times do not rise; allowed: > 1.0 (s)");
}

TEST(FluidRegion, AScenesFluidAndBoundsAreChecked) {
  const auto expect = [](const std::vector<std::string>& found, const std::string& text) {
    ASSERT_EQ(found.size(), 1u) << testing::PrintToString(found);
    EXPECT_NE(found[0].find(text), std::string::npos) << found[0];
  };
  expect(mistakes_in(""), "case.toml:1: geometry = \"scene\": no fluid; allowed: at least one [[fluid.region]]");
  const std::string box = "[[fluid.region]]\nshape = \"box\"\nlow = [0, 0]\nhigh = [1, 1]\n";
  expect(mistakes_in("domain = {low = [0, 0], high = [1, 0.09]}\n" + box), "narrower than two particles");
  const std::string tank = "geometry = \"tank\"\nparticles.spacing = 0.05\ntime = {end = 1.0, dt = 1e-3}\n";
  expect(mistakes_in("tank.size = [1.0, 1.0]\n", tank), "tank.fluid_height = 0.0: no fluid");
  expect(mistakes_in("tank = {size = [1.0, 1.0], fluid_height = 0.5}\n" + box, tank), "allowed: one of the two");
  expect(mistakes_in("jet = {width = 0.4, speed = 1, angle = 60}\n" + box,
                     "geometry = \"jet\"\nparticles.spacing = 0.02\ntime = {end = 1.0, dt = 1e-3}\n"),
         "a key of geometry \"tank\", \"scene\"");
}

}  // namespace
}  // namespace impinge
