// Shifting beside the free surface: particles that stand too near drift apart.

#include <gtest/gtest.h>

#include <algorithm>

#include "impinge/cases/make_simulation.hpp"
#include "mpi/gather.hpp"
#include "shipped_case.hpp"

namespace impinge {
namespace {

const MPI_Comm comm = MPI_COMM_WORLD;

/// Distance [dp], after ten steps of a tank at rest, of two particles of the surface that started half of dp apart.
double distance_after_steps(const std::string& least_distance) {
  const Case config = shipped_case("hydrostatic.toml", {"shifting.least_distance=" + least_distance});
  const double dp = config.particles.spacing;
  const Vector<2> left{{0.5 * config.tank.size[0] - 0.5 * dp, config.tank.fluid_height - 0.5 * dp}};
  const Vector<2> right{{left[0] + dp, left[1]}};
  Checkpoint<2> start = make_simulation<2>(comm, config).checkpoint();
  std::int64_t first = -1, second = -1;
  for (const auto& [id, position] : gather_by_id(comm, start.particles, start.particles.position)) {
    if (norm(position - left) < 1e-6 * dp) first = id;
    if (norm(position - right) < 1e-6 * dp) second = id;
  }
  EXPECT_GE(std::min(first, second), 0);
  for (std::size_t i = 0; i < static_cast<std::size_t>(start.particles.owned); ++i) {
    if (start.particles.id[i] != first) continue;
    start.particles.position[i][0] += 0.5 * dp;
    start.searched_position[i] = start.particles.position[i];
  }

  auto simulation = make_simulation<2>(comm, config, &start);
  for (int n = 0; n < 10; ++n) simulation.step();
  const auto places = gather_by_id(comm, simulation.particles(), simulation.particles().position);
  return norm(places.at(second) - places.at(first)) / dp;
}

TEST(Shifting, PartsParticlesThatAreTooNearBesideTheSurface) {
  const double apart = distance_after_steps("0.9");
  const double without = distance_after_steps("0.0");
  EXPECT_GT(apart, without + 0.01);
  EXPECT_LT(apart, 1.0);
  EXPECT_NEAR(distance_after_steps("0.5"), without, 1e-6);  // they are farther apart than that
}

}  // namespace
}  // namespace impinge
