#pragma once
// Pressure and velocity at a point of the fluid, from the particles around.

#include <array>
#include <optional>

#include "impinge/core/vector.hpp"

namespace impinge {

template <int Dim>
struct FluidValue {
  double pressure = 0.0;  ///< [Pa]
  Vector<Dim> velocity;   ///< [m/s]
};

/// Weighted least squares of a linear function through the values of the particles around a point, with the weights of
/// the non-singular kernel. The sums of several ranks add up.
template <int Dim>
class FluidFit {
 public:
  static constexpr double radius = 2.6;     ///< beyond it a particle does not count [dp]
  static constexpr double in_fluid = 1.25;  ///< a point farther from every particle is outside the fluid [dp]

  /// Adds a particle at `offset` from the point [dp].
  void add(const Vector<Dim>& offset, const FluidValue<Dim>& value);

  /// The linear function at the point, exact for a linear field. The weighted mean where the point is outside the fluid
  /// or the particles do not span the space. Nothing where there is no particle.
  std::optional<FluidValue<Dim>> value() const;

  /// What add sums up.
  static constexpr std::size_t size = 2 + Dim + Dim * Dim + (1 + Dim) * (1 + Dim);
  std::array<double, size> sums{};  ///< near particles; w; w d; w d d^T; for each quantity q w and q w d
};

}  // namespace impinge
