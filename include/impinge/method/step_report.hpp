#pragma once
// What a step tells of itself.

#include <array>
#include <cstdint>

#include "impinge/method/pressure/solver.hpp"

namespace impinge {

/// What bounds the time step.
enum class StepLimit { case_dt, cfl, growth, retry, force, target };
inline constexpr std::array step_limit_names{"case", "CFL", "growth", "retry", "force", "target"};

/// Totals over all ranks after a step.
struct StepReport {
  std::int64_t step = 0;
  double time = 0.0;                     ///< [s]
  double dt = 0.0;                       ///< [s]
  double free_dt = 0.0;                  ///< what it would be if no target were near [s]
  StepLimit limit = StepLimit::case_dt;  ///< what dt was bounded by
  std::int64_t particles = 0;            ///< of every type
  std::int64_t fluid = 0;                ///< stored
  std::int64_t in = 0;                   ///< fluid at the start and through the inlets since
  std::int64_t out = 0;                  ///< fluid through the outlets
  std::int64_t lost = 0;                 ///< fluid that left the bounds elsewhere and was removed
  double kinetic_energy = 0.0;           ///< of the fluid [J; J/m in 2D]
  double max_speed = 0.0;                ///< of the fluid [m/s]
  double max_pressure = 0.0;             ///< [Pa]
  double floor_force = 0.0;              ///< pressure force on plate or floor [N; N/m in 2D]
  PressureReport pressure;
  int cold_solves = 0;  ///< pressure solves of the step that were repeated from zero with a new preconditioner
  int halvings = 0;     ///< how often the step was repeated with half the time step
};

}  // namespace impinge
