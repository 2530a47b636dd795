#include "impinge/method/time_step.hpp"

#include <algorithm>
#include <cmath>

namespace impinge {

void choose_time_step(const TimeSettings& time, double spacing, double acceleration, StepReport& report) {
  constexpr double first_courant = 0.05;
  constexpr double most_growth = 1.1;
  const double largest = time.cfl * spacing / report.max_speed;  // infinite at rest
  const double grown = report.dt > 0.0 ? most_growth * report.dt : first_courant / time.cfl * largest;
  const double fallen = time.cfl * std::sqrt(spacing / acceleration);  // infinite without a force
  report.dt = std::min({time.dt, largest, fallen, grown});
  if (report.halvings > 0) {
    report.dt = std::ldexp(report.dt, -report.halvings);
    report.limit = StepLimit::retry;
    return;
  }
  report.limit = report.dt == time.dt   ? StepLimit::case_dt
                 : report.dt == largest ? StepLimit::cfl
                 : report.dt == fallen  ? StepLimit::force
                                        : StepLimit::growth;
}

}  // namespace impinge
