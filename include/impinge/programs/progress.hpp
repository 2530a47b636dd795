#pragma once
// The progress line of a run.

#include <chrono>
#include <string>

#include "impinge/method/simulation.hpp"

namespace impinge {

/// Tells now and then how far a run is: every 5 s, and more seldom the longer the run takes.
class Progress {
 public:
  /// `begin`, `end`: simulated time of the run's start and end [s]. `shown`: false on all ranks but one.
  Progress(double begin, double end, bool shown);

  /// Prints a line if the last one is old enough, or if this is the last step.
  void update(const StepReport& report);

  /// "step 1250  t 1/5 s (20 %)  dt 8.00e-04 s (case)  5123 particles  9 iterations  1 min 02 s left".
  static std::string line(const StepReport& report, double end, double seconds_left);

 private:
  using Clock = std::chrono::steady_clock;

  double end_;
  bool shown_;
  Clock::time_point start_;
  Clock::time_point last_time_;
  double last_simulated_;
  double rate_ = 0.0;  // simulated over wall-clock time, smoothed
};

/// "4.2 s", "3 min 05 s", "2 h 07 min", "11 d 03 h"; "unknown time" for what is no time.
std::string duration_text(double seconds);

}  // namespace impinge
