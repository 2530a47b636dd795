#include "impinge/programs/schedule.hpp"

#include <algorithm>
#include <cmath>

namespace impinge {
namespace {

constexpr double least_step = 0.01;  // before the end, over time.dt: pressure sources go as 1/dt

}  // namespace

Schedule::Schedule(const Case& config)
    : snapshots_(config.output.interval),
      checkpoints_(config.checkpoint.interval),
      average_start_(config.average_start),
      end_(config.time.end),
      tolerance_(1e-9 * config.time.end),
      least_step_(least_step * std::min(config.time.dt, config.time.end)) {
  for (const double interval : {snapshots_, checkpoints_})
    if (interval > 0.0) least_step_ = std::min(least_step_, least_step * interval);
}

double Schedule::next(double time) const {
  const double passed = time + tolerance_;
  double first = average_start_ > passed ? average_start_ : end_;
  for (const double interval : {snapshots_, checkpoints_})
    if (interval > 0.0) first = std::min(first, (std::floor(passed / interval) + 1.0) * interval);
  return first > end_ - std::max(tolerance_, least_step_) ? end_ : first;
}

bool Schedule::is_multiple(double time, double interval) const {
  return interval > 0.0 && std::abs(time - std::round(time / interval) * interval) <= tolerance_;
}

}  // namespace impinge
