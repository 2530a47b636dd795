#pragma once
// The pressure Poisson equation as a PETSc system. It knows pairs and roles, no geometry.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "impinge/core/petsc.hpp"
#include "impinge/method/pressure/matrix.hpp"
#include "impinge/parallel/exchange.hpp"
#include "impinge/particles/neighbours.hpp"

namespace impinge {

/// What a particle is to the pressure equation.
enum class PressureRole : std::uint8_t {
  absent,  ///< no flux from it
  zero,    ///< p = 0
  unknown
};

/// lap p = source, with the Laplacian of paper eq. 6 (times Dim), on the owned particles of all ranks. The matrix is
/// divided by -laplacian_factor: A_ij = -W_ij, A_ii = sum_j W_ij over unknown and p = 0 neighbours, and the surface's
/// weight; rows without an unknown are n0 p_i = 0. Views are read while assemble runs.
struct PressureEquation {
  /// A row: the pairs and weights of its Laplacian, columns of owned particles ascending, and where it has an unknown,
  /// the particle itself among them with weight 0; the weight of p = 0 beyond the surface [-]; and what flux from
  /// there is known [Pa].
  struct Row {
    PairRow pairs;
    double surface_weight = 0.0;
    double surface_flux = 0.0;
  };
  /// Calls its argument for every owned particle in their order.
  std::function<void(const std::function<void(int, const Row&)>&)> for_rows;
  std::span<const PressureRole> role;  ///< owned and halo
  std::span<const PetscInt> row;       ///< global rows, owned and halo
  std::span<const double> source;      ///< [Pa/m^2], owned
  double laplacian_factor;             ///< 2 Dim/(n0 lambda) [1/m^2]
  double n0;                           ///< full lattice's sum of weights [-]
  int usual_pairs;                     ///< full lattice's pairs of a particle
  /// Particles with an index beyond the halo are mirror images: whom each is an image of (owned or halo), and what its
  /// pressure is above its original's [Pa], or none.
  std::span<const int> original{};
  std::span<const double> image_offset{};
};

struct PressureReport {
  int iterations = 0;
  double residual = 0.0;  ///< |b - A p| / |b|, unpreconditioned; 0 where b = 0
  int pockets = 0;        ///< clusters of unknowns that touch no p = 0 particle
  std::string failure;    ///< empty if the solve converged; the same on every rank
};

/// Builds the matrix of each step and solves it with a KSP of options prefix `ppe_`. The matrix is symmetric, and
/// positive definite: in a cluster that touches no p = 0 particle the source's mean is removed, one particle is pinned,
/// and the pressure's lowest value is set to 0. Half of the matrix is stored, which serves products and the two-level
/// preconditioner; others get an AIJ matrix.
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

  /// Builds matrix and right-hand side; `halo` stays as it is until the next assemble. Collective.
  void assemble(const PressureEquation& equation, const Halo& halo);

  /// Solves for the owned particles; `pressure` [Pa] holds a guess (owned entries), the best multiple of which
  /// is where the solver starts, and receives the solution. Non-convergence is reported, never ignored. Collective.
  PressureReport solve(std::vector<double>& pressure);

  /// The options that this class set as defaults; the rest of the database is the user's.
  const std::vector<std::string>& default_options() const { return default_options_; }

  /// The matrix of the last assemble: what the solver multiplies with, its rows, and all its entries, built at each
  /// call with the equation's `row`. The last is collective.
  Mat matrix() const { return whole_matrix_ == nullptr ? matrix_.product_matrix() : Mat(whole_matrix_); }
  const MatrixRows& rows() const { return rows_; }
  PetscMatrix whole_matrix(std::span<const PetscInt> row) const { return matrix_.whole_matrix(row); }

  /// Memory of the matrix and the vectors [bytes].
  std::size_t bytes() const;

 private:
  void create_solver();
  void append_row(const PressureEquation& equation, int i, const PressureEquation::Row& row);
  template <class Test>
  bool any_later(std::size_t i, Test&& test) const;
  struct Sweep {
    bool changed, is_left;
  };
  Sweep spread_anchors(std::span<const PressureRole> role);
  void find_pockets(const PressureEquation& equation, const Halo& halo);
  void close_pockets(const PressureEquation& equation);

  MPI_Comm comm_;
  double tolerance_;
  bool is_two_level_ = false;
  PetscSolver solver_;
  std::vector<std::string> default_options_;
  struct OtherEntry {  // of the matrix, whose column is that of another rank's particle
    PetscInt row;
    int particle;
    double value;
  };
  std::vector<std::pair<PetscInt, double>> images_;  // of a row: entries of images of owned particles
  std::vector<OtherEntry> others_;                   // of a row
  MatrixRows rows_;
  PressureMatrix matrix_;     // uses the arrays of rows_
  PetscMatrix whole_matrix_;  // but for the two-level preconditioner
  std::vector<double> right_hand_side_;
  PetscInt first_row_ = 0;
  std::vector<std::uint8_t> anchored_;  // p = 0 is reached over unknowns, 2: and its neighbours know; owned and halo

  // Pockets: label per owned particle (smallest global row of its pocket, -1 elsewhere) and the labels of all.
  std::vector<PetscInt> pocket_;
  std::vector<PetscInt> pockets_;
};

}  // namespace impinge
