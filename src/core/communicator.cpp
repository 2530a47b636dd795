#include "impinge/core/communicator.hpp"

namespace impinge {

Communicator Communicator::of(MPI_Comm comm, bool belongs) {
  MPI_Comm part = MPI_COMM_NULL;
  MPI_Comm_split(comm, belongs ? 0 : MPI_UNDEFINED, 0, &part);
  return Communicator(part);
}

}  // namespace impinge
