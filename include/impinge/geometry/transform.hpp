#pragma once
// Where a shape of a scene is put.

#include <cmath>
#include <numbers>
#include <utility>

#include "impinge/core/vector.hpp"

namespace impinge {

/// Cosine and sine of an angle [deg], exact at multiples of 90 degrees.
inline std::pair<double, double> cosine_and_sine(double degrees) {
  const double quarters = std::round(degrees / 90.0);
  const double rest = (degrees - 90.0 * quarters) * std::numbers::pi / 180.0;
  const double cosine = std::cos(rest), sine = std::sin(rest);
  const double turn = quarters - 4.0 * std::floor(quarters / 4.0);
  if (turn == 0.0) return {cosine, sine};
  if (turn == 1.0) return {-sine, cosine};
  if (turn == 2.0) return {-cosine, -sine};
  return {sine, -cosine};
}

/// The matrix that turns a vector counter-clockwise by an angle [deg].
inline Matrix<2> rotation(double degrees) {
  const auto [cosine, sine] = cosine_and_sine(degrees);
  return {{{{{cosine, -sine}}, {{sine, cosine}}}}};
}

/// The matrix that turns a vector by an angle [deg] about a unit vector, counter-clockwise as seen against it.
inline Matrix<3> rotation(const Vector<3>& axis, double degrees) {
  const auto [cosine, sine] = cosine_and_sine(degrees);
  Matrix<3> result = cosine * Matrix<3>::identity();
  result.add_product((1.0 - cosine) * axis, axis);
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3, last = (k + 2) % 3;
    result.row[static_cast<std::size_t>(last)][next] += sine * axis[k];
    result.row[static_cast<std::size_t>(next)][last] -= sine * axis[k];
  }
  return result;
}

/// Scales and turns about a point, then moves.
template <int Dim>
struct Transform {
  double scale = 1.0;  ///< positive [-]
  Matrix<Dim> rotation = Matrix<Dim>::identity();
  Vector<Dim> about{};      ///< the point that scaling and turning leave where it is [m]
  Vector<Dim> translate{};  ///< [m]

  Vector<Dim> operator()(const Vector<Dim>& point) const {
    return about + scale * (rotation * (point - about)) + translate;
  }

  /// The point that is moved to this one [m].
  Vector<Dim> origin_of(const Vector<Dim>& point) const {
    const Vector<Dim> turned = 1.0 / scale * (point - about - translate);
    Vector<Dim> offset;
    for (int k = 0; k < Dim; ++k) offset += turned[k] * rotation.row[static_cast<std::size_t>(k)];
    return about + offset;
  }
};

}  // namespace impinge
