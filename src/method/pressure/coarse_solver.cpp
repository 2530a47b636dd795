#include "impinge/method/pressure/coarse_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "impinge/core/errors.hpp"
#include "impinge/core/mpi.hpp"
#include "impinge/parallel/exchange.hpp"

namespace impinge {
namespace {

constexpr const char* prefix = "ppe_coarse_";

struct Entry {
  PetscInt row, column;
  double value;
};

}  // namespace

CoarseSolver::CoarseSolver(MPI_Comm comm, int dim)
    : comm_(comm), dim_(dim), rows_per_rank_(default_rows_per_rank(dim)) {
  petsc_check(PetscOptionsGetInt(nullptr, prefix, "-rows_per_rank", &rows_per_rank_, nullptr));
  if (rows_per_rank_ < 1)
    throw InputError({fmt::format("command line: -ppe_coarse_rows_per_rank {}; allowed: at least 1", rows_per_rank_)});
  create_solver(comm);  // its options are then known from the start
}

void CoarseSolver::create_solver(MPI_Comm comm) {
  petsc_check(KSPCreate(comm, solver_.address()));
  petsc_check(KSPSetOptionsPrefix(solver_, prefix));
  petsc_check(KSPSetType(solver_, KSPPREONLY));
  PC preconditioner;
  petsc_check(KSPGetPC(solver_, &preconditioner));
  petsc_check(PCSetType(preconditioner, PCHYPRE));
  // BoomerAMG's own smoother, Jacobi between ranks, is indefinite where few particles tie nodes of two ranks together.
  // In 3D the levels fill: aggressive coarsening, with a stronger smoother, takes as many iterations and less time.
  std::vector<std::string> preferred;
  const auto prefer = [&](const std::string& name, const char* value) {
    const std::string option = "-ppe_coarse_pc_hypre_boomeramg_" + name;
    if (set_default_option(option, value)) preferred.push_back(option);
  };
  prefer("relax_type_all", dim_ == 3 ? "l1scaled-SOR/Jacobi" : "l1scaled-Jacobi");
  if (dim_ == 3) prefer("agg_nl", "1");
  petsc_check(KSPSetFromOptions(solver_));
  for (const std::string& option : preferred) petsc_check(PetscOptionsClearValue(nullptr, option.c_str()));
}

PetscInt CoarseSolver::rows_here() const {
  if (!solves()) return 0;
  const int block = rank_of(solving_);
  return static_cast<PetscInt>(blocks_.first_row(block + 1) - blocks_.first_row(block));
}

void CoarseSolver::choose_ranks(std::int64_t rows) {
  const int before = blocks_.count;
  blocks_ = CoarseBlocks::of(rows, ranks_of(comm_), rows_per_rank_);
  if (blocks_.count == before) return;
  matrix_.reset();
  solver_.reset();
  residual_.reset();
  solution_.reset();
  bool solves = false;
  for (int block = 0; block < blocks_.count; ++block) solves |= blocks_.rank_of_block(block) == rank_of(comm_);
  solving_ = Communicator::of(comm_, solves);
}

void CoarseSolver::set_up(const CoarseRows& rows, std::span<const PetscInt> row_of_node) {
  const auto own = static_cast<std::int64_t>(rows.length.size());
  std::int64_t first = 0;
  MPI_Exscan(&own, &first, 1, MPI_INT64_T, MPI_SUM, comm_);
  choose_ranks(sum_over_ranks(comm_, own));
  connect(row_of_node);
  build_matrix(rows, static_cast<PetscInt>(first));
}

void CoarseSolver::connect(std::span<const PetscInt> row_of_node) {
  std::vector<PetscInt> leaf;
  std::vector<PetscSFNode> root;
  for (std::size_t k = 0; k < row_of_node.size(); ++k) {
    if (row_of_node[k] < 0) continue;
    const int block = blocks_.block_of(row_of_node[k]);
    leaf.push_back(static_cast<PetscInt>(k));
    root.push_back({blocks_.rank_of_block(block), row_of_node[k] - static_cast<PetscInt>(blocks_.first_row(block))});
  }
  petsc_check(PetscSFCreate(comm_, nodes_.address()));
  petsc_check(PetscSFSetGraph(nodes_, rows_here(), static_cast<PetscInt>(leaf.size()), leaf.data(), PETSC_COPY_VALUES,
                              root.data(), PETSC_COPY_VALUES));
  petsc_check(PetscSFSetUp(nodes_));
}

void CoarseSolver::build_matrix(const CoarseRows& rows, PetscInt first) {
  std::vector<std::pair<int, int>> runs;
  std::vector<Entry> own;
  std::size_t next = 0;
  for (std::size_t k = 0; k < rows.length.size(); ++k) {
    const PetscInt row = first + static_cast<PetscInt>(k);
    const int rank = blocks_.rank_of_row(row);
    if (runs.empty() || runs.back().first != rank) runs.emplace_back(rank, 0);
    runs.back().second += static_cast<int>(rows.length[k]);
    for (std::int64_t entry = 0; entry < rows.length[k]; ++entry, ++next)
      own.push_back({row, static_cast<PetscInt>(rows.column[next]), rows.value[next]});
  }
  const Exchange exchange(comm_, runs);
  std::vector<Entry> entries(static_cast<std::size_t>(exchange.n_receive()));
  exchange.forward(own.data(), entries.data());
  matrix_.reset();
  if (!solves() || blocks_.rows == 0) return;

  const PetscInt n = rows_here(), most = dim_ == 3 ? coarse_stencil<3> : coarse_stencil<2>;
  petsc_check(
      MatCreateAIJ(solving_, n, n, PETSC_DETERMINE, PETSC_DETERMINE, most, nullptr, most, nullptr, matrix_.address()));
  std::vector<PetscInt> columns;
  std::vector<double> values;
  for (std::size_t k = 0; k < entries.size(); ++k) {
    columns.push_back(entries[k].column);
    values.push_back(entries[k].value);
    if (k + 1 < entries.size() && entries[k + 1].row == entries[k].row) continue;
    petsc_check(MatSetValues(matrix_, 1, &entries[k].row, static_cast<PetscInt>(columns.size()), columns.data(),
                             values.data(), ADD_VALUES));
    columns.clear();
    values.clear();
  }
  petsc_check(MatAssemblyBegin(matrix_, MAT_FINAL_ASSEMBLY));
  petsc_check(MatAssemblyEnd(matrix_, MAT_FINAL_ASSEMBLY));
  petsc_check(MatSetOption(matrix_, MAT_SPD, PETSC_TRUE));
  petsc_check(MatCreateVecs(matrix_, solution_.address(), residual_.address()));
  create_solver(solving_);
  petsc_check(KSPSetOperators(solver_, matrix_, matrix_));
  petsc_check(KSPSetUp(solver_));
}

void CoarseSolver::solve(std::span<double> value) {
  const bool has_matrix = matrix_ != nullptr;
  double* root = nullptr;
  if (has_matrix) {
    petsc_check(VecZeroEntries(residual_));
    petsc_check(VecGetArray(residual_, &root));
  }
  petsc_check(PetscSFReduceBegin(nodes_, MPI_DOUBLE, value.data(), root, MPI_SUM));
  petsc_check(PetscSFReduceEnd(nodes_, MPI_DOUBLE, value.data(), root, MPI_SUM));
  if (has_matrix) {
    petsc_check(VecRestoreArray(residual_, &root));
    petsc_check(KSPSolve(solver_, residual_, solution_));
    petsc_check(VecGetArray(solution_, &root));
  }
  std::ranges::fill(value, 0.0);
  petsc_check(PetscSFBcastBegin(nodes_, MPI_DOUBLE, root, value.data(), MPI_REPLACE));
  petsc_check(PetscSFBcastEnd(nodes_, MPI_DOUBLE, root, value.data(), MPI_REPLACE));
  if (has_matrix) petsc_check(VecRestoreArray(solution_, &root));
}

}  // namespace impinge
