// The exact wedge: its pressure against its momentum, the plate, and the analytic jet.

#include "impinge/validation/analytic_wedge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "impinge/scenes/analytic_jet.hpp"

namespace impinge {
namespace {

constexpr double width = 0.1, speed = 2.0, density = 1000.0;
constexpr double degree = std::numbers::pi / 180.0;

AnalyticWedge wedge(double degrees, double length) { return {width, speed, density, degrees * degree, length * width}; }

TEST(AnalyticWedge, PressureGivesTheForceOfTheMomentum) {
  for (const double degrees : {20.0, 30.0, 60.0, 90.0, 120.0}) {
    for (const double length : {0.3, 1.0, 4.0}) {
      const AnalyticWedge exact = wedge(degrees, length);
      constexpr int count = 100000;
      double sum = 0.0;
      for (int k = 0; k < count; ++k) {  // distance length u^3: the pressure is steep at the edge
        const double u = (k + 0.5) / count;
        sum += exact.pressure(length * width * u * u * u) * 3.0 * u * u * length * width / count;
      }
      EXPECT_NEAR(2.0 * std::sin(degrees * degree) * sum / exact.force(), 1.0, 1e-5) << degrees << " " << length;
      EXPECT_NEAR(exact.force(), density * speed * speed * width * (1.0 - std::cos(exact.turn())), 1e-9);
    }
  }
}

TEST(AnalyticWedge, LongFacesTurnTheJetAlongThem) {
  for (const double degrees : {30.0, 60.0, 120.0}) {
    EXPECT_NEAR(wedge(degrees, 50.0).turn(), degrees * degree, 1e-9);
    EXPECT_LT(wedge(degrees, 0.5).turn(), 0.95 * degrees * degree);
    EXPECT_LT(wedge(degrees, 0.25).turn(), wedge(degrees, 0.5).turn());
  }
}

TEST(AnalyticWedge, LongPlateAcrossHasTheAnalyticJetsPressure) {
  const AnalyticJet jet(width, speed, density, 90.0 * degree);
  const AnalyticWedge plate = wedge(90.0, 50.0);
  for (double x = 0.0; x < 3.0 * width; x += 0.05 * width)
    EXPECT_NEAR(plate.pressure(x), jet.wall_pressure(x), 1e-5 * jet.stagnation_pressure()) << x;
  EXPECT_EQ(wedge(90.0, 1.0).pressure(1.001 * width), 0.0);
}

TEST(AnalyticWedge, RefusesNumbersThatMakeNone) {
  for (const double degrees : {0.0, 180.0, -10.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(wedge(degrees, 1.0), std::invalid_argument);
  EXPECT_THROW(wedge(60.0, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace impinge
