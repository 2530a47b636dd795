#include "impinge/programs/schedule.hpp"

#include <algorithm>
#include <cmath>

namespace impinge {

Schedule::Schedule(const Case& config)
    : snapshots_(config.output.interval),
      checkpoints_(config.checkpoint.interval),
      average_start_(config.average_start),
      end_(config.time.end),
      tolerance_(1e-9 * config.time.end) {}

double Schedule::next(double time) const {
  const double passed = time + tolerance_;
  double first = average_start_ > passed ? average_start_ : end_;
  for (const double interval : {snapshots_, checkpoints_})
    if (interval > 0.0) first = std::min(first, (std::floor(passed / interval) + 1.0) * interval);
  return is_over(first) ? end_ : first;
}

bool Schedule::is_multiple(double time, double interval) const {
  return interval > 0.0 && std::abs(time - std::round(time / interval) * interval) <= tolerance_;
}

}  // namespace impinge
