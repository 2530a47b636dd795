#pragma once
// How velocities move particles, and what changes velocities besides the pressure.

#include "impinge/method/body_force.hpp"
#include "impinge/method/settings.hpp"
#include "impinge/method/state.hpp"

namespace impinge {

/// The rule by which a change of velocity in a step moves a particle: r_new = r + dt (u_old + share (u_new - u_old)).
/// share = 1/2: the mean of both velocities, second order in time; 1: the new one.
struct MotionRule {
  double dt;         ///< [s]
  double new_share;  ///< share of the new velocity [-]

  MotionRule(const TimeSettings& time, double dt_) : dt(dt_), new_share(time.mean_velocity ? 0.5 : 1.0) {}

  /// What a change of velocity u - u* [m/s] after advance() moves a particle by [m].
  template <int Dim>
  Vector<Dim> displacement(const Vector<Dim>& change) const {
    return new_share * dt * change;
  }
};

/// u* = u + dt (nu lap u + g) for the fluid, with the pairs of the last step. `laplacian_factor`: 2 Dim/(n0 lambda)
/// [1/m^2]. Positions are moved back by what advance() moves too far by the rule. Collective.
template <int Dim>
void accelerate(const MotionRule& rule, const BodyForce<Dim>& force, double viscosity, double laplacian_factor,
                State<Dim>& state);

/// Fluid particles that are about to come too near to each other bounce. `spacing`: dp [m]. Collective.
template <int Dim>
void collide(const CollisionSettings& collision, double spacing, double dt, State<Dim>& state);

/// r* = r + dt u*, for the fluid and the blocks of the inlets. Not collective.
template <int Dim>
void advance(double dt, Particles<Dim>& particles);

}  // namespace impinge
