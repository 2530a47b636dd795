#pragma once
// Forces per mass that act on the whole fluid.

#include <mpi.h>

#include "impinge/core/vector.hpp"
#include "impinge/method/settings.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

/// Gravity, constant or from a table in time, and a central force -B^2 (r - centre), at one time.
template <int Dim>
class BodyForce {
 public:
  /// `time` [s].
  BodyForce(const FluidSettings& fluid, double time);

  /// Acceleration at a position [m/s^2].
  Vector<Dim> at(const Vector<Dim>& position) const {
    return pull_ == 0.0 ? gravity_ : gravity_ - pull_ * (position - centre_);
  }

  /// Of the acceleration [1/s^2].
  double divergence() const { return -Dim * pull_; }

  bool is_zero() const { return pull_ == 0.0 && gravity_ == Vector<Dim>{}; }

  /// Largest acceleration of a fluid particle [m/s^2]. Collective.
  double largest(MPI_Comm comm, const Particles<Dim>& particles) const;

 private:
  Vector<Dim> gravity_;
  Vector<Dim> centre_;
  double pull_;  // B^2 [1/s^2]
};

}  // namespace impinge
