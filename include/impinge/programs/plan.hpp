#pragma once
// What a case would cost on a number of ranks, found without running it.

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "impinge/cases/case.hpp"
#include "impinge/parallel/cell_owners.hpp"

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
  std::int64_t coarse_values = 0;  ///< received per solver iteration: residuals where it solves, corrections at its nodes

  double field_bytes = 0.0;      ///< received when one double per halo particle is refreshed
  double step_bytes = 0.0;       ///< received per step in refreshes of the halo, but for the iterations of the solver
  double iteration_bytes = 0.0;  ///< received per solver iteration, the coarse solver's cycle excepted; at most
  double memory = 0.0;           ///< of particles, pair lists, matrix, interpolation and segments [bytes]
};

/// The decomposition with which a run on some number of ranks starts.
struct Plan {
  std::int64_t cells = 0;     ///< background cells
  std::int64_t occupied = 0;  ///< cells with particles
  Partitioner partitioner{};  ///< that distributes them
  int key_bits = 0;           ///< of a place on the curve: sums over the ranks in which it is cut
  std::int64_t segments = 0;  ///< of the owners of the cells
  std::vector<RankPlan> ranks;

  /// What a rank holds that grows with the ranks: the segments twice (decomposition, preconditioner) [bytes].
  std::int64_t table_bytes() const { return 2 * segments * static_cast<std::int64_t>(sizeof(Segment)); }
};

/// Decomposes the case's initial particles for `ranks` ranks, whatever the size of `comm`, as a run does: METIS
/// or the curve the run's own partition, PTScotch one of its kind. Needs memory for the cells with particles, on rank
/// 0. Collective.
template <int Dim>
Plan plan_run(MPI_Comm comm, const Case& config, int ranks);

}  // namespace impinge
