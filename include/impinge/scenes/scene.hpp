#pragma once
// Where particles are at the start, where they enter and where they leave.

#include <functional>
#include <memory>

#include "impinge/particles/cell_grid.hpp"
#include "impinge/particles/particles.hpp"
#include "impinge/programs/case.hpp"

namespace impinge {

/// Fluid particles that passed the open boundaries on this rank in one step.
struct BoundaryFlow {
  std::int64_t entered = 0;
  std::int64_t left = 0;
};

/// What an inlet remembers from step to step.
struct InletState {
  double last_row = 0.0;  ///< distance of the hindmost buffer row from the inlet plane, along the flow [m]
  std::int64_t next_id = 0;
};

/// The scene of a case. Walls of particles: the surface lies half a spacing in front of the row of wall particles, and
/// ghost rows stand behind it. Mirror walls: the surface is an edge of the bounds, and wall particles on it measure the
/// pressure.
template <int Dim>
class Geometry {
 public:
  virtual ~Geometry() = default;

  /// The region that particles may occupy [m]; one outside it is lost.
  virtual Box<Dim> bounds() const = 0;

  /// What is beyond the bounds.
  virtual Edges<Dim> edges() const { return {}; }

  /// Appends this rank's share of the initial particles, anywhere in space; the shares of all ranks make the whole, the
  /// same for every number of ranks.
  virtual void fill(int rank, int ranks, Particles<Dim>& particles) const = 0;

  /// Velocity of the inlet buffer [m/s].
  virtual Vector<Dim> inlet_velocity() const { return {}; }

  /// Lets inlet particles that crossed the inlet plane become fluid, removes fluid past the outlets, and adds the rows
  /// that the inlet needs after a step of `dt` [s]; a new particle is added where `owns` says its position is this
  /// rank's. Particles have no halo. Not collective.
  virtual BoundaryFlow move_boundaries(double /*dt*/, Particles<Dim>& /*particles*/,
                                       const std::function<bool(const Vector<Dim>&)>& /*owns*/) {
    return {};
  }

  /// The inlet after the steps so far, to be set in a run that goes on from there.
  virtual InletState inlet() const { return {}; }
  virtual void set_inlet(const InletState&) {}

  /// Unit normal of the wall, into the fluid, at one of its wall particles [-]; between the walls' normals in a corner.
  virtual Vector<Dim> wall_normal(const Vector<Dim>& /*position*/) const { return {}; }

  /// True for a wall particle of the plate or floor, whose force the history gives.
  virtual bool on_floor(const Vector<Dim>& /*position*/) const { return false; }
};

/// The geometry that the case names. Throws InputError where it does not exist in Dim dimensions.
template <int Dim>
std::unique_ptr<Geometry<Dim>> make_geometry(const Case& config);

}  // namespace impinge
