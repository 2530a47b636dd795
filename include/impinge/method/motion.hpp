#pragma once
// How velocities move particles, docs/method.md (2), and what changes velocities besides the pressure.

#include <span>
#include <vector>

#include "impinge/boundaries/inlet.hpp"
#include "impinge/method/body_force.hpp"
#include "impinge/method/damping.hpp"
#include "impinge/method/settings.hpp"
#include "impinge/method/state.hpp"

namespace impinge {

/// How a step moves particles: for the time `before` until the pressure is known, then for `after`. A change of
/// velocity in the step moves a particle by `before` times the change. With the new velocity (paper) before = dt: by dt
/// u*, then by dt (u - u*). With the mean velocity both are dt/2: by dt/2 u_old, then by dt/2 u_new, so that the
/// pressure acts in the middle of the step (position Verlet): second order in time, and it neither damps nor feeds an
/// oscillation.
struct MotionRule {
  double dt;      ///< [s]
  double before;  ///< [s]
  double after;   ///< [s]

  MotionRule(const TimeSettings& time, double dt_)
      : dt(dt_), before(time.mean_velocity ? 0.5 * dt_ : dt_), after(dt_ - before) {}
};

/// u* = u + dt g for the fluid, with what viscosity changes and the damping takes. The body force is that where the
/// pressure will act. `viscous`: of the owned particles, see viscous_change; empty without viscosity [m/s]. Positions
/// are moved back by what advance() moves too far by the rule. Not collective.
template <int Dim>
void accelerate(const MotionRule& rule, const BodyForce<Dim>& force, const DampingZones<Dim>& damping,
                std::span<const Vector<Dim>> viscous, State<Dim>& state);

/// Fluid particles that are about to come too near to each other bounce. `spacing`: dp [m]. Collective.
template <int Dim>
void collide(const CollisionSettings& collision, double spacing, double dt, State<Dim>& state);

/// r += dt u, for the fluid and the blocks of the inlets. Not collective.
template <int Dim>
void advance(double dt, std::vector<Inlet<Dim>>& inlets, Particles<Dim>& particles);

}  // namespace impinge
