#include "impinge/method/totals.hpp"

#include <gtest/gtest.h>

namespace impinge {
namespace {

/// A wall particle whose pressure is averaged step by step.
struct AveragedWall {
  explicit AveragedWall(double step) : dt(step) {
    particles.resize(1);
    particles.owned = 1;
    particles.type[0] = ParticleType::wall;
  }
  /// A step of length dt that ends at `time`.
  void add(double time, double pressure) {
    StepReport report;
    report.time = time;
    report.dt = dt;
    particles.pressure[0] = pressure;
    average_wall_pressure(report, window, particles);
  }
  double mean() const { return particles.pressure_impulse[0] / (window.end - window.begin); }

  double dt;
  Particles<2> particles;
  AveragingWindow window;
};

TEST(AverageOfTheWallPressure, IsOverItsWindow) {
  AveragedWall wall(0.1);
  wall.add(0.4, 2.0);
  wall.add(0.5, 6.0);
  EXPECT_NEAR(wall.window.begin, 0.3, 1e-12);
  EXPECT_EQ(wall.window.end, 0.5);
  EXPECT_NEAR(wall.mean(), 4.0, 1e-12);
}

TEST(AverageOfTheWallPressure, BeginsAnewAfterStepsThatAreLeftOut) {
  AveragedWall wall(0.1);
  wall.add(0.1, 5.0);
  EXPECT_EQ(wall.window.begin, 0.0);
  wall.add(0.3, 7.0);
  wall.add(0.4, 9.0);
  EXPECT_NEAR(wall.window.begin, 0.2, 1e-12);
  EXPECT_NEAR(wall.mean(), 8.0, 1e-12);
}

}  // namespace
}  // namespace impinge
