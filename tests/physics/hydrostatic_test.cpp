// Water in a tank stays at rest and its pressure is the weight of the column above.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "impinge/cases/make_simulation.hpp"
#include "shipped_case.hpp"

namespace impinge {
namespace {

const MPI_Comm comm = MPI_COMM_WORLD;

class Hydrostatic : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, Hydrostatic, testing::Values("consistent", "paper"),
                         [](const auto& test) { return test.param; });

TEST_P(Hydrostatic, ColumnStaysAtRestUnderItsWeight) {
  const Case config = shipped_case("hydrostatic.toml", {"scheme=" + GetParam()});
  const bool consistent = config.scheme == Scheme::consistent;
  const double dp = config.particles.spacing;
  const double width = config.tank.size[0];
  const double height = config.tank.fluid_height;
  const double gravity = -config.fluid.gravity[1];
  const double weight = config.fluid.density * gravity;  // per volume [Pa/m]
  const auto n_rows = static_cast<std::size_t>(std::lround(height / dp));

  // Pressure by height: sums over the last second of the mean pressure of each row of height dp, and the floor's.
  std::vector<double> profile(n_rows, 0.0);
  std::vector<double> floor;
  double averaged = 0.0, largest_speed = 0.0, largest_speed_later = 0.0, highest = 0.0, worst_floor = 0.0;
  int averaged_steps = 0;
  auto simulation = make_simulation<2>(comm, config);
  while (simulation.report().time < config.time.end - 1e-9) {
    simulation.step();
    const StepReport& report = simulation.report();
    largest_speed = std::max(largest_speed, report.max_speed);
    worst_floor = std::max(worst_floor, std::abs(report.floor_force / width / (weight * height) - 1.0));
    if (report.time < config.average_start) continue;
    largest_speed_later = std::max(largest_speed_later, report.max_speed);
    std::vector<double> sums(2 * n_rows, 0.0);
    double top = 0.0;
    const auto& particles = simulation.particles();
    for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
      if (particles.type[i] != ParticleType::fluid) continue;
      const double y = particles.position[i][1];
      top = std::max(top, y);
      const auto row = static_cast<std::size_t>(std::clamp(y / dp, 0.0, static_cast<double>(n_rows) - 0.5));
      sums[2 * row] += particles.pressure[i];
      sums[2 * row + 1] += 1.0;
    }
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, comm);
    highest = std::max(highest, max_over_ranks(comm, top));
    for (std::size_t row = 0; row < n_rows; ++row)
      profile[row] += report.dt * sums[2 * row] / std::max(sums[2 * row + 1], 1.0);
    floor.push_back(report.floor_force / width);
    averaged += report.dt;
    ++averaged_steps;
  }
  const StepReport& end = simulation.report();
  EXPECT_EQ(end.in, end.fluid);
  EXPECT_EQ(end.lost, 0);

  double worst = 0.0;
  for (std::size_t row = 0; row < n_rows; ++row) {
    const double depth = height - (static_cast<double>(row) + 0.5) * dp;
    worst = std::max(worst, std::abs(profile[row] / averaged - weight * depth));
  }
  double mean = 0.0, scatter = 0.0;
  for (const double pressure : floor) mean += pressure / averaged_steps;
  for (const double pressure : floor) scatter += std::pow(pressure - mean, 2) / averaged_steps;
  scatter = std::sqrt(scatter);
  const double at_floor = weight * height;
  if (rank_of(comm) == 0) {
    fmt::print("  floor: mean {:.1f} Pa, rho g h {:.1f} Pa, scatter of a snapshot {:.1f} Pa\n", mean, at_floor,
               scatter);
    fmt::print("  floor: largest deviation of a step {:.2f} %\n", 100.0 * worst_floor);
    fmt::print("  profile: largest deviation {:.2f} % of rho g h\n", 100.0 * worst / at_floor);
    fmt::print("  largest speed {:.3f} m/s, {:.3f} m/s in the last second; highest particle {:.4f} m there\n",
               largest_speed, largest_speed_later, highest);
    for (std::size_t row = 0; row < n_rows; ++row)
      fmt::print("    y = {:.3f} m: p = {:7.1f} Pa, rho g h {:7.1f} Pa\n", (static_cast<double>(row) + 0.5) * dp,
                 profile[row] / averaged, weight * (height - (static_cast<double>(row) + 0.5) * dp));
  }
  RecordProperty("floor_scatter_pa", fmt::format("{:.1f}", scatter));
  RecordProperty("largest_speed", fmt::format("{:.3f}", largest_speed_later));
  RecordProperty("profile_deviation", fmt::format("{:.4f}", worst / at_floor));
  EXPECT_LT(worst, (consistent ? 0.01 : 0.05) * at_floor);
  // The wall particles of the paper's scheme stand half a spacing below the floor.
  EXPECT_NEAR(mean, consistent ? at_floor : at_floor + 0.5 * dp * weight, (consistent ? 0.01 : 0.05) * at_floor);
  if (consistent) {
    EXPECT_LT(worst_floor, 0.01);
  }
  // Against the speed of a fall from the surface to the floor; the start is not quite at rest, for the column settles.
  const double fall_speed = std::sqrt(2.0 * gravity * height);
  EXPECT_LT(largest_speed, 0.2 * fall_speed);
  EXPECT_LT(largest_speed_later, (consistent ? 0.05 : 0.15) * fall_speed);
  EXPECT_NEAR(highest, height - 0.5 * dp, dp);
}

// Gravity lifts the column off the floor, which does not pull.
TEST(FreeFall, IsAParabolaWithTheMeanVelocity) {
  constexpr double gravity = 9.81;
  for (const bool mean : {true, false}) {
    const Case config = shipped_case(
        "hydrostatic.toml",
        {"fluid.gravity=[0, 9.81]", fmt::format("time.mean_velocity={}", mean), "pressure.clamp_negative=true"});
    auto simulation = make_simulation<2>(comm, config);
    double late = 0.0;  // of the place, where the whole new velocity moves it
    for (int n = 0; n < 30; ++n) {
      simulation.step();
      late += 0.5 * gravity * std::pow(simulation.report().dt, 2);
    }
    const auto& particles = simulation.particles();
    double highest = 0.0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
      if (particles.type[i] == ParticleType::fluid) highest = std::max(highest, particles.position[i][1]);
    highest = max_over_ranks(comm, highest);
    const double start = config.tank.fluid_height - 0.5 * config.particles.spacing;
    const double fall = 0.5 * gravity * std::pow(simulation.report().time, 2);
    EXPECT_NEAR(highest, start + fall + (mean ? 0.0 : late), 1e-9 * fall);
  }
}

}  // namespace
}  // namespace impinge
