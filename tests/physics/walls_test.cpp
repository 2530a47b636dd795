// Water at rest between walls that are not in line with the axes, that move, or that have no thickness.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "impinge/cases/make_simulation.hpp"
#include "mpi/gather.hpp"

namespace impinge {
namespace {

const MPI_Comm comm = MPI_COMM_WORLD;
constexpr double dp = 0.01;
constexpr double rho = 1000.0;
constexpr double gravity = 9.81;

Case scene(const std::string& text, double end, const std::vector<std::string>& settings = {}) {
  const std::string head =
      fmt::format("geometry = \"scene\"\nparticles.spacing = {}\ntime = {{end = {}, dt = 1e-3}}\n", dp, end);
  return parse_case({{"scene.toml", head + text}}, settings);
}

/// Force of the fluid on a wall [N/m].
Vector<2> force_on(const Simulation<2>& simulation, const Scene<2>& walls, int wall) {
  Vector<2> force;
  const Particles<2>& particles = simulation.particles();
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.type[i] != ParticleType::wall) continue;
    const WallPoint<2>& point = walls.wall_points[static_cast<std::size_t>(particles.id[i])];
    if (point.wall == wall) force -= particles.pressure[i] * point.area * point.normal;
  }
  for (int k = 0; k < 2; ++k) force[k] = sum_over_ranks(comm, force[k]);
  return force;
}

/// Positions of the fluid of all ranks, by id. Collective.
std::map<std::int64_t, Vector<2>> fluid_places(const Simulation<2>& simulation) {
  const Particles<2>& particles = simulation.particles();
  return gather_by_id(comm, particles, particles.position, ParticleType::fluid);
}

TEST(Walls, CarryTheWeightOfTheWaterInAVBottom) {
  // 0.3 m wide, sides at 45 degrees, and 0.1 m of water above them.
  const Case config = scene(R"(fluid.gravity = [0, -9.81]
[[wall]]
shape = "polygon"
points = [[0, 0], [0.15, 0.15], [0.15, 0.5], [-0.15, 0.5], [-0.15, 0.15]]
wet = "inside"
[[fluid.region]]
shape = "polygon"
points = [[0, 0], [0.15, 0.15], [0.15, 0.25], [-0.15, 0.25], [-0.15, 0.15]]
)",
                            1.0);
  const Scene<2> walls = make_scene<2>(config, config);
  auto simulation = make_simulation<2>(comm, config);
  const double weight = rho * gravity * static_cast<double>(simulation.report().fluid) * dp * dp;
  EXPECT_NEAR(weight, rho * gravity * 0.0525, 0.005 * weight);
  double sum = 0.0, fastest = 0.0;
  int steps = 0;
  while (simulation.report().time < config.time.end - 1e-9) {
    simulation.step();
    fastest = std::max(fastest, simulation.report().max_speed);
    if (simulation.report().time < 0.5) continue;
    sum += force_on(simulation, walls, 0)[1];
    ++steps;
  }
  EXPECT_NEAR(-sum / steps / weight, 1.0, 0.003);
  EXPECT_LT(fastest, 0.02);  // 0.01 sqrt(g h)
}

// Half a ring's outline about the origin.
std::string half_ring(double radius, double hole, double begin) {
  constexpr int parts = 90;
  std::string points;
  const auto add = [&](double r, int k) {
    const double angle = begin + std::numbers::pi * k / parts;
    points += fmt::format("[{:.5f}, {:.5f}], ", r * std::cos(angle), r * std::sin(angle));
  };
  for (int k = 0; k <= parts; ++k) add(radius, k);
  for (int k = parts; k >= 0; --k) add(hole, k);
  return fmt::format("[[fluid.region]]\nshape = \"polygon\"\npoints = [{}]\nabout = [0, 0]\nspin = 1\n", points);
}

// A ring of fluid in solid rotation presses with rho (r^2 - b^2)/2, b the radius of its hole, however the drum turns.
TEST(Walls, TurnTheFluidThatFollowsThem) {
  constexpr double radius = 0.2, hole = 0.1;
  for (const double spin : {0.0, 0.5, 1.0}) {
    const Case config =
        scene(half_ring(0.9999 * radius, hole, 0.0) + half_ring(0.9999 * radius, hole, std::numbers::pi) +
                  fmt::format(R"([[wall]]
shape = "circle"
center = [0, 0]
radius = {}
wet = "inside"
motion = "turn"
[[motion]]
name = "turn"
type = "constant"
spin = {}
)",
                              radius, spin),
              3.0, {"time.dt=0.01"});
    auto simulation = make_simulation<2>(comm, config);
    const Particles<2>& particles = simulation.particles();
    const double kinetic = simulation.report().kinetic_energy;
    double sum = 0.0;
    std::int64_t count = 0;
    while (simulation.report().time < config.time.end - 1e-9) {
      simulation.step();
      if (simulation.report().time < 1.5) continue;
      for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
        if (particles.type[i] != ParticleType::wall) continue;
        sum += particles.pressure[i];
        ++count;
      }
    }
    const double mean = sum_over_ranks(comm, sum) / static_cast<double>(sum_over_ranks(comm, count));
    EXPECT_NEAR(mean / (0.5 * rho * (radius * radius - hole * hole)), 1.0, 0.01) << "spin " << spin;
    EXPECT_NEAR(simulation.report().kinetic_energy / kinetic, 1.0, 0.01) << "spin " << spin;
  }
}

TEST(Walls, LetGoOfTheWaterBelowThemWhereTheyDoNotPull) {
  const Case config = scene(R"(fluid.gravity = [0, -9.81]
pressure.clamp_negative = true
[[wall]]
shape = "box"
low = [0, 0]
high = [0.3, 0.4]
wet = "inside"
[[fluid.region]]
shape = "box"
low = [0.08, 0.3]
high = [0.22, 0.4]
)",
                            0.15);
  auto simulation = make_simulation<2>(comm, config);
  const auto height = [&] {
    double sum = 0.0;
    const auto places = fluid_places(simulation);
    for (const auto& [id, place] : places) sum += place[1];
    return sum / static_cast<double>(places.size());
  };
  const double before = height();
  while (simulation.report().time < config.time.end - 1e-9) simulation.step();
  EXPECT_NEAR((before - height()) / (0.5 * gravity * std::pow(simulation.report().time, 2)), 1.0, 0.01);
}

constexpr const char* moving_tank = R"([[wall]]
shape = "box"
low = [0, 0]
high = [0.3, 0.4]
wet = "inside"
motion = "way"
[[fluid.region]]
shape = "box"
low = [0, 0]
high = [0.3, 0.2]
)";

// The lattice that is cut at them leaves gaps of a spacing there.
TEST(Walls, AroundAllFluidLeaveItNoFreeSurface) {
  for (const double radius : {0.2, 0.36}) {
    for (const auto& settings : {std::vector<std::string>{}, {"scheme=paper", "walls.model=mirror"}}) {
      const Case config = scene(fmt::format(R"([[wall]]
shape = "circle"
center = [0.0, 0.0]
radius = {0}
wet = "inside"
[[fluid.region]]
shape = "circle"
center = [0.0, 0.0]
radius = {0}
)",
                                            radius),
                                0.01, settings);
      auto simulation = make_simulation<2>(comm, config);
      const Particles<2>& particles = simulation.particles();
      std::int64_t count = 0;
      for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
        count += particles.type[i] == ParticleType::fluid && particles.free_surface[i];
      EXPECT_EQ(sum_over_ranks(comm, count), 0) << "radius " << radius;
    }
  }
}

TEST(Walls, ThatMoveSteadilyTakeTheWaterAlongAtRest) {
  const Case config = scene(std::string(moving_tank) + R"(velocity = [0.7, -0.4]
[[motion]]
name = "way"
type = "constant"
velocity = [0.7, -0.4]
)",
                            0.05);
  auto simulation = make_simulation<2>(comm, config);
  while (simulation.report().time < config.time.end - 1e-9) simulation.step();
  const Particles<2>& particles = simulation.particles();
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.type[i] != ParticleType::fluid) continue;
    EXPECT_LT(norm(particles.velocity[i] - Vector<2>{{0.7, -0.4}}), 1e-11);
  }
}

TEST(Walls, ThatMoveSteadilyChangeNothingUnderGravity) {
  const auto after_50_steps = [](const std::string& velocity) {
    const Case config = scene(std::string(moving_tank) + fmt::format(R"(velocity = {0}
[[motion]]
name = "way"
type = "constant"
velocity = {0}
)",
                                                                     velocity),
                              1.0, {"fluid.gravity=[0, -9.81]", "pressure.tolerance=1e-12", "time.dt=0.01"});
    auto simulation = make_simulation<2>(comm, config);
    for (int step = 0; step < 50; ++step) simulation.step();
    return std::pair(simulation.report().time, fluid_places(simulation));
  };
  const auto [time, at_rest] = after_50_steps("[0, 0]");
  const auto [same_time, moved] = after_50_steps("[0.7, -0.4]");  // twice the speed that would limit dt
  EXPECT_NEAR(same_time, time, 1e-12);
  const Vector<2> way = time * Vector<2>{{0.7, -0.4}};
  ASSERT_EQ(moved.size(), at_rest.size());
  for (const auto& [id, place] : moved) EXPECT_LT(norm(place - way - at_rest.at(id)), 1e-8 * dp);
}

// At 0.02 s a piston starts at once with 3 m/s: within a step of 1 ms it would pass a third of a spacing.
TEST(Walls, ThatStartAtOnceShortenTheStepBefore) {
  const Case config = scene(R"(fluid.gravity = [0, -9.81]
[[wall]]
shape = "box"
low = [0, 0]
high = [0.3, 0.4]
wet = "inside"
[[wall]]
shape = "polyline"
points = [[0.01, 0], [0.01, 0.4]]
wet = "right"
motion = "push"
[[fluid.region]]
shape = "box"
low = [0.01, 0]
high = [0.3, 0.1]
[[motion]]
name = "push"
type = "constant"
velocity = [3, 0]
start = 0.02
end = 0.03
)",
                            0.03);
  auto simulation = make_simulation<2>(comm, config);
  while (simulation.report().time < config.time.end - 1e-9) {
    simulation.step(config.time.end);
    const StepReport& report = simulation.report();
    EXPECT_LE(report.time > 0.02 ? report.dt : 0.0, config.time.cfl * dp / 3.0 * (1.0 + 1e-6));
  }
}

TEST(Walls, ThatRiseOrFallChangeTheWeightOfTheWater) {
  for (const double up : {3.0, -gravity}) {
    std::string times, places;
    for (int k = 0; k <= 30; ++k) {
      const double t = 0.01 * k;
      times += fmt::format("{}{}", k > 0 ? ", " : "", t);
      places += fmt::format("{}[0, {:.12g}]", k > 0 ? ", " : "", 0.5 * up * t * t);
    }
    const Case config =
        scene("fluid.gravity = [0, -9.81]\n" + std::string(moving_tank) +
                  fmt::format("[[motion]]\nname = \"way\"\ntype = \"table\"\ntimes = [{}]\npositions = [{}]\n", times,
                              places),
              0.2, {"time.max_speed=20"});
    auto simulation = make_simulation<2>(comm, config);
    while (simulation.report().time < config.time.end - 1e-9) simulation.step();
    const double lift = 0.5 * up * 0.2 * 0.2;
    const double largest = rho * gravity * 0.2;
    const Particles<2>& particles = simulation.particles();
    for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
      if (particles.type[i] != ParticleType::fluid) continue;
      const double depth = 0.2 - (particles.position[i][1] - lift);
      EXPECT_NEAR(particles.pressure[i], rho * (gravity + up) * depth, 0.002 * largest);
    }
  }
}

TEST(Walls, WithoutThicknessHoldBackAHigherLevel) {
  const Case config = scene(R"(fluid.gravity = [0, -9.81]
[[wall]]
shape = "box"
low = [-0.2, 0]
high = [0.2, 0.5]
wet = "inside"
[[wall]]
shape = "polyline"
points = [[0, 0], [0, 0.45]]
[[fluid.region]]
shape = "box"
low = [-0.2, 0]
high = [0, 0.2]
[[fluid.region]]
shape = "box"
low = [0, 0]
high = [0.2, 0.1]
)",
                            0.5);
  const Scene<2> walls = make_scene<2>(config, config);
  auto simulation = make_simulation<2>(comm, config);
  const auto start = fluid_places(simulation);
  while (simulation.report().time < config.time.end - 1e-9) simulation.step();
  for (const auto& [id, place] : fluid_places(simulation)) EXPECT_EQ(place[0] < 0.0, start.at(id)[0] < 0.0);
  EXPECT_NEAR(force_on(simulation, walls, 1)[0], rho * gravity * (0.2 * 0.2 - 0.1 * 0.1) / 2.0, 2.0);
}

}  // namespace
}  // namespace impinge
