// Shifting beside the free surface: particles that stand too near drift apart.

#include <gtest/gtest.h>

#include <algorithm>

#include "impinge/cases/make_simulation.hpp"
#include "mpi/gather.hpp"
#include "shipped_case.hpp"

namespace impinge {
namespace {

const MPI_Comm comm = MPI_COMM_WORLD;

/// A tank with two particles of the surface half of dp apart.
class NearPair {
 public:
  explicit NearPair(const std::string& least_distance)
      : config_(shipped_case("hydrostatic.toml", {"shifting.least_distance=" + least_distance})),
        start_(make_simulation<2>(comm, config_).checkpoint()) {
    const double dp = config_.particles.spacing;
    const Vector<2> left{{0.5 * config_.tank.size[0] - 0.5 * dp, config_.tank.fluid_height - 0.5 * dp}};
    const Vector<2> right{{left[0] + dp, left[1]}};
    for (const auto& [id, position] : gather_by_id(comm, start_.particles, start_.particles.position)) {
      if (norm(position - left) < 1e-6 * dp) first_ = id;
      if (norm(position - right) < 1e-6 * dp) second_ = id;
    }
    EXPECT_GE(std::min(first_, second_), 0);
    for (std::size_t i = 0; i < static_cast<std::size_t>(start_.particles.owned); ++i) {
      if (start_.particles.id[i] != first_) continue;
      start_.particles.position[i][0] += 0.5 * dp;
      start_.searched_position[i] = start_.particles.position[i];
    }
  }

  Checkpoint<2>& start() { return start_; }
  Particles<2> after(int steps) const {
    auto simulation = make_simulation<2>(comm, config_, &start_);
    for (int n = 0; n < steps; ++n) simulation.step();
    return simulation.particles();
  }
  /// [dp]
  double distance_after(int steps) const {
    const Particles<2> particles = after(steps);
    const auto places = gather_by_id(comm, particles, particles.position);
    return norm(places.at(second_) - places.at(first_)) / config_.particles.spacing;
  }

 private:
  Case config_;
  Checkpoint<2> start_;
  std::int64_t first_ = -1, second_ = -1;
};

TEST(Shifting, PartsParticlesThatAreTooNearBesideTheSurface) {
  const double apart = NearPair("0.9").distance_after(10);
  const double without = NearPair("0.0").distance_after(10);
  EXPECT_GT(apart, without + 0.01);
  EXPECT_LT(apart, 1.0);
  EXPECT_NEAR(NearPair("0.5").distance_after(10), without, 1e-6);  // they are farther apart than that
}

TEST(Shifting, PushesNoVelocity) {
  NearPair pushed("0.9"), free("0.0");
  for (NearPair* pair : {&pushed, &free}) {
    Particles<2>& particles = pair->start().particles;
    for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
      if (particles.type[i] == ParticleType::fluid)
        particles.velocity[i] = {{particles.position[i][0], -particles.position[i][1]}};
  }
  const Particles<2> one = pushed.after(1), other = free.after(1);
  const auto places = gather_by_id(comm, one, one.position);
  const auto velocities = gather_by_id(comm, one, one.velocity);
  double moved = 0.0;
  for (const auto& [id, place] : gather_by_id(comm, other, other.position))
    moved = std::max(moved, norm(place - places.at(id)));
  EXPECT_GT(moved, 1e-5);
  for (const auto& [id, velocity] : gather_by_id(comm, other, other.velocity))
    EXPECT_LT(norm(velocity - velocities.at(id)), 1e-12) << id;
}

}  // namespace
}  // namespace impinge
