#pragma once
// The symmetric matrix of the pressure equation: its rows, and the PETSc matrices that are made of them.

#include <span>
#include <vector>

#include "impinge/core/buffer.hpp"
#include "impinge/core/petsc.hpp"
#include "impinge/core/vector.hpp"
#include "impinge/parallel/exchange.hpp"

namespace impinge {

/// The matrix on this rank, by particles. Pairs of owned particles stand once, in the row of the first.
struct MatrixRows {
  struct Block {
    std::vector<PetscInt> start;
    Buffer<PetscInt> column;
    Buffer<double> value;  // may be longer than start.back(), as may be the columns

    void clear(std::size_t rows, std::size_t entries);  // and makes room for so many
    void make_room(std::size_t more);                   // behind the rows so far
    std::size_t bytes() const;
  };
  Block own;     ///< upper triangle; columns: owned particles, ascending from the diagonal on
  Block others;  ///< columns: halo particles, the first of the halo is 0; one of each particle of another rank
  std::vector<double> diagonal;
  /// What a row has of the constants: sum of its entries but for the diagonal, over -A_ii; 1 where no p = 0 is near, 0
  /// without an unknown.
  std::vector<double> coupling;
};

/// Rows as a PETSc matrix for products: the own block an SBAIJ matrix, which is all there is on one rank; on several
/// ranks a shell that adds the other ranks' columns, an AIJ block, once the halo has come. Uses the arrays as they are
/// (of less than 65,536 rows PETSc makes short column numbers besides) and the halo: both stay until the next build.
class PressureMatrix {
 public:
  PressureMatrix() = default;
  PressureMatrix(const PressureMatrix&) = delete;
  PressureMatrix& operator=(const PressureMatrix&) = delete;

  /// `all_rows`: of all ranks. Collective.
  void build(MPI_Comm comm, MatrixRows& rows, const Halo& halo, PetscInt all_rows);

  /// The matrix of the last build: symmetric, for products.
  Mat product_matrix() const { return ranks_of(comm_) == 1 ? Mat(own_) : Mat(shell_); }

  /// An AIJ matrix of its own memory, whole rows; for preconditioners that need the entries. `row`: global rows of
  /// owned and halo particles. Collective.
  PetscMatrix whole_matrix(std::span<const PetscInt> row) const;

 private:
  void multiply(::Vec x, ::Vec y);

  MPI_Comm comm_ = MPI_COMM_SELF;
  const MatrixRows* rows_ = nullptr;
  const Halo* halo_ = nullptr;
  PetscMatrix own_;
  PetscMatrix others_;
  PetscMatrix shell_;
  PetscVector own_x_, own_y_;   // views of a product's vectors
  std::vector<double> sent_;    // what other ranks need of x
  std::vector<double> halo_x_;  // what this rank needs of others
  PetscVector halo_x_view_;
};

}  // namespace impinge
