#pragma once
// The length of a step.

#include "impinge/method/settings.hpp"
#include "impinge/method/step_report.hpp"

namespace impinge {

/// Sets dt and its limit for the coming step from the last one's report: at most time.dt, CFL dp/|u|max, CFL
/// sqrt(dp/|g|) under the largest `acceleration` [m/s^2], and 1.1 times what the last step would have been without a
/// target; the first has a Courant number of at most 0.05, for an impact may be about to change the speeds. A step that
/// is repeated has half of it for every halving. Where `target` [s], a time after the report's, is at most ten steps
/// away, steps of equal length end there: the last one's dt is exactly what remains. `spacing`: dp [m].
void choose_time_step(const TimeSettings& time, double spacing, double acceleration, double target, StepReport& report);

}  // namespace impinge
