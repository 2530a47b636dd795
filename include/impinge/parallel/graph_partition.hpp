#pragma once
// Graph partitioning libraries.

#include <mpi.h>

#include <vector>

#include "impinge/config/key.hpp"

namespace impinge {

enum class Partitioner { metis, ptscotch };
constexpr auto words(Partitioner) { return std::to_array<std::string_view>({"metis", "ptscotch"}); }

struct ParallelSettings {
  Partitioner partitioner = Partitioner::metis;
  double imbalance = 1.1;  ///< repartition when max/mean of the owned particles passes it
};

/// Declares the table [parallel].
void declare_parallel(Keys& keys, ParallelSettings& settings);

/// A weighted undirected graph in compressed rows, the same on every rank that knows its edges.
struct CellGraph {
  std::vector<int> start{0};
  std::vector<int> neighbour;
  std::vector<int> vertex_weight;
  std::vector<int> edge_weight;

  int size() const { return static_cast<int>(vertex_weight.size()); }
};

/// True on the ranks that must know the edges of the graph; the vertices' weights must be known to all. Not collective.
bool needs_edges(MPI_Comm comm, int parts, Partitioner partitioner);

/// What a vertex of `neighbours` edges takes on a rank that knows them, and there the library [bytes]. Measured with
/// METIS: 4.4 times the graph in 2D, 3.6 times in 3D.
constexpr double graph_memory(int neighbours) { return 4.5 * neighbours * 2.0 * sizeof(int); }

/// Part of every vertex, 0 to `parts` - 1, with balanced vertex weights and a small cut; parts beyond the number of
/// vertices get nothing. METIS k-way runs on rank 0, PTScotch on all ranks (through PETSc): its parts differ
/// from call to call, those of METIS do not. Collective.
std::vector<int> partition_graph(MPI_Comm comm, const CellGraph& graph, int parts, Partitioner partitioner);

}  // namespace impinge
