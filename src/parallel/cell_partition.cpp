#include "impinge/parallel/cell_partition.hpp"

#include <algorithm>
#include <numeric>

#include "impinge/core/mpi.hpp"

namespace impinge {
namespace {

constexpr int most_parts_by_graph = 16;
constexpr double most_work_by_graph = 1.6e7;  // of 4 million fluid particles

double imbalance_of(std::span<const std::int64_t> part_work) {
  const auto total = static_cast<double>(std::accumulate(part_work.begin(), part_work.end(), std::int64_t{0}));
  const auto largest = static_cast<double>(std::ranges::max(part_work));
  return total > 0.0 ? largest * static_cast<double>(part_work.size()) / total : 1.0;
}

std::int64_t sum_of(std::span<const CellWork> work) {
  return std::accumulate(work.begin(), work.end(), std::int64_t{0},
                         [](std::int64_t sum, const CellWork& cell) { return sum + cell.work; });
}

// For each cut, from the highest bit of a key to the lowest: the last key with no more than its share before it.
Cut cut_curve(MPI_Comm comm, std::span<const CellWork> work, std::int64_t total, int bits, int parts) {
  if (total == 0) return {{{0, 0}}, 1.0};
  const auto n_cuts = static_cast<std::size_t>(parts) - 1;
  const auto share = [&](std::size_t cut) { return total * static_cast<std::int64_t>(cut + 1) / parts; };
  std::vector<std::int64_t> first(n_cuts, 0), before(n_cuts, 0), behind(n_cuts, total), sum(n_cuts);
  for (int bit = bits - 1; bit >= 0; --bit) {
    const std::int64_t half = std::int64_t{1} << bit;
    auto cell = work.begin();
    std::int64_t passed = 0;
    for (std::size_t cut = 0; cut < n_cuts; ++cut) {
      for (; cell != work.end() && cell->key < first[cut] + half; ++cell) passed += cell->work;
      sum[cut] = passed;
    }
    MPI_Allreduce(MPI_IN_PLACE, sum.data(), static_cast<int>(n_cuts), MPI_INT64_T, MPI_SUM, comm);
    for (std::size_t cut = 0; cut < n_cuts; ++cut) {
      if (sum[cut] <= share(cut)) {
        first[cut] += half;
        before[cut] = sum[cut];
      } else {
        behind[cut] = sum[cut];
      }
    }
  }
  Cut result{{{0, 0}}, 1.0};
  std::vector<std::int64_t> part_work;
  std::int64_t passed = 0;
  for (std::size_t cut = 0; cut < n_cuts; ++cut) {
    if (behind[cut] - share(cut) < share(cut) - before[cut]) {  // the cell is nearer to the end of its part
      ++first[cut];
      before[cut] = behind[cut];
    }
    part_work.push_back(before[cut] - passed);
    passed = before[cut];
    const Segment next{first[cut], static_cast<int>(cut) + 1};
    if (next.first == result.segments.back().first) {
      result.segments.back() = next;  // the part before has nothing
    } else {
      result.segments.push_back(next);
    }
  }
  part_work.push_back(total - passed);
  result.imbalance = imbalance_of(part_work);
  return result;
}

// Appends the items of all ranks, on rank 0 or on all of them.
std::vector<CellWork> gather(MPI_Comm comm, std::span<const CellWork> work, bool on_all) {
  MPI_Datatype item;
  MPI_Type_contiguous(sizeof(CellWork), MPI_BYTE, &item);
  MPI_Type_commit(&item);
  const auto ranks = static_cast<std::size_t>(ranks_of(comm));
  const int n = static_cast<int>(work.size());
  std::vector<int> count(ranks), start(ranks);
  MPI_Allgather(&n, 1, MPI_INT, count.data(), 1, MPI_INT, comm);
  std::exclusive_scan(count.begin(), count.end(), start.begin(), 0);
  std::vector<CellWork> all;
  if (on_all || rank_of(comm) == 0) all.resize(static_cast<std::size_t>(start.back() + count.back()));
  if (on_all) {
    MPI_Allgatherv(work.data(), n, item, all.data(), count.data(), start.data(), item, comm);
  } else {
    MPI_Gatherv(work.data(), n, item, all.data(), count.data(), start.data(), item, 0, comm);
  }
  MPI_Type_free(&item);
  merge_keys(all, [](CellWork& to, const CellWork& from) { to.work += from.work; });
  return all;
}

template <int Dim>
CellGraph graph_of(const CellGrid<Dim>& cells, const CellCurve<Dim>& curve, std::span<const CellWork> work) {
  CellGraph graph;
  CellIndex vertex;
  Vector<Dim> shift;
  for (const CellWork& cell : work) {
    vertex.insert(cells.wrapped_cell(curve.coordinates(cell.key), shift));
    graph.vertex_weight.push_back(static_cast<int>(cell.work));
  }
  for (int v = 0; v < vertex.size(); ++v) {
    for_cells_around(cells, vertex.cell(v), 1, [&](std::int64_t near, const Vector<Dim>&) {
      const int neighbour = vertex.find(near);
      if (neighbour < 0 || neighbour == v) return;
      graph.neighbour.push_back(neighbour);
      graph.edge_weight.push_back(graph.vertex_weight[static_cast<std::size_t>(v)] +
                                  graph.vertex_weight[static_cast<std::size_t>(neighbour)]);
    });
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return graph;
}

template <int Dim>
Cut cut_graph(MPI_Comm comm, const CellGrid<Dim>& cells, std::span<const CellWork> work, int parts,
              Partitioner partitioner) {
  const std::vector<CellWork> all = gather(comm, work, partitioner == Partitioner::ptscotch);
  const std::vector<int> part = partition_graph(comm, graph_of(cells, CellCurve<Dim>(cells), all), parts, partitioner);
  Cut cut{{{0, part.empty() ? 0 : part.front()}}, 1.0};
  std::vector<std::int64_t> part_work(static_cast<std::size_t>(parts), 0);
  for (std::size_t v = 0; v < part.size(); ++v) {
    part_work[static_cast<std::size_t>(part[v])] += all[v].work;
    if (part[v] != cut.segments.back().rank) cut.segments.push_back({all[v].key, part[v]});
  }
  cut.imbalance = imbalance_of(part_work);

  MPI_Datatype segment;
  MPI_Type_contiguous(sizeof(Segment), MPI_BYTE, &segment);
  MPI_Type_commit(&segment);
  int n = static_cast<int>(cut.segments.size());
  MPI_Bcast(&n, 1, MPI_INT, 0, comm);
  cut.segments.resize(static_cast<std::size_t>(n));
  MPI_Bcast(cut.segments.data(), n, segment, 0, comm);
  MPI_Bcast(&cut.imbalance, 1, MPI_DOUBLE, 0, comm);
  MPI_Type_free(&segment);
  return cut;
}

}  // namespace

Partitioner chosen_partitioner(Partitioner partitioner, int parts, double work) {
  if (partitioner != Partitioner::automatic) return partitioner;
  return parts <= most_parts_by_graph && work <= most_work_by_graph ? Partitioner::metis : Partitioner::curve;
}

template <int Dim>
Cut distribute_cells(MPI_Comm comm, const CellGrid<Dim>& cells, std::span<const CellWork> work, int parts,
                     Partitioner partitioner) {
  if (parts == 1) return {{{0, 0}}, 1.0};
  const std::int64_t total = sum_over_ranks(comm, sum_of(work));
  partitioner = chosen_partitioner(partitioner, parts, static_cast<double>(total));
  if (partitioner == Partitioner::curve) return cut_curve(comm, work, total, CellCurve<Dim>(cells).bits(), parts);
  return cut_graph(comm, cells, work, parts, partitioner);
}

template Cut distribute_cells(MPI_Comm, const CellGrid<2>&, std::span<const CellWork>, int, Partitioner);
template Cut distribute_cells(MPI_Comm, const CellGrid<3>&, std::span<const CellWork>, int, Partitioner);

}  // namespace impinge
