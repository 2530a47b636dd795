#pragma once
// A numbered axis-aligned lattice.

#include <array>
#include <cstdint>

#include "impinge/core/vector.hpp"

namespace impinge {

/// Points of an axis-aligned lattice of `extent` points whose first point is half a spacing inside the corner `low`,
/// numbered with the last axis fastest.
template <int Dim>
struct BoxLattice {
  Vector<Dim> low{};  ///< [m]
  std::array<std::int64_t, Dim> extent{};
  double spacing = 0.0;  ///< [m]

  std::int64_t count() const {
    std::int64_t points = 1;
    for (const auto n : extent) points *= n;
    return points;
  }
  std::array<std::int64_t, Dim> coordinates(std::int64_t k) const {
    std::array<std::int64_t, Dim> at;
    for (std::size_t axis = Dim; axis-- > 0;) {
      at[axis] = k % extent[axis];
      k /= extent[axis];
    }
    return at;
  }
  Vector<Dim> point(std::int64_t k) const {
    const auto at = coordinates(k);
    Vector<Dim> position;
    for (int axis = 0; axis < Dim; ++axis)
      position[axis] = low[axis] + (static_cast<double>(at[static_cast<std::size_t>(axis)]) + 0.5) * spacing;
    return position;
  }
};

}  // namespace impinge
