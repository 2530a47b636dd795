#include "impinge/two_level.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace impinge {
namespace {

constexpr const char* smoother_option = "-ppe_coarse_pc_hypre_boomeramg_relax_type_all";
constexpr double jacobi_weight = 1.5;
constexpr double least_node_weight = 0.05;  // a node with less interpolation weight is left out
constexpr double regularisation = 1e-9;     // of A_c's diagonal: few particles may leave P without full rank
constexpr int oldest = 10;                  // solves with one coarse matrix
constexpr double most_growth = 1.3;         // of the iterations

constexpr int power(int base, int exponent) { return exponent == 0 ? 1 : base * power(base, exponent - 1); }

/// Calls use(k, offset) for the points of a cube of `size` points along each axis, offsets from `first` on.
template <int Dim, class Use>
void for_cube(int size, int first, Use&& use) {
  for (int k = 0; k < power(size, Dim); ++k) {
    std::array<int, Dim> offset;
    int rest = k;
    for (int& component : offset) {
      component = rest % size + first;
      rest /= size;
    }
    use(k, offset);
  }
}

/// The k of a point of such a cube, from its offset to the first point.
template <int Dim>
int place_in_cube(int size, const std::array<int, Dim>& offset) {
  int k = 0;
  for (std::size_t axis = Dim; axis-- > 0;) k = k * size + offset[axis];
  return k;
}

template <int Dim>
std::array<int, Dim> sum(std::array<int, Dim> a, const std::array<int, Dim>& b) {
  for (std::size_t k = 0; k < Dim; ++k) a[k] += b[k];
  return a;
}

}  // namespace

template <int Dim>
TwoLevelPreconditioner<Dim>::TwoLevelPreconditioner(MPI_Comm comm, const CellGrid<Dim>& cells)
    : comm_(comm), cells_(cells) {
  create_coarse_solver();
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::create_coarse_solver() {
  check(KSPCreate(comm_, coarse_solver_.address()));
  check(KSPSetOptionsPrefix(coarse_solver_, "ppe_coarse_"));
  check(KSPSetType(coarse_solver_, KSPPREONLY));
  PC preconditioner;
  check(KSPGetPC(coarse_solver_, &preconditioner));
  check(PCSetType(preconditioner, PCHYPRE));
  // BoomerAMG's own smoother, Jacobi between ranks, is indefinite where few particles tie nodes of two ranks together.
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsHasName(nullptr, nullptr, smoother_option, &given));
  if (!given) check(PetscOptionsSetValue(nullptr, smoother_option, "l1scaled-SOR/Jacobi"));
  check(KSPSetFromOptions(coarse_solver_));
  if (!given) check(PetscOptionsClearValue(nullptr, smoother_option));
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::set_owners(std::span<const int> owner) {
  // Root of a cell: its place among the cells of its rank.
  std::vector<int> count(static_cast<std::size_t>(ranks_of(comm_)), 0);
  std::vector<PetscInt> root(owner.size());
  for (std::size_t cell = 0; cell < owner.size(); ++cell) root[cell] = count[static_cast<std::size_t>(owner[cell])]++;
  const int self = rank_of(comm_);
  owned_cells_ = static_cast<std::size_t>(count[static_cast<std::size_t>(self)]);

  node_of_cell_.assign(owner.size(), -1);
  cell_of_node_.clear();
  std::vector<PetscSFNode> remote;
  for (std::size_t cell = 0; cell < owner.size(); ++cell) {
    if (owner[cell] != self) continue;
    for_cells_around(cells_, static_cast<int>(cell), node_reach, [&](int near, const Image<Dim>&) {
      if (node_of_cell_[static_cast<std::size_t>(near)] >= 0) return;
      node_of_cell_[static_cast<std::size_t>(near)] = static_cast<int>(cell_of_node_.size());
      cell_of_node_.push_back(near);
      remote.push_back({owner[static_cast<std::size_t>(near)], root[static_cast<std::size_t>(near)]});
    });
  }
  check(PetscSFCreate(comm_, nodes_.address()));
  check(PetscSFSetGraph(nodes_, static_cast<PetscInt>(owned_cells_), static_cast<PetscInt>(remote.size()), nullptr,
                        PETSC_COPY_VALUES, remote.data(), PETSC_COPY_VALUES));
  check(PetscSFSetUp(nodes_));
  node_of_root_.clear();
  for (std::size_t cell = 0; cell < owner.size(); ++cell)
    if (owner[cell] == self) node_of_root_.push_back(node_of_cell_[cell]);
  root_value_.assign(owned_cells_, 0.0);
  leaf_value_.assign(cell_of_node_.size(), 0.0);
  number_.assign(cell_of_node_.size(), -1);
  stale_ = true;
}

template <int Dim>
int TwoLevelPreconditioner<Dim>::local_node(const std::array<int, Dim>& coordinates) const {
  Image<Dim> image;
  const int cell = cells_.wrapped_cell(coordinates, image);
  return cell < 0 ? -1 : node_of_cell_[static_cast<std::size_t>(cell)];
}

template <int Dim>
typename TwoLevelPreconditioner<Dim>::Place TwoLevelPreconditioner<Dim>::place(const Vec<Dim>& position) const {
  Place result;
  Vec<Dim> upper;  // weight of base + 1
  const Vec<Dim> in_edges = cells_.in_edges(cells_.unmirrored(position));
  for (int k = 0; k < Dim; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    double at = in_edges[k] - 0.5;
    if (cells_.edges()[axis].low != Edge::periodic) at = std::clamp(at, 0.0, cells_.extent()[axis] - 1.0);
    const double base = std::floor(at);
    result.base[axis] = static_cast<int>(base);
    upper[k] = at - base;
  }
  for_cube<Dim>(2, 0, [&](int c, const std::array<int, Dim>& corner) {
    double& weight = result.weight[static_cast<std::size_t>(c)];
    weight = 1.0;
    for (int k = 0; k < Dim; ++k) weight *= corner[static_cast<std::size_t>(k)] == 1 ? upper[k] : 1.0 - upper[k];
  });
  return result;
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::find_interpolation(const PressureEquation& equation,
                                                     std::span<const Vec<Dim>> position) {
  const auto owned = static_cast<std::size_t>(equation.far.rows());
  node_.assign(owned * corners, -1);
  weight_.assign(owned * corners, 0.0);
  for (std::size_t i = 0; i < owned; ++i) {
    if (equation.role[i] != PressureRole::unknown) continue;
    const Place at = place(position[i]);
    for_cube<Dim>(2, 0, [&](int c, const std::array<int, Dim>& corner) {
      const std::size_t entry = i * corners + static_cast<std::size_t>(c);
      weight_[entry] = at.weight[static_cast<std::size_t>(c)];
      if (weight_[entry] > 0.0) node_[entry] = local_node(sum<Dim>(at.base, corner));
    });
  }
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::sum_at_roots() {
  std::fill(root_value_.begin(), root_value_.end(), 0.0);
  check(PetscSFReduceBegin(nodes_, MPI_DOUBLE, leaf_value_.data(), root_value_.data(), MPI_SUM));
  check(PetscSFReduceEnd(nodes_, MPI_DOUBLE, leaf_value_.data(), root_value_.data(), MPI_SUM));
}

// The cells with enough particles.
template <int Dim>
void TwoLevelPreconditioner<Dim>::find_coarse_rows() {
  std::fill(leaf_value_.begin(), leaf_value_.end(), 0.0);
  for (std::size_t k = 0; k < node_.size(); ++k)
    if (node_[k] >= 0) leaf_value_[static_cast<std::size_t>(node_[k])] += weight_[k];
  sum_at_roots();
  root_.clear();
  for (std::size_t k = 0; k < owned_cells_; ++k)
    if (root_value_[k] >= least_node_weight) root_.push_back(k);
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::number_nodes() {
  PetscInt next = 0;
  const auto n_own = static_cast<PetscInt>(root_.size());
  MPI_Exscan(&n_own, &next, 1, MPIU_INT, MPI_SUM, comm_);
  std::vector<PetscInt> root_number(owned_cells_, -1);
  for (const std::size_t k : root_) root_number[k] = next++;
  check(PetscSFBcastBegin(nodes_, MPIU_INT, root_number.data(), number_.data(), MPI_REPLACE));
  check(PetscSFBcastEnd(nodes_, MPIU_INT, root_number.data(), number_.data(), MPI_REPLACE));
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::build_coarse_matrix(const PressureEquation& equation,
                                                      std::span<const Vec<Dim>> position) {
  // Row by row: (A P)_i on the 4^Dim nodes that neighbours of i touch, then P^T (A P) on the 5^Dim around each node.
  constexpr int near_size = power(4, Dim);
  constexpr int stencil_size = power(5, Dim);
  std::array<int, corners> corner_in_near, corner_in_stencil;
  for_cube<Dim>(2, 0, [&](int c, const std::array<int, Dim>& corner) {
    corner_in_near[static_cast<std::size_t>(c)] = place_in_cube<Dim>(4, corner);
    corner_in_stencil[static_cast<std::size_t>(c)] = place_in_cube<Dim>(5, corner);
  });
  std::array<int, near_size> near_in_stencil;
  for_cube<Dim>(4, 1, [&](int q, const std::array<int, Dim>& offset) {
    near_in_stencil[static_cast<std::size_t>(q)] = place_in_cube<Dim>(5, offset);
  });

  std::vector<Place> places(position.size());
  for (std::size_t i = 0; i < position.size(); ++i)
    if (equation.role[i] == PressureRole::unknown) places[i] = place(position[i]);

  std::vector<double> stencil(cell_of_node_.size() * stencil_size, 0.0);
  std::array<double, near_size> row;
  for (int i = 0; i < equation.far.rows(); ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (equation.role[self] != PressureRole::unknown) continue;
    row.fill(0.0);
    const auto add = [&](std::size_t j, double entry) {
      std::array<int, Dim> offset;
      for (std::size_t k = 0; k < Dim; ++k) offset[k] = places[j].base[k] - places[self].base[k] + 1;
      const int first = place_in_cube<Dim>(4, offset);
      for (std::size_t c = 0; c < corners; ++c)
        row[static_cast<std::size_t>(first + corner_in_near[c])] += entry * places[j].weight[c];
    };
    add(self, diagonal_[self]);
    for (int k = equation.far.begin(i); k < equation.far.end(i); ++k) {
      const auto j = static_cast<std::size_t>(equation.far.index[static_cast<std::size_t>(k)]);
      if (equation.role[j] == PressureRole::unknown && equation.row[j] != equation.row[self])
        add(j, -equation.far.weight[static_cast<std::size_t>(k)]);
    }
    for (std::size_t c = 0; c < corners; ++c) {
      const int node = node_[self * corners + c];
      if (node < 0) continue;
      double* entries = &stencil[static_cast<std::size_t>(node) * stencil_size];
      const double weight = places[self].weight[c];
      for (std::size_t q = 0; q < near_size; ++q) entries[near_in_stencil[q] - corner_in_stencil[c]] += weight * row[q];
    }
  }

  // Sums at the roots, in an order that does not change from run to run.
  std::vector<double> sums(owned_cells_ * stencil_size, 0.0);
  MPI_Datatype whole_stencil;
  MPI_Type_contiguous(stencil_size, MPI_DOUBLE, &whole_stencil);
  MPI_Type_commit(&whole_stencil);
  check(PetscSFReduceBegin(nodes_, whole_stencil, stencil.data(), sums.data(), MPI_SUM));
  check(PetscSFReduceEnd(nodes_, whole_stencil, stencil.data(), sums.data(), MPI_SUM));
  MPI_Type_free(&whole_stencil);

  create_coarse_matrix();
  std::vector<PetscInt> columns;
  std::vector<double> values;
  for (const std::size_t root : root_) {
    const auto node = static_cast<std::size_t>(node_of_root_[root]);
    const auto centre = cells_.coordinates(cell_of_node_[node]);
    columns.clear();
    values.clear();
    sums[root * stencil_size + stencil_size / 2] *= 1.0 + regularisation;
    for_cube<Dim>(5, -2, [&](int k, const std::array<int, Dim>& offset) {
      const double value = sums[root * stencil_size + static_cast<std::size_t>(k)];
      if (value == 0.0) return;
      const int other = local_node(sum<Dim>(centre, offset));
      if (other < 0 || number_[static_cast<std::size_t>(other)] < 0) return;
      columns.push_back(number_[static_cast<std::size_t>(other)]);
      values.push_back(value);
    });
    check(MatSetValues(coarse_matrix_, 1, &number_[node], static_cast<PetscInt>(columns.size()), columns.data(),
                       values.data(), ADD_VALUES));
  }
  finish_coarse_matrix();
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::create_coarse_matrix() {
  const auto n_own = static_cast<PetscInt>(root_.size());
  check(MatCreateAIJ(comm_, n_own, n_own, PETSC_DETERMINE, PETSC_DETERMINE, power(5, Dim), nullptr, power(5, Dim),
                     nullptr, coarse_matrix_.address()));
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::finish_coarse_matrix() {
  check(MatAssemblyBegin(coarse_matrix_, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(coarse_matrix_, MAT_FINAL_ASSEMBLY));
  check(MatSetOption(coarse_matrix_, MAT_SPD, PETSC_TRUE));
  check(MatCreateVecs(coarse_matrix_, coarse_solution_.address(), coarse_residual_.address()));
  create_coarse_solver();
  check(KSPSetOperators(coarse_solver_, coarse_matrix_, coarse_matrix_));
  check(KSPSetUp(coarse_solver_));
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::update(const PressureEquation& equation, std::span<const Vec<Dim>> position,
                                         std::span<const double> diagonal, int iterations) {
  diagonal_ = diagonal;
  find_interpolation(equation, position);
  if (age_ == 1) fresh_iterations_ = iterations;
  if (stale_ || age_ >= oldest || iterations > most_growth * fresh_iterations_ + 1) {
    find_coarse_rows();
    number_nodes();
    build_coarse_matrix(equation, position);
    stale_ = false;
    age_ = 0;
    ++builds_;
  }
  ++age_;
}

template <int Dim>
CoarseRows TwoLevelPreconditioner<Dim>::coarse_rows() const {
  CoarseRows rows;
  if (age() == 0) return rows;
  rows.cell.assign(root_.begin(), root_.end());
  PetscInt first = 0, end = 0;
  check(MatGetOwnershipRange(coarse_matrix_, &first, &end));
  for (PetscInt row = first; row < end; ++row) {
    PetscInt length = 0;
    const PetscInt* columns = nullptr;
    const double* values = nullptr;
    check(MatGetRow(coarse_matrix_, row, &length, &columns, &values));
    rows.length.push_back(length);
    rows.column.insert(rows.column.end(), columns, columns + length);
    rows.value.insert(rows.value.end(), values, values + length);
    check(MatRestoreRow(coarse_matrix_, row, &length, &columns, &values));
  }
  return rows;
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::set_coarse_rows(const CoarseRows& rows, int age, int fresh_iterations) {
  root_.assign(rows.cell.begin(), rows.cell.end());
  number_nodes();
  create_coarse_matrix();
  PetscInt row = 0;
  check(MatGetOwnershipRange(coarse_matrix_, &row, nullptr));
  const std::vector<PetscInt> columns(rows.column.begin(), rows.column.end());
  std::size_t entry = 0;
  for (const std::int64_t length : rows.length) {
    check(MatSetValues(coarse_matrix_, 1, &row, static_cast<PetscInt>(length), &columns[entry], &rows.value[entry],
                       INSERT_VALUES));
    entry += static_cast<std::size_t>(length);
    ++row;
  }
  finish_coarse_matrix();
  stale_ = false;
  age_ = age;
  fresh_iterations_ = fresh_iterations;
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::attach(PC preconditioner) {
  check(PCShellSetContext(preconditioner, this));
  check(PCShellSetApply(preconditioner, [](PC shell, ::Vec residual, ::Vec result) -> PetscErrorCode {
    void* self = nullptr;
    PetscCall(PCShellGetContext(shell, &self));
    try {
      static_cast<TwoLevelPreconditioner*>(self)->apply(residual, result);
    } catch (const PetscFailure& error) {  // must not pass through PETSc
      SETERRQ(PETSC_COMM_SELF, PETSC_ERR_LIB, "%s", error.what());
    }
    return 0;
  }));
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::apply(::Vec residual, ::Vec result) {
  const double* r = nullptr;
  double* z = nullptr;
  check(VecGetArrayRead(residual, &r));
  check(VecGetArray(result, &z));
  const std::size_t owned = diagonal_.size();
  std::fill(leaf_value_.begin(), leaf_value_.end(), 0.0);
  for (std::size_t i = 0; i < owned; ++i)
    for (std::size_t k = i * corners; k < (i + 1) * corners; ++k)
      if (node_[k] >= 0) leaf_value_[static_cast<std::size_t>(node_[k])] += weight_[k] * r[i];
  sum_at_roots();

  double* coarse = nullptr;
  check(VecGetArray(coarse_residual_, &coarse));
  for (std::size_t k = 0; k < root_.size(); ++k) coarse[k] = root_value_[root_[k]];
  check(VecRestoreArray(coarse_residual_, &coarse));
  check(KSPSolve(coarse_solver_, coarse_residual_, coarse_solution_));
  std::fill(root_value_.begin(), root_value_.end(), 0.0);
  check(VecGetArray(coarse_solution_, &coarse));
  for (std::size_t k = 0; k < root_.size(); ++k) root_value_[root_[k]] = coarse[k];
  check(VecRestoreArray(coarse_solution_, &coarse));

  check(PetscSFBcastBegin(nodes_, MPI_DOUBLE, root_value_.data(), leaf_value_.data(), MPI_REPLACE));
  check(PetscSFBcastEnd(nodes_, MPI_DOUBLE, root_value_.data(), leaf_value_.data(), MPI_REPLACE));
  for (std::size_t i = 0; i < owned; ++i) {
    double value = jacobi_weight * r[i] / diagonal_[i];
    for (std::size_t k = i * corners; k < (i + 1) * corners; ++k)
      if (node_[k] >= 0) value += weight_[k] * leaf_value_[static_cast<std::size_t>(node_[k])];
    z[i] = value;
  }
  check(VecRestoreArray(result, &z));
  check(VecRestoreArrayRead(residual, &r));
}

template <int Dim>
std::size_t TwoLevelPreconditioner<Dim>::bytes() const {
  return (weight_.capacity() + root_value_.capacity() + leaf_value_.capacity()) * sizeof(double) +
         (node_.capacity() + node_of_cell_.capacity() + cell_of_node_.capacity() + node_of_root_.capacity()) *
             sizeof(int) +
         number_.capacity() * sizeof(PetscInt) + root_.capacity() * sizeof(std::size_t);
}

template class TwoLevelPreconditioner<2>;
template class TwoLevelPreconditioner<3>;

}  // namespace impinge
