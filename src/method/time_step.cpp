#include "impinge/method/time_step.hpp"

#include <algorithm>
#include <cmath>

namespace impinge {
namespace {

constexpr double most_growth = 1.1;  // of a step over the one before
constexpr double rounding = 1e-6;    // by which dt may be longer than its limits, so that rounding adds no step

/// The longest step of at most `dt` of which a whole number fills the `rest` of the time, where that is few steps.
double fitted(double dt, double rest) {
  constexpr double few_steps = 10.0;  // the first of them is shorter than the one before by a tenth at most
  const double steps = std::max(1.0, std::ceil(rest / dt - rounding));
  return steps <= few_steps ? rest / steps : dt;
}

}  // namespace

double longest_step(const TimeSettings& time, const StepReport& report) {
  return report.free_dt > 0.0 ? std::min(time.dt, most_growth * report.free_dt) : time.dt;
}

void choose_time_step(const TimeSettings& time, double spacing, double speed, double acceleration, double target,
                      StepReport& report) {
  constexpr double first_courant = 0.05;
  const double largest = time.cfl * spacing / speed;  // infinite at rest
  const double grown = report.free_dt > 0.0 ? most_growth * report.free_dt : first_courant / time.cfl * largest;
  const double fallen = time.cfl * std::sqrt(spacing / acceleration);  // infinite without a force
  const double free = std::min({time.dt, largest, fallen, grown});
  report.limit = report.halvings > 0 ? StepLimit::retry
                 : free == time.dt   ? StepLimit::case_dt
                 : free == largest   ? StepLimit::cfl
                 : free == fallen    ? StepLimit::force
                                     : StepLimit::growth;
  report.free_dt = std::ldexp(free, -report.halvings);
  report.dt = fitted(report.free_dt, target - report.time);
  if (report.dt < (1.0 - rounding) * report.free_dt) report.limit = StepLimit::target;
}

}  // namespace impinge
