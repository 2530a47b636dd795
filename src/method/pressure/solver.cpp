#include "impinge/method/pressure/solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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

// Spreads a mark from particle to particle until nothing changes on any rank or nothing is left to mark. sweep()
// updates the marks of owned particles as far as it gets on its own. True if something is left on any rank.
template <class T, class Sweep>
bool spread(MPI_Comm comm, const Halo& halo, std::vector<T>& mark, int owned, Sweep&& sweep) {
  while (true) {
    halo.refresh(mark, owned);
    const auto [changed, is_left] = sweep();
    std::array<int, 2> anywhere{changed, is_left};
    MPI_Allreduce(MPI_IN_PLACE, anywhere.data(), 2, MPI_INT, MPI_MAX, comm);
    if (!anywhere[0] || !anywhere[1]) return anywhere[1] != 0;
  }
}

constexpr double reserve = 1.3;  // most pairs of the particles on average, over those of the full lattice

}  // namespace

PressureSolver::PressureSolver(MPI_Comm comm, double tolerance) : comm_(comm), tolerance_(tolerance) {
  petsc_check(PCRegister(two_level, [](PC preconditioner) { return PCSetType(preconditioner, PCSHELL); }));
  char chosen[64] = "";
  petsc_check(PetscOptionsGetString(nullptr, prefix, "-pc_type", chosen, sizeof chosen, nullptr));
  if (std::string(chosen) == "hypre") {
    const auto prefer = [&](const char* name, const char* value) {
      const std::string option = fmt::format("-{}{}", prefix, name);
      if (set_default_option(option, value)) default_options_.push_back(option);
    };
    prefer("pc_hypre_boomeramg_coarsen_type", "HMIS");
    prefer("pc_hypre_boomeramg_interp_type", "ext+i");
    prefer("pc_hypre_boomeramg_P_max", "4");
    prefer("pc_hypre_boomeramg_agg_nl", "1");
    prefer("pc_hypre_boomeramg_relax_type_down", "SOR/Jacobi");
    prefer("pc_hypre_boomeramg_relax_type_up", "backward-SOR/Jacobi");
  }
  create_solver();
}

void PressureSolver::create_solver() {
  petsc_check(KSPCreate(comm_, solver_.address()));
  petsc_check(KSPSetOptionsPrefix(solver_, prefix));
  petsc_check(KSPSetType(solver_, KSPCG));
  petsc_check(KSPCGUseSingleReduction(solver_, PETSC_TRUE));
  petsc_check(KSPSetNormType(solver_, KSP_NORM_UNPRECONDITIONED));
  petsc_check(KSPSetTolerances(solver_, tolerance_, PETSC_DEFAULT, 1e20, 10000));
  petsc_check(PCSetType(preconditioner(), two_level));
  petsc_check(KSPSetFromOptions(solver_));
  PetscBool is_shell = PETSC_FALSE;
  petsc_check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(preconditioner()), PCSHELL, &is_shell));
  is_two_level_ = is_shell == PETSC_TRUE;
}

PC PressureSolver::preconditioner() const {
  PC result = nullptr;
  petsc_check(KSPGetPC(solver_, &result));
  return result;
}

void PressureSolver::assemble(const PressureEquation& equation, const Halo& halo) {
  create_solver();  // KSPReset would leave a multigrid's levels with the sizes of the last step
  whole_matrix_.reset();
  const std::size_t owned = equation.source.size();
  first_row_ = owned > 0 ? equation.row[0] : 0;
  const double usual_entries = reserve * static_cast<double>(owned) * (0.5 * equation.usual_pairs + 1.0);
  rows_.own.clear(owned, static_cast<std::size_t>(usual_entries));
  rows_.others.clear(owned, 0);
  rows_.diagonal.assign(owned, equation.n0);
  rows_.coupling.assign(owned, 0.0);
  right_hand_side_.assign(owned, 0.0);
  anchored_.assign(equation.role.size(), 0);
  equation.for_rows([&](int i, const PressureEquation::Row& row) { append_row(equation, i, row); });
  find_pockets(equation, halo);
  close_pockets(equation);

  auto all_rows = static_cast<PetscInt>(owned);
  MPI_Allreduce(MPI_IN_PLACE, &all_rows, 1, MPIU_INT, MPI_SUM, comm_);
  matrix_.build(comm_, rows_, halo, all_rows);
  if (!is_two_level_) whole_matrix_ = matrix_.whole_matrix(equation.row);
}

void PressureSolver::append_row(const PressureEquation& equation, int i, const PressureEquation::Row& row) {
  const auto self = static_cast<std::size_t>(i);
  const PairRow& pairs = row.pairs;
  MatrixRows::Block& own = rows_.own;
  own.make_room(pairs.index.size() + 1);
  PetscInt* const column = own.column.data();
  double* const value = own.value.data();
  const auto row_begin = static_cast<std::size_t>(own.start.back());
  std::size_t used = row_begin;
  images_.clear();
  others_.clear();
  if (equation.role[self] != PressureRole::unknown) {
    column[used] = i;
    value[used++] = equation.n0;
    anchored_[self] = equation.role[self] == PressureRole::zero;
  } else {
    const int owned = static_cast<int>(equation.source.size());
    const int first_image = static_cast<int>(equation.role.size());
    double sum = 0.0;
    double zeros = 0.0;  // of the sum
    double offset = 0.0;
    ++used;  // the diagonal
    for (std::size_t k = 0; k < pairs.index.size(); ++k) {
      int j = pairs.index[k];
      const double weight = pairs.weight[k];
      if (j < owned) {
        const PressureRole role = equation.role[static_cast<std::size_t>(j)];
        sum += role == PressureRole::absent ? 0.0 : weight;
        zeros += role == PressureRole::zero ? weight : 0.0;
        column[used] = j;
        value[used] = -weight;
        used += role == PressureRole::unknown && j > i ? 1 : 0;
        continue;
      }
      const bool is_image = j >= first_image;
      const auto image = static_cast<std::size_t>(is_image ? j - first_image : 0);
      if (is_image) j = equation.original[image];
      const PressureRole role = equation.role[static_cast<std::size_t>(j)];
      if (role == PressureRole::absent) continue;
      if (is_image && !equation.image_offset.empty()) offset += weight * equation.image_offset[image];
      const PetscInt other = equation.row[static_cast<std::size_t>(j)];
      if (other == equation.row[self]) continue;  // its own image
      sum += weight;
      if (role == PressureRole::zero) {
        zeros += weight;
        continue;
      }
      if (other < first_row_ || other >= first_row_ + owned) {
        others_.push_back({other, j - owned, -weight});
      } else if (other > equation.row[self]) {
        images_.emplace_back(other - first_row_, -weight);
      }
    }
    sum += row.surface_weight;
    zeros += row.surface_weight;
    if (sum > 0.0) rows_.coupling[self] = (sum - zeros) / sum;
    if (sum == 0.0) sum = equation.n0;
    column[row_begin] = i;
    value[row_begin] = sum;
    rows_.diagonal[self] = sum;
    right_hand_side_[self] = offset + row.surface_flux - equation.source[self] / equation.laplacian_factor;
    anchored_[self] = zeros > 0.0;
  }

  // The original of a mirror image is a neighbour, too; that of a periodic image seldom.
  for (const auto& [to, entry] : images_) {
    PetscInt* const place = std::lower_bound(column + row_begin, column + used, to);
    double* const at = value + (place - column);
    if (place != column + used && *place == to) {
      *at += entry;
    } else {
      std::copy_backward(place, column + used, column + used + 1);
      std::copy_backward(at, value + used, value + used + 1);
      *place = to;
      *at = entry;
      ++used;
    }
  }
  own.start.push_back(static_cast<PetscInt>(used));

  // A particle of another rank may be seen more than once, as itself and as images.
  MatrixRows::Block& others = rows_.others;
  others.make_room(others_.size());
  std::ranges::stable_sort(others_, {}, &OtherEntry::row);
  auto end = static_cast<std::size_t>(others.start.back());
  PetscInt last = -1;
  for (const OtherEntry& entry : others_) {
    if (std::exchange(last, entry.row) == entry.row) {
      others.value[end - 1] += entry.value;
    } else {
      others.column[end] = entry.particle;
      others.value[end++] = entry.value;
    }
  }
  others.start.push_back(static_cast<PetscInt>(end));
}

// True if test(j) is, for any of the neighbours in a row: particles after i and halo.
template <class Test>
bool PressureSolver::any_later(std::size_t i, Test&& test) const {
  const auto in = [&](const MatrixRows::Block& block, std::size_t first) {
    const auto begin = block.column.begin() + block.start[i], end = block.column.begin() + block.start[i + 1];
    return std::any_of(begin, end, [&](PetscInt column) { return test(first + static_cast<std::size_t>(column)); });
  };
  return in(rows_.own, 0) || in(rows_.others, rows_.diagonal.size());
}

// Pins one particle of each pocket and frees its source of the mean, or no pressure field could answer it.
void PressureSolver::close_pockets(const PressureEquation& equation) {
  if (pockets_.empty()) return;
  std::vector<double> sums(2 * pockets_.size(), 0.0);
  for (std::size_t i = 0; i < pocket_.size(); ++i) {
    if (pocket_[i] < 0) continue;
    const std::size_t place = place_of(pockets_, pocket_[i]);
    sums[2 * place] += right_hand_side_[i];
    sums[2 * place + 1] += 1.0;
    if (pocket_[i] != equation.row[i]) continue;
    rows_.diagonal[i] += equation.n0;
    rows_.own.value[static_cast<std::size_t>(rows_.own.start[i])] = rows_.diagonal[i];
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, comm_);
  for (std::size_t i = 0; i < pocket_.size(); ++i) {
    if (pocket_[i] < 0) continue;
    const std::size_t place = place_of(pockets_, pocket_[i]);
    right_hand_side_[i] -= sums[2 * place] / sums[2 * place + 1];
  }
}

// Most hear of p = 0 from a later particle, all but a few of the rest from no one: only if some are left over do those
// that know tell the later ones.
PressureSolver::Sweep PressureSolver::spread_anchors(std::span<const PressureRole> role) {
  const std::size_t owned = rows_.diagonal.size();
  bool changed = false;
  while (true) {
    bool left_over = false;
    for (std::size_t i = owned; i-- > 0;) {
      if (anchored_[i] || role[i] != PressureRole::unknown) continue;
      anchored_[i] = any_later(i, [&](std::size_t j) { return anchored_[j] != 0; });
      (anchored_[i] ? changed : left_over) = true;
    }
    if (!left_over) return {changed, false};
    bool told = false;
    for (std::size_t i = 0; i < owned; ++i) {
      if (anchored_[i] != 1 || role[i] != PressureRole::unknown) continue;
      anchored_[i] = 2;
      any_later(i, [&](std::size_t j) {
        if (j < owned && !anchored_[j]) anchored_[j] = told = true;
        return false;
      });
    }
    if (!told) return {changed, true};
    changed = true;
  }
}

void PressureSolver::find_pockets(const PressureEquation& equation, const Halo& halo) {
  const int owned = static_cast<int>(equation.source.size());
  pockets_.clear();
  pocket_.assign(static_cast<std::size_t>(owned), -1);

  if (!spread(comm_, halo, anchored_, owned, [&] { return spread_anchors(equation.role); })) return;
  const auto in_pocket = [&](std::size_t i) { return equation.role[i] == PressureRole::unknown && !anchored_[i]; };

  // A pocket's label is its smallest row. Sweeps go forth and back along the sorted particles, so few are needed.
  std::vector<PetscInt> label(equation.row.begin(), equation.row.end());
  spread(comm_, halo, label, owned, [&] {
    bool changed = false, again = true;
    const auto level = [&](std::size_t i) {
      if (!in_pocket(i)) return;
      any_later(i, [&](std::size_t j) {
        if (!in_pocket(j) || label[j] == label[i]) return false;
        again = true;
        label[i] = label[j] = std::min(label[i], label[j]);
        return false;
      });
    };
    while (again) {
      again = false;
      for (std::size_t i = 0; i < static_cast<std::size_t>(owned); ++i) level(i);
      for (std::size_t i = static_cast<std::size_t>(owned); i-- > 0;) level(i);
      changed |= again;
    }
    return Sweep{changed, true};
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
  PetscVector b, x, residual, change;
  PetscInt all = 0;
  petsc_check(MatGetSize(matrix(), &all, nullptr));
  petsc_check(VecCreateMPIWithArray(comm_, 1, n, all, right_hand_side_.data(), b.address()));
  petsc_check(VecCreateMPIWithArray(comm_, 1, n, all, pressure.data(), x.address()));
  petsc_check(VecDuplicate(b, residual.address()));
  petsc_check(VecDuplicate(b, change.address()));
  for (std::size_t i = 0; i < right_hand_side_.size(); ++i)
    if (rows_.coupling[i] == 0.0) pressure[i] = right_hand_side_[i] / rows_.diagonal[i];
  petsc_check(MatMult(matrix(), x, residual));
  double b_norm = 0.0, x_a_x = 0.0, x_b = 0.0;  // one reduction
  petsc_check(VecNormBegin(b, NORM_2, &b_norm));
  petsc_check(VecDotBegin(x, residual, &x_a_x));
  petsc_check(VecDotBegin(x, b, &x_b));
  petsc_check(VecNormEnd(b, NORM_2, &b_norm));
  petsc_check(VecDotEnd(x, residual, &x_a_x));
  petsc_check(VecDotEnd(x, b, &x_b));
  if (!std::isfinite(b_norm)) {
    report.failure = "the source is not a number";
    return report;
  }
  if (b_norm == 0.0) {
    petsc_check(VecZeroEntries(x));
    return report;
  }
  // The multiple of the guess that is nearest to the solution in the norm of the matrix; the solver finds the rest.
  const double scale = x_a_x > 0.0 ? x_b / x_a_x : 0.0;
  petsc_check(VecScale(x, scale));
  petsc_check(VecAYPX(residual, -scale, b));
  // The residual counts against all of b.
  double relative = 0.0, absolute = 0.0;
  petsc_check(KSPGetTolerances(solver_, &relative, &absolute, nullptr, nullptr));
  petsc_check(KSPSetTolerances(solver_, 0.0, std::max(absolute, relative * b_norm), PETSC_DEFAULT, PETSC_DEFAULT));
  petsc_check(KSPSetOperators(solver_, matrix(), matrix()));
  petsc_check(KSPSolve(solver_, residual, change));
  petsc_check(VecAXPY(x, 1.0, change));

  KSPConvergedReason reason;
  PetscInt iterations = 0;
  petsc_check(KSPGetConvergedReason(solver_, &reason));
  petsc_check(KSPGetIterationNumber(solver_, &iterations));
  petsc_check(MatMult(matrix(), x, residual));
  petsc_check(VecAXPY(residual, -1.0, b));
  petsc_check(VecNorm(residual, NORM_2, &report.residual));
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
  MatInfo whole{};
  if (whole_matrix_ != nullptr) petsc_check(MatGetInfo(whole_matrix_, MAT_LOCAL, &whole));
  return (right_hand_side_.capacity() + rows_.diagonal.capacity() + rows_.coupling.capacity()) * sizeof(double) +
         pocket_.capacity() * sizeof(PetscInt) + rows_.own.bytes() + rows_.others.bytes() +
         static_cast<std::size_t>(whole.nz_allocated) * (sizeof(PetscInt) + sizeof(double));
}

}  // namespace impinge
