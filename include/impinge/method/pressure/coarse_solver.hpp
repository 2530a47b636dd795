#pragma once
// The coarse problem of the two-level preconditioner, solved by as many ranks as it is worth.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "impinge/core/communicator.hpp"
#include "impinge/core/petsc.hpp"
#include "impinge/method/checkpoint.hpp"

namespace impinge {

/// Even blocks of coarse rows on some of the ranks, which are evenly spread over all.
struct CoarseBlocks {
  std::int64_t rows = 0;  ///< of all ranks
  int ranks = 1;          ///< all
  int count = 0;          ///< blocks: ranks that solve

  /// One block for every `rows_per_rank` rows.
  static CoarseBlocks of(std::int64_t rows, int ranks, std::int64_t rows_per_rank) {
    return {rows, ranks,
            static_cast<int>(std::clamp<std::int64_t>((rows + rows_per_rank - 1) / rows_per_rank, 1, ranks))};
  }

  /// Of n rows in k blocks, block b has [b n/k, (b + 1) n/k).
  std::int64_t first_row(int block) const { return block * rows / count; }
  int block_of(std::int64_t row) const { return static_cast<int>(((row + 1) * count - 1) / rows); }
  int rank_of_block(int block) const { return static_cast<int>(static_cast<std::int64_t>(block) * ranks / count); }
  int rank_of_row(std::int64_t row) const { return rank_of_block(block_of(row)); }
};

/// A_c^-1 by one cycle of an algebraic multigrid, a KSP of prefix `ppe_coarse_`. The rows stand in even blocks on some
/// ranks, evenly spread over all: one for every rows_per_rank rows, whatever the number of ranks. Every rank sends its
/// parts of the residual straight to them and gets the solution from them.
class CoarseSolver {
 public:
  /// `dim`: 2 or 3. `-ppe_coarse_rows_per_rank` replaces default_rows_per_rank. Throws InputError where it is not
  /// positive. Collective.
  CoarseSolver(MPI_Comm comm, int dim);

  /// Coarse rows [1] for which a cycle takes half a millisecond.
  static constexpr int default_rows_per_rank(int dim) { return dim == 3 ? 1000 : 2500; }

  /// Takes the matrix. `rows`: this rank's, which follow those of the ranks before it; entries of the same place add
  /// up. `row_of_node`: the row of each of this rank's nodes, -1 for none. Collective.
  void set_up(const CoarseRows& rows, std::span<const PetscInt> row_of_node);

  /// Replaces `value`, the parts of the residual at this rank's nodes, which are summed over the ranks, by the solution
  /// there; 0 at nodes without a row. Collective.
  void solve(std::span<double> value);

  /// Ranks that solve.
  int ranks() const { return blocks_.count; }

 private:
  void create_solver(MPI_Comm comm);
  void choose_ranks(std::int64_t rows);
  void connect(std::span<const PetscInt> row_of_node);
  void build_matrix(const CoarseRows& rows, PetscInt first);
  bool solves() const { return solving_ != MPI_COMM_NULL; }
  PetscInt rows_here() const;

  MPI_Comm comm_;
  int dim_;
  PetscInt rows_per_rank_;
  CoarseBlocks blocks_;
  Communicator solving_;  // of the ranks that solve, on these alone
  PetscForest nodes_;     // roots: the rows on this rank; leaves: its nodes with a row
  PetscMatrix matrix_;    // with solver and vectors on the ranks that solve alone
  PetscSolver solver_;
  PetscVector residual_;
  PetscVector solution_;
};

}  // namespace impinge
