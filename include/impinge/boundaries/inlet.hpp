#pragma once
// Where fluid enters and leaves.

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "impinge/core/vector.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

/// A rigid block of rows of inlet particles that moves through a plane; what has passed it is fluid. A row is added
/// behind each time the block has moved by a spacing.
template <int Dim>
struct Inlet {
  Vector<Dim> corner;                                  ///< origin of the cross-section, on the inlet plane [m]
  Vector<Dim> direction;                               ///< of the flow, a unit vector normal to the plane [-]
  std::array<Vector<Dim>, Dim - 1> across{};           ///< unit vectors that span the plane [-]
  std::vector<std::array<double, Dim - 1>> section{};  ///< particles of a row along these [m]
  double speed = 0.0;                                  ///< [m/s]
  double spacing = 0.0;                                ///< of the rows [m]
  int rows = 0;                                        ///< behind the plane
  double last_row = 0.0;  ///< distance of the hindmost row from the plane, along the flow; negative [m]

  Vector<Dim> velocity() const { return speed * direction; }
  Vector<Dim> at(double distance, const std::array<double, Dim - 1>& place) const {
    Vector<Dim> position = corner + distance * direction;
    for (std::size_t k = 0; k < place.size(); ++k) position += place[k] * across[k];
    return position;
  }
  /// True where the hindmost row stands as pass_open_boundaries leaves it, up to rounding.
  bool is_in_place() const {
    constexpr double rounding = 1e-6;
    const double behind = last_row / spacing + rows;  // the plane that a new row would stand on [rows]
    return behind >= -rounding && behind <= 1.0 + rounding;
  }
  double distance_past(const Vector<Dim>& position) const { return dot(position - corner, direction); }
};

/// Fluid beyond the plane leaves.
template <int Dim>
struct Outlet {
  Vector<Dim> point;   ///< on the plane [m]
  Vector<Dim> normal;  ///< out of the fluid, a unit vector [-]

  bool has_passed(const Vector<Dim>& position) const { return dot(position - point, normal) > 0.0; }
};

/// Fluid particles that passed the open boundaries on this rank in one step.
struct BoundaryFlow {
  std::int64_t entered = 0;
  std::int64_t left = 0;
};

/// Lets inlet particles that crossed their plane become fluid, removes fluid past the outlets, and adds the rows that
/// the inlets need behind their last, with ids from `next_id` on; a new particle is added where `owns` says its
/// position is this rank's. Particles have no halo. Not collective; last_row and next_id stay the same on every rank.
template <int Dim>
BoundaryFlow pass_open_boundaries(std::vector<Inlet<Dim>>& inlets, const std::vector<Outlet<Dim>>& outlets,
                                  std::int64_t& next_id, Particles<Dim>& particles,
                                  const std::function<bool(const Vector<Dim>&)>& owns);

}  // namespace impinge
