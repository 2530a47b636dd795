#pragma once
// The length of a step; docs/method.md (1).

#include "impinge/method/settings.hpp"
#include "impinge/method/step_report.hpp"

namespace impinge {

/// The longest that the coming step can be, whatever moves: time.dt, and 1.1 times what the last step would have been
/// without a target [s].
double longest_step(const TimeSettings& time, const StepReport& report);

/// Sets dt and its limit for the coming step from the last one's report: at most longest_step(), CFL dp/U with the
/// largest `speed` U of fluid and walls [m/s], and CFL sqrt(dp/|g|) under the largest `acceleration` [m/s^2]; the first
/// has a Courant number of at most 0.05, for an impact may be about to change the speeds. A step that is repeated has
/// half of it for every halving. Where `target` [s], a time after the report's, is at most ten steps away, steps of
/// equal length end there: the last one's dt is exactly what remains. `spacing`: dp [m].
void choose_time_step(const TimeSettings& time, double spacing, double speed, double acceleration, double target,
                      StepReport& report);

}  // namespace impinge
