// The text of the progress line.

#include "impinge/programs/progress.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace impinge {
namespace {

TEST(Progress, SaysDurationsInTheUnitsOfTheirSize) {
  EXPECT_EQ(duration_text(4.21), "4.2 s");
  EXPECT_EQ(duration_text(185.4), "3 min 05 s");
  EXPECT_EQ(duration_text(2 * 3600.0 + 7 * 60.0), "2 h 07 min");
  EXPECT_EQ(duration_text(0.0), "0 s");
  EXPECT_EQ(duration_text(0.00412), "0.0041 s");
  EXPECT_EQ(duration_text(59.99), "1 min 00 s");
  EXPECT_EQ(duration_text(3599.7), "1 h 00 min");
  EXPECT_EQ(duration_text(1e6), "11 d 13 h");
  EXPECT_EQ(duration_text(HUGE_VAL), "unknown time");
  EXPECT_EQ(duration_text(std::nan("")), "unknown time");
}

TEST(Progress, SaysStepTimeStepLimitParticlesIterationsAndTimeLeft) {
  StepReport report;
  report.step = 1250;
  report.time = 1.0;
  report.dt = 8e-4;
  report.particles = 5123;
  report.pressure.iterations = 9;
  EXPECT_EQ(Progress::line(report, 5.0, 62.0),
            "step 1250  t 1/5 s (20 %)  dt 8.00e-04 s (case)  5123 particles  9 iterations  1 min 02 s left");
  report.time = 1.23456789e-6;
  EXPECT_NE(Progress::line(report, 2e-6, 62.0).find("  t 1.23457e-06/2e-06 s (61 %)  "), std::string::npos);
  report.time = 99999.9;
  EXPECT_NE(Progress::line(report, 1e5, 62.0).find("  t 99999.9/100000 s (99 %)  "), std::string::npos);
  report.limit = StepLimit::cfl;
  EXPECT_NE(Progress::line(report, 5.0, 62.0).find("(CFL)"), std::string::npos);
}

}  // namespace
}  // namespace impinge
