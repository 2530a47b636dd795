#pragma once
// File errors of one rank, thrown by all.

#include <mpi.h>

#include <string>

#include "impinge/core/errors.hpp"
#include "impinge/core/mpi.hpp"

namespace impinge {

/// Throws FileError on all ranks with the message of the first rank that has one; does nothing if none has. Collective.
void throw_together(MPI_Comm comm, const std::string& own_message);

/// Does what may throw FileError on any rank; if it did, throws it on all. Collective.
template <class Action>
void together(MPI_Comm comm, Action&& action) {
  std::string failure;
  try {
    action();
  } catch (const FileError& error) {
    failure = error.what();
  }
  throw_together(comm, failure);
}

/// The same, for what rank 0 does alone. Collective.
template <class Action>
void on_first_rank(MPI_Comm comm, Action&& action) {
  together(comm, [&] {
    if (rank_of(comm) == 0) action();
  });
}

}  // namespace impinge
