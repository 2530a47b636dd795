#pragma once
// Prescribed motions of rigid walls.

#include <functional>

#include "impinge/core/vector.hpp"

namespace impinge {

/// Where a rigid body is at a time, and how it moves. A body at rest has the default pose.
template <int Dim>
struct Pose {
  Matrix<Dim> rotation = Matrix<Dim>::identity();  ///< a point r of the body is at rotation r + shift
  Vector<Dim> shift;                               ///< [m]
  Vector<Dim> velocity;                            ///< of the body's point at the origin [m/s]
  Matrix<Dim> spin;                                ///< antisymmetric: a point at x moves at velocity + spin x [1/s]
  Vector<Dim> acceleration;                        ///< of the body's point at the origin [m/s^2]
  Matrix<Dim> bend;  ///< spin' + spin spin: a point at x accelerates by acceleration + bend x [1/s^2]

  Vector<Dim> of_position(const Vector<Dim>& r) const { return rotation * r + shift; }
  /// The point r that is at x [m].
  Vector<Dim> origin_of(const Vector<Dim>& x) const {
    const Vector<Dim> offset = x - shift;
    Vector<Dim> result;
    for (int k = 0; k < Dim; ++k) result += offset[k] * rotation.row[static_cast<std::size_t>(k)];
    return result;
  }
  Vector<Dim> of_direction(const Vector<Dim>& r) const { return rotation * r; }
  Vector<Dim> velocity_at(const Vector<Dim>& x) const { return velocity + spin * x; }
  Vector<Dim> acceleration_at(const Vector<Dim>& x) const { return acceleration + bend * x; }
};

/// The pose at a time [s]; twice differentiable.
template <int Dim>
using Motion = std::function<Pose<Dim>(double time)>;

}  // namespace impinge
