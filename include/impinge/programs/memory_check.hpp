#pragma once
// Whether a case fits into the memory of this machine, found before anything is allocated.

#include <mpi.h>

#include <cstdint>

#include "impinge/cases/case.hpp"

namespace impinge {

/// What a case takes at its start, on each of its ranks.
struct MemoryNeed {
  double particles = 0.0;  ///< of every type, on all ranks; exact up to some 100,000, else from a sample
  double rank = 0.0;       ///< arrays of particles, pairs, matrix and cells, and libraries [bytes]
  double graph = 0.0;      ///< besides, where the cells are partitioned: the graph, and METIS with it [bytes]
};

/// `particles`: how many a checkpoint holds; 0: those of the case's start. Allocates little; not collective.
template <int Dim>
MemoryNeed memory_need(const Case& config, int ranks, std::int64_t particles = 0);

/// Memory that is free for each rank, the least over the ranks: by its own limit, and by its share of its node [bytes].
/// Collective.
double free_memory(MPI_Comm comm);

/// Throws InputError where a run of the case on `comm` needs more than is free, and warns where it will need more with
/// the preconditioner. Collective.
template <int Dim>
void check_memory(MPI_Comm comm, const Case& config, std::int64_t particles = 0);

/// Throws InputError where plan_run for so many ranks needs more than is free. Collective.
template <int Dim>
void check_memory_of_plan(MPI_Comm comm, const Case& config, int ranks);

}  // namespace impinge
