#include "impinge/programs/progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace impinge {

std::string duration_text(double seconds) {
  if (!(seconds < 1e12)) return "unknown time";
  if (seconds < 0.95) return fmt::format("{:.2g} s", seconds);
  if (seconds < 59.95) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<long>(seconds + 0.5);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  if (whole < 48 * 3600) return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
  return fmt::format("{} d {:02} h", whole / 86400, whole % 86400 / 3600);
}

Progress::Progress(double begin, double end, bool shown)
    : end_(end), shown_(shown), start_(Clock::now()), last_time_(start_), last_simulated_(begin) {}

void Progress::update(const StepReport& report) {
  if (!shown_) return;
  const auto now = Clock::now();
  const auto seconds = [&](Clock::time_point since) { return std::chrono::duration<double>(now - since).count(); };
  const double elapsed = seconds(last_time_);
  if (elapsed < std::max(5.0, 0.01 * seconds(start_)) && report.time < end_) return;
  const double rate = (report.time - last_simulated_) / elapsed;
  rate_ = rate_ == 0.0 ? rate : 0.5 * (rate_ + rate);
  last_time_ = now;
  last_simulated_ = report.time;
  fmt::print("{}\n", line(report, end_, std::max((end_ - report.time) / rate_, 0.0)));
  std::fflush(stdout);
}

std::string Progress::line(const StepReport& report, double end, double seconds_left) {
  return fmt::format("step {}  t {:.6g}/{:.6g} s ({:.0f} %)  dt {:.2e} s ({})  {} particles  {} iterations  {} left",
                     report.step, report.time, end, std::floor(100.0 * report.time / end), report.dt,
                     step_limit_names[static_cast<std::size_t>(report.limit)], report.particles,
                     report.pressure.iterations, duration_text(seconds_left));
}

}  // namespace impinge
