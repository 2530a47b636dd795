#include "impinge/pressure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace impinge {
namespace {

constexpr const char* prefix = "ppe_";

// The union over the ranks of short lists, sorted.
std::vector<PetscInt> gather_labels(MPI_Comm comm, std::vector<PetscInt> own) {
  std::sort(own.begin(), own.end());
  own.erase(std::unique(own.begin(), own.end()), own.end());
  const int n_own = static_cast<int>(own.size());
  std::vector<int> counts(static_cast<std::size_t>(ranks_of(comm)));
  MPI_Allgather(&n_own, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  std::vector<int> displacements(counts.size(), 0);
  std::partial_sum(counts.begin(), counts.end() - 1, displacements.begin() + 1);
  std::vector<PetscInt> all(static_cast<std::size_t>(std::accumulate(counts.begin(), counts.end(), 0)));
  MPI_Allgatherv(own.data(), n_own, MPIU_INT, all.data(), counts.data(), displacements.data(), MPIU_INT, comm);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

std::size_t place_of(const std::vector<PetscInt>& labels, PetscInt label) {
  return static_cast<std::size_t>(std::lower_bound(labels.begin(), labels.end(), label) - labels.begin());
}

// Spreads a mark from particle to particle until nothing changes on any rank. improve(i) updates particle i from its
// neighbours and says whether it changed. Sweeps go forth and back along the sorted particles, so few are needed.
template <class T, class Improve>
void spread(MPI_Comm comm, const Halo& halo, std::vector<T>& mark, int owned, Improve&& improve) {
  bool changed_anywhere = true;
  while (changed_anywhere) {
    halo.refresh(mark, owned);
    bool changed = false;
    bool again = true;
    while (again) {
      again = false;
      for (int i = 0; i < owned; ++i) again |= improve(i);
      for (int i = owned - 1; i >= 0; --i) again |= improve(i);
      changed |= again;
    }
    changed_anywhere = any_rank(comm, changed);
  }
}

std::size_t halo_pairs(const PairList& list) {
  const auto end = list.index.begin() + list.pairs();
  return static_cast<std::size_t>(std::count_if(list.index.begin(), end, [&](int j) { return j >= list.rows(); }));
}

}  // namespace

void PressureSolver::Block::reset(std::size_t rows, std::size_t most_entries) {
  start.clear();
  start.reserve(rows + 1);
  start.push_back(0);
  used = 0;
  if (column.size() >= most_entries) return;
  const std::size_t size = most_entries + most_entries / 8;
  column.resize(size);
  value.resize(size);
}

void PressureSolver::Block::append(PetscInt to, double entry) {
  column[used] = to;
  value[used++] = entry;
}

void PressureSolver::Block::merge(std::size_t row_begin, std::vector<std::pair<PetscInt, double>>& more) {
  for (std::size_t k = row_begin; k < used; ++k) more.emplace_back(column[k], value[k]);
  std::sort(more.begin(), more.end());
  used = row_begin;
  for (const auto& [to, entry] : more) {
    if (used > row_begin && column[used - 1] == to) {
      value[used - 1] += entry;
    } else {
      append(to, entry);
    }
  }
}

void PressureSolver::Block::end_row() { start.push_back(static_cast<PetscInt>(used)); }

PressureSolver::PressureSolver(MPI_Comm comm, double tolerance) : comm_(comm), tolerance_(tolerance) {
  check(PCRegister(two_level, [](PC preconditioner) { return PCSetType(preconditioner, PCSHELL); }));
  char chosen[64] = "";
  check(PetscOptionsGetString(nullptr, prefix, "-pc_type", chosen, sizeof chosen, nullptr));
  if (std::string(chosen) == "hypre") {
    set_default_option("pc_hypre_boomeramg_coarsen_type", "HMIS");
    set_default_option("pc_hypre_boomeramg_interp_type", "ext+i");
    set_default_option("pc_hypre_boomeramg_P_max", "4");
    set_default_option("pc_hypre_boomeramg_agg_nl", "1");
    set_default_option("pc_hypre_boomeramg_relax_type_down", "SOR/Jacobi");
    set_default_option("pc_hypre_boomeramg_relax_type_up", "backward-SOR/Jacobi");
  }
  create_solver();
}

void PressureSolver::create_solver() {
  check(KSPCreate(comm_, solver_.address()));
  check(KSPSetOptionsPrefix(solver_, prefix));
  check(KSPSetType(solver_, KSPCG));
  check(KSPSetNormType(solver_, KSP_NORM_UNPRECONDITIONED));
  // A warm start may begin far above |b|: that is no divergence.
  check(KSPSetTolerances(solver_, tolerance_, PETSC_DEFAULT, 1e20, 10000));
  check(KSPSetInitialGuessNonzero(solver_, PETSC_TRUE));
  check(PCSetType(preconditioner(), two_level));
  check(KSPSetFromOptions(solver_));
  PetscBool is_shell = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(preconditioner()), PCSHELL, &is_shell));
  is_two_level_ = is_shell == PETSC_TRUE;
}

PC PressureSolver::preconditioner() const {
  PC result = nullptr;
  check(KSPGetPC(solver_, &result));
  return result;
}

void PressureSolver::set_default_option(const char* name, const char* value) {
  const std::string option = fmt::format("-{}{}", prefix, name);
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsHasName(nullptr, nullptr, option.c_str(), &given));
  if (given) return;
  check(PetscOptionsSetValue(nullptr, option.c_str(), value));
  default_options_.push_back(option);
}

void PressureSolver::assemble(const PressureEquation& equation, const Halo& halo) {
  create_solver();  // KSPReset would leave a multigrid's levels with the sizes of the last step
  matrix_.reset();
  const int owned = equation.far.rows();
  first_row_ = 0;
  const PetscInt own_rows = owned;
  MPI_Exscan(&own_rows, &first_row_, 1, MPIU_INT, MPI_SUM, comm_);
  right_hand_side_.assign(static_cast<std::size_t>(owned), 0.0);
  find_pockets(equation, halo);

  const auto rows = static_cast<std::size_t>(owned);
  const auto pairs = static_cast<std::size_t>(equation.far.pairs());
  const bool distributed = ranks_of(comm_) > 1;
  diagonal_.reset(rows, rows + pairs);
  off_diagonal_.reset(rows, distributed ? halo_pairs(equation.far) : 0);
  diagonal_entries_.assign(rows, equation.n0);
  std::vector<std::pair<PetscInt, double>> images, others;  // of a row: periodic images, columns of other ranks
  for (int i = 0; i < owned; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (equation.role[self] != PressureRole::unknown) {
      diagonal_.append(i, equation.n0);
    } else {
      right_hand_side_[self] = -equation.source[self] / equation.factor;
      images.clear();
      others.clear();
      double sum = 0.0;
      const std::size_t row_begin = diagonal_.used;
      std::size_t own_place = 0;  // of the diagonal entry; columns ascend
      bool placed = false;
      const auto place_own = [&] {
        own_place = diagonal_.used;
        diagonal_.append(i, 0.0);
        placed = true;
      };
      for (int k = equation.far.begin(i); k < equation.far.end(i); ++k) {
        const int j = equation.far.index[static_cast<std::size_t>(k)];
        const PressureRole role = equation.role[static_cast<std::size_t>(j)];
        if (role == PressureRole::excluded) continue;
        const PetscInt row = equation.row[static_cast<std::size_t>(j)];
        if (row == equation.row[self]) continue;  // its own mirror image
        const double weight = equation.far.weight[static_cast<std::size_t>(k)];
        sum += weight;
        if (role == PressureRole::zero) continue;
        if (j < owned) {
          if (j > i && !placed) place_own();
          diagonal_.append(j, -weight);
        } else if (row >= first_row_ && row < first_row_ + own_rows) {
          images.emplace_back(row - first_row_, -weight);
        } else {
          others.emplace_back(row, -weight);
        }
      }
      if (!placed) place_own();
      if (!equation.surface.empty()) sum += equation.surface[self];
      if (sum == 0.0) sum = equation.n0;
      if (pocket_[self] == equation.row[self]) sum += equation.n0;
      diagonal_.value[own_place] = sum;
      diagonal_entries_[self] = sum;
      if (!images.empty()) diagonal_.merge(row_begin, images);
      off_diagonal_.merge(off_diagonal_.used, others);
    }
    diagonal_.end_row();
    off_diagonal_.end_row();
  }

  // A pocket's source must be free of a mean, or no pressure field could answer it.
  if (!pockets_.empty()) {
    std::vector<double> sums(2 * pockets_.size(), 0.0);
    for (std::size_t i = 0; i < pocket_.size(); ++i) {
      if (pocket_[i] < 0) continue;
      const std::size_t place = place_of(pockets_, pocket_[i]);
      sums[2 * place] += right_hand_side_[i];
      sums[2 * place + 1] += 1.0;
    }
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, comm_);
    for (std::size_t i = 0; i < pocket_.size(); ++i) {
      if (pocket_[i] < 0) continue;
      const std::size_t place = place_of(pockets_, pocket_[i]);
      right_hand_side_[i] -= sums[2 * place] / sums[2 * place + 1];
    }
  }

  // The matrix uses the arrays as they are, without a copy.
  if (!distributed) {
    check(MatCreateSeqAIJWithArrays(comm_, own_rows, own_rows, diagonal_.start.data(), diagonal_.column.data(),
                                    diagonal_.value.data(), matrix_.address()));
  } else {
    check(MatCreateMPIAIJWithSplitArrays(comm_, own_rows, own_rows, PETSC_DETERMINE, PETSC_DETERMINE,
                                         diagonal_.start.data(), diagonal_.column.data(), diagonal_.value.data(),
                                         off_diagonal_.start.data(), off_diagonal_.column.data(),
                                         off_diagonal_.value.data(), matrix_.address()));
  }
  check(MatSetOption(matrix_, MAT_SPD, PETSC_TRUE));
}

void PressureSolver::find_pockets(const PressureEquation& equation, const Halo& halo) {
  const int owned = equation.far.rows();
  const auto any_neighbour = [&](int i, auto&& test) {
    for (int k = equation.far.begin(i); k < equation.far.end(i); ++k)
      if (test(static_cast<std::size_t>(equation.far.index[static_cast<std::size_t>(k)]))) return true;
    return false;
  };
  pockets_.clear();
  pocket_.assign(static_cast<std::size_t>(owned), -1);

  // A particle is anchored if p = 0 is reached from it over unknowns.
  std::vector<std::uint8_t> anchored(equation.role.size(), 0);
  for (std::size_t i = 0; i < anchored.size(); ++i) anchored[i] = equation.role[i] == PressureRole::zero;
  for (std::size_t i = 0; i < equation.surface.size(); ++i)
    if (equation.surface[i] > 0.0) anchored[i] = 1;
  spread(comm_, halo, anchored, owned, [&](int i) {
    const auto self = static_cast<std::size_t>(i);
    if (anchored[self] || equation.role[self] != PressureRole::unknown) return false;
    anchored[self] = any_neighbour(i, [&](std::size_t j) { return anchored[j] != 0; });
    return anchored[self] != 0;
  });
  const auto in_pocket = [&](std::size_t i) { return equation.role[i] == PressureRole::unknown && !anchored[i]; };
  bool found = false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(owned); ++i) found |= in_pocket(i);
  if (!any_rank(comm_, found)) return;

  // A pocket's label is its smallest row.
  halo.refresh(anchored, owned);
  std::vector<PetscInt> label(equation.row.begin(), equation.row.end());
  spread(comm_, halo, label, owned, [&](int i) {
    const auto self = static_cast<std::size_t>(i);
    if (!in_pocket(self)) return false;
    PetscInt smallest = label[self];
    any_neighbour(i, [&](std::size_t j) {
      if (in_pocket(j)) smallest = std::min(smallest, label[j]);
      return false;
    });
    return std::exchange(label[self], smallest) != smallest;
  });
  std::vector<PetscInt> own_labels;
  for (std::size_t i = 0; i < static_cast<std::size_t>(owned); ++i) {
    if (!in_pocket(i)) continue;
    pocket_[i] = label[i];
    own_labels.push_back(label[i]);
  }
  pockets_ = gather_labels(comm_, std::move(own_labels));
}

PressureReport PressureSolver::solve(std::vector<double>& pressure) {
  PressureReport report;
  report.pockets = static_cast<int>(pockets_.size());
  const auto n = static_cast<PetscInt>(right_hand_side_.size());
  PetscVector b, x, residual;
  check(VecCreateMPIWithArray(comm_, 1, n, PETSC_DETERMINE, right_hand_side_.data(), b.address()));
  check(VecCreateMPIWithArray(comm_, 1, n, PETSC_DETERMINE, pressure.data(), x.address()));
  double b_norm = 0.0;
  check(VecNorm(b, NORM_2, &b_norm));
  if (!std::isfinite(b_norm)) {
    report.failure = "the source is not a number";
    return report;
  }
  if (b_norm == 0.0) {
    check(VecZeroEntries(x));
    return report;
  }
  // The last step's pressure, if it is a better guess than zero.
  double start_norm = 0.0;
  check(VecDuplicate(b, residual.address()));
  check(MatMult(matrix_, x, residual));
  check(VecAXPY(residual, -1.0, b));
  check(VecNorm(residual, NORM_2, &start_norm));
  if (!(start_norm < b_norm)) check(VecZeroEntries(x));

  check(KSPSetOperators(solver_, matrix_, matrix_));
  check(KSPSolve(solver_, b, x));
  KSPConvergedReason reason;
  PetscInt iterations = 0;
  check(KSPGetConvergedReason(solver_, &reason));
  check(KSPGetIterationNumber(solver_, &iterations));
  check(MatMult(matrix_, x, residual));
  check(VecAXPY(residual, -1.0, b));
  check(VecNorm(residual, NORM_2, &report.residual));
  report.residual /= b_norm;
  report.iterations = static_cast<int>(iterations);
  if (reason < 0)
    report.failure = fmt::format("{} after {} iterations, relative residual {:.2e}", KSPConvergedReasons[reason],
                                 iterations, report.residual);

  if (!pockets_.empty()) {
    std::vector<double> lowest(pockets_.size(), std::numeric_limits<double>::max());
    for (std::size_t i = 0; i < pocket_.size(); ++i) {
      if (pocket_[i] < 0) continue;
      double& low = lowest[place_of(pockets_, pocket_[i])];
      low = std::min(low, pressure[i]);
    }
    MPI_Allreduce(MPI_IN_PLACE, lowest.data(), static_cast<int>(lowest.size()), MPI_DOUBLE, MPI_MIN, comm_);
    for (std::size_t i = 0; i < pocket_.size(); ++i)
      if (pocket_[i] >= 0) pressure[i] -= lowest[place_of(pockets_, pocket_[i])];
  }
  return report;
}

std::size_t PressureSolver::bytes() const {
  std::size_t sum = right_hand_side_.capacity() * sizeof(double) + pocket_.capacity() * sizeof(PetscInt);
  for (const Block* block : {&diagonal_, &off_diagonal_})
    sum += (block->start.capacity() + block->column.capacity()) * sizeof(PetscInt) +
           block->value.capacity() * sizeof(double);
  return sum;
}

}  // namespace impinge
