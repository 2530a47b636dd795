#pragma once
// Small value types that every level uses. SI units throughout.

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

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

/// A Dim x Dim matrix by rows [unit of its use].
template <int Dim>
struct Matrix {
  std::array<Vec<Dim>, Dim> row{};

  static Matrix identity() {
    Matrix result;
    for (int k = 0; k < Dim; ++k) result.row[static_cast<std::size_t>(k)][k] = 1.0;
    return result;
  }

  /// Adds a b^T.
  void add_product(const Vec<Dim>& a, const Vec<Dim>& b) {
    for (int k = 0; k < Dim; ++k) row[static_cast<std::size_t>(k)] += a[k] * b;
  }

  friend Matrix operator*(double factor, Matrix m) {
    for (Vec<Dim>& r : m.row) r *= factor;
    return m;
  }
  friend Vec<Dim> operator*(const Matrix& m, const Vec<Dim>& v) {
    Vec<Dim> result;
    for (int k = 0; k < Dim; ++k) result[k] = dot(m.row[static_cast<std::size_t>(k)], v);
    return result;
  }
};

/// The matrix with m adjugate(m) = determinant(m) identity.
inline Matrix<2> adjugate(const Matrix<2>& m) {
  return {{{{{m.row[1][1], -m.row[0][1]}}, {{-m.row[1][0], m.row[0][0]}}}}};
}
inline Matrix<3> adjugate(const Matrix<3>& m) {
  Matrix<3> result;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      const Vec<3>& one = m.row[static_cast<std::size_t>((c + 1) % 3)];
      const Vec<3>& two = m.row[static_cast<std::size_t>((c + 2) % 3)];
      result.row[static_cast<std::size_t>(r)][c] =
          one[(r + 1) % 3] * two[(r + 2) % 3] - one[(r + 2) % 3] * two[(r + 1) % 3];
    }
  }
  return result;
}

template <int Dim>
double determinant(const Matrix<Dim>& m) {
  const Matrix<Dim> adjoint = adjugate(m);
  double sum = 0.0;
  for (int k = 0; k < Dim; ++k) sum += m.row[0][k] * adjoint.row[static_cast<std::size_t>(k)][0];
  return sum;
}

/// Leaves new entries of a vector unwritten: memory beyond what is used then costs nothing.
template <class T>
struct UninitialisedAllocator : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = UninitialisedAllocator<U>;
  };
  template <class U, class... Arguments>
  void construct(U* place, Arguments&&... arguments) {
    ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
  }
  template <class U>
  void construct(U* place) {
    ::new (static_cast<void*>(place)) U;
  }
};

/// A vector whose new entries have no value.
template <class T>
using Buffer = std::vector<T, UninitialisedAllocator<T>>;

/// Axis-aligned box [m].
template <int Dim>
struct Box {
  Vec<Dim> low, high;
};

/// Where a periodic or mirror image stands: r' = sign r + shift along each axis.
template <int Dim>
struct Image {
  Vec<Dim> sign = all_ones();  // 1, or -1 where the axis is reflected
  Vec<Dim> shift;              // [m]

  bool reflects() const { return sign != all_ones(); }
  Vec<Dim> of_position(const Vec<Dim>& r) const { return of_direction(r) + shift; }
  Vec<Dim> of_direction(Vec<Dim> v) const {
    for (int k = 0; k < Dim; ++k) v[k] *= sign[k];
    return v;
  }
  friend bool operator==(const Image&, const Image&) = default;

 private:
  static Vec<Dim> all_ones() {
    Vec<Dim> ones;
    ones.component.fill(1.0);
    return ones;
  }
};

/// What a particle is. The values are those of the file format.
enum class ParticleType : std::uint8_t {
  fluid = 0,  ///< moves freely, carries a pressure unknown
  inlet = 1,  ///< rigid buffer that moves at the jet's speed, p = 0
  wall = 2,   ///< first row of a wall, with a pressure unknown; on a mirror: measures the pressure
  ghost = 3   ///< rows behind the wall row that complete number density and divergence
};

}  // namespace impinge
