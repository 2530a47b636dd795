// Shifting beside the free surface: particles that stand too near drift apart.

#include <gtest/gtest.h>

#include <limits>

#include "impinge/cases/make_simulation.hpp"
#include "mpi/gather.hpp"
#include "shipped_case.hpp"

namespace impinge {
namespace {

const MPI_Comm comm = MPI_COMM_WORLD;

/// Where the particle of a checkpoint stands that is nearest to a place.
std::int64_t nearest(const Checkpoint<2>& state, const Vector<2>& place) {
  std::int64_t found = -1;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [id, position] : gather_by_id(comm, state.particles, state.particles.position)) {
    if (norm(position - place) >= least) continue;
    least = norm(position - place);
    found = id;
  }
  return found;
}

void move(Checkpoint<2>& state, std::int64_t id, const Vector<2>& way) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(state.particles.owned); ++i) {
    if (state.particles.id[i] != id) continue;
    state.particles.position[i] += way;
    state.searched_position[i] = state.particles.position[i];
  }
}

Case tank(const std::string& least_distance) {
  return shipped_case("hydrostatic.toml", {"shifting.least_distance=" + least_distance});
}

/// Distance [dp], after ten steps of a tank at rest, of two particles of the surface that started half of dp apart.
double distance_after_steps(const std::string& least_distance) {
  const Case config = tank(least_distance);
  const double dp = config.particles.spacing;
  const Vector<2> left{{0.5 * config.tank.size[0] - 0.5 * dp, config.tank.fluid_height - 0.5 * dp}};
  Checkpoint<2> start = make_simulation<2>(comm, config).checkpoint();
  const std::int64_t first = nearest(start, left), second = nearest(start, left + Vector<2>{{dp, 0.0}});
  move(start, first, {{0.5 * dp, 0.0}});
  auto simulation = make_simulation<2>(comm, config, &start);
  for (int n = 0; n < 10; ++n) simulation.step();
  const auto places = gather_by_id(comm, simulation.particles(), simulation.particles().position);
  return norm(places.at(second) - places.at(first)) / dp;
}

/// Momentum over density, after a step of a tank in straining flow, with a particle of the surface near the wall.
Vector<2> momentum_after_step(const std::string& least_distance, double& place) {
  const Case config = tank(least_distance);
  const double dp = config.particles.spacing;
  Checkpoint<2> start = make_simulation<2>(comm, config).checkpoint();
  const std::int64_t near = nearest(start, {{0.5 * dp, config.tank.fluid_height - 0.5 * dp}});
  move(start, near, {{-0.25 * dp, 0.0}});
  for (std::size_t i = 0; i < static_cast<std::size_t>(start.particles.owned); ++i)
    if (start.particles.type[i] == ParticleType::fluid)
      start.particles.velocity[i] = {{start.particles.position[i][0], -start.particles.position[i][1]}};
  auto simulation = make_simulation<2>(comm, config, &start);
  simulation.step();
  const Particles<2>& particles = simulation.particles();
  place = gather_by_id(comm, particles, particles.position).at(near)[0];
  Vector<2> sum;
  for (const auto& [id, velocity] : gather_by_id(comm, particles, particles.velocity)) sum += velocity;
  return dp * dp * sum;
}

TEST(Shifting, PartsParticlesThatAreTooNearBesideTheSurface) {
  const double apart = distance_after_steps("0.9");
  const double without = distance_after_steps("0.0");
  EXPECT_GT(apart, without + 0.01);
  EXPECT_LT(apart, 1.0);
  EXPECT_NEAR(distance_after_steps("0.5"), without, 1e-6);  // they are farther apart than that
}

TEST(Shifting, OffAWallChangesNoMomentum) {
  double pushed = 0.0, free = 0.0;
  const Vector<2> change = momentum_after_step("0.9", pushed) - momentum_after_step("0.0", free);
  EXPECT_GT(pushed, free + 1e-6);
  EXPECT_LT(norm(change), 1e-15);
}

}  // namespace
}  // namespace impinge
