#include "impinge/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace impinge {

std::string duration_text(double seconds) {
  if (seconds < 60.0) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<long>(seconds + 0.5);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

Progress::Progress(double begin, double end, bool shown)
    : end_(end),
      shown_(shown),
      terminal_(isatty(STDOUT_FILENO) != 0),
      last_time_(Clock::now()),
      last_simulated_(begin) {}

Progress::~Progress() { interrupt(); }

void Progress::update(const StepReport& report) {
  if (!shown_) return;
  const double elapsed = std::chrono::duration<double>(Clock::now() - last_time_).count();
  const double interval = terminal_ ? 0.5 : 10.0;
  if (elapsed < interval && report.time < end_) return;
  const double rate = (report.time - last_simulated_) / elapsed;
  rate_ = rate_ == 0.0 ? rate : 0.7 * rate_ + 0.3 * rate;
  last_time_ += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(elapsed));
  last_simulated_ = report.time;
  const std::string text = line(report, end_, (end_ - report.time) / rate_);
  fmt::print("{}{}{}", terminal_ ? "\r\x1b[K" : "", text, terminal_ ? "" : "\n");
  std::fflush(stdout);
  open_ = terminal_;
}

void Progress::interrupt() {
  if (open_) fmt::print("\n");
  open_ = false;
}

std::string Progress::line(const StepReport& report, double end, double seconds_left) {
  return fmt::format("step {}  t {:.4f}/{:.4f} s ({:.0f} %)  dt {:.2e} s ({})  {} particles  {} iterations  {} left",
                     report.step, report.time, end, 100.0 * report.time / end, report.dt,
                     report.limit == StepLimit::cfl ? "CFL" : "case", report.particles, report.pressure.iterations,
                     duration_text(std::max(seconds_left, 0.0)));
}

}  // namespace impinge
