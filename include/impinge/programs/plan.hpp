#pragma once
// What a case would cost on a number of ranks, found without running it.

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "impinge/cases/case.hpp"

namespace impinge {

/// One rank of a planned run, in its initial state.
struct RankPlan {
  std::int64_t work = 0;         ///< what the partition balances
  std::int64_t owned = 0;        ///< particles
  std::int64_t rows = 0;         ///< owned fluid and wall particles: those with neighbours and a row of the matrix
  std::int64_t halo = 0;         ///< copies of other ranks' particles, and periodic and mirror images
  std::int64_t received = 0;     ///< those of them that come from other ranks, not images of its own particles
  std::int64_t neighbours = 0;   ///< other ranks that it receives copies from
  std::int64_t nodes = 0;        ///< owned cells with particles, each a node of the two-level preconditioner's grid
  std::int64_t node_copies = 0;  ///< cells of other ranks whose coarse values it exchanges

  double field_bytes = 0.0;      ///< received when one double per halo particle is refreshed
  double step_bytes = 0.0;       ///< received per step in refreshes of the halo, but for the iterations of the solver
  double iteration_bytes = 0.0;  ///< received per solver iteration, the coarse solver's own traffic excepted; at most
  double memory = 0.0;           ///< of particles, pair lists, matrix, interpolation and arrays over all cells [bytes]
};

/// The decomposition with which a run on some number of ranks starts.
struct Plan {
  std::int64_t cells = 0;     ///< background cells, on every rank
  std::int64_t occupied = 0;  ///< cells with particles: vertices of the graph that is partitioned
  std::vector<RankPlan> ranks;
};

/// Decomposes the case's initial particles for `ranks` ranks, whatever the size of `comm`, as a run does: METIS gives
/// the run's own partition, PTScotch one of its kind. Needs memory for the cells, not for the particles. Collective.
template <int Dim>
Plan plan_run(MPI_Comm comm, const Case& config, int ranks);

}  // namespace impinge
