// Body forces, the length of a step, and mirrors.

#include "impinge/method/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "cloud.hpp"
#include "dimensions.hpp"
#include "impinge/method/body_force.hpp"
#include "impinge/method/time_step.hpp"

namespace impinge {
namespace {

TEST(BodyForce, FollowsATableLinearlyAndStaysConstantBeyondIt) {
  FluidSettings fluid;
  fluid.gravity = {7.0, 7.0, 7.0};
  fluid.gravity_at = {{1.0, {0.0, -10.0}}, {2.0, {4.0, -10.0}}, {4.0, {4.0, -6.0}}};
  const auto at = [&](double time) { return BodyForce<2>(fluid, time).at({{3.0, 5.0}}); };
  EXPECT_EQ(at(0.0), (Vector<2>{{0.0, -10.0}}));
  EXPECT_EQ(at(1.5), (Vector<2>{{2.0, -10.0}}));
  EXPECT_EQ(at(3.0), (Vector<2>{{4.0, -8.0}}));
  EXPECT_EQ(at(9.0), (Vector<2>{{4.0, -6.0}}));
}

TEST(BodyForce, PullsToACentreInProportionToTheDistance) {
  FluidSettings fluid;
  fluid.central_force = 2.0;
  fluid.force_center = {1.0, 0.0, 0.0};
  const BodyForce<2> force(fluid, 0.0);
  EXPECT_EQ(force.at({{1.0, 0.0}}), (Vector<2>{}));
  EXPECT_EQ(force.at({{2.0, -1.0}}), (Vector<2>{{-4.0, 4.0}}));
  EXPECT_FALSE(force.is_zero());
  EXPECT_TRUE(BodyForce<2>(FluidSettings{}, 0.0).is_zero());
  Particles<2> particles;
  particles.append({{{1.0, 3.0}}, {}, 0.0, 0.0, 0, ParticleType::fluid});
  particles.append({{{1.0, 9.0}}, {}, 0.0, 0.0, 1, ParticleType::wall});
  EXPECT_DOUBLE_EQ(force.largest(MPI_COMM_SELF, particles), 12.0);
}

TEST(BodyForce, InSpaceAddsTheTableAndThePull) {
  FluidSettings fluid;
  fluid.gravity_at = {{1.0, {1.0, 2.0, -3.0}}};
  fluid.central_force = 0.5;
  fluid.force_center = {0.0, 0.0, 4.0};
  for (const double time : {0.0, 1.0, 5.0})
    EXPECT_EQ(BodyForce<3>(fluid, time).at({{4.0, 0.0, 0.0}}), (Vector<3>{{0.0, 2.0, -2.0}}));
  fluid.gravity_at = {{1.0, {1.0, 2.0, -3.0}}, {1.5, {2.0, 4.0, -6.0}}};
  fluid.central_force = 0.0;
  EXPECT_EQ(BodyForce<3>(fluid, 1.0).at({}), (Vector<3>{{1.0, 2.0, -3.0}}));
  EXPECT_EQ(BodyForce<3>(fluid, 1.5).at({}), (Vector<3>{{2.0, 4.0, -6.0}}));
  EXPECT_DOUBLE_EQ(BodyForce<3>(fluid, 1.25).largest(MPI_COMM_SELF, {}), 1.5 * std::sqrt(14.0));
}

/// Energy of a particle on a spring of frequency 1 after many steps by the rule, over that at the start; the spring's
/// force acts where the pressure does.
double energy_ratio(bool mean_velocity, double dt) {
  TimeSettings time;
  time.mean_velocity = mean_velocity;
  const MotionRule rule(time, dt);
  std::vector<Inlet<2>> none;
  Particles<2> particles;
  particles.append({{{1.0, 0.0}}, {}, 0.0, 0.0, 0, ParticleType::fluid});
  particles.owned = 1;
  Vector<2>&x = particles.position[0], &u = particles.velocity[0];
  double largest = 0.0;
  for (int step = 0; step * dt < 100.0; ++step) {
    advance(rule.before, none, particles);
    const Vector<2> change = -rule.dt * x;
    u += change;
    advance(rule.after, none, particles);
    x += (rule.before - rule.after) * change;
    if (step * dt > 90.0) largest = std::max(largest, dot(x, x) + dot(u, u));
  }
  return largest;
}

TEST(MotionRule, OfTheMeanVelocityKeepsTheEnergyOfAnOscillation) {
  EXPECT_NEAR(energy_ratio(true, 0.1), 1.0, 0.003);
  EXPECT_NEAR(energy_ratio(true, 0.05), 1.0, 0.003 / 4.0);
  EXPECT_LT(energy_ratio(false, 0.1), 0.5);
}

TEST(MotionRule, OfTheMeanVelocityTakesAFallExactly) {
  TimeSettings time;
  for (const bool mean : {true, false}) {
    time.mean_velocity = mean;
    const MotionRule rule(time, 0.1);
    double x = 0.0, u = 0.0;
    for (int step = 0; step < 10; ++step) {
      u += -10.0 * rule.dt;
      x += rule.before * u - rule.after * -10.0 * rule.dt + rule.after * u;
    }
    EXPECT_NEAR(x, mean ? -5.0 : -5.5, 1e-12);
  }
}

TEST(TimeStep, IsTheSmallestOfItsLimits) {
  constexpr double spacing = 0.01;
  const auto choose = [](double dt, double speed, double acceleration, double last, int halvings = 0) {
    TimeSettings time;
    time.dt = dt;
    time.cfl = 0.2;
    StepReport report;
    report.dt = last;
    report.halvings = halvings;
    report.free_dt = last;
    choose_time_step(time, spacing, speed, acceleration, HUGE_VAL, report);
    return std::pair(report.dt, report.limit);
  };
  EXPECT_EQ(choose(1e-3, 1.0, 10.0, 1e-3), std::pair(1e-3, StepLimit::case_dt));
  EXPECT_EQ(choose(1.0, 4.0, 10.0, 1e-3), std::pair(0.2 * spacing / 4.0, StepLimit::cfl));
  EXPECT_EQ(choose(1.0, 0.0, 9.81, 1.0), std::pair(0.2 * std::sqrt(spacing / 9.81), StepLimit::force));
  EXPECT_EQ(choose(1.0, 0.0, 0.0, 1e-3), std::pair(1.1 * 1e-3, StepLimit::growth));
  EXPECT_EQ(choose(1e-3, 1.0, 10.0, 1e-3, 2), std::pair(0.25e-3, StepLimit::retry));
  EXPECT_EQ(choose(1.0, 0.0, 9.81, 1.0, 3), std::pair(0.2 * std::sqrt(spacing / 9.81) / 8.0, StepLimit::retry));
  EXPECT_EQ(choose(1e-3, 0.0, 0.0, 0.0), std::pair(1e-3, StepLimit::case_dt));
  // The first step has a quarter of the Courant number.
  EXPECT_DOUBLE_EQ(choose(1.0, 4.0, 0.0, 0.0).first, 0.05 * spacing / 4.0);
}

TEST(TimeStep, EndsAtATargetWithoutTinySteps) {
  TimeSettings time;
  time.cfl = 0.2;
  // Time step by time step from 0 to the target.
  const auto run = [&](double dt, double target) {
    time.dt = dt;
    StepReport report;
    std::vector<double> steps;
    while (report.time < target) {
      choose_time_step(time, 1.0, 0.0, 1.0, target, report);
      EXPECT_LE(report.dt, dt * (1.0 + 1e-6));
      EXPECT_EQ(report.limit, report.dt < 0.999 * dt ? StepLimit::target : StepLimit::case_dt);
      report.time = report.dt == target - report.time ? target : report.time + report.dt;
      steps.push_back(report.dt);
    }
    EXPECT_EQ(report.time, target);
    return steps;
  };
  for (const double target : {0.1, 0.0953, 0.09999999999, 0.1000000001, 0.3, 7.77}) {
    const auto steps = run(1e-3, target);
    EXPECT_EQ(steps.size(), std::ceil(target / 1e-3 - 1e-6)) << target;
    EXPECT_GE(*std::ranges::min_element(steps), 0.9e-3 * (1.0 - 1e-9)) << target;
  }
  const auto even = run(3e-3, 0.01);
  ASSERT_EQ(even.size(), 4u);
  for (const double dt : even) EXPECT_NEAR(dt, 2.5e-3, 1e-15);
  EXPECT_EQ(run(1.0, 1e-5), std::vector{1e-5});

  // What a near target has shortened does not bound the growth.
  StepReport report;
  time.dt = 1.0;
  report.free_dt = 1e-2;
  choose_time_step(time, 1.0, 0.0, 1.0, 1e-7, report);
  EXPECT_EQ(report.dt, 1e-7);
  choose_time_step(time, 1.0, 0.0, 1.0, HUGE_VAL, report);
  EXPECT_DOUBLE_EQ(report.dt, 1.1 * 1.1e-2);
  // A step that is repeated is fitted, too.
  report = {};
  report.free_dt = time.dt = 1e-3;
  report.halvings = 1;
  choose_time_step(time, 1.0, 0.0, 1.0, 0.9e-3, report);
  EXPECT_EQ(std::pair(report.dt, report.limit), std::pair(0.45e-3, StepLimit::target));
}

template <class Dimension>
class Mirrors : public testing::Test {
 protected:
  /// A room far from the origin whose walls are mirrors.
  static Box<Dimension::value> room() {
    Box<Dimension::value> box;
    for (int k = 0; k < Dimension::value; ++k) {
      box.low[k] = 1000.0 + k;
      box.high[k] = 1010.0 + k;
    }
    return box;
  }
};
TYPED_TEST_SUITE(Mirrors, Dimensions);

TYPED_TEST(Mirrors, ShowEveryParticleWithinReachOnceBehindEveryWallEdgeAndCorner) {
  constexpr int Dim = TypeParam::value;
  constexpr double reach = 2.5;
  const Box<Dim> box = this->room();
  auto walls = mirrors_of<Dim>(Edge::mirror, box, reach);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0.0, 10.0), speed(-1.0, 1.0);
  Particles<Dim> particles;
  for (int i = 0; i < 200; ++i) {
    ParticleRecord<Dim> record{};
    for (int k = 0; k < Dim; ++k) {
      record.position[k] = box.low[k] + place(random);
      record.velocity[k] = speed(random);
    }
    record.id = i;
    particles.append(record);
  }
  walls.append_images(particles);
  std::size_t expected = 0;
  for (int i = 0; i < 200; ++i) {
    std::size_t images = 1;
    for (int k = 0; k < Dim; ++k) {
      const double low = particles.position[static_cast<std::size_t>(i)][k] - box.low[k];
      images *= 1 + (low < reach) + (10.0 - low < reach);
    }
    expected += images - 1;
  }
  ASSERT_EQ(walls.count(), expected);
  std::vector<Vector<Dim>> held = particles.velocity;
  walls.copy_held_velocities(particles.position, held);
  walls.for_images([&](std::size_t, std::size_t at, std::size_t from) {
    EXPECT_EQ(particles.id[at], particles.id[from]);
    double parity = 1.0;
    for (int k = 0; k < Dim; ++k) {
      const double mine = particles.position[at][k], other = particles.position[from][k];
      const bool reflected = mine < box.low[k] || mine > box.high[k];
      const double wall = mine < box.low[k] ? box.low[k] : box.high[k];
      EXPECT_NEAR(mine, reflected ? 2.0 * wall - other : other, 1e-11);
      EXPECT_EQ(particles.velocity[at][k], reflected ? -particles.velocity[from][k] : particles.velocity[from][k]);
      if (reflected) parity = -parity;
    }
    EXPECT_EQ(held[at], parity * particles.velocity[from]);
  });
}

TYPED_TEST(Mirrors, PutBackWhatHasPassedThem) {
  constexpr int Dim = TypeParam::value;
  const Box<Dim> box = this->room();
  const auto walls = mirrors_of<Dim>(Edge::mirror, box, 2.5);
  Particles<Dim> particles;
  ParticleRecord<Dim> record{};
  for (int k = 0; k < Dim; ++k) record.position[k] = box.low[k] + 5.0;
  record.position[0] = box.low[0] - 0.25;
  record.position[1] = box.high[1] + 0.5;
  record.velocity[0] = -1.0;
  record.velocity[1] = 2.0;
  particles.append(record);
  record.position[0] = box.high[0];  // on the wall
  particles.append(record);
  record.position[0] = -1.0;
  record.type = ParticleType::inlet;
  particles.append(record);
  walls.confine([](int) { return Vector<Dim>{}; }, particles);
  EXPECT_DOUBLE_EQ(particles.position[0][0], box.low[0] + 0.25);
  EXPECT_DOUBLE_EQ(particles.position[0][1], box.high[1] - 0.5);
  EXPECT_EQ(particles.velocity[0][0], 1.0);
  EXPECT_EQ(particles.velocity[0][1], -2.0);
  EXPECT_LT(particles.position[1][0], box.high[0]);
  EXPECT_EQ(particles.position[2][0], -1.0);
}

TYPED_TEST(Mirrors, PutBackToTheInsideAtAnyPlaceOfAnyWall) {
  constexpr int Dim = TypeParam::value;
  constexpr double spacing = 0.01;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (const double corner : {0.0, -3.0, 1e3, -1e6}) {
    Box<Dim> box;
    for (int k = 0; k < Dim; ++k) {
      box.low[k] = corner;
      box.high[k] = corner + 1.0;
    }
    const auto walls = mirrors_of<Dim>(Edge::mirror, box, 2.5 * spacing, spacing);
    for (int trial = 0; trial < 500; ++trial) {
      Particles<Dim> particles;
      ParticleRecord<Dim> record{};
      Vector<Dim> expected, velocity;
      for (int k = 0; k < Dim; ++k) {
        record.velocity[k] = velocity[k] = share(random) - 0.5;
        expected[k] = record.position[k] = corner + 0.1 + 0.8 * share(random);
        const double depth = share(random) < 0.4 ? 0.0 : std::pow(10.0, -18.0 * share(random)) * spacing;
        if (share(random) < 0.5) continue;  // away from the walls of this axis
        const bool is_low = share(random) < 0.5;
        record.position[k] = is_low ? box.low[k] - depth : box.high[k] + depth;
        expected[k] = is_low ? 2.0 * box.low[k] - record.position[k] : 2.0 * box.high[k] - record.position[k];
        if (record.position[k] < box.low[k] || record.position[k] > box.high[k]) velocity[k] = -velocity[k];
      }
      particles.append(record);
      walls.confine([](int) { return Vector<Dim>{}; }, particles);
      for (int k = 0; k < Dim; ++k) {
        EXPECT_GT(particles.position[0][k], box.low[k]);
        EXPECT_LT(particles.position[0][k], box.high[k]);
        EXPECT_NEAR(particles.position[0][k], expected[k], 2e-9 * spacing + 4e-15 * std::abs(corner));
        EXPECT_EQ(particles.velocity[0][k], velocity[k]);
      }
    }
  }
}

}  // namespace
}  // namespace impinge
