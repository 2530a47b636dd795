#include "impinge/parallel/graph_partition.hpp"

#include <metis.h>
#include <petscmat.h>

#include <algorithm>
#include <new>
#include <stdexcept>

#include "impinge/parallel/exchange.hpp"

namespace impinge {
namespace {

std::vector<int> partition_with_metis(const CellGraph& graph, int parts) {
  idx_t n = graph.size();
  idx_t n_parts = parts;
  idx_t constraints = 1;
  idx_t cut = 0;
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  std::vector<idx_t> start(graph.start.begin(), graph.start.end());
  std::vector<idx_t> neighbour(graph.neighbour.begin(), graph.neighbour.end());
  std::vector<idx_t> vertex_weight(graph.vertex_weight.begin(), graph.vertex_weight.end());
  std::vector<idx_t> edge_weight(graph.edge_weight.begin(), graph.edge_weight.end());
  std::vector<idx_t> part(static_cast<std::size_t>(n), 0);
  const int code = METIS_PartGraphKway(&n, &constraints, start.data(), neighbour.data(), vertex_weight.data(), nullptr,
                                       edge_weight.data(), &n_parts, nullptr, nullptr, options, &cut, part.data());
  if (code == METIS_ERROR_MEMORY) throw std::bad_alloc();
  if (code != METIS_OK) throw std::runtime_error("METIS could not partition the background cells");
  return {part.begin(), part.end()};
}

std::vector<int> partition_with_ptscotch(MPI_Comm comm, const CellGraph& graph, int parts) {
  const int rank = rank_of(comm);
  const int size = ranks_of(comm);
  const auto first_of = [&](int r) { return static_cast<int>(static_cast<std::int64_t>(graph.size()) * r / size); };
  const int begin = first_of(rank);
  const int end = first_of(rank + 1);
  // MatCreateMPIAdj takes over arrays from PetscMalloc.
  PetscInt *start, *neighbour, *edge_weight, *vertex_weight;
  const int first_edge = graph.start[static_cast<std::size_t>(begin)];
  const int n_edges = graph.start[static_cast<std::size_t>(end)] - first_edge;
  petsc_check(PetscMalloc1(end - begin + 1, &start));
  petsc_check(PetscMalloc1(n_edges, &neighbour));
  petsc_check(PetscMalloc1(n_edges, &edge_weight));
  petsc_check(PetscMalloc1(end - begin, &vertex_weight));
  for (int v = begin; v <= end; ++v) start[v - begin] = graph.start[static_cast<std::size_t>(v)] - first_edge;
  for (int v = begin; v < end; ++v) vertex_weight[v - begin] = graph.vertex_weight[static_cast<std::size_t>(v)];
  for (int e = 0; e < n_edges; ++e) {
    neighbour[e] = graph.neighbour[static_cast<std::size_t>(first_edge + e)];
    edge_weight[e] = graph.edge_weight[static_cast<std::size_t>(first_edge + e)];
  }
  PetscMatrix adjacency;
  petsc_check(MatCreateMPIAdj(comm, end - begin, graph.size(), start, neighbour, edge_weight, adjacency.address()));
  PetscHandle<MatPartitioning, MatPartitioningDestroy> partitioning;
  petsc_check(MatPartitioningCreate(comm, partitioning.address()));
  petsc_check(MatPartitioningSetAdjacency(partitioning, adjacency));
  petsc_check(MatPartitioningSetType(partitioning, MATPARTITIONINGPTSCOTCH));
  petsc_check(MatPartitioningSetNParts(partitioning, parts));
  petsc_check(MatPartitioningSetVertexWeights(partitioning, vertex_weight));
  PetscHandle<IS, ISDestroy> own_part;
  petsc_check(MatPartitioningApply(partitioning, own_part.address()));
  PetscHandle<IS, ISDestroy> part;
  petsc_check(ISAllGather(own_part, part.address()));
  const PetscInt* values = nullptr;
  petsc_check(ISGetIndices(part, &values));
  std::vector<int> result(values, values + graph.size());
  petsc_check(ISRestoreIndices(part, &values));
  return result;
}

}  // namespace

void declare_parallel(Keys& keys, ParallelSettings& settings) {
  keys.add(
      "parallel.partitioner", settings.partitioner,
      "how the cells are distributed over the ranks: by the graph of the cells with particles (metis, ptscotch) or "
      "by cuts of a space-filling curve; auto: metis up to 16 ranks and 4 million particles, then curve");
  keys.add("parallel.imbalance", settings.imbalance,
           "largest over mean number of particles of a rank that calls for a new partition",
           {.range = from_to(1, 100)});
}

std::vector<int> partition_graph(MPI_Comm comm, const CellGraph& graph, int parts, Partitioner partitioner) {
  parts = std::min(parts, graph.size());
  if (parts <= 1) return std::vector<int>(static_cast<std::size_t>(graph.size()), 0);
  if (partitioner == Partitioner::ptscotch) return partition_with_ptscotch(comm, graph, parts);
  return partition_with_metis(graph, parts);
}

}  // namespace impinge
