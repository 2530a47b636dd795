#include "impinge/parallel.hpp"

#include <algorithm>
#include <numeric>

namespace impinge {

int rank_of(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

int ranks_of(MPI_Comm comm) {
  int size = 1;
  MPI_Comm_size(comm, &size);
  return size;
}

Exchange::Exchange(MPI_Comm comm, std::span<const std::pair<int, int>> runs) {
  // Tell every destination where in this rank's send buffer its run begins and how long it is.
  std::vector<PetscMPIInt> destinations;
  std::vector<int> places;
  for (const auto& [rank, count] : runs) {
    destinations.push_back(rank);
    places.insert(places.end(), {n_send_, count});
    n_send_ += count;
  }
  PetscMPIInt n_sources = 0;
  PetscMPIInt* sources = nullptr;
  int* source_places = nullptr;
  check(PetscCommBuildTwoSided(comm, 2, MPI_INT, static_cast<PetscMPIInt>(destinations.size()), destinations.data(),
                               places.data(), &n_sources, &sources, &source_places));
  std::vector<int> order(static_cast<std::size_t>(n_sources));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return sources[a] < sources[b]; });

  std::vector<PetscSFNode> remote;
  for (const int k : order)
    for (int item = 0; item < source_places[2 * k + 1]; ++item)
      remote.push_back({sources[k], source_places[2 * k] + item});
  check(PetscFree(sources));
  check(PetscFree(source_places));
  n_receive_ = static_cast<int>(remote.size());

  check(PetscSFCreate(comm, forest_.address()));
  check(PetscSFSetGraph(forest_, n_send_, n_receive_, nullptr, PETSC_COPY_VALUES, remote.data(), PETSC_COPY_VALUES));
  check(PetscSFSetUp(forest_));
}

void Exchange::forward_bytes(const void* send, void* receive, int item_bytes) const {
  if (forest_ == nullptr) return;
  MPI_Datatype item;
  MPI_Type_contiguous(item_bytes, MPI_BYTE, &item);
  MPI_Type_commit(&item);
  check(PetscSFBcastBegin(forest_, item, send, receive, MPI_REPLACE));
  check(PetscSFBcastEnd(forest_, item, send, receive, MPI_REPLACE));
  MPI_Type_free(&item);
}

void Exchange::begin_forward(const double* send, double* receive) const {
  if (forest_ != nullptr) check(PetscSFBcastBegin(forest_, MPI_DOUBLE, send, receive, MPI_REPLACE));
}

void Exchange::end_forward(const double* send, double* receive) const {
  if (forest_ != nullptr) check(PetscSFBcastEnd(forest_, MPI_DOUBLE, send, receive, MPI_REPLACE));
}

double sum_over_ranks(MPI_Comm comm, double value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_SUM, comm);
  return value;
}

std::int64_t sum_over_ranks(MPI_Comm comm, std::int64_t value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT64_T, MPI_SUM, comm);
  return value;
}

double max_over_ranks(MPI_Comm comm, double value) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, comm);
  return value;
}

std::string broadcast(MPI_Comm comm, std::string text, int root) {
  auto length = static_cast<std::int64_t>(text.size());
  MPI_Bcast(&length, 1, MPI_INT64_T, root, comm);
  text.resize(static_cast<std::size_t>(length));
  MPI_Bcast(text.data(), static_cast<int>(length), MPI_CHAR, root, comm);
  return text;
}

bool any_rank(MPI_Comm comm, bool value) { return max_over_ranks(comm, value ? 1.0 : 0.0) > 0.0; }

}  // namespace impinge
