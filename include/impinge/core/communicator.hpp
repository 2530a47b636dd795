#pragma once
// Communicators of some of the ranks.

#include <mpi.h>

#include <utility>

namespace impinge {

/// Owns a communicator, or none.
class Communicator {
 public:
  Communicator() = default;

  /// Takes it over.
  explicit Communicator(MPI_Comm comm) : comm_(comm) {}

  /// The ranks of `comm` that belong, in their order; none on the others. Collective.
  static Communicator of(MPI_Comm comm, bool belongs);

  Communicator(Communicator&& other) noexcept : comm_(std::exchange(other.comm_, MPI_COMM_NULL)) {}
  Communicator& operator=(Communicator&& other) noexcept {
    std::swap(comm_, other.comm_);
    return *this;
  }

  /// Collective on its ranks.
  ~Communicator() {
    if (comm_ != MPI_COMM_NULL) MPI_Comm_free(&comm_);
  }

  operator MPI_Comm() const { return comm_; }

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
};

}  // namespace impinge
