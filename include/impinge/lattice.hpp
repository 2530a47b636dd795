#pragma once
// Numbered lattices, shared out over the ranks.

#include <cstdint>

namespace impinge {

/// Rows of a wall: one of wall particles and the ghosts behind it, enough for a Laplacian radius of 4.01 dp.
constexpr int wall_layers = 4;

/// Calls use(k) for this rank's share of 0 <= k < count.
template <class Use>
void for_share(std::int64_t count, int rank, int ranks, Use&& use) {
  for (std::int64_t k = count * rank / ranks; k < count * (rank + 1) / ranks; ++k) use(k);
}

}  // namespace impinge
