#pragma once
// Whether the ranks of a run have a core each.

#include <mpi.h>

#include <string>

namespace impinge {

/// What to tell of `ranks` of a node with so many cores, `others` of which other processes use; empty where the ranks
/// have a core each.
std::string core_warning(int ranks, int cores, int others);

/// Warns where the ranks of a node outnumber its free cores and do not yield them while they wait. Collective.
void check_cores(MPI_Comm comm);

}  // namespace impinge
