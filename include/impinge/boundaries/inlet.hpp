#pragma once
// Where fluid enters and leaves.

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "impinge/core/vector.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

/// A speed at a time.
struct SpeedEntry {
  double time = 0.0;   ///< [s]
  double speed = 0.0;  ///< [m/s]
};

/// A rigid block of rows of inlet particles that moves through a plane; what has passed it is fluid. A row is added
/// behind each time the block has moved by a spacing. Before it starts and after it has stopped there are no rows.
template <int Dim>
struct Inlet {
  Vector<Dim> corner;                                  ///< origin of the cross-section, on the inlet plane [m]
  Vector<Dim> direction;                               ///< of the flow, a unit vector normal to the plane [-]
  std::array<Vector<Dim>, Dim - 1> across{};           ///< unit vectors that span the plane [-]
  std::vector<std::array<double, Dim - 1>> section{};  ///< particles of a row along these [m]
  double speed = 0.0;                                  ///< now [m/s]
  double spacing = 0.0;                                ///< of the rows [m]
  int rows = 0;                                        ///< behind the plane
  double last_row = 0.0;  ///< distance of the hindmost row from the plane, along the flow; negative [m]

  /// Of a round section around the corner, which lies in its middle: its radii [m]. Every row is turned against the
  /// last, so that the particles of several make no thread.
  double radius = 0.0, inner_radius = 0.0;

  std::string name{};
  std::vector<SpeedEntry> speeds{};  ///< linear in between, constant before and after; empty: `speed` is constant
  double start = -std::numeric_limits<double>::infinity();  ///< [s]
  double stop = std::numeric_limits<double>::infinity();    ///< [s]
  bool blows = true;                                        ///< now

  bool blows_at(double time) const { return start <= time && time < stop; }
  /// Its speed at a time while it blows [m/s].
  double speed_at(double time) const;
  /// True where speed and rows do not depend on the time.
  bool is_steady() const { return speeds.empty() && !has_times(); }
  /// last_row where there are no rows [m].
  double no_row() const { return 0.5 * spacing; }

  Vector<Dim> velocity() const { return speed * direction; }
  Vector<Dim> at(double distance, const std::array<double, Dim - 1>& place) const {
    Vector<Dim> position = corner + distance * direction;
    for (std::size_t k = 0; k < place.size(); ++k) position += place[k] * across[k];
    return position;
  }
  /// True where the hindmost row stands as pass_open_boundaries leaves it, or less than a row farther: a step ends with
  /// the second part of its way.
  bool is_in_place() const {
    constexpr double rounding = 1e-6;
    if (has_times() && last_row == no_row()) return true;
    const double behind = last_row / spacing + rows;  // the plane that a new row would stand on [rows]
    return behind >= -rounding && behind <= 2.0;
  }
  /// Where a particle of the section stands in the row that begins with an id [m].
  Vector<Dim> in_row(double distance, std::size_t k, std::int64_t first_id) const;
  double distance_past(const Vector<Dim>& position) const { return dot(position - corner, direction); }
  /// How far a position is outside the block, half a spacing around its particles [m]; 0 inside.
  double distance_from_block(const Vector<Dim>& position) const;

 private:
  bool has_times() const {
    return start > -std::numeric_limits<double>::max() || stop < std::numeric_limits<double>::max();
  }
};

/// Fluid beyond a plane, or in a region, leaves.
template <int Dim>
struct Outlet {
  Vector<Dim> point;   ///< on the plane [m]
  Vector<Dim> normal;  ///< out of the fluid, a unit vector [-]

  std::function<bool(const Vector<Dim>&)> region{};  ///< in the place of the plane
  std::string name{};
  std::int64_t out = 0;  ///< fluid particles that have left, of all ranks; of a region

  bool has_passed(const Vector<Dim>& position) const {
    return region ? region(position) : dot(position - point, normal) > 0.0;
  }
};

/// Fluid particles that passed the open boundaries on this rank in one step.
struct BoundaryFlow {
  std::int64_t entered = 0;
  std::int64_t left = 0;
  std::vector<std::int64_t> left_by{};  ///< each outlet
};

/// Sets what inlets do at a time [s], and the velocity of their particles. Not collective.
template <int Dim>
void set_inlets(double time, std::vector<Inlet<Dim>>& inlets, Particles<Dim>& particles);

/// Lets inlet particles that crossed their plane become fluid, removes those of inlets that do not blow and fluid past
/// the outlets, and adds the rows that the inlets need behind their last, with ids from `next_id` on; a new particle is
/// added where `owns` says its position is this rank's. Particles have no halo. Not collective; last_row and next_id
/// stay the same on every rank.
template <int Dim>
BoundaryFlow pass_open_boundaries(std::vector<Inlet<Dim>>& inlets, const std::vector<Outlet<Dim>>& outlets,
                                  std::int64_t& next_id, Particles<Dim>& particles,
                                  const std::function<bool(const Vector<Dim>&)>& owns);

}  // namespace impinge
