#pragma once
// Motions of rigid bodies: steady, harmonic, by a table.

#include <vector>

#include "impinge/boundaries/motion.hpp"

namespace impinge {

/// When a motion takes place, and what it turns a body about. Before the start the body stands where it is at the
/// start, after the end where it is at the end.
template <int Dim>
struct MotionFrame {
  Vector<Dim> center;                    ///< where the pose is the identity; it moves with the body [m]
  double start = 0.0, end = 0.0;         ///< [s]
  Vector<3> axis = {{{0.0, 0.0, 1.0}}};  ///< a unit vector; angles are counter-clockwise as seen against it [-]
};

/// At a constant velocity of the centre [m/s] and a constant spin [rad/s].
template <int Dim>
Motion<Dim> steady_motion(const MotionFrame<Dim>& frame, const Vector<Dim>& velocity, double spin);

/// A displacement and an angle that go as sin(2 pi f t + phase) with the time t since the start. For the time `ramp`
/// they rise to that, twice differentiable.
template <int Dim>
struct Oscillation {
  Vector<Dim> amplitude;  ///< [m]
  double angle;           ///< amplitude of the angle [rad]
  double frequency;       ///< f [Hz]
  double phase;           ///< [rad]
  double ramp;            ///< [s]
};
template <int Dim>
Motion<Dim> harmonic_motion(const MotionFrame<Dim>& frame, const Oscillation<Dim>& oscillation);

/// A displacement and an angle at a time.
template <int Dim>
struct MotionPoint {
  double time;        ///< since the start [s]
  Vector<Dim> shift;  ///< [m]
  double angle;       ///< [rad]
};
/// By a cubic spline through at least two points whose times rise, at rest at the first and at the last of them.
template <int Dim>
Motion<Dim> table_motion(const MotionFrame<Dim>& frame, const std::vector<MotionPoint<Dim>>& points);

}  // namespace impinge
