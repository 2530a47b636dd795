// Viscous flows along walls that they stick to, straight and tilted, at rest and moving, and round.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "impinge/cases/make_simulation.hpp"

namespace impinge {
namespace {

const MPI_Comm comm = MPI_COMM_WORLD;
constexpr double nu = 1.0;  // m^2/s

/// A scene with `rows` particles across a gap [m], to a time [s].
Case scene(const std::string& text, double gap, int rows, double end) {
  const double dp = gap / rows;
  const std::string head =
      fmt::format("geometry = \"scene\"\nfluid.viscosity = {}\nparticles.spacing = {}\ntime = {{end = {}, dt = {}}}\n",
                  nu, dp, end, 0.15 * dp * dp / nu);
  return parse_case({{"scene.toml", head + text}});
}

/// Runs a scene to its end. RMS of the velocity less `exact` over the fluid where `use` says so [m/s]. Collective.
double rms_error(const Case& config, const std::function<bool(const Vector<2>&)>& use,
                 const std::function<Vector<2>(const Vector<2>&)>& exact) {
  auto simulation = make_simulation<2>(comm, config);
  while (simulation.report().time < config.time.end - 1e-9) simulation.step(config.time.end);
  EXPECT_EQ(simulation.report().lost, 0);
  const Particles<2>& particles = simulation.particles();
  double square = 0.0, count = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    const Vector<2>& place = particles.position[i];
    if (particles.type[i] != ParticleType::fluid || !use(place)) continue;
    const Vector<2> off = particles.velocity[i] - exact(place);
    square += dot(off, off);
    count += 1.0;
  }
  return std::sqrt(sum_over_ranks(comm, square) / sum_over_ranks(comm, count));
}

void report(const char* what, int rows, double error) {
  if (rank_of(comm) == 0)
    fmt::print("  {}, {} rows: RMS error {:.2f} % of the largest speed\n", what, rows, 100.0 * error);
}

// Poiseuille flow that begins from rest, in the middle of a slug of fluid that is eight gaps long and open at its ends.
TEST(ViscousWalls, SlowDownAFlowThatAForceDrives) {
  constexpr double force = 40.0, end = 0.15;  // m/s^2, s
  const auto exact = [](const Vector<2>& place) {
    const double y = place[1];
    double speed = force / (2.0 * nu) * y * (1.0 - y);
    for (int k = 1; k < 40; k += 2) {
      const double wave = k * std::numbers::pi;
      speed -= 4.0 * force / (nu * std::pow(wave, 3)) * std::sin(wave * y) * std::exp(-nu * wave * wave * end);
    }
    return Vector<2>{{speed, 0.0}};
  };
  const double largest = exact(Vector<2>{{0.0, 0.5}})[0];
  double errors[2];
  for (int k = 0; k < 2; ++k) {
    const int rows = k == 0 ? 8 : 16;
    const Case config = scene(fmt::format(R"(fluid.gravity = [{}, 0]
[[fluid.region]]
shape = "box"
low = [-4, 0]
high = [4, 1]
[[wall]]
shape = "polyline"
points = [[-8, 0], [8, 0]]
wet = "left"
[[wall]]
shape = "polyline"
points = [[-8, 1], [8, 1]]
wet = "right"
)",
                                          force),
                              1.0, rows, end);
    errors[k] = rms_error(
                    config, [](const Vector<2>& place) { return std::abs(place[0]) < 1.0; }, exact) /
                largest;
    report("Poiseuille", rows, errors[k]);
  }
  EXPECT_LT(errors[0], 0.04);   // measured: 2.5 %
  EXPECT_LT(errors[1], 0.015);  // 0.9 %
}

// Plane Couette flow between plates that are turned by 30 degrees and move along themselves, one to and one fro.
TEST(ViscousWalls, TakeTheFluidAlongBetweenTiltedPlates) {
  constexpr double speed = 4.0, end = 0.15;  // m/s, s
  const Vector<2> along{{std::cos(std::numbers::pi / 6.0), std::sin(std::numbers::pi / 6.0)}},
      up{{-along[1], along[0]}};
  const auto exact = [&](const Vector<2>& place) {
    const double share = dot(place, up) / 0.5;  // of the way from the middle to a plate
    double result = speed * share;
    for (int k = 1; k < 40; ++k) {
      const double wave = k * std::numbers::pi;
      result += speed * 2.0 / wave * (k % 2 == 0 ? 1.0 : -1.0) * std::sin(wave * share) *
                std::exp(-nu * std::pow(wave / 0.5, 2) * end);
    }
    return result * along;
  };
  const auto plate = [&](double side, const char* wet) {
    const Vector<2> begin = -6.0 * along + 0.5 * side * up, tip = 6.0 * along + 0.5 * side * up;
    const Vector<2> velocity = side * speed * along;
    return fmt::format(R"([[wall]]
shape = "polyline"
points = [[{:.12g}, {:.12g}], [{:.12g}, {:.12g}]]
wet = "{}"
motion = "{}"
[[motion]]
name = "{}"
type = "constant"
velocity = [{:.12g}, {:.12g}]
)",
                       begin[0], begin[1], tip[0], tip[1], wet, wet, wet, velocity[0], velocity[1]);
  };
  for (const int rows : {8, 16}) {
    const Case config = scene(plate(-1.0, "left") + plate(1.0, "right") + R"([[fluid.region]]
shape = "box"
low = [-3, -0.5]
high = [3, 0.5]
about = [0, 0]
rotate = 30
)",
                              1.0, rows, end);
    const double error = rms_error(
                             config, [&](const Vector<2>& place) { return std::abs(dot(place, along)) < 1.0; }, exact) /
                         speed;
    report("plane Couette", rows, error);
    EXPECT_LT(error, rows == 8 ? 3e-3 : 2e-3);  // measured: 0.15 and 0.08 %
  }
}

// Couette flow between two cylinders, A r + B / r, of which one turns.
TEST(ViscousWalls, TakeTheFluidAlongBetweenCylinders) {
  constexpr double inner = 0.5, outer = 1.0, speed = 20.0, end = 0.25;  // m, m, m/s, s: gap^2/nu
  for (const bool inner_turns : {true, false}) {
    const double spin = speed / (inner_turns ? inner : outer), squares = outer * outer - inner * inner;
    const double A = spin * (inner_turns ? -inner * inner : outer * outer) / squares;
    const double B = spin * (inner_turns ? 1.0 : -1.0) * std::pow(inner * outer, 2) / squares;
    const auto exact = [&](const Vector<2>& place) {
      const double turning = A + B / dot(place, place);
      return Vector<2>{{-turning * place[1], turning * place[0]}};
    };
    for (const int rows : {8, 16}) {
      if (rows == 16 && !inner_turns) break;  // the better of both
      const Case config = scene(fmt::format(R"([[fluid.region]]
shape = "circle"
center = [0, 0]
radius = {1}
[[wall]]
shape = "circle"
center = [0, 0]
radius = {0}
wet = "outside"
{2}
[[wall]]
shape = "circle"
center = [0, 0]
radius = {1}
wet = "inside"
{3}
[[motion]]
name = "turn"
type = "constant"
spin = {4}
)",
                                            inner, outer, inner_turns ? "motion = \"turn\"" : "",
                                            inner_turns ? "" : "motion = \"turn\"", spin),
                                outer - inner, rows, end);
      const double error = rms_error(
                               config, [](const Vector<2>&) { return true; }, exact) /
                           speed;
      report(inner_turns ? "round Couette, the inner wall turns" : "round Couette, the outer wall turns", rows, error);
      EXPECT_LT(error, rows == 8 ? 0.012 : 0.004);  // measured: 0.7 and 0.2 %; 0.24 %
    }
  }
}

}  // namespace
}  // namespace impinge
