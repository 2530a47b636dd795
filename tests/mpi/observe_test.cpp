// What is observed is the same on any number of ranks.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "impinge/cases/make_simulation.hpp"
#include "impinge/core/mpi.hpp"
#include "impinge/observe/observers.hpp"
#include "region_cases.hpp"
#include "shipped_case.hpp"

namespace impinge {
namespace {

/// A run with its observers.
template <int Dim>
struct ObservedRun {
  Simulation<Dim> simulation;
  Observers<Dim> observers;

  ObservedRun(MPI_Comm comm, const Case& config)
      : simulation(comm, config, make_scene<Dim>(config, config)),
        observers(comm, config, config, make_scene<Dim>(config, config), simulation.particles(), simulation.report()) {}

  std::vector<TableLine> step() {
    simulation.step();
    return observers.observe(
        {simulation.particles(), simulation.surface_depth(), simulation.outlets(), simulation.report()});
  }
};

std::vector<double> numbers(const std::string& row) {
  std::vector<double> values;
  std::istringstream cells(row);
  for (std::string cell; std::getline(cells, cell, ',');) values.push_back(std::stod(cell));
  return values;
}

template <int Dim>
std::vector<double> expect_the_same_tables(const Case& config, int steps, std::size_t tables) {
  ObservedRun<Dim> here(MPI_COMM_WORLD, config), alone(MPI_COMM_SELF, config);
  EXPECT_EQ(here.observers.headers().size(), tables);
  std::vector<double> last;
  for (int step = 1; step <= steps; ++step) {
    const auto shared = here.step(), single = alone.step();
    EXPECT_EQ(shared.size(), tables);
    last.clear();
    for (std::size_t k = 0; k < shared.size(); ++k) {
      EXPECT_EQ(shared[k].kind, single[k].kind);
      const auto left = numbers(shared[k].text), right = numbers(single[k].text);
      EXPECT_EQ(left.size(), right.size());
      for (std::size_t c = 0; c < left.size(); ++c) {
        if (std::isnan(right[c])) {
          EXPECT_TRUE(std::isnan(left[c])) << shared[k].text;
        } else {
          EXPECT_NEAR(left[c], right[c], 1e-5 * std::max(1.0, std::abs(right[c])))
              << shared[k].kind << " column " << c << " step " << step;
        }
        if (c > 1) last.push_back(right[c]);
      }
      EXPECT_EQ(broadcast(MPI_COMM_WORLD, shared[k].text, 0), shared[k].text);  // all ranks have the same row
    }
  }
  return last;
}

constexpr const char* observed = R"([[probe]]
position = [0.2, 0]
[[probe]]
position = [0, 0.2]
diameter = 0.2
normal = [1, 0]
[[probe]]
position = [0.9, 0.45]
[[gauge]]
point = [0.2, 0]
length = 0.5
[[section]]
begin = [0.4, 0]
end = [0.4, 0.5]
[[section]]
begin = [0.6, 0]
end = [0.6, 0.5]
)";

TEST(Observed, ColumnThatFallsIsThatOfASingleRank) {
  const Case column = column_case({"parallel.imbalance=1.0"});  // it is repartitioned
  const Case config = parse_case({{"column.toml", column.resolved_text + observed}});
  const auto values = expect_the_same_tables<2>(config, 150, 3);
  ASSERT_EQ(values.size(), 3u * 3u + 1u + 4u);
  EXPECT_GT(values[11], 0.03);  // beyond the first section [m^2]
  EXPECT_GT(values[13], 0.0);
  EXPECT_LT(values[13], values[11]);
}

TEST(Observed, TotalsAreTheFluidBeyondASection) {
  const Case config = parse_case({{"column.toml", column_case().resolved_text + observed}});
  ObservedRun<2> run(MPI_COMM_WORLD, config);
  std::vector<TableLine> rows;
  for (int step = 1; step <= 200; ++step) rows = run.step();
  const Particles<2>& particles = run.simulation.particles();
  double beyond = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
    if (particles.type[i] == ParticleType::fluid && particles.position[i][0] >= 0.4) beyond += 0.05 * 0.05;
  beyond = sum_over_ranks(MPI_COMM_WORLD, beyond);
  ASSERT_EQ(rows[2].kind, "sections");
  EXPECT_NEAR(numbers(rows[2].text)[3], beyond, 1e-8);
  EXPECT_GT(beyond, 0.03);
}

TEST(Observed, TankInThreeDimensionsIsThatOfASingleRank) {
  const Case tank = shipped_case("hydrostatic-3d.toml", {"pressure.tolerance=1e-12"});
  const Numbers& size = tank.tank.size;
  const std::string text = fmt::format(
      "[[probe]]\nposition = [{0}, {1}, 0]\n[[probe]]\nposition = [{0}, {1}, 0]\ndiameter = {0}\n"
      "[[gauge]]\npoint = [{0}, {1}, 0]\nlength = {2}\n",
      0.5 * size[0], 0.5 * size[1], size[2]);
  const auto values = expect_the_same_tables<3>(parse_case({{"tank.toml", tank.resolved_text + text}}), 5, 2);
  const double weight = 9.81 * 1000.0 * tank.tank.fluid_height;
  EXPECT_NEAR(values[0], weight, 0.02 * weight);
  EXPECT_NEAR(values[4], weight, 0.02 * weight);
  EXPECT_NEAR(values[8], tank.tank.fluid_height, 1e-3 * tank.tank.fluid_height);
}

TEST(Observed, DischargeOfARoundJetIsThatOfASingleRank) {
  const Case jet = parse_case({{"jet.toml", R"(geometry = "scene"
dimension = 3
particles.spacing = 0.02
time = {end = 1.0, dt = 3e-3}
domain = {low = [-0.3, -0.3, -0.2], high = [0.3, 0.3, 0.6]}
[[inlet]]
section = "circle"
center = [0, 0, 0]
direction = [0, 0, 1]
radius = 0.1
speed = 1.0
[[section]]
begin = [-0.2, -0.2, 0.1]
end = [0.2, -0.2, 0.1]
side = [0, 0.4, 0]
)"}});
  const auto values = expect_the_same_tables<3>(jet, 80, 1);
  // Rows cross one at a time, every 0.02 m.
  EXPECT_NEAR(values[1], 0.01 * std::numbers::pi * (80 * 3e-3 - 0.1), 0.01 * std::numbers::pi * 0.03);
}

TEST(Observed, JetsPlateFeelsTheStagnationPressure) {
  const Case jet = parse_case({{"jet.toml", R"(geometry = "jet"
particles.spacing = 0.04
time = {end = 10.0, dt = 3e-3}
jet = {width = 0.4, speed = 1.0, angle = 90.0, start = "steady"}
[[probe]]
position = [0, 0]
[[section]]
name = "jet"
begin = [-0.4, 1.0]
end = [0.4, 1.0]
)"}});
  ObservedRun<2> run(MPI_COMM_WORLD, jet);
  std::vector<TableLine> rows;
  while (run.simulation.report().time < 0.8) rows = run.step();
  EXPECT_NEAR(numbers(rows[0].text)[2], 500.0, 25.0);  // measured: 501.1
  EXPECT_NEAR(numbers(rows[1].text)[3], 0.4 * run.simulation.report().time, 0.016);
}

}  // namespace
}  // namespace impinge
