// Walls of any shape: their sides, points, particles, the fluid between them, and what can be wrong with them.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "impinge/scenes/scene_report.hpp"
#include "scene_case.hpp"

namespace impinge {
namespace {

constexpr double dp = 0.05;

/// The places of the fluid of a scene.
std::vector<Vector<2>> fluid_of(const std::string& text) {
  const Particles<2> particles = particles_of(scene_of(scene_case(text)));
  std::vector<Vector<2>> places;
  for (std::size_t i = 0; i < particles.position.size(); ++i)
    if (particles.type[i] == ParticleType::fluid) places.push_back(particles.position[i]);
  return places;
}

TEST(SceneWalls, TakeEachShapeWithItsPlaceAndItsSides) {
  const Scene<2> scene = scene_of(scene_case(unit_square + R"([[wall]]
name = "tank"
shape = "box"
low = [-1, -1]
high = [2, 3]
wet = "inside"
slip = true
[[wall]]
shape = "circle"
center = [0.5, 0.5]
radius = 0.2
[[wall]]
shape = "arc"
center = [0, 0]
radius = 0.5
from = 90
to = 0
scale = 0.5
wet = "right"
[[wall]]
shape = "polygon"
points = [[0, 2], [0.5, 2], [0.25, 2.5]]
wet = "both"
[[wall]]
shape = "polyline"
points = [[1.2, 0], [1.2, 1], [1.5, 1]]
rotate = 90
about = [1.2, 0]
translate = [0.5, 0]
)"));
  ASSERT_EQ(scene.walls.size(), 5u);
  const auto sides = [&](std::size_t k) { return std::pair(scene.walls[k].wet_front, scene.walls[k].wet_back); };
  EXPECT_EQ(scene.walls[0].name, "tank");
  EXPECT_EQ(scene.walls[1].name, "wall_2");
  EXPECT_EQ(sides(0), std::pair(false, true));
  EXPECT_EQ(sides(1), std::pair(true, false));
  EXPECT_EQ(sides(2), std::pair(true, false));
  EXPECT_EQ(sides(3), std::pair(true, true));
  EXPECT_EQ(sides(4), std::pair(true, true));
  EXPECT_TRUE(scene.walls[0].slip);
  EXPECT_FALSE(scene.walls[1].slip);
  EXPECT_DOUBLE_EQ(scene.walls[0].surface->volume(), 12.0);
  EXPECT_NEAR(scene.walls[2].surface->length(), 0.125 * std::numbers::pi, 1e-14);
  const auto& edges = scene.walls[4].surface->edges();
  ASSERT_EQ(edges.size(), 2u);
  EXPECT_NEAR(norm(edges[0].begin - Vector<2>{{1.7, 0.0}}), 0.0, 1e-14);
  EXPECT_NEAR(norm(edges[0].end - Vector<2>{{0.7, 0.0}}), 0.0, 1e-14);
  EXPECT_NEAR(norm(edges[1].end - Vector<2>{{0.7, 0.3}}), 0.0, 1e-14);
}

TEST(SceneWalls, HaveAParticleOnEachPointBeforeTheFluid) {
  const Case config = scene_case(unit_square +
                                 "[[wall]]\nshape = \"box\"\nlow = [0, 0]\nhigh = [1, 1.5]\nwet = \"inside\"\n"
                                 "[[wall]]\nshape = \"polyline\"\npoints = [[0.3, 0.2], [0.3, 0.8]]\n");
  const Scene<2> scene = scene_of(config);
  const Particles<2> particles = particles_of(scene);
  ASSERT_EQ(scene.wall_points.size(), 100u + 24u);
  std::set<std::int64_t> ids;
  for (std::size_t i = 0; i < particles.position.size(); ++i) {
    EXPECT_TRUE(ids.insert(particles.id[i]).second);
    EXPECT_LT(particles.id[i], scene.next_id);
    const bool is_wall = particles.type[i] == ParticleType::wall;
    EXPECT_EQ(is_wall, particles.id[i] < static_cast<std::int64_t>(scene.wall_points.size()));
    if (!is_wall) continue;
    const WallPoint<2>& point = scene.wall_points[static_cast<std::size_t>(particles.id[i])];
    EXPECT_EQ(particles.position[i], point.position);
    EXPECT_EQ(scene.wall_normal(particles.position[i]), point.normal);
  }
  EXPECT_EQ(std::ranges::count(particles.type, ParticleType::wall), 124);
  for (const int ranks : {2, 3, 7}) {
    const Particles<2> parts = particles_of(scene, ranks);
    EXPECT_EQ(std::set(parts.id.begin(), parts.id.end()), ids);
    EXPECT_EQ(parts.owned, particles.owned);
  }
}

TEST(SceneWalls, ATankKeepsTheFluidInside) {
  const std::string region = "[[fluid.region]]\nshape = \"box\"\nlow = [-1, -1]\nhigh = [3, 0.5]\n";
  const auto fluid = fluid_of(region + "[[wall]]\nshape = \"box\"\nlow = [0, 0]\nhigh = [1, 1]\nwet = \"inside\"\n");
  EXPECT_EQ(fluid.size(), 20u * 10u);
  for (const auto& place : fluid) {
    EXPECT_GT(place[0], 0.0);
    EXPECT_LT(place[0], 1.0);
    EXPECT_GT(place[1], 0.0);
  }
  // Two tanks beside each other.
  EXPECT_EQ(fluid_of(region + "[[wall]]\nshape = \"box\"\nlow = [0, 0]\nhigh = [1, 1]\nwet = \"inside\"\n"
                              "[[wall]]\nshape = \"box\"\nlow = [1.5, 0]\nhigh = [2.5, 1]\nwet = \"inside\"\n")
                .size(),
            2u * 20u * 10u);
}

TEST(SceneWalls, ABodyKeepsTheFluidOutside) {
  const auto fluid = fluid_of(unit_square + "[[wall]]\nshape = \"circle\"\ncenter = [0.5, 0.5]\nradius = 0.3\n");
  EXPECT_NEAR(static_cast<double>(fluid.size()) * dp * dp, 1.0 - 0.09 * std::numbers::pi, 0.05);
  for (const auto& place : fluid) EXPECT_GE(norm(place - Vector<2>{{0.5, 0.5}}), 0.3 + 0.25 * dp);
}

TEST(SceneWalls, ALineKeepsAGapAndIsDryBehindOnlyWhereItSaysSo) {
  const auto with = [&](const std::string& points, const std::string& wet) {
    return fluid_of(unit_square + "[[wall]]\nshape = \"polyline\"\npoints = " + points + "\nwet = \"" + wet + "\"\n");
  };
  // Along a column of particles: these go to one side or the other.
  const auto both = with("[[0.525, 0.2], [0.525, 0.8]]", "both");
  EXPECT_EQ(both.size(), 400u);
  EXPECT_TRUE(std::ranges::none_of(
      both, [](const auto& x) { return std::abs(x[0] - 0.525) < 0.25 * dp && x[1] > 0.2 && x[1] < 0.8; }));
  // Fluid to the right of the way upwards, x > 0.5; behind it goes what is nearer than 3 dp: three columns.
  const auto right = with("[[0.5, 0], [0.5, 1]]", "right");
  EXPECT_EQ(right.size(), 400u - 3u * 20u);
  EXPECT_TRUE(std::ranges::none_of(right, [](const auto& x) { return x[0] > 0.5 - 3.0 * dp && x[0] < 0.5; }));
  const auto left = with("[[0.5, 0], [0.5, 1]]", "left");
  EXPECT_TRUE(std::ranges::none_of(left, [](const auto& x) { return x[0] < 0.5 + 3.0 * dp && x[0] > 0.5; }));
  // A line that ends inside the fluid hides nothing beyond its end.
  const auto half = with("[[0.5, -1], [0.5, 0.5]]", "right");
  EXPECT_EQ(half.size(), 400u - 3u * 10u);
}

TEST(SceneWalls, TheVolumeOfAFluidIsThatBetweenTheWalls) {
  const Case config = scene_case(
      "[[fluid.region]]\nshape = \"box\"\nlow = [-1, -1]\nhigh = [3, 0.5]\n"
      "[[wall]]\nshape = \"box\"\nlow = [0, 0]\nhigh = [1, 1]\nwet = \"inside\"\n"
      "[[wall]]\nshape = \"circle\"\ncenter = [0.5, 0.0]\nradius = 0.2\n");
  const RegionVolume volume = volume_between_walls<2>(config, config, config.regions[0]);
  EXPECT_NEAR(volume.expected, 0.5 - 0.02 * std::numbers::pi, 2e-3);
  EXPECT_NEAR(
      volume.of_particles,
      static_cast<double>(std::ranges::count(particles_of(scene_of(config)).type, ParticleType::fluid)) * dp * dp,
      1e-12);
}

// 18.3 rows of particles are 18.
TEST(SceneWalls, TheVolumeIsThatOfTheFluidNotOfItsLattice) {
  const Case config =
      scene_case(fmt::format("[[fluid.region]]\nshape = \"box\"\nlow = [0, 0]\nhigh = [1, {0}]\n"
                             "[[wall]]\nshape = \"box\"\nlow = [0, 0]\nhigh = [1, 2]\nwet = \"inside\"\n",
                             18.3 * dp));
  const RegionVolume volume = volume_between_walls<2>(config, config, config.regions[0]);
  EXPECT_NEAR(volume.expected, 18.3 * dp, 1e-9);
  EXPECT_NEAR(volume.of_particles, 18.0 * dp, 1e-9);
}

TEST(SceneWalls, TheBoundsHoldThem) {
  const Case config =
      scene_case(unit_square + "[[wall]]\nshape = \"box\"\nlow = [-3, -2]\nhigh = [4, 5]\nwet = \"inside\"\n");
  EXPECT_DOUBLE_EQ(config.domain.low[0], -4.0);
  EXPECT_DOUBLE_EQ(config.domain.low[1], -3.0);
  EXPECT_DOUBLE_EQ(config.domain.high[0], 5.0);
  EXPECT_DOUBLE_EQ(config.domain.high[1], 6.0);
  EXPECT_DOUBLE_EQ(config.time.max_speed, 20.0 * std::sqrt(2.0 * 9.81 * 7.0));
  expect_mistake(
      scene_mistakes("domain = {low = [-2, -2], high = [2, 2]}\n" + unit_square +
                     "[[wall]]\nshape = \"polyline\"\npoints = [[0, -0.5], [2, -0.5]]\n"),
      "case.toml:11: wall[1].shape = \"polyline\": the wall reaches from x = 0 to 2 m, nearer to the bounds");
}

TEST(SceneWalls, ReadBackFromTheResolvedCase) {
  const Case config = scene_case(
      unit_square +
      "[[wall]]\nshape = \"arc\"\ncenter = [0, 0]\nradius = 2\nfrom = -90\nto = 0\nslip = false\n"
      "[[wall]]\nname = \"keel\"\nshape = \"polygon\"\npoints = [[0.1, -0.5], [0.9, -0.5], [0.5, -0.1]]\nrotate = 5\n");
  const Case again = parse_case({{"resolved.toml", config.resolved_text}});
  EXPECT_EQ(again.resolved_text, config.resolved_text);
  EXPECT_EQ(particles_of(scene_of(again)).position, particles_of(scene_of(config)).position);
  const NamedText stored{"a.checkpoint", config.resolved_text};
  EXPECT_NO_THROW(parse_restart(stored, {"time.end=2"}, "out"));
  EXPECT_THROW(parse_restart(stored, {"wall[2].rotate=20"}, "out"), InputError);
}

TEST(SceneWalls, AreTold) {
  const Case config = scene_case(
      unit_square +
      "[[wall]]\nname = \"tank\"\nshape = \"box\"\nlow = [0, 0]\nhigh = [2, 1.5]\nwet = \"inside\"\nmotion = \"sway\"\n"
      "[[wall]]\nname = \"post\"\nshape = \"circle\"\ncenter = [1, 1.2]\nradius = 0.1\nmotion = \"sway\"\n"
      "[[wall]]\nname = \"plate\"\nshape = \"polyline\"\npoints = [[0.2, 1], [0.3, 1], [0.4, 1], [0.4, 1.2]]\nmotion = "
      "\"sway\"\n"
      "[[motion]]\nname = \"sway\"\ntype = \"constant\"\n"
      "[[motion]]\nname = \"roll\"\ntype = \"constant\"\nvelocity = [0.3, 0]\nspin = -20\nstart = 0.5\n"
      "[[inlet]]\ncenter = [1.7, 0.5]\ndirection = [-1, 0]\nwidth = 0.2\nspeed = 0.5\nstart = 0.25\n"
      "[[inlet]]\ncenter = [1.7, 1]\ndirection = [-1, 0]\nwidth = 0.2\ntimes = [0, 1]\nspeeds = [1, 2]\nstop = 2\n"
      "[[outlet]]\nshape = \"box\"\nlow = [1.5, 0]\nhigh = [2, 0.25]\n");
  const SceneReport report = report_scene(config, config);
  EXPECT_EQ(
      report.lines,
      (std::vector<std::string>{
          "wall        tank: 7 m long, 3 m^2 enclosed, 4 faces, wet inside, moves by sway, narrowest gap 4 dp, to "
          "post, at (1, 1.4) m",
          "wall        post: 0.628319 m long, 0.0314159 m^2 enclosed, 1 face, wet outside, moves by sway, narrowest "
          "gap 4 dp, to tank, at (1, 1.4) m",
          "wall        plate: 0.4 m long, 2 faces of 3 pieces, wet both, moves by sway, narrowest gap 4 dp, to tank, "
          "at (0.1, 1) m",
          "motion      sway: constant, t = 0 to 1 s, moves tank, post, plate",
          "motion      roll: constant, t = 0.5 to 1 s, x from 0 to 0.15 m, angle from -573 to 0 deg, moves no wall",
          "inlet       inlet_1: 0.2 m wide, 4 rows of 4 particles, 0.5 m/s, from t = 0.25 s",
          "inlet       inlet_2: 0.2 m wide, 4 rows of 4 particles, 2 speeds up to 2 m/s, until t = 2 s",
          "outlet      outlet_1: 0.125 m^2"}));
  EXPECT_EQ(report.warnings, std::vector<std::string>{});
}

TEST(SceneWalls, ANarrowGapIsAWarningWithItsPlace) {
  const auto warnings = [](const std::string& body) {
    const Case config = scene_case(unit_square +
                                   "[[wall]]\nname = \"floor\"\nshape = \"polyline\"\npoints = [[-1, 0], [3, "
                                   "0]]\nwet = \"left\"\n[[wall]]\nname = \"body\"\n" +
                                   body);
    return report_scene(config, config).warnings;
  };
  const auto box = [](const std::string& low) {
    return "shape = \"box\"\nlow = [1.5, " + low + "]\nhigh = [1.6, 0.7]\n";
  };
  expect_mistake(
      warnings(box("0.05")),
      "the gap between the walls \"floor\" and \"body\" is 1 dp wide at (1.5, 0.025) m; fluid needs 2 dp to pass");
  EXPECT_EQ(warnings(box("0.11")), std::vector<std::string>{});
  EXPECT_EQ(warnings(box("0")), std::vector<std::string>{});     // standing on it
  EXPECT_EQ(warnings(box("-0.1")), std::vector<std::string>{});  // sunk into it
  // Below the floor, which is dry there.
  EXPECT_EQ(warnings("shape = \"box\"\nlow = [1.5, -0.7]\nhigh = [1.6, -0.05]\n"), std::vector<std::string>{});
}

TEST(SceneWalls, AGapWithinAWallCountsAsOneBetweenTwo) {
  const auto warnings = [](const std::string& wall) {
    const Case config =
        scene_case("domain = {low = [-9, -9], high = [9, 9]}\n" + unit_square + "[[wall]]\nname = \"w\"\n" + wall);
    return report_scene(config, config).warnings;
  };
  const auto polygon = [](const std::string& points) { return "shape = \"polygon\"\npoints = " + points + "\n"; };
  const auto line = [](const std::string& points) { return "shape = \"polyline\"\npoints = " + points + "\n"; };
  // A slot, open at its top.
  const auto slot = [&](const std::string& left, const std::string& right) {
    return polygon("[[2, 0], [4, 0], [4, 1], [" + right + ", 1], [" + right + ", 0.2], [" + left + ", 0.2], [" + left +
                   ", 1], [2, 1]]");
  };
  expect_mistake(warnings(slot("3", "3.05")), "the gap within the wall \"w\" is 1 dp wide at (3.025, ");
  EXPECT_EQ(warnings(slot("3", "3.11")), std::vector<std::string>{});
  EXPECT_EQ(warnings(slot("3", "3.05") + "wet = \"inside\"\n"), std::vector<std::string>{});
  // A throat between two tips, and one that is closed on all sides.
  expect_mistake(
      warnings(polygon("[[2, 0], [4, 0], [4, 1], [3.04, 0.5], [3.5, 0.2], [2.5, 0.2], [2.96, 0.5], [2, 1]]")),
      "1.6 dp wide at (3, 0.5) m");
  expect_mistake(warnings("shape = \"box\"\nlow = [2, 0]\nhigh = [4, 0.08]\nwet = \"inside\"\n"), "1.6 dp wide at (");
  EXPECT_EQ(warnings("shape = \"box\"\nlow = [2, 0]\nhigh = [4, 0.08]\n"), std::vector<std::string>{});
  // A line that comes back, and the mouth of an arc.
  expect_mistake(warnings(line("[[2, 0], [3, 0], [3, 1], [2.05, 0.09]]")), "is 1.");
  expect_mistake(warnings(line("[[2, 0], [3, 0], [3, 0.06], [2, 0.06]]")), "is 1.2 dp wide");
  EXPECT_EQ(warnings(line("[[2, 0], [3, 0], [3, 0.06], [2, 0.06]]") + "wet = \"right\"\n"), std::vector<std::string>{});
  const std::string arc = "shape = \"arc\"\ncenter = [3, 0]\nradius = 0.5\nfrom = 5\nto = ";
  expect_mistake(warnings(arc + "355\n"), "is 1.74 dp wide at (3.4981, 0) m");
  EXPECT_EQ(warnings(arc + "345\n"), std::vector<std::string>{});
  // Corners, sharp or blunt, have none, nor has a curve of short pieces.
  EXPECT_EQ(warnings(line("[[2, 1], [3, 0], [3.1, 1]]")), std::vector<std::string>{});
  EXPECT_EQ(warnings(line("[[2, 1], [3, 0], [3.03, 0], [4, 1]]")), std::vector<std::string>{});
  std::string curve = "[[2, 0]";
  for (int k = 1; k < 200; ++k)
    curve += ", [" + std::to_string(2.0 + 0.01 * k) + ", " + std::to_string(0.2 * std::sin(0.05 * k)) + "]";
  EXPECT_EQ(warnings(line(curve + "]")), std::vector<std::string>{});
}

TEST(SceneWalls, AWallOfShortPiecesHasNoGaps) {
  const auto warnings = [](const std::vector<std::string>& lines, const std::string& wet) {
    std::string walls;
    for (const std::string& points : lines)
      walls += "[[wall]]\nshape = \"polyline\"\npoints = [" + points + "]\nwet = \"" + wet + "\"\n";
    const Case config = scene_case("domain = {low = [-9, -9], high = [9, 9]}\n" + unit_square + walls);
    return report_scene(config, config).warnings;
  };
  for (const char* wet : {"left", "both"}) {
    // One piece of 1.5 dp between long ones, in line with them or not, and two of 1.1 dp.
    EXPECT_EQ(warnings({"[1, 0], [2, 0]", "[2, 0], [2.075, 0]", "[2.075, 0], [3, 0]"}, wet),
              std::vector<std::string>{});
    EXPECT_EQ(warnings({"[1, 0], [2, 0]", "[2, 0], [2.06, 0.045]", "[2.06, 0.045], [3, 0.045]"}, wet),
              std::vector<std::string>{});
    EXPECT_EQ(warnings({"[1, 0], [2, 0.2]", "[2, 0.2], [2.06, 0.155]", "[2.06, 0.155], [3, 0.4]"}, wet),
              std::vector<std::string>{});
    EXPECT_EQ(
        warnings({"[1, 0.5], [2, 0]", "[2, 0], [2.05, -0.02]", "[2.05, -0.02], [2.098, 0]", "[2.098, 0], [3, 0.5]"},
                 wet),
        std::vector<std::string>{});
    // A slot of 1.5 dp between walls is one also with a bottom.
    expect_mistake(warnings({"[2, 0.5], [2, 0]", "[2, 0], [2.075, 0]", "[2.075, 0], [2.075, 0.5]"}, wet),
                   "the gap between the walls \"wall_1\" and \"wall_3\" is 1.5 dp wide");
  }
}

TEST(SceneWalls, AGapThatOpensInTimeIsToldWithTheTime) {
  const auto warnings = [](const std::string& body, const std::string& motion) {
    const Case config =
        scene_case("domain = {low = [-9, -9], high = [9, 9]}\n" + unit_square +
                   "[[wall]]\nname = \"flume\"\nshape = \"polyline\"\nwet = \"left\"\npoints = [[-1, 0], "
                   "[3, 0], [3, 1]]\n[[wall]]\nname = \"body\"\nmotion = \"m\"\n" +
                   body + "[[motion]]\nname = \"m\"\n" + motion);
    return report_scene(config, config).warnings;
  };
  const std::string piston = "shape = \"polyline\"\npoints = [[0, 0], [0, 1]]\n";
  const std::string box = "shape = \"box\"\nlow = [1.5, 0.5]\nhigh = [2, 0.8]\n";
  const auto stroke = [](const std::string& of) {
    return "type = \"table\"\ntimes = [0, 0.5, 1]\npositions = [[0, 0], " + of + ", [0, 0]]\n";
  };
  // Sliding along the floor and touching it are no gaps; coming near is.
  EXPECT_EQ(warnings(piston, stroke("[0.5, 0]")), std::vector<std::string>{});
  EXPECT_EQ(warnings("shape = \"box\"\nlow = [1, 0]\nhigh = [1.5, 0.5]\n", stroke("[0.5, 0]")),
            std::vector<std::string>{});
  EXPECT_EQ(warnings(box, stroke("[0.5, 0]")), std::vector<std::string>{});
  expect_mistake(warnings(box, stroke("[0.92, 0]")), "the gap between the walls \"flume\" and \"body\" is 1.6 dp wide");
  expect_mistake(warnings(box, stroke("[0, -0.45]")), "is 1 dp wide at (");
  expect_mistake(warnings(box, stroke("[0, -0.45]")), ", 0.025) m at t = 0.5 s; fluid needs 2 dp to pass");
  // Walls that move as one do not come nearer to each other; a flap on its hinge makes a corner.
  EXPECT_EQ(warnings(piston, "type = \"harmonic\"\nangle = 80\nfrequency = 1\n"), std::vector<std::string>{});
}

TEST(SceneWalls, WhatIsWrongWithThemIsTold) {
  const auto mistakes = [](const std::string& wall, const std::vector<std::string>& settings = {}) {
    return scene_mistakes(unit_square + "[[wall]]\n" + wall, settings);
  };
  const std::string circle = "shape = \"circle\"\ncenter = [0.5, 0.5]\nradius = 0.2\n";
  const std::string line = "shape = \"polyline\"\npoints = [[0, -0.1], [1, -0.1]]\n";
  expect_mistake(mistakes(circle + "wet = \"left\"\n"),
                 "case.toml:13: wall[1].wet = \"left\": a shape with an inside has no such side; allowed: \"outside\", "
                 "\"inside\", \"both\"");
  expect_mistake(
      mistakes(line + "wet = \"inside\"\n"),
      "case.toml:12: wall[1].wet = \"inside\": a line has no such side; allowed: \"left\", \"right\", \"both\"");
  expect_mistake(mistakes(line + "wet = \"none\"\n"),
                 "case.toml:12: wall[1].wet = \"none\": unknown word; allowed: \"outside\", \"inside\", \"left\"");
  expect_mistake(
      mistakes("shape = \"polygon\"\npoints = [[0, 0], [1, 1], [1, 0], [0, 1]]\n"),
      "case.toml:10: wall[1].shape = \"polygon\": the polygon meets itself: edge 1 from (0, 0) to (1, 1) and ");
  expect_mistake(mistakes("shape = \"polyline\"\npoints = [[0, 0], [1, 1], [1, 0], [0, 1]]\n"),
                 "the polyline meets itself");
  expect_mistake(mistakes("shape = \"polygon\"\npoints = [[0, 0], [1, 1]]\n"), "a polygon needs at least 3 points");
  expect_mistake(mistakes("shape = \"polygon\"\npoints = [[0, 0], [1, 1], [0, 1], [0, 0]]\n"), "repeats the first");
  expect_mistake(mistakes("shape = \"arc\"\ncenter = [0, 0]\nradius = 1\nfrom = 10\nto = 370\n"),
                 "the arc from 10 to 370 degrees must be more than 0 and less than 360 degrees long");
  expect_mistake(mistakes("shape = \"sphere\"\ncenter = [0, 0]\nradius = 1\n"),
                 "wall[1].shape = \"sphere\": a sphere has three dimensions");
  expect_mistake(mistakes("shape = \"polyline\"\npoints = [[0, 0], [0.01, 0]]\n"), "shorter than a spacing, 0.01 m");
  expect_mistake(mistakes(circle + "[[wall]]\nname = \"wall_1\"\n" + line),
                 "case.toml:14: wall[2].name = \"wall_1\": the name is used twice, first at case.toml:9");
  expect_mistake(mistakes(line, {"scheme=paper"}),
                 "case.toml:9: wall = [{...}]: walls of any shape are no particles; allowed: walls.model = \"mirror\"");
  expect_mistake(mistakes(line, {"walls.model=particles"}), "walls of any shape are no particles");
  expect_mistake(scene_mistakes("[[fluid.region]]\nshape = \"arc\"\n"),
                 "fluid.region[1].shape = \"arc\": a line has no inside; allowed: \"box\", \"circle\", \"polygon\"");
  const auto in_space = [](const std::string& text) {
    try {
      parse_case({{"case.toml",
                   "dimension = 3\ngeometry = \"scene\"\nparticles.spacing = 0.05\ntime = {end = 1, dt = "
                   "1e-3}\n[[fluid.region]]\nshape = \"box\"\nlow = [0, 0, 0]\nhigh = [1, 1, 1]\n" +
                       text}});
    } catch (const InputError& error) {
      return error.mistakes();
    }
    return std::vector<std::string>{};
  };
  expect_mistake(in_space("[[wall]]\nshape = \"circle\"\ncenter = [0, 0, 0]\nradius = 1\n"),
                 "case.toml:10: wall[1].shape = \"circle\": circles, arcs and polylines have two dimensions");
  EXPECT_EQ(scene_mistakes("geometry = \"tank\"\n").size(), 1u);
  EXPECT_EQ(
      mistakes("shape = \"circle\"\ncenter = [0.5, 0.5]\nradius = -1\nwet = \"on\"\nslip = 1\nsplip = 2\n").size(), 4u);
}

}  // namespace
}  // namespace impinge
