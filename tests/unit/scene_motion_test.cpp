// Prescribed motions: poses and their derivatives, tables, and what can be wrong with walls that move.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "impinge/boundaries/prescribed_motion.hpp"
#include "impinge/scenes/wall_crossing.hpp"
#include "impinge/scenes/wet_space.hpp"
#include "scene_case.hpp"

namespace impinge {
namespace {

constexpr double pi = std::numbers::pi;
const Vector<2> a_point{{0.7, -0.4}};

/// Velocities and accelerations of a point are the derivatives of its place.
void expect_consistent(const Motion<2>& motion, double from, double to) {
  constexpr double h = 1e-4;
  for (double t = from; t < to; t += 0.0371 * (to - from)) {
    const auto place = [&](double time) { return motion(time).of_position(a_point); };
    const Pose<2> pose = motion(t);
    const Vector<2> before = place(t - h), here = place(t), after = place(t + h);
    EXPECT_NEAR(norm(pose.velocity_at(here) - 0.5 / h * (after - before)), 0.0, 2e-5) << t;
    EXPECT_NEAR(norm(pose.acceleration_at(here) - 1.0 / (h * h) * (after - 2.0 * here + before)), 0.0, 2e-4) << t;
    const Vector<2> direction = pose.of_direction({{1.0, 0.0}});
    EXPECT_NEAR(norm(direction), 1.0, 1e-14);
    EXPECT_NEAR(norm(pose.of_position(a_point + Vector<2>{{1.0, 0.0}}) - here - direction), 0.0, 1e-14);
  }
}

void expect_at_rest(const Pose<2>& pose) {
  const Vector<2> place = pose.of_position(a_point);
  EXPECT_EQ(pose.velocity_at(place), Vector<2>{});
  EXPECT_EQ(pose.acceleration_at(place), Vector<2>{});
}

const MotionFrame<2> frame{.center = {{0.3, 0.2}}, .start = 0.5, .end = 4.5};
constexpr Oscillation<2> oscillation{
    .amplitude = {{0.3, -0.1}}, .angle = 0.4, .frequency = 0.7, .phase = 0.6, .ramp = 1.5};
const std::vector<MotionPoint<2>> table{{0.0, {{0.0, 0.0}}, 0.0},  {0.4, {{0.1, 0.0}}, 0.1},
                                        {1.0, {{0.3, -0.2}}, 0.5}, {2.5, {{0.2, 0.4}}, -0.5},
                                        {3.0, {{0.0, 0.3}}, -0.4}, {4.0, {{-0.2, 0.1}}, 0.2}};

TEST(PrescribedMotion, VelocitiesAndAccelerationsAreDerivativesOfThePlace) {
  for (const auto& motion :
       {steady_motion(frame, {{0.3, -1.0}}, 2.0), harmonic_motion(frame, oscillation), table_motion(frame, table)})
    expect_consistent(motion, 0.501, 4.4);
}

TEST(PrescribedMotion, StandsBeforeItsStartAndAfterItsEnd) {
  for (const auto& motion :
       {steady_motion(frame, {{0.3, -1.0}}, 2.0), harmonic_motion(frame, oscillation), table_motion(frame, table)}) {
    expect_at_rest(motion(0.0));
    expect_at_rest(motion(9.0));
    EXPECT_EQ(motion(0.0).of_position(a_point), motion(0.5).of_position(a_point));
    EXPECT_EQ(motion(9.0).of_position(a_point), motion(4.5).of_position(a_point));
    EXPECT_NEAR(norm(motion(0.0).of_position(a_point) - a_point), 0.0, 1e-15);
  }
}

TEST(PrescribedMotion, TurnsAboutItsCentreThatMoves) {
  const Motion<2> motion = steady_motion<2>({.center = {{1.0, 2.0}}, .start = 0.0, .end = 1e30}, {{3.0, 0.0}}, pi);
  const Pose<2> pose = motion(0.5);
  EXPECT_NEAR(norm(pose.of_position({{1.0, 2.0}}) - Vector<2>{{2.5, 2.0}}), 0.0, 1e-14);
  EXPECT_NEAR(norm(pose.of_position({{2.0, 2.0}}) - Vector<2>{{2.5, 3.0}}), 0.0, 1e-14);
  EXPECT_NEAR(norm(pose.velocity_at({{2.5, 3.0}}) - Vector<2>{{3.0 - pi, 0.0}}), 0.0, 1e-14);
  EXPECT_NEAR(norm(pose.acceleration_at({{2.5, 3.0}}) - Vector<2>{{0.0, -pi * pi}}), 0.0, 1e-13);
}

TEST(PrescribedMotion, ARampRisesTwiceDifferentiably) {
  const Motion<2> motion = harmonic_motion({.center = {}, .start = 0.0, .end = 1e30}, oscillation);
  for (const double t : {0.0, 1.5}) {
    const auto acceleration = [&](double time) {
      const Pose<2> pose = motion(time);
      return pose.acceleration_at(pose.of_position(a_point));
    };
    EXPECT_NEAR(norm(acceleration(t) - acceleration(t + 1e-9)), 0.0, 1e-6);
    EXPECT_NEAR(norm(acceleration(t) - acceleration(t - 1e-9)), 0.0, 1e-6);
  }
  EXPECT_NEAR(motion(2.0).of_position({})[0], 0.3 * std::sin(2.0 * pi * 0.7 * 2.0 + 0.6), 1e-14);
}

TEST(PrescribedMotion, ASplineMeetsItsPointsAndIsSmoothThere) {
  const Motion<2> motion = table_motion<2>({.center = {}, .start = 0.0, .end = 1e30}, table);
  for (const MotionPoint<2>& point : table) {
    const Pose<2> pose = motion(point.time);
    EXPECT_NEAR(norm(pose.of_position({}) - point.shift), 0.0, 1e-14);
    EXPECT_NEAR(pose.of_direction({{1.0, 0.0}})[1], std::sin(point.angle), 1e-14);
    const Pose<2> before = motion(point.time - 1e-9), after = motion(point.time + 1e-9);
    EXPECT_NEAR(norm(before.velocity - after.velocity), 0.0, 1e-7);
    if (point.time > 0.0 && point.time < 4.0) {
      EXPECT_NEAR(norm(before.acceleration - after.acceleration), 0.0, 1e-6) << point.time;
    }
  }
  expect_at_rest(motion(4.0));
  // A parabola's cubic in between two points at rest: s^2 (3 - 2 s).
  const Motion<2> step =
      table_motion<2>({.center = {}, .start = 1.0, .end = 1e30}, {{0.0, {}, 0.0}, {2.0, {{1.0, 0.0}}, 0.0}});
  EXPECT_NEAR(step(1.5).of_position({})[0], 0.0625 * 2.5, 1e-15);
}

const std::string tank_wall =
    "[[wall]]\nname = \"tank\"\nshape = \"box\"\nlow = [0, 0]\nhigh = [1, 2]\nwet = \"inside\"\nmotion = \"sway\"\n";

TEST(SceneMotion, SeveralWallsMayHaveOne) {
  const Case config =
      scene_case(unit_square + tank_wall +
                 "[[wall]]\nshape = \"polyline\"\npoints = [[0.5, 0], [0.5, 0.5]]\nmotion = \"sway\"\n"
                 "[[wall]]\nshape = \"circle\"\ncenter = [0.3, 0.6]\nradius = 0.1\n"
                 "[[motion]]\nname = \"sway\"\ntype = \"harmonic\"\namplitude = [0.1, 0]\nfrequency = 1\nphase = 90\n");
  const Scene<2> scene = scene_of(config);
  ASSERT_EQ(scene.walls.size(), 3u);
  EXPECT_FALSE(scene.walls[2].motion);
  for (const std::size_t k : {0u, 1u}) {
    ASSERT_TRUE(scene.walls[k].motion);
    EXPECT_NEAR((*scene.walls[k].motion)(0.0).shift[0], 0.1, 1e-15);
    EXPECT_NEAR((*scene.walls[k].motion)(0.5).shift[0], -0.1, 1e-15);
  }
  // Particles and fluid stand between the walls as they are at the start.
  const Particles<2> particles = particles_of(scene);
  for (std::size_t i = 0; i < particles.position.size(); ++i) {
    if (particles.type[i] == ParticleType::fluid) {
      EXPECT_GT(particles.position[i][0], 0.1);
    }
    if (particles.id[i] >= 120) continue;  // the tank's
    const WallPoint<2>& point = scene.wall_points[static_cast<std::size_t>(particles.id[i])];
    EXPECT_NEAR(norm(particles.position[i] - point.position - Vector<2>{{0.1, 0.0}}), 0.0, 1e-14);
  }
  // The bounds hold the walls wherever they go, and speeds count those of the walls.
  EXPECT_NEAR(config.domain.low[0], -0.1 - 1.0, 1e-3);
  EXPECT_NEAR(config.domain.high[0], 1.1 + 1.0, 1e-3);
  EXPECT_NEAR(config.time.max_speed, 20.0 * std::sqrt(std::pow(0.2 * pi, 2) + 2.0 * 9.81 * 2.0), 1e-2);
}

TEST(SceneMotion, ReadsBackFromTheResolvedCase) {
  const Case config = scene_case(unit_square + tank_wall +
                                 "[[motion]]\nname = \"sway\"\ntype = \"table\"\ntimes = [0, 0.5, 1]\n"
                                 "positions = [[0, 0], [0.1, 0], [0.1, 0.1]]\nangles = [0, 5, 0]\ncenter = [0.5, 0]\n"
                                 "[[motion]]\ntype = \"constant\"\nspin = 1\nend = 2\n");
  const Case again = parse_case({{"resolved.toml", config.resolved_text}});
  EXPECT_EQ(again.resolved_text, config.resolved_text);
  EXPECT_EQ(again.motions[0].angles, (std::vector{0.0, 5.0, 0.0}));
  EXPECT_EQ(again.motions[1].name, "motion_2");
  const NamedText stored{"a.checkpoint", config.resolved_text};
  EXPECT_NO_THROW(parse_restart(stored, {"time.end=2"}, "out"));
  EXPECT_THROW(parse_restart(stored, {"motion[1].angles=[0,6,0]"}, "out"), InputError);
}

TEST(SceneMotion, ATableComesFromAFileOnce) {
  const auto directory = std::filesystem::temp_directory_path() / ("impinge_motion_" + std::to_string(getpid()));
  std::filesystem::create_directories(directory / "data");
  const auto write = [&](const std::string& name, const std::string& text) {
    std::ofstream(directory / name) << text;
    return (directory / name).string();
  };
  const std::string path =
      write("case.toml", scene_head + unit_square + tank_wall +
                             "[[motion]]\nname = \"sway\"\ntype = \"table\"\nfile = \"data/sway.csv\"\n");
  write("data/sway.csv", "# measured\r\nt, x, y, angle\r\n0, 0, 0, 0\r\n\r\n0.5, 0.1, 0, +2.5\r\n1,0.1,0.1,0\r\n");
  const std::vector<NamedText> files = load_case_files(path);
  ASSERT_EQ(files.size(), 2u);
  const Case config = parse_case(files);
  EXPECT_EQ(config.motions[0].times, (std::vector{0.0, 0.5, 1.0}));
  EXPECT_EQ(config.motions[0].angles, (std::vector{0.0, 2.5, 0.0}));
  EXPECT_EQ(config.motions[0].positions[2][1], 0.1);
  const Case again = parse_case({{"resolved.toml", config.resolved_text}});
  EXPECT_EQ(again.resolved_text, config.resolved_text);
  EXPECT_TRUE(are_of_one_run({"a", config.resolved_text}, {"b", again.resolved_text}));

  const auto mistakes = [&](const std::string& text) {
    write("data/sway.csv", text);
    try {
      parse_case(load_case_files(path));
    } catch (const InputError& error) {
      return error.mistakes();
    }
    return std::vector<std::string>{};
  };
  EXPECT_EQ(mistakes("t,x,y\n0,0,0\n1,0.1,0\n"), std::vector<std::string>{});
  const std::string place = path + ":19: motion[1].file = \"data/sway.csv\": ";
  expect_mistake(mistakes("t,x,y\n0,0,0\n1,0\n"),
                 place + "line 3 has 2 number(s); allowed: t [s], x [m], y [m], angle");
  expect_mistake(mistakes("0,0,0,0\n1,0,,0\n"), place + "line 2 has \"\" in the place of a number");
  expect_mistake(mistakes("0,0,0,0\n1,nan,0,0\n"), place + "line 2 has \"nan\" in the place of a number");
  expect_mistake(mistakes("t,x,y\n"), place + "has no line of numbers");
  expect_mistake(mistakes("0,0,0\n1,0,0\n1,0.1,0\n"),
                 "motion[1].times = [0.0, 1.0, 1.0]: the times do not rise: 1.0 after 1.0; allowed: > 1.0 (s)");
  std::filesystem::remove(directory / "data/sway.csv");
  try {
    parse_case(load_case_files(path));
    ADD_FAILURE();
  } catch (const InputError& error) {
    expect_mistake(error.mistakes(), place + "cannot read " + (directory / "data/sway.csv").string());
  }
  std::filesystem::remove_all(directory);
}

TEST(SceneMotion, WhatIsWrongWithItIsTold) {
  const auto mistakes = [](const std::string& motion, const std::vector<std::string>& settings = {}) {
    return scene_mistakes(unit_square + tank_wall + "[[motion]]\nname = \"sway\"\n" + motion, settings);
  };
  const std::string times = "type = \"table\"\ntimes = [0, 1, 2]\n";
  expect_mistake(
      mistakes(times + "positions = [[0, 0], [0, 1]]\n"),
      "case.toml:20: motion[1].positions = [[0.0, 0.0], [0.0, 1.0]]: 2 positions, but 3 times; allowed: one");
  expect_mistake(mistakes(times + "angles = [0, 0, 1, 2]\n"), "4 angles, but 3 times; allowed: one for each time");
  expect_mistake(
      mistakes("type = \"table\"\ntimes = [0, 2, 1]\nangles = [0, 0, 0]\n"),
      "case.toml:19: motion[1].times = [0.0, 2.0, 1.0]: the times do not rise: 1.0 after 2.0; allowed: > 2.0");
  expect_mistake(mistakes("type = \"table\"\n"),
                 "motion[1].type = \"table\": the table has 0 time(s); allowed: a file");
  expect_mistake(mistakes("type = \"table\"\nfile = \"sway.txt\"\n"), "has another ending; allowed: a .csv file");
  expect_mistake(mistakes("type = \"table\"\nfile = \"~/sway.csv\"\n"), "a case is no shell");
  expect_mistake(mistakes(times + "file = \"sway.csv\"\nangles = [0, 0, 1]\n"),
                 "is given by times, positions or angles, too");
  expect_mistake(mistakes("type = \"harmonic\"\n"), "motion[1].frequency: required key is missing");
  expect_mistake(mistakes("type = \"harmonic\"\nfrequency = 1\nspin = 1\n"), "a key of type \"constant\", but ");
  expect_mistake(mistakes("type = \"constant\"\nstart = 2\nend = 2\n"), "ends before it starts; allowed: > 2.0 (s)");
  expect_mistake(mistakes("type = \"constant\"\nvelocity = [3, 4]\n", {"time.max_speed=4.5"}),
                 "case.toml:15: wall[1].motion = \"sway\": moves the wall at 5 m/s at t = 0 s; allowed: up to "
                 "time.max_speed, 4.5 (m/s)");
  expect_mistake(mistakes("type = \"table\"\ntimes = [0, 1]\npositions = [[0, 0], [4, 0]]\n", {"time.max_speed=5"}),
                 "moves the wall at 6 m/s at t = 0.5 s; allowed: up to time.max_speed, 5.0 (m/s)");
  expect_mistake(mistakes("type = \"constant\"\n[[motion]]\nname = \"sway\"\ntype = \"constant\"\n"),
                 "motion[2].name = \"sway\": the name is used twice, first at case.toml:17");
  expect_mistake(scene_mistakes(unit_square + "[[motion]]\nname = \"none\"\ntype = \"constant\"\n"),
                 "the word of walls that do not move; allowed: any other name");
  expect_mistake(
      scene_mistakes(unit_square + tank_wall + "[[motion]]\ntype = \"constant\"\n"),
      "case.toml:15: wall[1].motion = \"sway\": no [[motion]] has this name; allowed: \"none\", \"motion_1\"");
}

TEST(SceneMotion, AWallThatMovesThroughAnotherIsAMistake) {
  const std::string floor = "[[wall]]\nname = \"floor\"\nshape = \"polyline\"\npoints = [[-1, 0], [2, 0]]\n";
  const std::string post = "[[wall]]\nname = \"post\"\nshape = \"circle\"\ncenter = [1.5, 0.5]\nradius = 0.1\n";
  const auto piston = [](const std::string& shape) {
    return "[[wall]]\nname = \"piston\"\nmotion = \"push\"\n" + shape;
  };
  const std::string plate = piston("shape = \"polyline\"\npoints = [[0, 0], [0, 1]]\n");
  const std::string block = piston("shape = \"box\"\nlow = [-0.2, 0]\nhigh = [0, 1]\n");
  const auto push = [](const std::string& what) { return "[[motion]]\nname = \"push\"\n" + what; };
  const std::string slow = push("type = \"harmonic\"\namplitude = [0.3, 0]\nfrequency = 1\n");
  const std::string far = push("type = \"constant\"\nvelocity = [1.7, 0]\n");
  const std::string down = push("type = \"constant\"\nvelocity = [0, -0.1]\n");
  const auto of = [](const std::string& walls) { return scene_mistakes(unit_square + walls); };
  // Sliding along a floor, touching it or a little above; moving away.
  for (const std::string& body : {plate, block}) {
    EXPECT_EQ(of(floor + body + slow), std::vector<std::string>{});
    EXPECT_EQ(of(body + floor + post + slow), std::vector<std::string>{});
    EXPECT_EQ(of(floor + body + "translate = [0, 0.02]\n" + slow), std::vector<std::string>{});
    EXPECT_EQ(of(body + floor + push("type = \"constant\"\nvelocity = [0, 1]\n")), std::vector<std::string>{});
    expect_mistake(of(floor + post + body + far),
                   "motion = \"push\": the wall \"piston\" moves through the wall \"post\", at t = ");
    expect_mistake(of(body + post + far), "the wall \"piston\" moves through the wall \"post\", at t = 0.8");
  }
  expect_mistake(of(block + floor + down), "the wall \"piston\" moves through the wall \"floor\", at t = 0.1");
  // A plate that falls flat onto another at once.
  const auto flat = piston("shape = \"polyline\"\npoints = [[0, 0.5], [1, 0.5]]\n");
  expect_mistake(of(floor + flat + push("type = \"table\"\ntimes = [0, 0.01]\npositions = [[0, 0], [0, -2]]\n")),
                 "the wall \"piston\" moves through the wall \"floor\"");
  // Past the end of a line.
  EXPECT_EQ(of(floor + plate + "translate = [2.5, 0]\n" + down), std::vector<std::string>{});
  // A tank and what is in it turn together; alone they do not.
  const std::string bar = "[[wall]]\nname = \"bar\"\nshape = \"polyline\"\npoints = [[0.1, 0.5], [0.9, 0.5]]\n";
  const std::string turn = "[[motion]]\nname = \"sway\"\ntype = \"constant\"\nspin = 6\ncenter = [0.5, 1]\n";
  EXPECT_EQ(of(tank_wall + bar + "motion = \"sway\"\n" + turn), std::vector<std::string>{});
  expect_mistake(of(tank_wall + bar + turn), "the wall \"tank\" moves through the wall \"bar\"");
}

}  // namespace
}  // namespace impinge
