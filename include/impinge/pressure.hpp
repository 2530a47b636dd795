#pragma once
// The pressure Poisson equation as a PETSc system. It knows pairs and roles, no geometry.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "impinge/neighbours.hpp"
#include "impinge/parallel.hpp"
#include "impinge/petsc.hpp"

namespace impinge {

/// What a particle is to the pressure equation.
enum class PressureRole : std::uint8_t {
  excluded,  ///< not there: no flux from it
  zero,      ///< p = 0
  unknown
};

/// lap p = source, with the Laplacian of paper eq. 6 (times Dim), on the owned particles of all ranks. All views stay
/// valid until the solve.
struct PressureEquation {
  const PairList& far;                 ///< pairs and weights of the Laplacian, one row per owned particle
  std::span<const PressureRole> role;  ///< owned and halo
  std::span<const PetscInt> row;       ///< global rows, owned and halo
  std::span<const double> source;      ///< [Pa/m^2], owned
  double factor;                       ///< 2 Dim/(n0 lambda) [1/m^2]
  double n0;                           ///< full lattice's sum of weights [-]
  std::span<const double> surface{};   ///< weight of p = 0 beyond the surface, owned [-]; or none
};

struct PressureReport {
  int iterations = 0;
  double residual = 0.0;  ///< |b - A p| / |b|, unpreconditioned; 0 where b = 0
  int pockets = 0;        ///< clusters of unknowns that touch no p = 0 particle
  std::string failure;    ///< empty if the solve converged; the same on every rank
};

/// Builds the matrix of each step and solves it with a KSP of options prefix `ppe_`. The system is divided by -factor:
/// A_ij = -W_ij, A_ii = sum_j W_ij over unknown and p = 0 neighbours, and the surface's weight, b_i = -source_i/factor;
/// rows without an unknown are n0 p_i = 0. Symmetric, and positive definite: in a cluster that touches no p = 0
/// particle the source's mean is removed, one particle is pinned, and the pressure's lowest value is set to 0.
class PressureSolver {
 public:
  /// The default preconditioner, a shell that the owner of this object fills before each solve.
  static constexpr const char* two_level = "two_level";

  /// `tolerance`: relative residual in the unpreconditioned norm. Defaults (CG with two_level) give way to the PETSc
  /// options database. Collective.
  PressureSolver(MPI_Comm comm, double tolerance);

  /// True unless the options database chose another preconditioner.
  bool is_two_level() const { return is_two_level_; }

  /// Preconditioner of the coming solve, made anew by assemble.
  PC preconditioner() const;

  /// Builds matrix and right-hand side. Collective.
  void assemble(const PressureEquation& equation, const Halo& halo);

  /// Solves for the owned particles; `pressure` [Pa] holds the first guess (owned entries) and receives the solution.
  /// Non-convergence is reported, never ignored. Collective.
  PressureReport solve(std::vector<double>& pressure);

  /// The options that this class set as defaults; the rest of the database is the user's.
  const std::vector<std::string>& default_options() const { return default_options_; }

  /// Diagonal of the matrix of the last assemble, owned rows.
  const std::vector<double>& diagonal() const { return diagonal_entries_; }

  /// Matrix of the last assemble.
  Mat matrix() const { return matrix_; }

  /// Memory of the matrix and the vectors [bytes].
  std::size_t bytes() const;

 private:
  struct Block {
    std::vector<PetscInt> start, column;
    std::vector<double> value;
    std::size_t used = 0;  // entries; the arrays may be longer
    void reset(std::size_t rows, std::size_t most_entries);
    void append(PetscInt to, double entry);
    void merge(std::size_t row_begin, std::vector<std::pair<PetscInt, double>>& more);  // into the last row, ascending
    void end_row();
  };

  void create_solver();
  void set_default_option(const char* name, const char* value);
  void find_pockets(const PressureEquation& equation, const Halo& halo);

  MPI_Comm comm_;
  double tolerance_;
  bool is_two_level_ = false;
  PetscSolver solver_;
  std::vector<std::string> default_options_;
  std::vector<double> diagonal_entries_;
  Block diagonal_;      // columns of this rank, local
  Block off_diagonal_;  // columns of other ranks, global
  PetscMatrix matrix_;
  std::vector<double> right_hand_side_;
  PetscInt first_row_ = 0;

  // Pockets: label per owned particle (smallest global row of its pocket, -1 elsewhere) and the labels of all.
  std::vector<PetscInt> pocket_;
  std::vector<PetscInt> pockets_;
};

}  // namespace impinge
