#pragma once
// Communication patterns. An Exchange moves packed items between ranks; a Halo refreshes copies with it.

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "impinge/core/mpi.hpp"
#include "impinge/core/petsc.hpp"

namespace impinge {

/// A one-way pattern: each rank sends a run of items to some ranks (itself included) and receives runs from others,
/// ordered by the sender's rank.
class Exchange {
 public:
  /// Nobody sends anything.
  Exchange() = default;

  /// `runs`: (destination rank, number of items) in the order in which the items stand in the send buffer.
  /// Collective.
  Exchange(MPI_Comm comm, std::span<const std::pair<int, int>> runs);

  int n_send() const { return n_send_; }
  int n_receive() const { return n_receive_; }

  /// Copies send[0, n_send) of every rank to receive[0, n_receive). T is copied bytewise. Collective.
  template <class T>
  void forward(const T* send, T* receive) const {
    static_assert(std::is_trivially_copyable_v<T>);
    forward_bytes(send, receive, static_cast<int>(sizeof(T)));
  }

  /// Likewise of items of so many bytes. Collective.
  void forward_bytes(const void* send, void* receive, int item_bytes) const;

  /// The two halves of forward, for work in between that touches neither array. Collective.
  void begin_forward(const double* send, double* receive) const;
  void end_forward() const;

 private:
  struct Run {
    int rank, first, count;
  };

  void begin(const void* send, void* receive, MPI_Datatype item, std::size_t item_bytes) const;
  void end() const;

  MPI_Comm comm_ = MPI_COMM_NULL;
  std::vector<Run> sends_;     // to other ranks
  std::vector<Run> receives_;  // from other ranks
  Run own_send_{};             // to this rank
  Run own_receive_{};
  mutable std::vector<MPI_Request> requests_;
  int n_send_ = 0;
  int n_receive_ = 0;
};

/// Sends each item to the rank that stands before it, this rank included. Returns what came, by the sender's rank and,
/// of each, in the order in which it was given. T is copied bytewise. Collective.
template <class T>
std::vector<T> exchange_items(MPI_Comm comm, std::span<const std::pair<int, T>> items) {
  std::vector<std::size_t> order(items.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return items[k].first; });
  std::vector<std::pair<int, int>> runs;
  std::vector<T> send;
  for (const std::size_t k : order) {
    const auto& [rank, item] = items[k];
    if (runs.empty() || runs.back().first != rank) runs.emplace_back(rank, 0);
    ++runs.back().second;
    send.push_back(item);
  }
  const Exchange exchange(comm, runs);
  std::vector<T> received(static_cast<std::size_t>(exchange.n_receive()));
  exchange.forward(send.data(), received.data());
  return received;
}

/// Refreshes the copies of other ranks' particles (and periodic images) that stand behind the owned ones.
class Halo {
 public:
  Halo() = default;

  /// `index`: owned particles to send, in the order of the exchange's runs.
  Halo(Exchange exchange, std::vector<int> index) : exchange_(std::move(exchange)), index_(std::move(index)) {}

  const Exchange& exchange() const { return exchange_; }
  std::span<const int> index() const { return index_; }

  /// Copies what refresh sends of a field of owned particles. Not collective.
  template <class T>
  void pack(const T* field, std::vector<T>& packed) const {
    for (std::size_t k = 0; k < index_.size(); ++k) packed[k] = field[index_[k]];
  }

  /// Copies field[owned] of the senders to field[owned, owned + n_receive). Collective.
  template <class T>
  void refresh(std::vector<T>& field, int owned) const {
    std::vector<T> packed(index_.size());
    pack(field.data(), packed);
    exchange_.forward(packed.data(), field.data() + owned);
  }

  /// refresh of several fields in one message to each rank. Collective.
  template <class... T>
  void refresh_together(int owned, std::vector<T>&... fields) const {
    static_assert((std::is_trivially_copyable_v<T> && ...));
    constexpr std::size_t item = (sizeof(T) + ...);
    std::vector<std::byte> packed(index_.size() * item);
    std::vector<std::byte> received(static_cast<std::size_t>(exchange_.n_receive()) * item);
    std::byte* to = packed.data();
    const auto pack_one = [&]<class U>(const U& value) {
      std::memcpy(to, &value, sizeof value);
      to += sizeof value;
    };
    for (const int i : index_) (pack_one(fields[static_cast<std::size_t>(i)]), ...);
    exchange_.forward_bytes(packed.data(), received.data(), static_cast<int>(item));
    const std::byte* from = received.data();
    const auto unpack_one = [&]<class U>(U& value) {
      std::memcpy(&value, from, sizeof value);
      from += sizeof value;
    };
    for (std::size_t k = 0; k < static_cast<std::size_t>(exchange_.n_receive()); ++k)
      (unpack_one(fields[static_cast<std::size_t>(owned) + k]), ...);
  }

 private:
  Exchange exchange_;
  std::vector<int> index_;
};

}  // namespace impinge
