#pragma once
// Forces per mass that act on the whole fluid.

#include "impinge/core/vector.hpp"
#include "impinge/method/settings.hpp"

namespace impinge {

/// Gravity.
template <int Dim>
class BodyForce {
 public:
  explicit BodyForce(const FluidSettings& fluid) {
    for (int k = 0; k < Dim; ++k) gravity_[k] = fluid.gravity[static_cast<std::size_t>(k)];
  }

  /// Acceleration at a position [m/s^2].
  Vector<Dim> at(const Vector<Dim>&) const { return gravity_; }

  /// Largest acceleration [m/s^2].
  double largest() const { return norm(gravity_); }

  bool is_zero() const { return gravity_ == Vector<Dim>{}; }

 private:
  Vector<Dim> gravity_;
};

}  // namespace impinge
