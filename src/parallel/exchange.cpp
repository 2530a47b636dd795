#include "impinge/parallel/exchange.hpp"

#include <algorithm>
#include <numeric>

namespace impinge {

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
  petsc_check(PetscCommBuildTwoSided(comm, 2, MPI_INT, static_cast<PetscMPIInt>(destinations.size()),
                                     destinations.data(), places.data(), &n_sources, &sources, &source_places));
  std::vector<int> order(static_cast<std::size_t>(n_sources));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return sources[a] < sources[b]; });

  std::vector<PetscSFNode> remote;
  for (const int k : order)
    for (int item = 0; item < source_places[2 * k + 1]; ++item)
      remote.push_back({sources[k], source_places[2 * k] + item});
  petsc_check(PetscFree(sources));
  petsc_check(PetscFree(source_places));
  n_receive_ = static_cast<int>(remote.size());

  petsc_check(PetscSFCreate(comm, forest_.address()));
  petsc_check(
      PetscSFSetGraph(forest_, n_send_, n_receive_, nullptr, PETSC_COPY_VALUES, remote.data(), PETSC_COPY_VALUES));
  petsc_check(PetscSFSetUp(forest_));
}

void Exchange::forward_bytes(const void* send, void* receive, int item_bytes) const {
  if (forest_ == nullptr) return;
  MPI_Datatype item;
  MPI_Type_contiguous(item_bytes, MPI_BYTE, &item);
  MPI_Type_commit(&item);
  petsc_check(PetscSFBcastBegin(forest_, item, send, receive, MPI_REPLACE));
  petsc_check(PetscSFBcastEnd(forest_, item, send, receive, MPI_REPLACE));
  MPI_Type_free(&item);
}

void Exchange::begin_forward(const double* send, double* receive) const {
  if (forest_ != nullptr) petsc_check(PetscSFBcastBegin(forest_, MPI_DOUBLE, send, receive, MPI_REPLACE));
}

void Exchange::end_forward(const double* send, double* receive) const {
  if (forest_ != nullptr) petsc_check(PetscSFBcastEnd(forest_, MPI_DOUBLE, send, receive, MPI_REPLACE));
}

}  // namespace impinge
