#pragma once
// A simulation of a case in its scene.

#include "impinge/cases/case.hpp"
#include "impinge/method/simulation.hpp"
#include "impinge/scenes/scenes.hpp"

namespace impinge {

/// Starts the case, or goes on from a checkpoint. See Simulation. Collective.
template <int Dim>
Simulation<Dim> make_simulation(MPI_Comm comm, const Case& config, const Checkpoint<Dim>* checkpoint = nullptr) {
  return Simulation<Dim>(comm, config, make_scene<Dim>(config, config), checkpoint);
}

}  // namespace impinge
