// A standing wave: its period, and the energy that it loses.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "impinge/cases/make_simulation.hpp"

namespace impinge {
namespace {

const MPI_Comm comm = MPI_COMM_WORLD;

struct Maximum {
  double time, value;
};

/// The largest values of a curve with several waves, each by the parabola through points some steps apart.
std::vector<Maximum> maxima(const std::vector<double>& time, const std::vector<double>& value) {
  constexpr std::size_t reach = 12;
  std::vector<Maximum> found;
  for (std::size_t n = reach; n + reach < value.size(); ++n) {
    bool is_largest = true;
    for (std::size_t k = n - reach; k <= n + reach; ++k) is_largest &= value[k] <= value[n];
    if (!is_largest || (!found.empty() && time[n] - found.back().time < 0.3)) continue;
    const double before = value[n - reach], after = value[n + reach], bend = before - 2.0 * value[n] + after;
    const double off = 0.5 * (before - after) / bend;  // from n [reaches]
    found.push_back({time[n] + off * (time[n + reach] - time[n]), value[n] - 0.25 * (before - after) * off});
  }
  return found;
}

// Water that gravity tilts by a fiftieth sloshes in its lowest mode (Lamb, Hydrodynamics, art. 228).
TEST(StandingWave, KeepsItsPeriodAndItsEnergy) {
  const Case config = parse_case({{"sloshing.toml", R"(geometry = "tank"
particles.spacing = 0.025
tank = {size = [1.0, 0.6], fluid_height = 0.3}
fluid.gravity = [0.2, -9.81]
time = {end = 4.2, dt = 5e-3}
)"}});
  auto simulation = make_simulation<2>(comm, config);
  std::vector<double> time, energy;
  while (simulation.report().time < config.time.end - 1e-9) {
    simulation.step();
    time.push_back(simulation.report().time);
    energy.push_back(simulation.report().kinetic_energy);
  }
  const std::vector<Maximum> found = maxima(time, energy);
  ASSERT_GE(found.size(), 5u);
  const double periods = 0.5 * static_cast<double>(found.size() - 1);
  const double period = (found.back().time - found.front().time) / periods;
  const double lost = 1.0 - std::pow(found.back().value / found.front().value, 1.0 / periods);
  const double k = std::numbers::pi;  // of a tank 1 m long
  const double exact = 2.0 * std::numbers::pi / std::sqrt(9.81 * k * std::tanh(0.3 * k));
  if (rank_of(comm) == 0)
    fmt::print("  period {:+.2f} %, energy lost in a period {:.2f} %\n", 100.0 * (period / exact - 1.0), 100.0 * lost);
  EXPECT_NEAR(period, exact, 0.006 * exact);
  EXPECT_LT(std::abs(lost), 0.02);
}

}  // namespace
}  // namespace impinge
