// Shifting beside the free surface: particles that stand too near drift apart.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "impinge/simulation.hpp"
#include "shipped_case.hpp"

namespace impinge {
namespace {

const MPI_Comm comm = MPI_COMM_WORLD;

/// Distance [dp], after ten steps of a tank at rest, of two particles of the surface that started half of dp apart.
double distance_after_steps(const std::string& least_distance) {
  const Config config = shipped_case("hydrostatic.toml", {"shifting.least_distance=" + least_distance});
  const double dp = config.particles.spacing;
  const Vec<2> left{{0.5 * config.tank.size[0] - 0.5 * dp, config.tank.fluid_height - 0.5 * dp}};
  const Vec<2> right{{left[0] + dp, left[1]}};
  Checkpoint<2> start = Simulation<2>(comm, config).checkpoint();
  std::array<double, 2> ids{-1.0, -1.0};
  for (std::size_t i = 0; i < static_cast<std::size_t>(start.particles.owned); ++i) {
    Vec<2>& position = start.particles.position[i];
    if (norm(position - left) < 1e-6 * dp) {
      ids[0] = static_cast<double>(start.particles.id[i]);
      position[0] += 0.5 * dp;
      start.searched_position[i] = position;
    } else if (norm(position - right) < 1e-6 * dp) {
      ids[1] = static_cast<double>(start.particles.id[i]);
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, ids.data(), 2, MPI_DOUBLE, MPI_MAX, comm);
  EXPECT_GE(std::min(ids[0], ids[1]), 0.0);

  Simulation<2> simulation(comm, config, &start);
  for (int n = 0; n < 10; ++n) simulation.step();
  std::array<double, 4> places{};
  const auto& particles = simulation.particles();
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      if (static_cast<double>(particles.id[i]) != ids[k]) continue;
      places[2 * k] = particles.position[i][0];
      places[2 * k + 1] = particles.position[i][1];
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, places.data(), 4, MPI_DOUBLE, MPI_SUM, comm);
  return std::hypot(places[2] - places[0], places[3] - places[1]) / dp;
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
