#pragma once
// What all ranks have together after a step.

#include <mpi.h>

#include <functional>

#include "impinge/method/settings.hpp"
#include "impinge/method/step_report.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

/// Puts counts, kinetic energy, largest speed and pressure, and the force on the wall particles that `on_floor` says
/// yes to into the report. Returns false where a velocity or a pressure is not a number. Collective.
template <int Dim>
bool measure_totals(MPI_Comm comm, const MethodSettings& settings, const Particles<Dim>& particles,
                    const std::function<bool(const Vector<Dim>&)>& on_floor, StepReport& report);

/// Time span over which the wall pressure has been averaged so far [s]; nothing yet where they are equal.
struct AveragingWindow {
  double begin = 0.0;
  double end = 0.0;
};

/// Adds p dt of a step to the pressure impulse of the wall particles. A step that does not follow on the window begins
/// a new one. Not collective.
template <int Dim>
void average_wall_pressure(const StepReport& report, AveragingWindow& window, Particles<Dim>& particles);

}  // namespace impinge
