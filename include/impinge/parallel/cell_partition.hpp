#pragma once
// Distributes the cells that have particles over ranks.

#include <algorithm>
#include <span>
#include <vector>

#include "impinge/parallel/cell_owners.hpp"
#include "impinge/parallel/graph_partition.hpp"

namespace impinge {

/// Work in the cell of a key.
struct CellWork {
  std::int64_t key;
  std::int64_t work;
};

/// Sorts by keys and makes one item of those of one key: add(a, b) adds the amounts of b to a.
template <class Item, class Add>
void merge_keys(std::vector<Item>& items, Add&& add) {
  std::ranges::sort(items, {}, &Item::key);
  auto last = items.begin();
  for (auto item = items.begin(); item != items.end(); ++item) {
    if (item == items.begin()) continue;
    if (item->key == last->key) {
      add(*last, *item);
    } else {
      *++last = *item;
    }
  }
  if (!items.empty()) items.erase(last + 1, items.end());
}

/// Owners of all cells, and how well they share the work.
struct Cut {
  std::vector<Segment> segments;  ///< see CellOwners
  double imbalance = 1.0;         ///< largest over mean work of a part
};

/// What distribute_cells uses: where it may choose, METIS for few parts of little work (see
/// docs/results/scaling.md), else the curve.
Partitioner chosen_partitioner(Partitioner partitioner, int parts, double work);

/// Distributes the cells to `parts` ranks with balanced work. `work`: this rank's, by ascending keys; several ranks may
/// have some in one cell. By graph: METIS k-way on rank 0, or PTScotch on all, on the graph of the cells with work, of
/// which each of these ranks has all. By the curve: it is cut where the work before comes nearest to the equal
/// shares, which bisection finds for all cuts together, with a sum of `parts` numbers over the ranks for each bit of a
/// key. A cell is never cut: a part has at most half the work of its first and of its last cell more than its share.
/// Cells without work belong to the segment that they lie in. The same on every rank, and for every distribution of the
/// same work. Collective.
template <int Dim>
Cut distribute_cells(MPI_Comm comm, const CellGrid<Dim>& cells, std::span<const CellWork> work, int parts,
                     Partitioner partitioner);

}  // namespace impinge
