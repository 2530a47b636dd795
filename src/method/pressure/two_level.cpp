#include "impinge/method/pressure/two_level.hpp"

#include <algorithm>
#include <cmath>

namespace impinge {
namespace {

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

/// Shares of the corners of a cube, first axis fastest, in a value at a place inside it, 0 to 1 along each axis.
template <int Dim>
std::array<double, 1 << Dim> corner_shares(double value, const Vector<Dim>& inside) {
  std::array<double, 1 << Dim> weight;
  weight[0] = value;
  std::size_t known = 1;
  for (int k = 0; k < Dim; ++k) {
    for (std::size_t c = 0; c < known; ++c) {
      weight[known + c] = inside[k] * weight[c];
      weight[c] -= weight[known + c];
    }
    known *= 2;
  }
  return weight;
}

}  // namespace

template <int Dim>
TwoLevelPreconditioner<Dim>::TwoLevelPreconditioner(MPI_Comm comm, const CellGrid<Dim>& cells)
    : comm_(comm), cells_(cells), owner_(cells), coarse_solver_(comm, Dim) {}

template <int Dim>
void TwoLevelPreconditioner<Dim>::set_owners(const CellOwners<Dim>& owners) {
  owner_ = owners;
  stale_ = true;
}

// Where cells repeat, the one that repeats there; -1 outside.
template <int Dim>
std::int64_t TwoLevelPreconditioner<Dim>::cell_at(const std::array<int, Dim>& coordinates) const {
  Vector<Dim> shift;
  return cells_.wrapped_cell(coordinates, shift);
}

template <int Dim>
std::array<int, Dim> TwoLevelPreconditioner<Dim>::place(const Vector<Dim>& position, Vector<Dim>& inside) const {
  std::array<int, Dim> base;
  const Vector<Dim> in_edges = cells_.in_edges(position);
  for (int k = 0; k < Dim; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    double at = in_edges[k] - 0.5;
    if (!cells_.periodic()[axis]) at = std::clamp(at, 0.0, cells_.extent()[axis] - 1.0);
    base[axis] = static_cast<int>(std::floor(at));
    inside[k] = at - base[axis];
  }
  return base;
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::find_interpolation(std::span<const PressureRole> role,
                                                     std::span<const Vector<Dim>> position) {
  patches_.clear();
  inside_.resize(diagonal_.size());
  for (std::size_t i = 0; i < inside_.size(); ++i) {
    if (role[i] != PressureRole::unknown) continue;
    const std::array<int, Dim> base = place(position[i], inside_[i]);
    if (!patches_.empty() && patches_.back().last == i && patches_.back().base == base) {
      patches_.back().last = i + 1;
      continue;
    }
    patches_.push_back({i, i + 1, base, {}});
  }
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::find_corners() {
  for (Patch& patch : patches_) {
    for_cube<Dim>(2, 0, [&](int c, const std::array<int, Dim>& corner) {
      const int node = nodes_.find(cell_at(sum<Dim>(patch.base, corner)));
      patch.node[static_cast<std::size_t>(c)] = static_cast<std::size_t>(node < 0 ? nodes_.size() : node);
    });
  }
}

// The row of P.
template <int Dim>
typename TwoLevelPreconditioner<Dim>::Corners TwoLevelPreconditioner<Dim>::interpolation(std::size_t i) const {
  return corner_shares(coupling_[i], inside_[i]);
}

// The cells with enough particles: each rank sends the weights of its particles to the owners of the cells.
template <int Dim>
void TwoLevelPreconditioner<Dim>::find_coarse_rows() {
  struct CellWeight {
    std::int64_t cell;
    double weight;
  };
  CellIndex touched;
  std::vector<double> sums;
  std::array<std::size_t, corners> number;
  for (const Patch& patch : patches_) {
    for_cube<Dim>(2, 0, [&](int c, const std::array<int, Dim>& corner) {
      number[static_cast<std::size_t>(c)] =
          static_cast<std::size_t>(touched.insert(cell_at(sum<Dim>(patch.base, corner))));
    });
    sums.resize(static_cast<std::size_t>(touched.size()), 0.0);
    for (std::size_t i = patch.first; i < patch.last; ++i) {
      const Corners weight = interpolation(i);
      for (std::size_t c = 0; c < corners; ++c) sums[number[c]] += weight[c];
    }
  }
  std::vector<std::pair<int, CellWeight>> sends;
  for (std::size_t k = 0; k < sums.size(); ++k)
    if (const std::int64_t cell = touched.cell(static_cast<int>(k)); cell >= 0)
      sends.emplace_back(owner_(cell), CellWeight{cell, sums[k]});
  CellIndex own;
  sums.clear();
  for (const auto& [cell, weight] : exchange_items(comm_, std::span<const std::pair<int, CellWeight>>(sends))) {
    const auto k = static_cast<std::size_t>(own.insert(cell));
    if (k == sums.size()) sums.push_back(0.0);
    sums[k] += weight;
  }
  coarse_rows_.cell.clear();
  for (std::size_t k = 0; k < sums.size(); ++k)
    if (sums[k] >= least_node_weight) coarse_rows_.cell.push_back(own.cell(static_cast<int>(k)));
  std::ranges::sort(coarse_rows_.cell);
}

// Numbers the rows, and tells them to the owners of the cells around.
template <int Dim>
void TwoLevelPreconditioner<Dim>::connect_nodes() {
  struct Row {
    std::int64_t cell;
    PetscInt number;
  };
  PetscInt next = 0;
  const auto n_own = static_cast<PetscInt>(coarse_rows_.cell.size());
  MPI_Exscan(&n_own, &next, 1, MPIU_INT, MPI_SUM, comm_);
  std::vector<std::pair<int, Row>> sends;
  std::vector<int> users;
  for (const std::int64_t cell : coarse_rows_.cell) {
    users.clear();
    for_cells_around(cells_, cell, node_reach, [&](std::int64_t near, const Vector<Dim>&) {
      const int user = owner_(near);
      if (std::ranges::find(users, user) == users.end()) users.push_back(user);
    });
    for (const int user : users) sends.emplace_back(user, Row{cell, next});
    ++next;
  }
  nodes_.clear();
  number_.clear();
  for (const auto& [cell, number] : exchange_items(comm_, std::span<const std::pair<int, Row>>(sends))) {
    nodes_.insert(cell);
    number_.push_back(number);
  }
  PetscLayout rows = nullptr;
  petsc_check(PetscLayoutCreateFromSizes(comm_, n_own, PETSC_DECIDE, 1, &rows));
  petsc_check(PetscSFCreate(comm_, copies_.address()));
  petsc_check(PetscSFSetGraphLayout(copies_, rows, nodes_.size(), nullptr, PETSC_COPY_VALUES, number_.data()));
  petsc_check(PetscSFSetUp(copies_));
  petsc_check(PetscLayoutDestroy(&rows));
  leaf_value_.assign(number_.size() + 1, 0.0);
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::build_coarse_matrix(const MatrixRows& matrix, std::span<const PressureRole> role,
                                                      std::span<const Vector<Dim>> position, const Halo& halo) {
  // A = B + B^T, with half the entries in B: the upper triangle and half of the diagonal and of other ranks' columns.
  // Row by row: (B P)_i on the 3^Dim cubes of nodes around the neighbours of i, then on the 4^Dim nodes themselves;
  // patch by patch P^T (B P) on the same nodes; then on the 5^Dim around each node.
  constexpr std::size_t n_cubes = power(3, Dim);
  constexpr std::size_t near_size = power(4, Dim);
  constexpr std::size_t stencil_size = coarse_stencil<Dim>;
  std::array<std::array<std::size_t, corners>, n_cubes> node_of_cube;
  std::array<std::size_t, corners> corner_in_stencil;
  for_cube<Dim>(2, 0, [&](int c, const std::array<int, Dim>& corner) {
    const auto to = static_cast<std::size_t>(c);
    corner_in_stencil[to] = static_cast<std::size_t>(place_in_cube<Dim>(5, corner));
    for_cube<Dim>(3, 0, [&](int cube, const std::array<int, Dim>& offset) {
      node_of_cube[static_cast<std::size_t>(cube)][to] =
          static_cast<std::size_t>(place_in_cube<Dim>(4, sum<Dim>(offset, corner)));
    });
  });
  std::array<std::size_t, near_size> near_in_stencil;
  for_cube<Dim>(4, 1, [&](int q, const std::array<int, Dim>& offset) {
    near_in_stencil[static_cast<std::size_t>(q)] = static_cast<std::size_t>(place_in_cube<Dim>(5, offset));
  });

  std::vector<double> coupling(matrix.coupling);
  coupling.resize(position.size());
  halo.refresh(coupling, static_cast<int>(coupling_.size()));
  std::vector<std::array<int, Dim>> base(position.size());
  std::vector<Corners> weight(position.size());
  for (std::size_t i = 0; i < position.size(); ++i) {
    if (role[i] != PressureRole::unknown) continue;
    Vector<Dim> inside;
    base[i] = place(position[i], inside);
    weight[i] = corner_shares(coupling[i], inside);
  }

  std::vector<double> stencil((number_.size() + 1) * stencil_size, 0.0);
  std::array<Corners, n_cubes> cubes;
  std::array<double, near_size> row;
  std::array<std::array<double, near_size>, corners> product;
  for (const Patch& patch : patches_) {
    for (auto& line : product) line.fill(0.0);
    for (std::size_t i = patch.first; i < patch.last; ++i) {
      for (Corners& cube : cubes) cube.fill(0.0);
      const auto add = [&](std::size_t j, double entry) {
        std::array<int, Dim> offset;
        for (std::size_t k = 0; k < Dim; ++k) {
          offset[k] = base[j][k] - patch.base[k] + 1;
          if (!cells_.periodic()[k]) continue;
          if (offset[k] > 2) offset[k] -= cells_.extent()[k];
          if (offset[k] < 0) offset[k] += cells_.extent()[k];
        }
        Corners& cube = cubes[static_cast<std::size_t>(place_in_cube<Dim>(3, offset))];
        for (std::size_t c = 0; c < corners; ++c) cube[c] += entry * weight[j][c];
      };
      add(i, 0.5 * matrix.diagonal[i]);
      for (auto k = static_cast<std::size_t>(matrix.own.start[i]) + 1;
           k < static_cast<std::size_t>(matrix.own.start[i + 1]); ++k)
        add(static_cast<std::size_t>(matrix.own.column[k]), matrix.own.value[k]);
      for (auto k = static_cast<std::size_t>(matrix.others.start[i]);
           k < static_cast<std::size_t>(matrix.others.start[i + 1]); ++k)
        add(coupling_.size() + static_cast<std::size_t>(matrix.others.column[k]), 0.5 * matrix.others.value[k]);
      row.fill(0.0);
      for (std::size_t cube = 0; cube < n_cubes; ++cube)
        for (std::size_t c = 0; c < corners; ++c) row[node_of_cube[cube][c]] += cubes[cube][c];
      for (std::size_t c = 0; c < corners; ++c)
        for (std::size_t q = 0; q < near_size; ++q) product[c][q] += weight[i][c] * row[q];
    }
    for (std::size_t c = 0; c < corners; ++c) {
      double* entries = &stencil[patch.node[c] * stencil_size];
      for (std::size_t q = 0; q < near_size; ++q) entries[near_in_stencil[q] - corner_in_stencil[c]] += product[c][q];
    }
  }

  // Sums at the roots, in an order that does not change from run to run, and back to all that need the transpose.
  std::vector<double> sums(coarse_rows_.cell.size() * stencil_size, 0.0);
  MPI_Datatype whole_stencil;
  MPI_Type_contiguous(stencil_size, MPI_DOUBLE, &whole_stencil);
  MPI_Type_commit(&whole_stencil);
  petsc_check(PetscSFReduceBegin(copies_, whole_stencil, stencil.data(), sums.data(), MPI_SUM));
  petsc_check(PetscSFReduceEnd(copies_, whole_stencil, stencil.data(), sums.data(), MPI_SUM));
  petsc_check(PetscSFBcastBegin(copies_, whole_stencil, sums.data(), stencil.data(), MPI_REPLACE));
  petsc_check(PetscSFBcastEnd(copies_, whole_stencil, sums.data(), stencil.data(), MPI_REPLACE));
  MPI_Type_free(&whole_stencil);

  coarse_rows_.length.clear();
  coarse_rows_.column.clear();
  coarse_rows_.value.clear();
  for (const std::int64_t row_cell : coarse_rows_.cell) {
    const auto node = static_cast<std::size_t>(nodes_.find(row_cell));
    const auto centre = cells_.coordinates(row_cell);
    const std::size_t before = coarse_rows_.column.size();
    for_cube<Dim>(5, -2, [&](int k, const std::array<int, Dim>& offset) {
      const int near = nodes_.find(cell_at(sum<Dim>(centre, offset)));
      if (near < 0) return;
      const auto other = static_cast<std::size_t>(near);
      const auto there = static_cast<std::size_t>(k);
      const double value =
          stencil[node * stencil_size + there] + stencil[other * stencil_size + stencil_size - 1 - there];
      if (value == 0.0) return;
      coarse_rows_.column.push_back(number_[other]);
      coarse_rows_.value.push_back(there == stencil_size / 2 ? (1.0 + regularisation) * value : value);
    });
    coarse_rows_.length.push_back(static_cast<std::int64_t>(coarse_rows_.column.size() - before));
  }
  coarse_solver_.set_up(coarse_rows_, number_);
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::update(const MatrixRows& matrix, std::span<const PressureRole> role,
                                         std::span<const Vector<Dim>> position, const Halo& halo, int iterations) {
  diagonal_ = matrix.diagonal;
  coupling_ = matrix.coupling;
  find_interpolation(role, position);
  if (age_ == 1) fresh_iterations_ = iterations;
  const bool renews = stale_ || age_ >= oldest || iterations > most_growth * fresh_iterations_ + 1;
  if (renews) {
    find_coarse_rows();
    connect_nodes();
  }
  find_corners();
  if (renews) {
    build_coarse_matrix(matrix, role, position, halo);
    stale_ = false;
    age_ = 0;
    ++builds_;
  }
  ++age_;
}

template <int Dim>
CoarseRows TwoLevelPreconditioner<Dim>::coarse_rows() const {
  return age() == 0 ? CoarseRows{} : coarse_rows_;
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::set_coarse_rows(const CoarseRows& rows, int age, int fresh_iterations) {
  coarse_rows_ = rows;
  connect_nodes();
  coarse_solver_.set_up(coarse_rows_, number_);
  stale_ = false;
  age_ = age;
  fresh_iterations_ = fresh_iterations;
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::attach(PC preconditioner) {
  petsc_check(PCShellSetContext(preconditioner, this));
  petsc_check(PCShellSetApply(preconditioner, [](PC shell, ::Vec residual, ::Vec result) -> PetscErrorCode {
    void* self = nullptr;
    PetscCall(PCShellGetContext(shell, &self));
    return code_of([&] { static_cast<TwoLevelPreconditioner*>(self)->apply(residual, result); });
  }));
}

template <int Dim>
void TwoLevelPreconditioner<Dim>::apply(::Vec residual, ::Vec result) {
  const double* r = nullptr;
  double* z = nullptr;
  petsc_check(VecGetArrayRead(residual, &r));
  petsc_check(VecGetArray(result, &z));
  const std::size_t owned = diagonal_.size();
  std::fill(leaf_value_.begin(), leaf_value_.end(), 0.0);
  for (const Patch& patch : patches_) {
    Corners sum{};
    for (std::size_t i = patch.first; i < patch.last; ++i) {
      const Corners weight = interpolation(i);
      for (std::size_t c = 0; c < corners; ++c) sum[c] += weight[c] * r[i];
    }
    for (std::size_t c = 0; c < corners; ++c) leaf_value_[patch.node[c]] += sum[c];
  }
  coarse_solver_.solve(std::span(leaf_value_).first(number_.size()));
  leaf_value_.back() = 0.0;
  for (std::size_t i = 0; i < owned; ++i) z[i] = jacobi_weight * r[i] / diagonal_[i];
  for (const Patch& patch : patches_) {
    Corners value;
    for (std::size_t c = 0; c < corners; ++c) value[c] = leaf_value_[patch.node[c]];
    for (std::size_t i = patch.first; i < patch.last; ++i) {
      const Corners weight = interpolation(i);
      for (std::size_t c = 0; c < corners; ++c) z[i] += weight[c] * value[c];
    }
  }
  petsc_check(VecRestoreArray(result, &z));
  petsc_check(VecRestoreArrayRead(residual, &r));
}

template <int Dim>
std::size_t TwoLevelPreconditioner<Dim>::bytes() const {
  return inside_.capacity() * sizeof(Vector<Dim>) + patches_.capacity() * sizeof(Patch) +
         leaf_value_.capacity() * sizeof(double) + owner_.bytes() + nodes_.bytes() +
         number_.capacity() * sizeof(PetscInt) + coarse_rows_.column.capacity() * sizeof(std::int64_t) +
         coarse_rows_.value.capacity() * sizeof(double) +
         (coarse_rows_.cell.capacity() + coarse_rows_.length.capacity()) * sizeof(std::int64_t);
}

template class TwoLevelPreconditioner<2>;
template class TwoLevelPreconditioner<3>;

}  // namespace impinge
