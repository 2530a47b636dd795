#pragma once
// What all ranks of a communicator do together, in one line.

#include <mpi.h>

#include <cstdint>
#include <string>

namespace impinge {

/// This process' number, and how many there are. Not collective.
int rank_of(MPI_Comm comm);
int ranks_of(MPI_Comm comm);

/// What a launcher's variables say of this process: its number, and how many it has started; 0 of 1 where there is
/// none. `variable`: the one that says how many. Needs no MPI.
struct LaunchedProcess {
  int rank = 0;
  int processes = 1;
  std::string variable;
};
LaunchedProcess launched_process();

/// Sum, maximum over the ranks. Collective.
double sum_over_ranks(MPI_Comm comm, double value);
std::int64_t sum_over_ranks(MPI_Comm comm, std::int64_t value);
double max_over_ranks(MPI_Comm comm, double value);

/// The text of rank `root`. Collective.
std::string broadcast(MPI_Comm comm, std::string text, int root);

/// True if it is true on any rank. Collective.
bool any_rank(MPI_Comm comm, bool value);

/// Calls use(k) for this rank's share of 0 <= k < count.
template <class Use>
void for_share(std::int64_t count, int rank, int ranks, Use&& use) {
  for (std::int64_t k = count * rank / ranks; k < count * (rank + 1) / ranks; ++k) use(k);
}

}  // namespace impinge
