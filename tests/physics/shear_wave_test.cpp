// Flows in a periodic box decay as viscosity says.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "impinge/cases/make_simulation.hpp"
#include "shipped_case.hpp"

namespace impinge {
namespace {

const MPI_Comm comm = MPI_COMM_WORLD;

class ShearWave : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, ShearWave, testing::Values("consistent", "paper"),
                         [](const auto& test) { return test.param; });

TEST_P(ShearWave, DecaysAtTheAnalyticRate) {
  const Case config = shipped_case("shear-wave.toml", {"scheme=" + GetParam()});
  auto simulation = make_simulation<2>(comm, config);
  while (simulation.report().time < config.time.end - 1e-9) simulation.step();

  const double k = 2.0 * std::numbers::pi / config.periodic_box.size[1];
  const double amplitude =
      config.periodic_box.shear_speed * std::exp(-config.fluid.viscosity * k * k * simulation.report().time);
  const auto& particles = simulation.particles();
  double projection = 0.0, square = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    const double wave = std::sin(k * particles.position[i][1]);
    const Vector<2> velocity = particles.velocity[i];
    projection += 2.0 * velocity[0] * wave;
    square += std::pow(velocity[0] - amplitude * wave, 2) + std::pow(velocity[1], 2);
  }
  const auto count = static_cast<double>(simulation.report().fluid);
  projection = sum_over_ranks(comm, projection) / count;
  const double deviation = std::sqrt(sum_over_ranks(comm, square) / count);
  if (rank_of(comm) == 0)
    fmt::print("  t = {:.4f} s: amplitude {:.5f} m/s, analytic {:.5f} m/s ({:+.2f} %), RMS deviation {:.2f} %\n",
               simulation.report().time, projection, amplitude, 100.0 * (projection / amplitude - 1.0),
               100.0 * deviation / amplitude);
  RecordProperty("amplitude_ratio", fmt::format("{:.4f}", projection / amplitude));
  RecordProperty("rms_deviation", fmt::format("{:.4f}", deviation / amplitude));
  EXPECT_EQ(simulation.report().lost, 0);
  const double bound = config.fluid.corrected_viscosity ? 5e-3 : 0.03;
  EXPECT_NEAR(projection / amplitude, 1.0, bound);
  EXPECT_LT(deviation, bound * amplitude);
}

// nu_t = (C_s dp)^2 |du/dy|, and the flow that it alone slows down, du/dt = d/dy (nu_t du/dy), on a fine grid.
TEST(ShearWave, DecaysByItsEddiesAsSmagorinskySays) {
  constexpr double period = 0.1, speed = 0.05, length = 0.5 * 0.0025, end = 5.0;  // m, m/s, C_s dp [m], s
  constexpr int points = 200;
  std::vector<double> u(points), flux(points);
  for (int k = 0; k < points; ++k)
    u[static_cast<std::size_t>(k)] = speed * std::sin(2.0 * std::numbers::pi * (k + 0.5) / points);
  constexpr double dy = period / points, dt = 1e-3;
  for (int step = 0; step < static_cast<int>(end / dt + 0.5); ++step) {
    for (std::size_t k = 0; k < points; ++k) {
      const double slope = (u[(k + 1) % points] - u[k]) / dy;
      flux[k] = length * length * std::abs(slope) * slope;
    }
    for (std::size_t k = 0; k < points; ++k) u[k] += dt / dy * (flux[k] - flux[(k + points - 1) % points]);
  }
  double exact = 0.0;  // energy over that at the start
  for (const double one : u) exact += 2.0 * one * one / (points * speed * speed);

  const auto energy_left = [&](const char* smagorinsky) {
    const Case config =
        shipped_case("shear-wave.toml", {"fluid.viscosity=0", "smoothing.rate=0", fmt::format("time.end={}", end),
                                         "time.dt=0.01", fmt::format("fluid.smagorinsky={}", smagorinsky)});
    auto simulation = make_simulation<2>(comm, config);
    const double at_start = simulation.report().kinetic_energy;
    while (simulation.report().time < end - 1e-9) simulation.step(end);
    return simulation.report().kinetic_energy / at_start;
  };
  const double without = energy_left("0"), with = energy_left("0.5");
  if (rank_of(comm) == 0) fmt::print("  energy left {:.4f} without, {:.4f} with; exact {:.4f}\n", without, with, exact);
  EXPECT_NEAR(without, 1.0, 3e-3);                           // measured: -0.1 %
  EXPECT_NEAR(std::log(with) / std::log(exact), 1.0, 0.03);  // -0.5 %
}

// E/E0 = exp(-16 pi^2 nu t / L^2). The square lattice buckles in the first fifth of the time: until then and behind.
TEST(TaylorGreen, VorticesDecayAtTheExactRate) {
  const Case config = shipped_case("taylor-green/taylor-green.toml");
  auto simulation = make_simulation<2>(comm, config);
  const double rate = 16.0 * std::pow(std::numbers::pi, 2) * config.fluid.viscosity;
  const double at_start = simulation.report().kinetic_energy;
  EXPECT_NEAR(at_start, 250.0, 1e-9);  // J/m: rho V^2 L^2 / 4
  const auto energy_at = [&](double time) {
    while (simulation.report().time < time - 1e-9) simulation.step(time);
    return simulation.report().kinetic_energy / at_start;
  };
  const double early = energy_at(0.4), late = energy_at(1.0);
  if (rank_of(comm) == 0)
    fmt::print("  energy {:+.2f} % at 0.4 s, {:+.2f} % at 1 s\n", 100.0 * (early / std::exp(-0.4 * rate) - 1.0),
               100.0 * (late / std::exp(-rate) - 1.0));
  EXPECT_NEAR(early / std::exp(-0.4 * rate), 1.0, 0.03);           // measured: +2.1 %
  EXPECT_NEAR(std::log(early / late) / (0.6 * rate), 1.0, 0.015);  // -0.7 to -0.9 %
}

}  // namespace
}  // namespace impinge
