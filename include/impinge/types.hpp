#pragma once
// Small value types that every level uses. SI units throughout.

#include <array>
#include <cmath>
#include <cstdint>

namespace impinge {

/// A point or vector in Dim dimensions [unit of its use].
template <int Dim>
struct Vec {
  std::array<double, Dim> component{};

  double& operator[](int k) { return component[static_cast<std::size_t>(k)]; }
  double operator[](int k) const { return component[static_cast<std::size_t>(k)]; }

  Vec& operator+=(const Vec& other) {
    for (int k = 0; k < Dim; ++k) (*this)[k] += other[k];
    return *this;
  }
  Vec& operator-=(const Vec& other) {
    for (int k = 0; k < Dim; ++k) (*this)[k] -= other[k];
    return *this;
  }
  Vec& operator*=(double factor) {
    for (int k = 0; k < Dim; ++k) (*this)[k] *= factor;
    return *this;
  }
  friend Vec operator+(Vec a, const Vec& b) { return a += b; }
  friend Vec operator-(Vec a, const Vec& b) { return a -= b; }
  friend Vec operator*(double factor, Vec a) { return a *= factor; }
  friend bool operator==(const Vec&, const Vec&) = default;
};

template <int Dim>
double dot(const Vec<Dim>& a, const Vec<Dim>& b) {
  double sum = 0.0;
  for (int k = 0; k < Dim; ++k) sum += a[k] * b[k];
  return sum;
}

template <int Dim>
double norm(const Vec<Dim>& a) {
  return std::sqrt(dot(a, a));
}

/// Axis-aligned box [m].
template <int Dim>
struct Box {
  Vec<Dim> low, high;
};

/// What a particle is. The values are those of the file format.
enum class ParticleType : std::uint8_t {
  fluid = 0,  ///< moves freely, carries a pressure unknown
  inlet = 1,  ///< rigid buffer that moves at the jet's speed, p = 0
  wall = 2,   ///< first row of a wall, carries a pressure unknown
  ghost = 3   ///< rows behind the wall row that complete number density and divergence
};

}  // namespace impinge
