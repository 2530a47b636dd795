#pragma once
// Graph partitioning libraries.

#include <mpi.h>

#include <vector>

#include "impinge/config/key.hpp"

namespace impinge {

enum class Partitioner { automatic, metis, ptscotch, curve };
constexpr auto words(Partitioner) { return std::to_array<std::string_view>({"auto", "metis", "ptscotch", "curve"}); }

struct ParallelSettings {
  Partitioner partitioner = Partitioner::automatic;
  double imbalance = 1.1;  ///< repartition when max/mean of the owned particles passes it
};

/// Declares the table [parallel].
void declare_parallel(Keys& keys, ParallelSettings& settings);

/// A weighted undirected graph in compressed rows, the same on every rank that knows it.
struct CellGraph {
  std::vector<int> start{0};
  std::vector<int> neighbour;
  std::vector<int> vertex_weight;
  std::vector<int> edge_weight;

  int size() const { return static_cast<int>(vertex_weight.size()); }
};

/// What a vertex of `neighbours` edges takes on a rank that knows it, and there the library [bytes]. Measured with
/// METIS: 4.4 times the graph in 2D, 3.6 times in 3D.
constexpr double graph_memory(int neighbours) { return 4.5 * neighbours * 2.0 * sizeof(int); }

/// Part of every vertex, 0 to `parts` - 1, with balanced vertex weights and a small cut; parts beyond the number of
/// vertices get nothing. METIS k-way runs on rank 0, which alone knows the graph and gets the parts, that of the others
/// being empty; PTScotch runs on all ranks (through PETSc), which all do: its parts differ from call to call, those of
/// METIS do not. Collective.
std::vector<int> partition_graph(MPI_Comm comm, const CellGraph& graph, int parts, Partitioner partitioner);

}  // namespace impinge
