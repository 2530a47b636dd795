#pragma once
// The times of a run at which something is due.

#include "impinge/cases/case.hpp"

namespace impinge {

/// Snapshots and checkpoints at the multiples of their intervals, the start of the wall-pressure average, and the end.
/// It remembers nothing: a restarted run has the same times. Times that differ by 1e-9 of the end are one, and so are
/// the end and what is due less than a hundredth of time.dt before it.
class Schedule {
 public:
  explicit Schedule(const Case& config);

  /// The first time after `time` at which anything is due [s].
  double next(double time) const;

  bool has_snapshot(double time) const { return is_multiple(time, snapshots_); }
  bool has_checkpoint(double time) const { return is_multiple(time, checkpoints_); }
  bool is_over(double time) const { return time >= end_ - tolerance_; }

 private:
  bool is_multiple(double time, double interval) const;

  double snapshots_;    // interval [s]; 0: none
  double checkpoints_;  // likewise
  double average_start_;
  double end_;
  double tolerance_;   // [s]
  double least_step_;  // the last one [s]
};

}  // namespace impinge
