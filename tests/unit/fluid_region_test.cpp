// Regions full of fluid: their particles, velocities, and what can be wrong with them.

#include "impinge/scenes/fluid_region.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "case_mistakes.hpp"
#include "impinge/core/errors.hpp"
#include "impinge/scenes/scenes.hpp"

namespace impinge {
namespace {

constexpr double dp = 0.05;
constexpr const char* head = "geometry = \"scene\"\nparticles.spacing = 0.05\ntime = {end = 1.0, dt = 1e-3}\n";
const std::string space = std::string("dimension = 3\n") + head;
const std::string tank =
    "geometry = \"tank\"\nparticles.spacing = 0.05\ntime = {end = 1.0, dt = 1e-3}\ntank.size = [1.0, 0.5]\n";
constexpr const char* square = "[[fluid.region]]\nshape = \"box\"\nlow = [0, 0]\nhigh = [1, 1]\n";

Case scene_case(const std::string& regions, const std::string& before = head) {
  return parse_case({{"case.toml", before + regions}});
}

std::vector<std::string> mistakes_in(const std::string& regions, const std::string& before = head) {
  return case_mistakes({{"case.toml", before + regions}});
}

/// The one mistake has the text in it.
void expect_one(const std::vector<std::string>& found, const std::string& text) {
  ASSERT_EQ(found.size(), 1u) << testing::PrintToString(found);
  EXPECT_NE(found[0].find(text), std::string::npos) << found[0] << " has no \"" << text << "\"";
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
  EXPECT_NEAR(count("shape = \"sphere\"\ncenter = [0, 0, 1]\nradius = 0.5\n", space) * area * 0.05,
              std::numbers::pi / 6.0, 0.01);
  EXPECT_EQ(count("shape = \"box\"\nlow = [0, 0, 0]\nhigh = [0.2, 0.1, 0.05]\n", space), 4 * 2);
}

/// The particles of a region: all inside, a spacing apart, and no place inside is far from them.
template <int Dim>
void expect_filled(const std::string& region) {
  SCOPED_TRACE(region);
  const Case config = scene_case("[[fluid.region]]\n" + region, Dim == 2 ? head : space);
  const PlacedRegion<Dim> shape(config.regions.front(), dp);
  const auto particles = fill<Dim>(config);
  EXPECT_EQ(particles.owned, shape.count());
  EXPECT_NEAR(particles.owned * std::pow(dp, Dim), shape.volume(), 0.04 * shape.volume());
  const Box<Dim> bounds = shape.bounds();
  double least = 1e300;
  for (std::size_t i = 0; i < particles.position.size(); ++i) {
    EXPECT_TRUE(shape.contains(particles.position[i]));
    for (int k = 0; k < Dim; ++k) {
      EXPECT_GT(particles.position[i][k], bounds.low[k]);
      EXPECT_LT(particles.position[i][k], bounds.high[k]);
    }
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, norm(particles.position[i] - particles.position[j]));
  }
  EXPECT_NEAR(least, dp, 1e-9 * dp);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  int inside = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Vector<Dim> place;
    for (int k = 0; k < Dim; ++k) place[k] = bounds.low[k] + share(random) * (bounds.high[k] - bounds.low[k]);
    if (!shape.contains(place, dp)) continue;
    ++inside;
    double nearest = 1e300;
    for (const auto& position : particles.position) nearest = std::min(nearest, norm(position - place));
    EXPECT_LT(nearest, 0.5 * std::sqrt(Dim) * dp * (1.0 + 1e-9));
  }
  EXPECT_GT(inside, 200);
}

TEST(FluidRegion, OfAnyShapeAndPlaceIsFilledWithoutHoles) {
  for (const std::string place :
       {"", "rotate = 31\n", "scale = 1.5\nrotate = -115\nabout = [3, 1]\ntranslate = [-7, 40]\n"}) {
    expect_filled<2>("shape = \"box\"\nlow = [-0.4, 0.1]\nhigh = [0.6, 0.8]\n" + place);
    expect_filled<2>("shape = \"circle\"\ncenter = [0.3, 0.2]\nradius = 0.6\n" + place);
    expect_filled<2>("shape = \"polygon\"\npoints = [[0, 0], [1.2, 0], [1.2, 1], [0.6, 0.4], [0, 1]]\n" + place);
  }
  for (const std::string place : {"", "scale = 1.5\nabout = [3, 1, 0]\ntranslate = [-7, 4, 2]\n"}) {
    expect_filled<3>("shape = \"box\"\nlow = [-0.2, 0.1, 0]\nhigh = [0.3, 0.5, 0.4]\n" + place);
    expect_filled<3>("shape = \"sphere\"\ncenter = [0.3, 0.2, 0.1]\nradius = 0.4\n" + place);
  }
}

TEST(FluidRegion, IsScaledTurnedAndSpunAboutItsMiddleUnlessToldOtherwise) {
  const std::string moves = "scale = 0.5\nrotate = 40\nspin = 3\ngradient = [1, 0, 0, -1]\nvelocity = [2, 1]\n";
  for (const std::string shape :
       {"shape = \"box\"\nlow = [4, 1]\nhigh = [6, 5]\n", "shape = \"circle\"\ncenter = [5, 3]\nradius = 1\n",
        "shape = \"polygon\"\npoints = [[4, 1], [6, 1], [6, 5], [4, 5]]\n"}) {
    const auto particles = fill<2>(scene_case("[[fluid.region]]\n" + shape + moves + "translate = [1, -1]\n"));
    Vector<2> middle, velocity;
    for (std::size_t i = 0; i < particles.position.size(); ++i) {
      middle += 1.0 / particles.owned * particles.position[i];
      velocity += 1.0 / particles.owned * particles.velocity[i];
    }
    EXPECT_NEAR(norm(middle - Vector<2>{{6.0, 2.0}}), 0.0, 1e-9) << shape;
    EXPECT_NEAR(norm(velocity - Vector<2>{{2.0, 1.0}}), 0.0, 1e-9) << shape;
  }
}

TEST(FluidRegion, InSpaceStartsWithAGradientRowByRow) {
  const auto fluid = fill<3>(
      scene_case("[[fluid.region]]\nshape = \"box\"\nlow = [0, 0, 0]\nhigh = [0.2, 0.2, 0.2]\nabout = [0, 0, 0]\n"
                 "velocity = [1, 2, 3]\ngradient = [1, 2, 3, 4, 5, 6, 7, 8, 9]\n",
                 space));
  ASSERT_EQ(fluid.owned, 64);
  for (std::size_t i = 0; i < fluid.position.size(); ++i) {
    const auto& [x, y, z] = fluid.position[i].component;
    EXPECT_NEAR(fluid.velocity[i][0], 1.0 + 1.0 * x + 2.0 * y + 3.0 * z, 1e-14);
    EXPECT_NEAR(fluid.velocity[i][1], 2.0 + 4.0 * x + 5.0 * y + 6.0 * z, 1e-14);
    EXPECT_NEAR(fluid.velocity[i][2], 3.0 + 7.0 * x + 8.0 * y + 9.0 * z, 1e-14);
  }
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

TEST(FluidRegion, BesideWallsSharesMakeTheWholeForAnyNumberOfRanks) {
  const Case flat = scene_case("[[fluid.region]]\nshape = \"circle\"\ncenter = [0.2, 0]\nradius = 0.3\n", tank);
  const Case deep = scene_case(
      "tank.size = [0.3, 0.25, 0.25]\n[[fluid.region]]\nshape = \"sphere\"\ncenter = [0.1, 0.1, 0.1]\nradius = 0.1\n",
      "geometry = \"tank\"\nparticles.spacing = 0.05\ntime = {end = 1.0, dt = 1e-3}\ndimension = 3\n");
  const auto expect = [](const auto& whole, const auto& parts) {
    const std::set<std::int64_t> ids(whole.id.begin(), whole.id.end());
    EXPECT_EQ(ids.size(), whole.id.size());
    EXPECT_EQ(std::set(parts.id.begin(), parts.id.end()), ids);
    EXPECT_EQ(parts.owned, whole.owned);
    EXPECT_EQ(positions(parts), positions(whole));
  };
  for (const int ranks : {1, 2, 3, 7}) {
    expect(fill<2>(flat), fill<2>(flat, ranks));
    expect(fill<3>(deep), fill<3>(deep, ranks));
  }
}

// A particle on a mirror would be its own image.
TEST(FluidRegion, KeepsAQuarterOfASpacingFromATanksWalls) {
  for (const char* scheme : {"scheme = \"consistent\"\n", "scheme = \"paper\"\n"}) {
    const Case config =
        scene_case("[[fluid.region]]\nshape = \"box\"\nlow = [-0.025, -0.025]\nhigh = [1.025, 0.325]\n", scheme + tank);
    const auto particles = fill<2>(config);
    EXPECT_EQ(std::ranges::count(particles.type, ParticleType::fluid), 19 * 6) << scheme;
    for (std::size_t i = 0; i < particles.position.size(); ++i) {
      if (particles.type[i] != ParticleType::fluid) continue;
      EXPECT_GE(particles.position[i][0], 0.25 * dp);
      EXPECT_LE(particles.position[i][0], 1.0 - 0.25 * dp);
      EXPECT_GE(particles.position[i][1], 0.25 * dp);
    }
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

TEST(FluidRegion, OfARestartIsThatOfTheRun) {
  const Case config = scene_case(
      "[[fluid.region]]\nshape = \"circle\"\ncenter = [0, 0]\nradius = 1\ngradient = [1, 0, 0, -1]\n"
      "[[fluid.region]]\nshape = \"polygon\"\npoints = [[3, 0], [4, 0], [3.5, 1]]\n"
      "[[fluid.gravity_at]]\ntime = 0\nvalue = [0, -9.81]\n");
  const NamedText stored{"a.checkpoint", config.resolved_text};
  // The same values, in other words, and what a run may change.
  EXPECT_NO_THROW(
      parse_restart(stored, {"fluid.region[1].radius=1", "fluid.region[2].points=[[3,0],[4,0],[3.5,1.0]]"}, "o"));
  EXPECT_EQ(parse_restart(stored, {"fluid.gravity_at[1].value=[1,2]"}, "o").fluid.gravity_at[0].value[1], 2.0);
  for (const std::string change :
       {"fluid.region[1].radius=1.1", "fluid.region[1].center=[0,1e-9]", "fluid.region[1].gradient=[1,0,0,-1.5]",
        "fluid.region[2].points=[[3,0],[4,0],[3.5,2]]", "fluid.region[2].name=\"other\"", "fluid.region[2].scale=2",
        "fluid.region[2].rotate=1", "fluid.region[2].translate=[1,0]", "fluid.region[2].about=[3,0]",
        "fluid.region[2].velocity=[0,1]", "fluid.region[2].spin=1"}) {
    try {
      parse_restart(stored, {change}, "o");
      ADD_FAILURE() << change;
    } catch (const InputError& error) {
      expect_one(error.mistakes(), "--set: " + change.substr(0, change.find('=')) + " = ");
      expect_one(error.mistakes(), ": a restart cannot change this key; allowed: ");
    }
  }
  for (const std::string change : {"fluid.region[3].radius=1", "fluid.region=[]", "fluid.region[1].shape=\"box\""})
    EXPECT_THROW(parse_restart(stored, {change}, "o"), InputError) << change;
}

TEST(FluidRegion, InSpaceReadsBackFromTheResolvedCase) {
  const Case config = scene_case(
      "[[fluid.region]]\nshape = \"sphere\"\ncenter = [0, 0, 1]\nradius = 0.3\ngradient = [1, 2, 3, 4, 5, 6, 7, 8, 9]\n"
      "[[fluid.region]]\nname = \"a \\\"b\\\"\"\nshape = \"box\"\nlow = [1, 0, 0]\nhigh = [1.2, 0.3, 0.1]\nscale = "
      "1.5\n",
      space);
  const Case again = parse_case({{"resolved.toml", config.resolved_text}});
  EXPECT_EQ(again.resolved_text, config.resolved_text);
  EXPECT_EQ(positions(fill<3>(again)), positions(fill<3>(config)));
  EXPECT_EQ(fill<3>(again).velocity, fill<3>(config).velocity);
  EXPECT_EQ(again.regions[1].name, "a \"b\"");
}

TEST(FluidRegion, OverlapsAreFoundAndTouchingRegionsAreNot) {
  const auto box = [](const std::string& low, const std::string& high, const std::string& more = "") {
    return "[[fluid.region]]\nshape = \"box\"\nlow = " + low + "\nhigh = " + high + "\n" + more;
  };
  const auto circle = [](const std::string& center) {
    return "[[fluid.region]]\nshape = \"circle\"\ncenter = " + center + "\nradius = 1\n";
  };
  const auto overlaps = [](const std::string& regions, const std::string& before = head) {
    const auto found = mistakes_in(regions, before);
    if (!found.empty()) expect_one(found, ": overlaps the fluid \"region_1\", given at case.toml:");
    return !found.empty();
  };
  EXPECT_FALSE(overlaps(box("[0, 0]", "[1, 1]") + box("[1, 0]", "[2, 1]")));
  EXPECT_FALSE(overlaps(box("[0, 0]", "[1, 1]") + box("[0.99, 0]", "[2, 1]")));
  EXPECT_FALSE(overlaps(circle("[0, 0]") + circle("[2, 0]")));
  EXPECT_FALSE(overlaps(circle("[0, 0]") + box("[0.71, 0.71]", "[1, 1]")));
  EXPECT_FALSE(overlaps(box("[0, 0]", "[1, 1]") + box("[0, 0]", "[1, 1]", "translate = [0, 1]\n")));
  // Turned by 45 degrees, a square's bounds overlap, but not the square.
  EXPECT_FALSE(overlaps(box("[0, 0]", "[1, 1]", "rotate = 45\n") + box("[0.95, 0.95]", "[1.5, 1.5]")));
  EXPECT_TRUE(overlaps(box("[0, 0]", "[1, 1]", "rotate = 45\n") + box("[0.8, 0.6]", "[1.5, 1.5]")));
  EXPECT_TRUE(overlaps(circle("[0, 0]") + circle("[1.35, 1.35]")));
  EXPECT_TRUE(overlaps(box("[0, 0]", "[1, 1]") + box("[0.4, 0.4]", "[0.6, 0.6]")));  // one in the other
  EXPECT_TRUE(overlaps(box("[0, 0]", "[1, 1]") + box("[0, 0]", "[1, 1]")));
  // A narrow strip between long regions.
  const std::string room = "domain = {low = [0, 0], high = [1000, 2]}\n";
  EXPECT_TRUE(overlaps(room + box("[0, 0]", "[1000, 1]") + box("[0, 0.95]", "[1000, 2]")));
  EXPECT_FALSE(overlaps(room + box("[0, 0]", "[1000, 1]") + box("[0, 1]", "[1000, 2]")));
  EXPECT_TRUE(overlaps(box("[0, 0, 0]", "[9, 9, 1]") + box("[0, 0, 0.95]", "[9, 9, 2]"), space));
  EXPECT_FALSE(overlaps(box("[0, 0, 0]", "[9, 9, 1]") + box("[0, 0, 1]", "[9, 9, 2]"), space));
}

TEST(FluidRegion, OfTheWrongDimensionOrWithoutParticlesIsAMistake) {
  const auto with = [](const std::string& region) { return "[[fluid.region]]\n" + region; };
  const std::string sphere = "shape = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n";
  expect_one(mistakes_in(with("shape = \"circle\"\ncenter = [0, 0, 0]\nradius = 1\n"), space),
             "case.toml:6: fluid.region[1].shape = \"circle\": circles and polygons have two dimensions");
  expect_one(mistakes_in(with("shape = \"polygon\"\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\n"), space),
             "case.toml:6: fluid.region[1].shape = \"polygon\": circles and polygons have two dimensions");
  expect_one(mistakes_in(with(sphere + "axis = [0, 0, 0]\n"), space),
             "case.toml:9: fluid.region[1].axis = [0.0, 0.0, 0.0]: no direction; allowed: any vector but 0");
  expect_one(mistakes_in(with(sphere + "spin = 5\n"), space),
             "case.toml:9: fluid.region[1].spin = 5.0: a rotation in two dimensions only; allowed: 0 (rad/s)");
  expect_one(mistakes_in(with(sphere + "gradient = [1, 0, 0, 1]\n"), space),
             "case.toml:9: fluid.region[1].gradient = [1.0, 0.0, 0.0, 1.0]: has 4 numbers; allowed: 9");
  expect_one(mistakes_in(with("shape = \"box\"\nlow = [0, 0, 0]\nhigh = [1, -1, 1]\n"), space),
             "case.toml:6: fluid.region[1].shape = \"box\": the low corner is not below the high corner");
  expect_one(mistakes_in(with("shape = \"box\"\nlow = [0, 0]\nhigh = [1, 0]\n")),
             "case.toml:5: fluid.region[1].shape = \"box\": ");
  expect_one(mistakes_in(with("shape = \"circle\"\ncenter = [0, 0]\nradius = 1\nscale = 0.01\n")),
             "case.toml:5: fluid.region[1].shape = \"circle\": holds no particle");
  expect_one(mistakes_in(with("shape = \"circle\"\ncenter = [0, 0]\nradius = 0\n")),
             "case.toml:7: fluid.region[1].radius = 0: out of range; allowed: > 0 (m)");
  expect_one(mistakes_in(with("shape = \"polygon\"\npoints = [[0, 0], [1, 1]]\n")), "at least 3 points");
  expect_one(mistakes_in(with("shape = \"polygon\"\npoints = [[0, 0], [1, 1, 1], [2, 0]]\n")),
             "case.toml:6: fluid.region[1].points = ");
  expect_one(
      mistakes_in(with("shape = \"circle\"\ncenter = [0, 0]\nradius = 1\nlow = [0, 0]\n")),
      "case.toml:8: fluid.region[1].low = [0, 0]: a key of shape \"box\", but fluid.region[1].shape is \"circle\"");
  expect_one(mistakes_in("domain = {low = [0, 0], high = [1, 1]}\n" +
                         with("shape = \"box\"\nlow = [-1e9, -1e9]\nhigh = [1e9, 1e9]\n")),
             "case.toml:6: fluid.region[1].shape = \"box\": makes some 1.6e+21 particles; allowed: at most 2147483647");
}

TEST(FluidRegion, OutsideTheSceneIsAMistake) {
  const std::string far = "[[fluid.region]]\nshape = \"box\"\nlow = [1, 0]\nhigh = [2, 0.3]\n";
  expect_one(
      mistakes_in(far, tank),
      "case.toml:6: fluid.region[1].shape = \"box\": lies outside the scene, which reaches from (0, 0) to (1, 0.5) m");
  expect_one(
      mistakes_in("domain = {low = [5, -5], high = [6, 6.5]}\n" + far),
      "case.toml:6: fluid.region[1].shape = \"box\": lies outside the scene, which reaches from (5, -5) to (6, 6.5) m");
  expect_one(
      mistakes_in("domain.high = [1.05, 1]\ndomain.low = [1.02, -1]\n" + far),
      "case.toml:4: domain.high = [1.05, 1.0]: the bounds are narrower than two particles; allowed: above 1.12 (m)");
  EXPECT_EQ(mistakes_in("domain = {low = [1.5, -5], high = [6, 6]}\n" + far), std::vector<std::string>{});
  EXPECT_EQ(mistakes_in(far + "translate = [-1.5, 0]\n", tank), std::vector<std::string>{});
}

TEST(FluidRegion, ANameThatIsNotGivenCountsToo) {
  expect_one(mistakes_in("[[fluid.region]]\nname = \"region_2\"\nshape = \"box\"\nlow = [3, 3]\nhigh = [4, 4]\n" +
                         std::string(square)),
             "case.toml:9: fluid.region[2].name = \"region_2\": the name is used twice, first at case.toml:5");
}

TEST(FluidRegion, TheSpeedBoundIsThatOfTheLargestGravityInTime) {
  const std::string column = "[[fluid.region]]\nshape = \"box\"\nlow = [0, 0]\nhigh = [0.4, 0.4]\n";
  const double constant = scene_case("fluid.gravity = [9.0, -12.0]\n" + column, tank).time.max_speed;
  EXPECT_DOUBLE_EQ(constant, 20.0 * std::sqrt(2.0 * 15.0 * 0.4));
  const std::string table =
      "[[fluid.gravity_at]]\ntime = 0\nvalue = [0, -9.81]\n[[fluid.gravity_at]]\ntime = 1\nvalue = [9, -12]\n";
  EXPECT_DOUBLE_EQ(scene_case(column + table, tank).time.max_speed, constant);
  EXPECT_DOUBLE_EQ(scene_case("tank.fluid_height = 0.4\n" + table, tank).time.max_speed, constant);
  // The table stands instead of fluid.gravity.
  EXPECT_DOUBLE_EQ(scene_case("fluid.gravity = [0, -99]\n" + column + table, tank).time.max_speed, constant);
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
  expect_one(mistakes_in(""),
             "case.toml:1: geometry = \"scene\": no fluid and no inlet; allowed: at least one "
             "[[fluid.region]] or [[inlet]]");
  expect_one(mistakes_in("domain = {low = [0, 0], high = [1, 0.09]}\n" + std::string(square)),
             "narrower than two particles");
  expect_one(mistakes_in("", tank), "tank.fluid_height = 0.0: no fluid");
  expect_one(mistakes_in("tank.fluid_height = 0.5\n" + std::string(square), tank), "allowed: one of the two");
  expect_one(mistakes_in("jet = {width = 0.4, speed = 1, angle = 60}\n" + std::string(square),
                         "geometry = \"jet\"\nparticles.spacing = 0.02\ntime = {end = 1.0, dt = 1e-3}\n"),
             "a key of geometry \"tank\", \"scene\"");
}

}  // namespace
}  // namespace impinge
