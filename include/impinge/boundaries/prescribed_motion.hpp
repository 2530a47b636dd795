#pragma once
// Motions of rigid bodies in two dimensions: steady, harmonic, by a table.

#include <vector>

#include "impinge/boundaries/motion.hpp"

namespace impinge {

/// When a motion takes place, and the point that it turns a body about. Before the start the body stands where it is at
/// the start, after the end where it is at the end.
struct MotionFrame {
  Vector<2> center;   ///< where the pose is the identity; it moves with the body [m]
  double start, end;  ///< [s]
};

/// At a constant velocity of the centre [m/s] and a constant spin [rad/s], counter-clockwise.
Motion<2> steady_motion(const MotionFrame& frame, const Vector<2>& velocity, double spin);

/// A displacement and an angle that go as sin(2 pi f t + phase) with the time t since the start. For the time `ramp`
/// they rise to that, twice differentiable.
struct Oscillation {
  Vector<2> amplitude;  ///< [m]
  double angle;         ///< amplitude of the angle, counter-clockwise [rad]
  double frequency;     ///< f [Hz]
  double phase;         ///< [rad]
  double ramp;          ///< [s]
};
Motion<2> harmonic_motion(const MotionFrame& frame, const Oscillation& oscillation);

/// A displacement and an angle at a time.
struct MotionPoint {
  double time;      ///< since the start [s]
  Vector<2> shift;  ///< [m]
  double angle;     ///< counter-clockwise [rad]
};
/// By a cubic spline through at least two points whose times rise, at rest at the first and at the last of them.
Motion<2> table_motion(const MotionFrame& frame, const std::vector<MotionPoint>& points);

}  // namespace impinge
