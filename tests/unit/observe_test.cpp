// Probes, gauges, sections and forces on particles that are set by hand, and the keys that ask for them.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "case_mistakes.hpp"
#include "impinge/core/errors.hpp"
#include "impinge/observe/fluid_value.hpp"
#include "impinge/observe/observer_report.hpp"
#include "impinge/observe/observers.hpp"

namespace impinge {
namespace {

using Texts = std::vector<std::string>;

constexpr double dp = 0.1;

template <int Dim>
FluidValue<Dim> linear_value(const Vector<Dim>& r) {
  FluidValue<Dim> value{.pressure = 5.0, .velocity = {}};
  for (int k = 0; k < Dim; ++k) {
    value.pressure += (3.0 + k) * r[k];
    value.velocity[k] = 1.0 - 2.0 * r[k] + 0.5 * r[(k + 1) % Dim];
  }
  return value;
}

/// A block of fluid from the origin on with linear values, slightly disordered.
template <int Dim>
Particles<Dim> block(const std::array<int, Dim>& extent) {
  Particles<Dim> particles;
  std::int64_t count = 1;
  for (const int n : extent) count *= n;
  for (std::int64_t k = 0; k < count; ++k) {
    Vector<Dim> position;
    std::int64_t rest = k;
    for (int axis = 0; axis < Dim; ++axis) {
      const int n = extent[static_cast<std::size_t>(axis)];
      position[axis] = (static_cast<double>(rest % n) + 0.5 + 0.1 * std::sin(3.0 * static_cast<double>(k + axis))) * dp;
      rest /= n;
    }
    const FluidValue<Dim> value = linear_value(position);
    particles.append({position, value.velocity, value.pressure, 0.0, 1000 + k, ParticleType::fluid});
  }
  return particles;
}

template <int Dim>
Scene<Dim> open_scene() {
  Scene<Dim> scene;
  for (int k = 0; k < Dim; ++k) scene.bounds.high[k] = 2.0;
  return scene;
}

template <int Dim>
std::vector<double> probed(const ProbeSettings& probe, const Particles<Dim>& particles,
                           const Scene<Dim>& scene = open_scene<Dim>(), double time = 0.0) {
  return Probes<Dim>({probe}, scene, dp).measure(MPI_COMM_SELF, particles, time);
}

template <int Dim>
void expect_linear(const std::vector<double>& values, const Vector<Dim>& at, double tolerance = 1e-12) {
  const FluidValue<Dim> expected = linear_value(at);
  ASSERT_EQ(values.size(), static_cast<std::size_t>(Dim + 1));
  EXPECT_NEAR(values[0], expected.pressure, tolerance);
  for (int k = 0; k < Dim; ++k) EXPECT_NEAR(values[static_cast<std::size_t>(k) + 1], expected.velocity[k], tolerance);
}

TEST(Probe, IsExactForALinearFieldInTheFluidAtWallsAndInCorners) {
  const auto flat = block<2>({10, 8});
  for (const Vector<2>& at : {Vector<2>{{0.43, 0.37}}, {{0.5, 0.0}}, {{0.0, 0.0}}, {{0.42, 0.8}}})
    expect_linear(probed<2>({.position = {at[0], at[1]}}, flat), at);
  const auto solid = block<3>({8, 8, 8});
  for (const Vector<3>& at : {Vector<3>{{0.43, 0.37, 0.4}}, {{0.4, 0.4, 0.0}}, {{0.0, 0.0, 0.0}}})
    expect_linear(probed<3>({.position = {at[0], at[1], at[2]}}, solid), at);
}

TEST(Probe, GivesTheMeanWhereTheParticlesAreInARowAndNothingInTheAir) {
  const auto row = probed<2>({.position = {0.5, 0.05}}, block<2>({10, 1}));
  EXPECT_NEAR(row[0], linear_value<2>({{0.5, 0.05}}).pressure, 0.05);
  // Above the surface nothing is extrapolated.
  const auto particles = block<2>({10, 8});
  const auto above = probed<2>({.position = {0.5, 0.95}}, particles);
  EXPECT_LT(above[0], linear_value<2>({{0.5, 0.8}}).pressure);
  for (const double value : probed<2>({.position = {0.5, 1.1}}, particles)) EXPECT_TRUE(std::isnan(value));
}

TEST(Probe, OfAFaceIsTheMeanOverIt) {
  const auto flat = block<2>({10, 8});
  // A face on the side wall, its upper half dry.
  expect_linear(probed<2>({.position = {0, 0.4}, .diameter = 0.4, .normal = {1, 0}}, flat), Vector<2>{{0.0, 0.4}});
  const auto half = probed<2>({.position = {0, 1.1}, .diameter = 1.6, .normal = {-2, 0}}, flat);
  EXPECT_LT(half[0], 0.75 * linear_value<2>({{0.0, 0.6}}).pressure);
  EXPECT_GT(half[0], 0.25 * linear_value<2>({{0.0, 0.6}}).pressure);
  expect_linear(probed<3>({.position = {0.4, 0.4, 0.1}, .diameter = 0.35, .normal = {1, 2, 2}}, block<3>({8, 8, 8})),
                Vector<3>{{0.4, 0.4, 0.1}});
}

TEST(Probe, SeesFluidBeyondBoundsThatRepeat) {
  Scene<2> scene = open_scene<2>();
  scene.bounds.high = {{1.0, 0.8}};
  scene.periodic = {true, false};
  Particles<2> particles = block<2>({10, 8});
  for (auto& velocity : particles.velocity) velocity = {{1.0, 2.0}};
  for (std::size_t i = 0; i < particles.position.size(); ++i) particles.pressure[i] = particles.position[i][1];
  const auto values = probed<2>({.position = {0.999, 0.4}}, particles, scene);
  EXPECT_NEAR(values[0], 0.4, 1e-12);
  // With one side alone the corner's particles would all lie to the left.
  Particles<2> left = particles;
  for (std::size_t i = 0; i < left.position.size(); ++i)
    if (left.position[i][0] > 0.5) left.type[i] = ParticleType::wall;
  EXPECT_NEAR(probed<2>({.position = {0.999, 0.4}}, left, scene)[0], 0.4, 1e-12);
}

/// A box as a wall, wet outside or inside, with its wall particles in their pose at a time.
Scene<2> scene_with_box(bool outside, const Motion<2>& motion = {}) {
  std::vector<std::string> mistakes;
  Scene<2> scene = open_scene<2>();
  scene.walls = {{.name = "box",
                  .surface = std::make_shared<const Outline>(*make_box({{0.5, 0.5}}, {{1.0, 0.9}}, mistakes)),
                  .wet_front = outside,
                  .wet_back = !outside,
                  .slip = true,
                  .motion = motion ? std::make_shared<const Motion<2>>(motion) : nullptr}};
  scene.wall_points = wall_points(scene.walls, dp);
  return scene;
}

/// The wall particles of a scene, with a pressure of where they are.
template <class Pressure>
Particles<2> wall_particles(const Scene<2>& scene, double time, Pressure pressure) {
  Particles<2> particles;
  const auto poses = poses_of(scene.walls, time);
  for (std::size_t k = 0; k < scene.wall_points.size(); ++k) {
    const WallPoint<2>& point = scene.wall_points[k];
    const Vector<2> at = poses[static_cast<std::size_t>(point.wall)].of_position(point.position);
    particles.append({at, {}, pressure(at), 0.0, static_cast<std::int64_t>(k), ParticleType::wall});
  }
  return particles;
}

/// A turn by 90 degrees and a shift.
Pose<2> turned(double) {
  return {
      .rotation = rotation(90.0), .shift = {{3.0, 1.0}}, .velocity = {}, .spin = {}, .acceleration = {}, .bend = {}};
}

TEST(Probe, RidesOnAWall) {
  for (const bool moves : {false, true}) {
    const Scene<2> scene = scene_with_box(true, moves ? Motion<2>(turned) : Motion<2>{});
    const auto pressure = [](const Vector<2>& at) { return 100.0 * at[0] + 10.0 * at[1]; };
    const Particles<2> particles = wall_particles(scene, 0.0, pressure);
    const auto pose = poses_of(scene.walls, 0.0)[0];
    // Between two wall particles, on one, and the mean over a face.
    for (const Vector<2>& at : {Vector<2>{{0.7, 0.9}}, {{0.73, 0.9}}, {{1.0, 0.65}}})
      EXPECT_NEAR(probed<2>({.wall = "box", .position = {at[0], at[1]}}, particles, scene)[0],
                  pressure(pose.of_position(at)), 1e-4);
    EXPECT_NEAR(probed<2>({.wall = "box", .position = {0.7, 0.9}, .diameter = 0.3}, particles, scene)[0],
                pressure(pose.of_position({{0.7, 0.9}})), 10.0);
    // The velocity is that of the fluid; there is none.
    EXPECT_TRUE(std::isnan(probed<2>({.wall = "box", .position = {0.7, 0.9}}, particles, scene)[1]));
  }
}

TEST(Probe, DoesNotSeeThroughAPlate) {
  std::vector<std::string> mistakes;
  Scene<2> scene = open_scene<2>();
  scene.walls = {{.name = "plate",
                  .surface = std::make_shared<const Outline>(*make_polyline({{{0.5, -1.0}}, {{0.5, 3.0}}}, mistakes)),
                  .wet_front = true,
                  .wet_back = true,
                  .slip = true,
                  .motion = {}}};
  scene.wall_points = wall_points(scene.walls, dp);
  Particles<2> particles = block<2>({10, 8});
  for (std::size_t i = 0; i < particles.position.size(); ++i)
    particles.pressure[i] = particles.position[i][0] < 0.5 ? 1.0 : 7.0;
  EXPECT_NEAR(probed<2>({.position = {0.45, 0.4}}, particles, scene)[0], 1.0, 1e-12);
  EXPECT_NEAR(probed<2>({.position = {0.55, 0.4}}, particles, scene)[0], 7.0, 1e-12);
}

TEST(Force, OnAWallIsThePressuresWithItsTorque) {
  // Hydrostatic pressure: the weight of the water that a body displaces, through its middle.
  const auto pressure = [](const Vector<2>& at) { return 1000.0 * (5.0 - at[1]); };
  for (const bool moves : {false, true}) {
    const Scene<2> scene = scene_with_box(true, moves ? Motion<2>(turned) : Motion<2>{});
    const auto values = WallForces<2>(scene).measure(MPI_COMM_SELF, wall_particles(scene, 0.0, pressure), 0.0);
    const Vector<2> arm = moves ? rotation(90.0) * Vector<2>{{0.75, 0.7}} : Vector<2>{{0.75, 0.7}};
    ASSERT_EQ(values.size(), 3u);
    EXPECT_NEAR(values[0], 0.0, 1e-3);
    EXPECT_NEAR(values[1], 1000.0 * 0.5 * 0.4, 1e-3);
    EXPECT_NEAR(values[2], arm[0] * values[1], 1e-2);
  }
  // From inside, the weight of what it holds.
  const Scene<2> tank = scene_with_box(false);
  EXPECT_NEAR(WallForces<2>(tank).measure(MPI_COMM_SELF, wall_particles(tank, 0.0, pressure), 0.0)[1],
              -1000.0 * 0.5 * 0.4, 1e-3);
  EXPECT_EQ(WallForces<2>(tank).columns(), (Texts{"fx_box [N/m]", "fy_box [N/m]", "torque_box [N]"}));
}

MethodSettings method() {
  MethodSettings settings;
  settings.particles.spacing = dp;
  settings.kernel.radius = 2.6;
  return settings;
}

std::vector<double> levels(const GaugeSettings& gauge, const Particles<2>& particles,
                           std::span<const double> depth = {}) {
  return Gauges<2>({gauge}, open_scene<2>(), method()).measure(MPI_COMM_SELF, particles, depth);
}

TEST(Gauge, IsTheFarthestFluidAlongTheLine) {
  Particles<2> particles;
  for (int k = 0; k < 6; ++k) particles.append({{{0.45, (k + 0.5) * dp}}, {}, 0.0, 0.0, k, ParticleType::fluid});
  std::ranges::fill(particles.number_density, 100.0);
  const GaugeSettings up{.name = "", .point = {0.5, 0}, .direction = {0, 3}, .length = 1.0};
  EXPECT_NEAR(levels(up, particles)[0], 0.6, 1e-12);
  EXPECT_NEAR(levels({.name = "", .point = {0.5, 0.25}, .direction = {0, 1}, .length = 1.0}, particles)[0], 0.35,
              1e-12);
  EXPECT_NEAR(levels({.name = "", .point = {0.5, 0}, .direction = {0, 1}, .length = 0.4}, particles)[0], 0.4, 1e-12);
  EXPECT_EQ(levels({.name = "", .point = {0.53, 0}, .direction = {0, 1}, .length = 1.0}, particles)[0], 0.0);
  EXPECT_EQ(levels({.name = "", .point = {0.5, 0.7}, .direction = {0, 1}, .length = 1.0}, particles)[0], 0.0);
  EXPECT_NEAR(levels(up, particles, std::vector<double>(6, 0.6))[0], 0.61, 1e-12);
  particles.number_density.back() = 0.0;  // spray
  EXPECT_NEAR(levels(up, particles)[0], 0.5, 1e-12);
}

TEST(Section, CountsWhatCrossesAndWhatComesBack) {
  Particles<2> particles;
  for (int k = 0; k < 4; ++k) particles.append({{{0.96, (k + 0.5) * dp}}, {}, 0.0, 0.0, k, ParticleType::fluid});
  // Its upper end is below the last particle; up is to the left of the way to the right.
  Sections<2> sections(MPI_COMM_SELF,
                       {{.name = "gate", .begin = {1, 0}, .end = {1, 0.3}},
                        {.name = "back", .begin = {1, 0.3}, .end = {1, 0}},
                        {.name = "level", .begin = {0, 0.2}, .end = {2, 0.2}}},
                       open_scene<2>(), dp, particles, 0.0);
  EXPECT_EQ(sections.columns()[0], "gate [m^2/s]");
  EXPECT_EQ(sections.columns()[1], "total_gate [m^2]");
  const auto move = [&](const Vector<2>& way) {
    for (Vector<2>& position : particles.position) position += way;
    sections.count(particles);
  };
  move({{0.03, 0.0}});
  EXPECT_EQ(sections.measure(0.5), (std::vector<double>{0, 0, 0, 0, 0, 0}));
  move({{0.03, 0.0}});
  move({{0.03, 0.0}});
  auto values = sections.measure(1.0);
  EXPECT_NEAR(values[0], 0.03 / 0.5, 1e-12);
  EXPECT_NEAR(values[1], 0.03, 1e-12);
  EXPECT_NEAR(values[3], -0.03, 1e-12);
  move({{-0.07, 0.0}});
  values = sections.measure(2.0);
  EXPECT_NEAR(values[0], -0.03, 1e-12);
  EXPECT_NEAR(values[1], 0.0, 1e-12);
  move({{0.0, 0.06}});  // one rises through the level
  values = sections.measure(3.0);
  EXPECT_NEAR(values[5], -0.01, 1e-12);
  sections.go_on(3.0, {0, 0.05, 0, 0, 0, 0});
  EXPECT_NEAR(sections.measure(4.0)[1], 0.05, 1e-12);
}

TEST(Section, CountsWhatLeavesBoundsThatRepeat) {
  Scene<2> scene = open_scene<2>();
  scene.periodic = {true, true};
  Particles<2> particles;
  particles.append({{{1.98, 0.1}}, {}, 0.0, 0.0, 0, ParticleType::fluid});
  Sections<2> sections(MPI_COMM_SELF, {{.name = "", .begin = {0, 0}, .end = {0, 2}}}, scene, dp, particles, 0.0);
  particles.position[0] = {{0.02, 0.1}};
  sections.count(particles);
  EXPECT_NEAR(sections.measure(1.0)[1], 0.01, 1e-12);
}

TEST(Section, InSpaceIsAParallelogram) {
  Particles<3> particles;  // on a lattice in the plane of z
  for (int a = -20; a < 20; ++a)
    for (int b = -20; b < 20; ++b)
      particles.append({{{(a + 0.5) * dp, (b + 0.5) * dp, -0.03}}, {}, 0.0, 0.0, particles.owned, ParticleType::fluid});
  // From (0, 0, 0) to (1, 0, 0) and then along (0.5, 1, 0), a right hand's thumb is up.
  const Numbers begin{-0.75, -0.5, 0.0}, end{0.25, -0.5, 0.0}, side{0.5, 1.0, 0.0};
  Sections<3> sections(MPI_COMM_SELF,
                       {{.name = "up", .begin = begin, .end = end, .side = side},
                        {.name = "down", .begin = end, .end = begin, .side = side}},
                       open_scene<3>(), dp, particles, 0.0);
  EXPECT_EQ(sections.columns()[0], "up [m^3/s]");
  EXPECT_EQ(sections.columns()[1], "total_up [m^3]");
  int inside = 0;
  for (const Vector<3>& x : particles.position) {
    const double along_side = x[1] + 0.5, along_way = x[0] + 0.75 - 0.5 * along_side;
    inside += along_side >= 0.0 && along_side < 1.0 && along_way >= 0.0 && along_way < 1.0;
  }
  EXPECT_NEAR(inside, 1.0 / (dp * dp), 10.0);
  for (Vector<3>& position : particles.position) position[2] += 0.05;
  sections.count(particles);
  const auto values = sections.measure(2.0);
  const double volume = inside * dp * dp * dp;
  EXPECT_NEAR(values[0], volume / 2.0, 1e-12);
  EXPECT_NEAR(values[1], volume, 1e-12);
  EXPECT_NEAR(values[3], -volume, 1e-12);
  sections.go_on(2.0, values);
  EXPECT_NEAR(sections.measure(3.0)[1], volume, 1e-12);
}

/// The steps of 20 whose rows are written, each of 0.01 s; a restart after the 7th changes nothing.
std::vector<std::int64_t> sampled(double interval, int steps) {
  ObserverSettings settings;
  settings.gauges = {{.name = "g", .point = {}, .direction = {0, 1}, .length = 1.0}};
  settings.sampling = {.interval = interval, .steps = steps};
  StepReport report;
  const Particles<2> particles;
  const auto start = [&] {
    return Observers<2>(MPI_COMM_SELF, settings, method(), open_scene<2>(), particles, report);
  };
  Observers<2> observers = start();
  std::vector<std::int64_t> found;
  for (report.step = 1; report.step <= 20; ++report.step) {
    report.time += 0.01;
    for (const TableLine& row : observers.observe({particles, {}, {}, report})) found.push_back(std::stoll(row.text));
    if (report.step == 7) observers = start();
  }
  return found;
}

TEST(Observers, WriteRowsByStepsAndByTime) {
  EXPECT_EQ(sampled(0.0, 0), (std::vector<std::int64_t>{}));
  EXPECT_EQ(sampled(0.0, 1).size(), 20u);
  EXPECT_EQ(sampled(0.0, 7), (std::vector<std::int64_t>{7, 14}));
  EXPECT_EQ(sampled(0.05, 0), (std::vector<std::int64_t>{5, 10, 15, 20}));
  EXPECT_EQ(sampled(0.035, 0), (std::vector<std::int64_t>{4, 7, 11, 14, 18}));
  EXPECT_EQ(sampled(0.05, 8), (std::vector<std::int64_t>{5, 8, 10, 15, 16, 20}));
}

TEST(Observers, SectionsGoOnFromTheirLastRow) {
  ObserverSettings settings;
  settings.sections = {{.name = "s", .begin = {1, 0}, .end = {1, 1}}};
  settings.sampling = {.interval = 0.0, .steps = 2};
  StepReport report;
  report.step = 5;
  report.time = 0.5;
  const Particles<2> particles;
  Observers<2> observers(MPI_COMM_SELF, settings, method(), open_scene<2>(), particles, report);
  ASSERT_EQ(observers.headers().size(), 1u);
  EXPECT_EQ(observers.headers()[0].kind, "sections");
  EXPECT_EQ(observers.headers()[0].text, "step,t [s],s [m^2/s],total_s [m^2]");
  observers.go_on("");
  for (const char* row : {"5,0.5,2", "5,0.5,2,nan", "5,0.5,2,1e300"})
    EXPECT_THROW(observers.go_on(row), FileError) << row;
  observers.go_on("5,0.5,2,0.25");
  EXPECT_TRUE(observers.rows_for_restart(report).empty());  // the file has it
  report.step = 6;
  report.time = 1.0;
  EXPECT_EQ(observers.observe({particles, {}, {}, report})[0].text, "6,1,0,0.25");
  report.step = 7;
  report.time = 2.0;
  EXPECT_TRUE(observers.observe({particles, {}, {}, report}).empty());
  EXPECT_EQ(observers.rows_for_restart(report)[0].text, "7,2,0,0.25");
}

// Keys.

const std::string tank = R"(geometry = "tank"
particles.spacing = 0.1
time = {end = 2.0, dt = 1e-3}
tank = {size = [2, 1], fluid_height = 0.5}
fluid.gravity = [0.0, -9.81]
)";

Case parse(const std::string& text) { return parse_case({{"case.toml", tank + text}}); }

Texts mistakes_in(const std::string& text) { return case_mistakes({{"case.toml", tank + text}}); }

TEST(ObserverKeys, HaveDefaultsAndReadBack) {
  const Case config = parse(R"([[probe]]
position = [1, 0]
[[gauge]]
point = [1, 0]
length = 1
[[gauge]]
name = "side"
point = [0, 0.2]
direction = [1, 0]
length = 1
[[section]]
begin = [1, 0]
end = [1, 1]
)");
  ASSERT_EQ(config.probes.size(), 1u);
  EXPECT_EQ(config.probes[0].name, "probe_1");
  EXPECT_EQ(config.probes[0].wall, "none");
  EXPECT_EQ(config.probes[0].normal, (Numbers{0, 1, 0}));
  EXPECT_EQ(config.gauges[0].name, "gauge_1");
  EXPECT_EQ(config.gauges[0].direction, (Numbers{0, 1, 0}));
  EXPECT_EQ(config.gauges[1].name, "side");
  EXPECT_EQ(config.sections[0].name, "section_1");
  EXPECT_EQ(config.sampling.steps, 1);
  EXPECT_EQ(parse("output.sample_interval = 0.1").sampling.steps, 0);
  EXPECT_EQ(parse_case({{"case.toml", config.resolved_text}}).resolved_text, config.resolved_text);
}

TEST(ObserverKeys, AreTold) {
  const Case config = parse(R"([[probe]]
position = [1, 0]
[[probe]]
name = "sensor"
position = [0, 0.1]
diameter = 0.05
normal = [1, 0]
[[gauge]]
name = "side"
point = [0, 0.2]
direction = [1, 0]
length = 1
[[section]]
begin = [1, 0]
end = [1, 1]
)");
  EXPECT_EQ(observer_lines(config, 2),
            (Texts{"probe       probe_1: at (1, 0) m",
                   "probe       sensor: at (0, 0.1) m, a face of 0.05 m that looks along (1, 0)",
                   "gauge       side: from (0, 0.2) m on 1 m along (1, 0)",
                   "section     section_1: from (1, 0) to (1, 1) m"}));
}

TEST(ObserverKeys, EachMistakeIsToldAtOnce) {
  const std::string bounds = "allowed: within the scene's bounds, from (0, 0) to (2, 2) m";
  EXPECT_EQ(mistakes_in(R"([[probe]]
name = "a"
position = [3, 0]
[[probe]]
name = "a"
position = [1, -0.2]
normal = [0, 0]
[[probe]]
name = "b,c"
wall = "hull"
position = [1, 0]
[[probe]]
position = [1, 0]
diameter = 5
[[gauge]]
point = [1, 4]
direction = [0, 0]
length = 1
[[gauge]]
name = "gauge_1"
point = [1, 0]
length = 1
[[section]]
begin = [1, 0]
end = [1, 0]
[[section]]
begin = [-1, 0]
end = [1, 3]
)"),
            (Texts{
                "case.toml:8: probe[1].position = [3.0, 0.0]: outside the scene; " + bounds,
                "case.toml:10: probe[2].name = \"a\": the name is used twice, first at case.toml:7; allowed: a name of "
                "its own",
                "case.toml:11: probe[2].position = [1.0, -0.2]: outside the scene; " + bounds,
                "case.toml:12: probe[2].normal = [0.0, 0.0]: no direction; allowed: a vector that is not 0",
                "case.toml:14: probe[3].name = \"b,c\": has a ',', but a table's header is made of it; allowed: a text "
                "without , \" [ ]",
                "case.toml:15: probe[3].wall = \"hull\": no wall of this name; allowed: \"none\"",
                "case.toml:19: probe[4].diameter = 5.0: larger than the scene; allowed: [0, 2.82843] (m)",
                "case.toml:21: gauge[1].point = [1.0, 4.0]: outside the scene; " + bounds,
                "case.toml:22: gauge[1].direction = [0.0, 0.0]: no direction; allowed: a vector that is not 0",
                "case.toml:25: gauge[2].name = \"gauge_1\": the name is used twice, first at case.toml:20; allowed: a "
                "name of its own",
                "case.toml:30: section[1].end = [1.0, 0.0]: the line has no length; allowed: another point than its "
                "begin",
                "case.toml:32: section[2].begin = [-1.0, 0.0]: outside the scene; " + bounds,
                "case.toml:33: section[2].end = [1.0, 3.0]: outside the scene; " + bounds,
            }));
  EXPECT_EQ(mistakes_in("[[gauge]]\npoint = [1, 0]\nlength = 0\n"),
            Texts{"case.toml:8: gauge[1].length = 0: out of range; allowed: > 0 (m)"});
  EXPECT_EQ(mistakes_in("[[probe]]\ndiameter = -1\n").size(), 2u);
  EXPECT_EQ(mistakes_in("output.sample_steps = -1").size(), 1u);
  EXPECT_EQ(mistakes_in("output.sample_interval = -1").size(), 1u);
}

/// A scene's observers are checked against its walls, whoever makes them.
Texts mistakes_in_scene(const std::string& probe, const Scene<2>& scene) {
  ObserverSettings settings;
  int dimension = 2;
  Keys keys(dimension);
  keys.add("dimension", dimension, "of space");
  declare_observers(keys, settings);
  read_files(keys, {{"case.toml", probe}}, {});
  derive_observers(keys, dimension, settings);
  check_observers_in(keys, scene, dp, settings);
  try {
    keys.throw_mistakes();
  } catch (const InputError& error) {
    return error.mistakes();
  }
  return {};
}

TEST(ObserverKeys, ProbesStandOutsideOfWallsOrOnThem) {
  const Scene<2> scene = scene_with_box(true);
  const auto with = [&](const std::string& text) { return mistakes_in_scene("[[probe]]\n" + text, scene); };
  EXPECT_EQ(with("position = [0.4, 0.7]"), Texts{});
  EXPECT_EQ(with("position = [0.5, 0.7]"), Texts{});
  EXPECT_EQ(with("position = [0.7, 0.7]"),
            Texts{"case.toml:2: probe[1].position = [0.7, 0.7]: inside the wall \"box\"; allowed: in the fluid or on "
                  "the wall"});
  EXPECT_EQ(with("wall = \"box\"\nposition = [0.5, 0.7]"), Texts{});
  EXPECT_EQ(with("wall = \"box\"\nposition = [0.2, 0.7]"),
            Texts{"case.toml:3: probe[1].position = [0.2, 0.7]: 0.3 m from the wall \"box\"; allowed: at most a "
                  "spacing, 0.1 m"});
  EXPECT_EQ(with("wall = \"bax\"\nposition = [0.2, 0.7]"),
            Texts{"case.toml:2: probe[1].wall = \"bax\": no wall of this name; allowed: \"none\", \"box\""});
}

TEST(ObserverKeys, SectionsInSpaceHaveASide) {
  const auto with = [](const std::string& section) {
    return parse_case({{"case.toml",
                        "geometry = \"tank\"\ndimension = 3\nparticles.spacing = 0.1\n"
                        "time = {end = 2.0, dt = 1e-3}\ntank = {size = [1, 1, 1], fluid_height = 0.5}\n"
                        "fluid.gravity = [0.0, 0.0, -9.81]\n[[section]]\nbegin = [0, 0, 0]\n" +
                            section}});
  };
  const auto mistakes = [&](const std::string& section) {
    try {
      with(section);
    } catch (const InputError& error) {
      return error.mistakes();
    }
    return Texts{};
  };
  const std::string wrong = "0, or along the line from begin to end; allowed: any other vector (m)";
  EXPECT_EQ(mistakes("end = [1, 0, 0]\n"), Texts{"case.toml:7: section[1].side = [0.0, 0.0, 0.0]: " + wrong});
  EXPECT_EQ(mistakes("end = [0.5, 0, 0]\nside = [0.5, 0, 0]\n"),
            Texts{"case.toml:10: section[1].side = [0.5, 0.0, 0.0]: " + wrong});
  const auto outside = mistakes("end = [1, 0, 0]\nside = [0, 0, -1]\n");
  ASSERT_EQ(outside.size(), 1u);
  EXPECT_TRUE(outside[0].starts_with("case.toml:10: section[1].side = [0.0, 0.0, -1.0]: ends outside the scene; "));
  const Case config = with("end = [1, 0, 0]\nside = [0, 1, 0.5]\n");
  EXPECT_EQ(observer_lines(config, 3),
            Texts{"section     section_1: from (0, 0, 0) to (1, 0, 0) m, side (0, 1, 0.5) m"});
}

}  // namespace
}  // namespace impinge
