#pragma once
// Means and numbers that may be missing.

#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "impinge/particles/particles.hpp"

namespace impinge {

/// Nothing of a number that is not finite.
inline std::optional<double> if_finite(double value) {
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// True where position, velocity and pressure of a particle are finite.
template <int Dim>
bool is_finite(const Particles<Dim>& particles, std::size_t i) {
  bool finite = std::isfinite(particles.pressure[i]);
  for (int k = 0; k < Dim; ++k)
    finite = finite && std::isfinite(particles.position[i][k]) && std::isfinite(particles.velocity[i][k]);
  return finite;
}

inline double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Standard deviation; not a number of a single value.
inline double scatter_of(const std::vector<double>& values) {
  const double mean = mean_of(values);
  double squares = 0.0;
  for (const double value : values) squares += std::pow(value - mean, 2);
  return std::sqrt(squares / (static_cast<double>(values.size()) - 1.0));
}

}  // namespace impinge
