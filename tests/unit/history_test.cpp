// The columns of the history.

#include "impinge/observe/history.hpp"

#include <gtest/gtest.h>

namespace impinge {
namespace {

TEST(History, ARowHasAValueForEveryName) {
  EXPECT_EQ(history_header(),
            "step,t,dt,limit,particles,fluid,in,out,lost,kinetic_energy,max_speed,max_pressure,plate_force,iterations,"
            "residual,cold_solves,halvings,seconds");
  StepReport report;
  report.step = 3;
  report.time = 0.1;
  report.dt = 0.05;
  report.limit = StepLimit::cfl;
  report.particles = 40;
  report.fluid = 30;
  report.in = 35;
  report.out = 5;
  report.lost = 1;
  report.kinetic_energy = 2.5;
  report.max_speed = 1.5;
  report.max_pressure = 1000.0;
  report.floor_force = -7.0;
  report.pressure.iterations = 12;
  report.pressure.residual = 1.25e-7;
  report.cold_solves = 1;
  report.halvings = 2;
  EXPECT_EQ(history_row(report, 0.5),
            "3,0.10000000000000001,0.050000000000000003,CFL,40,30,35,5,1,2.5,1.5,1000,-7,12,1.250e-07,1,2,0.5000");
}

TEST(History, DescribesEveryColumn) {
  const std::string text = describe_history();
  for (const HistoryColumn& column : history_columns()) {
    EXPECT_NE(text.find(std::string("  ") + column.name + " "), std::string::npos) << column.name;
    EXPECT_NE(text.find(column.meaning), std::string::npos) << column.name;
  }
}

}  // namespace
}  // namespace impinge
