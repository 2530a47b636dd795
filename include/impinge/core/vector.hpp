#pragma once
// Points, vectors, matrices and boxes in two and three dimensions. SI units throughout.

#include <array>
#include <cmath>

namespace impinge {

/// A point or vector in Dim dimensions [unit of its use]; of one number each, or of several side by side (Lanes).
template <int Dim, class Number = double>
struct Vector {
  std::array<Number, Dim> component{};

  Number& operator[](int k) { return component[static_cast<std::size_t>(k)]; }
  Number operator[](int k) const { return component[static_cast<std::size_t>(k)]; }

  Vector& operator+=(const Vector& other) {
    for (int k = 0; k < Dim; ++k) (*this)[k] += other[k];
    return *this;
  }
  Vector& operator-=(const Vector& other) {
    for (int k = 0; k < Dim; ++k) (*this)[k] -= other[k];
    return *this;
  }
  Vector& operator*=(Number factor) {
    for (int k = 0; k < Dim; ++k) (*this)[k] *= factor;
    return *this;
  }
  friend Vector operator+(Vector a, const Vector& b) { return a += b; }
  friend Vector operator-(Vector a, const Vector& b) { return a -= b; }
  friend Vector operator*(Number factor, Vector a) { return a *= factor; }
  friend bool operator==(const Vector&, const Vector&) = default;
};

template <int Dim, class Number>
Number dot(const Vector<Dim, Number>& a, const Vector<Dim, Number>& b) {
  Number sum{};
  for (int k = 0; k < Dim; ++k) sum += a[k] * b[k];
  return sum;
}

template <int Dim>
double norm(const Vector<Dim>& a) {
  return std::sqrt(dot(a, a));
}

/// A Dim x Dim matrix by rows [unit of its use].
template <int Dim, class Number = double>
struct Matrix {
  std::array<Vector<Dim, Number>, Dim> row{};

  static Matrix identity() {
    Matrix result;
    for (int k = 0; k < Dim; ++k) result.row[static_cast<std::size_t>(k)][k] = 1.0;
    return result;
  }

  /// Adds a b^T.
  void add_product(const Vector<Dim, Number>& a, const Vector<Dim, Number>& b) {
    for (int k = 0; k < Dim; ++k) row[static_cast<std::size_t>(k)] += a[k] * b;
  }

  friend bool operator==(const Matrix&, const Matrix&) = default;
  friend Matrix operator*(Number factor, Matrix m) {
    for (Vector<Dim, Number>& r : m.row) r *= factor;
    return m;
  }
  friend Vector<Dim, Number> operator*(const Matrix& m, const Vector<Dim, Number>& v) {
    Vector<Dim, Number> result;
    for (int k = 0; k < Dim; ++k) result[k] = dot(m.row[static_cast<std::size_t>(k)], v);
    return result;
  }
};

template <int Dim>
double trace(const Matrix<Dim>& m) {
  double sum = 0.0;
  for (int k = 0; k < Dim; ++k) sum += m.row[static_cast<std::size_t>(k)][k];
  return sum;
}

/// Trace of m m.
template <int Dim>
double trace_of_square(const Matrix<Dim>& m) {
  double sum = 0.0;
  for (int k = 0; k < Dim; ++k)
    for (int l = 0; l < Dim; ++l) sum += m.row[static_cast<std::size_t>(k)][l] * m.row[static_cast<std::size_t>(l)][k];
  return sum;
}

/// The matrix with m adjugate(m) = determinant(m) identity.
inline Matrix<2> adjugate(const Matrix<2>& m) {
  return {{{{{m.row[1][1], -m.row[0][1]}}, {{-m.row[1][0], m.row[0][0]}}}}};
}
inline Matrix<3> adjugate(const Matrix<3>& m) {
  Matrix<3> result;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      const Vector<3>& one = m.row[static_cast<std::size_t>((c + 1) % 3)];
      const Vector<3>& two = m.row[static_cast<std::size_t>((c + 2) % 3)];
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

/// a x b: positive where b points to the left of a.
inline double cross(const Vector<2>& a, const Vector<2>& b) { return a[0] * b[1] - a[1] * b[0]; }

/// a x b, normal to both; in a right-handed sense.
inline Vector<3> cross(const Vector<3>& a, const Vector<3>& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

/// Turned by 90 degrees, counter-clockwise.
inline Vector<2> turned_left(const Vector<2>& a) { return {{-a[1], a[0]}}; }

/// Axis-aligned box [m].
template <int Dim>
struct Box {
  Vector<Dim> low, high;

  /// Corner k of 2^Dim: bit d of k says which end of axis d.
  Vector<Dim> corner(int k) const {
    Vector<Dim> result;
    for (int axis = 0; axis < Dim; ++axis) result[axis] = (k >> axis) & 1 ? high[axis] : low[axis];
    return result;
  }

  /// True within the box and a margin around it, on the surface too.
  bool contains(const Vector<Dim>& point, double margin = 0.0) const {
    for (int axis = 0; axis < Dim; ++axis)
      if (!(point[axis] >= low[axis] - margin && point[axis] <= high[axis] + margin)) return false;
    return true;
  }
};

}  // namespace impinge
