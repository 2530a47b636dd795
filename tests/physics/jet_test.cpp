// The steady jet at low resolution, against the analytic one.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>

#include "impinge/cases/make_simulation.hpp"
#include "impinge/scenes/analytic_jet.hpp"
#include "shipped_case.hpp"

namespace impinge {
namespace {

const MPI_Comm comm = MPI_COMM_WORLD;

/// Fluid above begin < x < end, as a mean thickness [m].
double film_thickness(const Particles<2>& particles, double spacing, double begin, double end) {
  std::int64_t count = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    const double x = particles.position[i][0];
    count += particles.type[i] == ParticleType::fluid && x > begin && x < end;
  }
  return static_cast<double>(sum_over_ranks(comm, count)) * spacing * spacing / (end - begin);
}

struct Bounds {
  const char* scheme;
  double least_force, largest_force, film;
};

// H/dp = 10 from the analytic state. With the paper's operators the force is about a third too high at this resolution:
// those bounds tell a jet from none, not a good one from a fair one.
class Jet : public testing::TestWithParam<Bounds> {};
INSTANTIATE_TEST_SUITE_P(All, Jet,
                         testing::Values(Bounds{"consistent", 0.95, 1.05, 0.06}, Bounds{"paper", 1.0, 1.5, 0.1}),
                         [](const auto& test) { return std::string(test.param.scheme); });

TEST_P(Jet, HoldsItsSteadyStateAtLowResolution) {
  const Bounds bounds = GetParam();
  const Case config = shipped_case("jet.toml", {fmt::format("scheme={}", bounds.scheme), "particles.spacing=0.04",
                                                "time.dt=1.6e-3", "jet.start=\"steady\""});
  const double width = config.jet.width;
  const AnalyticJet analytic(width, config.jet.speed, config.fluid.density,
                             config.jet.angle * std::numbers::pi / 180.0);
  auto simulation = make_simulation<2>(comm, config);
  const std::int64_t at_start = simulation.report().fluid;
  const double energy_at_start = simulation.report().kinetic_energy;
  double impulse = 0.0, span = 0.0, largest_speed = 0.0, film = 0.0;
  while (simulation.report().time < 1.5) {
    simulation.step();
    const StepReport& report = simulation.report();
    ASSERT_EQ(report.in, report.out + report.fluid);
    largest_speed = std::max(largest_speed, report.max_speed);
    if (report.time < 0.5) continue;
    impulse += report.dt * report.floor_force;
    span += report.dt;
    film += report.dt * film_thickness(simulation.particles(), config.particles.spacing, 1.5 * width, 3.0 * width);
  }
  const StepReport& end = simulation.report();
  const double force_ratio = impulse / span / analytic.normal_force();
  const double film_ratio = film / span / analytic.sheet_thickness(AnalyticJet::Side::h1);
  const double energy_ratio = end.kinetic_energy / energy_at_start;
  if (rank_of(comm) == 0)
    fmt::print(
        "  force ratio {:.3f}, film h1 ratio {:.3f}, kinetic energy {:.3f} of the start's, largest speed {:.2f} U, "
        "fluid {} -> {} (in {}, out {})\n",
        force_ratio, film_ratio, energy_ratio, largest_speed / config.jet.speed, at_start, end.fluid, end.in - at_start,
        end.out);
  RecordProperty("force_ratio", fmt::format("{:.3f}", force_ratio));
  RecordProperty("film_h1", fmt::format("{:.3f}", film_ratio));
  EXPECT_GT(force_ratio, bounds.least_force);
  EXPECT_LT(force_ratio, bounds.largest_force);
  EXPECT_NEAR(film_ratio, 1.0, bounds.film);
  EXPECT_NEAR(energy_ratio, 1.0, 0.1);
  EXPECT_NEAR(static_cast<double>(end.fluid) / static_cast<double>(at_start), 1.0, 0.05);
  EXPECT_NEAR(static_cast<double>(end.in - at_start), 1.5 * config.jet.speed / config.particles.spacing * 10.0, 10.0);
}

}  // namespace
}  // namespace impinge
