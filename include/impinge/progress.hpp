#pragma once
// The progress line of a run.

#include <chrono>
#include <string>

#include "impinge/simulation.hpp"

namespace impinge {

/// Tells on the terminal how far a run is: the line renews itself there; in a file a new one is added now and then.
class Progress {
 public:
  /// `begin`, `end`: simulated time of the run's start and end [s]. `shown`: false on all ranks but one.
  Progress(double begin, double end, bool shown);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows the step if the last line is old enough, or if it is the last step.
  void update(const StepReport& report);

  /// Begins a new line, so that other text can be printed.
  void interrupt();

  /// "step 1250  t 1.0000/5.0000 s (20 %)  dt 8.0e-04 s (case)  5123 particles  9 iterations  1 min 02 s left".
  static std::string line(const StepReport& report, double end, double seconds_left);

 private:
  using Clock = std::chrono::steady_clock;

  double end_;
  bool shown_;
  bool terminal_;
  bool open_ = false;  // the cursor stands behind a line that is to be renewed
  Clock::time_point last_time_;
  double last_simulated_;
  double rate_ = 0.0;  // simulated over wall-clock time, smoothed
};

/// "4.2 s", "3 min 05 s", "2 h 07 min".
std::string duration_text(double seconds);

}  // namespace impinge
