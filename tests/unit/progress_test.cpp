// The text of the progress line.

#include "impinge/programs/progress.hpp"

#include <gtest/gtest.h>

namespace impinge {
namespace {

TEST(Progress, SaysDurationsInTheUnitsOfTheirSize) {
  EXPECT_EQ(duration_text(4.21), "4.2 s");
  EXPECT_EQ(duration_text(185.4), "3 min 05 s");
  EXPECT_EQ(duration_text(2 * 3600.0 + 7 * 60.0), "2 h 07 min");
}

TEST(Progress, SaysStepTimeStepLimitParticlesIterationsAndTimeLeft) {
  StepReport report;
  report.step = 1250;
  report.time = 1.0;
  report.dt = 8e-4;
  report.particles = 5123;
  report.pressure.iterations = 9;
  EXPECT_EQ(Progress::line(report, 5.0, 62.0),
            "step 1250  t 1.0000/5.0000 s (20 %)  dt 8.00e-04 s (case)  5123 particles  9 iterations  1 min 02 s left");
  report.limit = StepLimit::cfl;
  EXPECT_NE(Progress::line(report, 5.0, 62.0).find("(CFL)"), std::string::npos);
}

}  // namespace
}  // namespace impinge
