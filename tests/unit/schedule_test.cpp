// The times at which a run has something to do.

#include "impinge/programs/schedule.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace impinge {
namespace {

Case with(double end, double snapshots, double checkpoints, double average_start) {
  Case config;
  config.time.end = end;
  config.output.interval = snapshots;
  config.checkpoint.interval = checkpoints;
  config.average_start = average_start;
  return config;
}

std::vector<double> times_of(const Schedule& schedule, double time = 0.0) {
  std::vector<double> times;
  while (!schedule.is_over(time)) times.push_back(time = schedule.next(time));
  return times;
}

TEST(Schedule, HasSnapshotsCheckpointsTheAverageAndTheEnd) {
  const Schedule schedule(with(1.0, 0.4, 0.25, 0.6));
  EXPECT_EQ(times_of(schedule), (std::vector{0.25, 0.4, 0.5, 0.6, 0.75, 0.8, 1.0}));
  EXPECT_EQ(times_of(schedule, 0.51), (std::vector{0.6, 0.75, 0.8, 1.0}));
  EXPECT_TRUE(schedule.has_snapshot(0.8));
  EXPECT_FALSE(schedule.has_checkpoint(0.8));
  EXPECT_TRUE(schedule.has_checkpoint(0.75));
  EXPECT_FALSE(schedule.has_snapshot(0.75));
  EXPECT_FALSE(schedule.has_snapshot(0.6));
}

TEST(Schedule, WithoutIntervalsIsTheAverageAndTheEnd) {
  const Schedule schedule(with(1e-5, 0.0, 0.0, 0.0));
  EXPECT_EQ(times_of(schedule), std::vector{1e-5});
  EXPECT_FALSE(schedule.has_snapshot(1e-5));
  EXPECT_EQ(times_of(Schedule(with(1e5, 0.0, 0.0, 8e4))), (std::vector{8e4, 1e5}));
}

// 3 * 0.1 > 0.3 and 0.7 - 0.1 < 0.6: multiples and ends that rounding keeps apart are one time.
TEST(Schedule, RoundingAddsNoTime) {
  for (const double interval : {0.1, 0.01, 1e-3, 0.7 / 3.0}) {
    for (int count = 1; count <= 300; ++count) {
      const double end = count * interval;
      const auto times = times_of(Schedule(with(end, interval, 2.0 * interval, 0.8 * end)));
      EXPECT_EQ(times.back(), end);
      for (std::size_t k = 1; k < times.size(); ++k) EXPECT_GT(times[k] - times[k - 1], 1e-3 * interval);
    }
  }
}

// 3 * 3.33333333 < 10 by 1e-8.
TEST(Schedule, HasNoTinyStepBeforeTheEnd) {
  Case config = with(10.0, 3.33333333, 0.0, 0.0);
  config.time.dt = 1e-3;
  EXPECT_EQ(times_of(Schedule(config)), (std::vector{3.33333333, 6.66666666, 10.0}));
  config.output.interval = 3.333;  // a step of one dt is left
  EXPECT_EQ(times_of(Schedule(config)), (std::vector{3.333, 6.666, 9.999, 10.0}));
}

}  // namespace
}  // namespace impinge
