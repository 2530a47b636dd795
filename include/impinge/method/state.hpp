#pragma once
// What the phases of a step work on.

#include <vector>

#include "impinge/boundaries/mirror_walls.hpp"
#include "impinge/core/vector.hpp"
#include "impinge/method/pressure/solver.hpp"
#include "impinge/parallel/decomposition.hpp"
#include "impinge/particles/neighbours.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

/// Particles, their neighbours, and what these say of them. In arrays over all particles the owned ones come first,
/// then the halo, then the mirror images.
template <int Dim>
struct State {
  Particles<Dim> particles;
  Decomposition<Dim> decomposition;
  MirrorWalls<Dim> walls;
  NeighbourSearch<Dim> search;
  std::vector<Vector<Dim>> wall_normal;  ///< zero but at wall particles; all particles. Empty if walls are mirrors

  // Measured with the neighbours, see measure_density.
  std::vector<Vector<Dim>> asymmetry;   ///< F_i; all particles
  std::vector<Matrix<Dim>> correction;  ///< L_i; owned
  std::vector<PressureRole> role;       ///< owned and halo

  const PairList& near() const { return search.near(); }
  std::size_t owned() const { return static_cast<std::size_t>(particles.owned); }
  bool moves(std::size_t i) const { return particles.type[i] == ParticleType::fluid; }

  /// Copies a field of the owned particles to halo and images. Collective.
  template <class T>
  void refresh(std::vector<T>& field) const {
    decomposition.halo().refresh(field, particles.owned);
    walls.copy(field);
  }

  /// Likewise a field of directions, which the mirrors turn. Collective.
  void refresh_directions(std::vector<Vector<Dim>>& field) const {
    decomposition.halo().refresh(field, particles.owned);
    walls.copy_directions(field);
  }

  /// Likewise the velocities, which move with the walls. Collective.
  void refresh_velocities() {
    decomposition.halo().refresh(particles.velocity, particles.owned);
    walls.copy_velocities(particles.position, particles.velocity);
  }

  /// Likewise the positions. Collective.
  void refresh_positions() {
    decomposition.refresh_positions(particles);
    walls.copy_positions(particles.position);
  }
};

}  // namespace impinge
