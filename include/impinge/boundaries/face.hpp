#pragma once
// Planes, reflections at them, and the faces that a line is reflected at.

#include <algorithm>
#include <array>
#include <compare>
#include <span>

#include "impinge/core/vector.hpp"

namespace impinge {

/// A plane: the fluid is where (x - point).normal > 0.
template <int Dim>
struct Face {
  Vector<Dim> point;   ///< on the face [m]
  Vector<Dim> normal;  ///< unit vector into the fluid [-]

  /// Signed distance of a position, positive in the fluid [m].
  double distance(const Vector<Dim>& position) const { return dot(position - point, normal); }
};

/// An affine map x -> linear x + shift: a reflection, or one after the other.
template <int Dim>
struct Reflection {
  Matrix<Dim> linear = Matrix<Dim>::identity();
  Vector<Dim> shift;  ///< [m]

  Vector<Dim> of_position(const Vector<Dim>& r) const { return linear * r + shift; }
};

/// The reflection at a plane.
template <int Dim>
Reflection<Dim> reflection_at(const Face<Dim>& plane);

/// x -> outer(inner(x)).
template <int Dim>
Reflection<Dim> product(const Reflection<Dim>& outer, const Reflection<Dim>& inner);

/// A face near a particle.
struct NearFace {
  int face;
  double distance;  ///< to the face itself, not negative [m]
  double height;    ///< distance to the face or its continuation, positive on its wet side [m]
};

/// Where a curved face is nearest to a particle before it.
template <int Dim>
struct Foot {
  Vector<Dim> point;    ///< [m]
  Vector<Dim> normal;   ///< of the face there, into the fluid [-]
  double height = 0.0;  ///< of the particle [m]
  Matrix<Dim> bending;  ///< slope of the normal along the face, positive where it bulges into the fluid [1/m]
};

/// Where a path meets a curved face.
template <int Dim>
struct Meeting {
  Face<Dim> plane;      ///< touches the face there
  Matrix<Dim> bending;  ///< of the face there, see Foot [1/m]
  double share = 0.0;   ///< of the pair in sums: that of a ray tube, see MirrorWalls [-]
};

/// The walls of a scene: WallFaces<2> and WallFaces<3>.
template <int Dim>
class WallFaces;

/// Faces, by their numbers, that a line is reflected at on its way from a particle, in this order.
struct MirrorPath {
  static constexpr int longest = 4;

  std::array<int, longest> face{};
  int count = 0;

  MirrorPath then(int next) const {
    MirrorPath result = *this;
    result.face[static_cast<std::size_t>(result.count++)] = next;
    return result;
  }
  MirrorPath reversed() const {
    MirrorPath result;
    for (int k = count; k-- > 0;) result = result.then(face[static_cast<std::size_t>(k)]);
    return result;
  }
  std::span<const int> faces() const { return {face.data(), static_cast<std::size_t>(count)}; }
  friend auto operator<=>(const MirrorPath&, const MirrorPath&) = default;
};

}  // namespace impinge
