#pragma once
// Fields of all ranks on every rank, for the comparisons of the tests.

#include <map>
#include <numeric>
#include <optional>

#include "impinge/parallel/exchange.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

/// The items of all ranks, in the order of the ranks. Collective.
template <class T>
std::vector<T> gather(MPI_Comm comm, const std::vector<T>& own) {
  static_assert(std::is_trivially_copyable_v<T>);
  const int bytes = static_cast<int>(own.size() * sizeof(T));
  std::vector<int> counts(static_cast<std::size_t>(ranks_of(comm))), starts(counts.size());
  MPI_Allgather(&bytes, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  std::exclusive_scan(counts.begin(), counts.end(), starts.begin(), 0);
  std::vector<T> all(static_cast<std::size_t>(starts.back() + counts.back()) / sizeof(T));
  MPI_Allgatherv(own.data(), bytes, MPI_BYTE, all.data(), counts.data(), starts.data(), MPI_BYTE, comm);
  return all;
}

/// `field` of the owned particles of all ranks, or of those of a type, by id. Collective.
template <int Dim, class T>
std::map<std::int64_t, T> gather_by_id(MPI_Comm comm, const Particles<Dim>& particles, const std::vector<T>& field,
                                       std::optional<ParticleType> type = std::nullopt) {
  struct Item {
    std::int64_t id;
    T value;
  };
  std::vector<Item> own;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
    if (!type || particles.type[i] == *type) own.push_back({particles.id[i], field[i]});
  std::map<std::int64_t, T> result;
  for (const Item& item : gather(comm, own)) result.emplace(item.id, item.value);
  return result;
}

}  // namespace impinge
