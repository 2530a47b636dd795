#include "impinge/io/together.hpp"

namespace impinge {

void throw_together(MPI_Comm comm, const std::string& own_message) {
  const int ranks = ranks_of(comm);
  int first = own_message.empty() ? ranks : rank_of(comm);
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, comm);
  if (first == ranks) return;
  throw FileError(broadcast(comm, own_message, first));
}

}  // namespace impinge
