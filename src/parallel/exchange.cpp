#include "impinge/parallel/exchange.hpp"

#include <algorithm>

namespace impinge {
namespace {

constexpr int tag = 1;

}  // namespace

Exchange::Exchange(MPI_Comm comm, std::span<const std::pair<int, int>> runs) : comm_(comm) {
  const int self = rank_of(comm);
  std::vector<PetscMPIInt> destinations;
  std::vector<int> counts;
  for (const auto& [rank, count] : runs) {
    const Run run{rank, n_send_, count};
    n_send_ += count;
    if (rank == self) {
      own_send_ = own_receive_ = run;
    } else if (count > 0) {
      sends_.push_back(run);
      destinations.push_back(rank);
      counts.push_back(count);
    }
  }
  PetscMPIInt n_sources = 0;
  PetscMPIInt* sources = nullptr;
  int* source_counts = nullptr;
  petsc_check(PetscCommBuildTwoSided(comm, 1, MPI_INT, static_cast<PetscMPIInt>(destinations.size()),
                                     destinations.data(), counts.data(), &n_sources, &sources, &source_counts));
  for (int k = 0; k < n_sources; ++k) receives_.push_back({sources[k], 0, source_counts[k]});
  petsc_check(PetscFree(sources));
  petsc_check(PetscFree(source_counts));
  std::ranges::sort(receives_, {}, &Run::rank);
  bool is_after_own = false;
  for (Run& run : receives_) {
    if (!is_after_own && run.rank > self) {
      is_after_own = true;
      own_receive_.first = n_receive_;
      n_receive_ += own_receive_.count;
    }
    run.first = n_receive_;
    n_receive_ += run.count;
  }
  if (is_after_own) return;
  own_receive_.first = n_receive_;
  n_receive_ += own_receive_.count;
}

void Exchange::begin(const void* send, void* receive, MPI_Datatype item, std::size_t item_bytes) const {
  const auto* from = static_cast<const std::byte*>(send);
  auto* to = static_cast<std::byte*>(receive);
  const auto place = [&](const Run& run) { return static_cast<std::size_t>(run.first) * item_bytes; };
  requests_.resize(receives_.size() + sends_.size());
  MPI_Request* request = requests_.data();
  for (const Run& run : receives_) MPI_Irecv(to + place(run), run.count, item, run.rank, tag, comm_, request++);
  for (const Run& run : sends_) MPI_Isend(from + place(run), run.count, item, run.rank, tag, comm_, request++);
  if (own_send_.count > 0)
    std::memcpy(to + place(own_receive_), from + place(own_send_),
                static_cast<std::size_t>(own_send_.count) * item_bytes);
}

void Exchange::end() const { MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE); }

void Exchange::forward_bytes(const void* send, void* receive, int item_bytes) const {
  MPI_Datatype item;
  MPI_Type_contiguous(item_bytes, MPI_BYTE, &item);
  MPI_Type_commit(&item);
  begin(send, receive, item, static_cast<std::size_t>(item_bytes));
  end();
  MPI_Type_free(&item);
}

void Exchange::begin_forward(const double* send, double* receive) const {
  begin(send, receive, MPI_DOUBLE, sizeof(double));
}

void Exchange::end_forward() const { end(); }

}  // namespace impinge
