#pragma once
// A two-level preconditioner for the pressure equation: Jacobi and a coarse grid of about one kernel radius.

#include <array>
#include <span>
#include <vector>

#include "impinge/core/petsc.hpp"
#include "impinge/method/checkpoint.hpp"
#include "impinge/method/pressure/coarse_solver.hpp"
#include "impinge/method/pressure/solver.hpp"
#include "impinge/parallel/cell_owners.hpp"

namespace impinge {

/// z = w D^-1 r + P A_c^-1 P^T r, symmetric and positive definite as A is. One Jacobi sweep damps all that is shorter
/// than the wide kernel; the rest lives on the centres of the background cells. P: (bi, tri)linear interpolation from
/// the cells to the unknown particles, times the row's coupling, which makes it fall to zero where p = 0 is near, as a
/// sweep of Jacobi on the constants would; A_c = P^T A P; A_c^-1: see CoarseSolver. P is that of the current positions;
/// A_c is kept until iterations grow.
template <int Dim>
class TwoLevelPreconditioner {
 public:
  /// Cells that a rank exchanges coarse values with: particles of its own touch the next cells, those of the halo the
  /// next but one.
  static constexpr int node_reach = 2;

  /// `cells`: background cells whose edge is at least the Laplacian's radius. Collective.
  TwoLevelPreconditioner(MPI_Comm comm, const CellGrid<Dim>& cells);

  /// Takes the rank of each cell. Not collective.
  void set_owners(const CellOwners<Dim>& owners);

  /// Makes the next update renew the coarse matrix.
  void expire() { stale_ = true; }

  /// Follows the particles and renews the coarse matrix where it is due. `matrix` is valid until the solve; `role`,
  /// `position`: owned and halo, whose pattern is `halo`; `iterations`: of the solve before. Collective.
  void update(const MatrixRows& matrix, std::span<const PressureRole> role, std::span<const Vector<Dim>> position,
              const Halo& halo, int iterations);

  /// This rank's rows of the coarse matrix, nothing where the next update renews it anyway; its age and iterations. Not
  /// collective.
  CoarseRows coarse_rows() const;
  int age() const { return stale_ ? 0 : age_; }
  int fresh_iterations() const { return fresh_iterations_; }

  /// Takes the coarse matrix that another object had with the same owners. Collective.
  void set_coarse_rows(const CoarseRows& rows, int age, int fresh_iterations);

  /// Makes `preconditioner` (a shell) this one. Collective.
  void attach(PC preconditioner);

  /// How often the coarse matrix was built.
  int builds() const { return builds_; }

  /// Memory of interpolation and node lists [bytes].
  std::size_t bytes() const;

  /// The part of it that every unknown takes [bytes].
  static constexpr std::size_t bytes_per_row = sizeof(Vector<Dim>);

 private:
  static constexpr std::size_t corners = 1 << Dim;
  using Corners = std::array<double, corners>;  // of the cells base + (0 or 1 along each axis), first axis fastest

  /// Unknown particles [first, last) between the centres of the cells `base` and `base` + 1 along each axis.
  struct Patch {
    std::size_t first, last;
    std::array<int, Dim> base;
    std::array<std::size_t, corners> node;  // local nodes of the corners; one behind all of them where there is no row
  };

  std::int64_t cell_at(const std::array<int, Dim>& coordinates) const;
  std::array<int, Dim> place(const Vector<Dim>& position, Vector<Dim>& inside) const;
  void find_interpolation(std::span<const PressureRole> role, std::span<const Vector<Dim>> position);
  void find_coarse_rows();
  void connect_nodes();
  void find_corners();
  void build_coarse_matrix(const MatrixRows& matrix, std::span<const PressureRole> role,
                           std::span<const Vector<Dim>> position, const Halo& halo);
  Corners interpolation(std::size_t i) const;
  void apply(::Vec residual, ::Vec result);

  MPI_Comm comm_;
  CellGrid<Dim> cells_;
  CellOwners<Dim> owner_;
  CellIndex nodes_;     // the cells with a row, of any rank, near cells of this rank: the local nodes
  PetscForest copies_;  // roots: the rows of this rank; leaves: the local nodes

  std::span<const double> diagonal_;  // of A, owned rows
  std::span<const double> coupling_;  // likewise
  std::vector<Patch> patches_;        // all unknowns
  std::vector<Vector<Dim>> inside_;   // place of an owned particle between the centres, 0 to 1 along each axis
  std::vector<PetscInt> number_;      // row of A_c of a local node
  std::vector<double> leaf_value_;    // of the local nodes, and one behind them that is nobody's
  CoarseRows coarse_rows_;            // of this rank
  CoarseSolver coarse_solver_;

  bool stale_ = true;
  int builds_ = 0;
  int age_ = 0;               // solves since the last build
  int fresh_iterations_ = 0;  // of the first of them
};

}  // namespace impinge
