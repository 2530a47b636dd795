#include "impinge/method/pressure/matrix.hpp"

#include <algorithm>

namespace impinge {

void MatrixRows::Block::clear(std::size_t rows, std::size_t entries) {
  start.clear();
  start.reserve(rows + 1);
  start.push_back(0);
  if (column.size() >= entries) return;
  column = Buffer<PetscInt>(2 * entries);  // room that nobody writes costs nothing
  value = Buffer<double>(2 * entries);
}

void MatrixRows::Block::make_room(std::size_t more) {
  const std::size_t needed = static_cast<std::size_t>(start.back()) + more;
  if (needed <= column.size()) return;
  column.resize(2 * needed);
  value.resize(2 * needed);
}

std::size_t MatrixRows::Block::bytes() const {
  if (start.empty()) return 0;
  return start.capacity() * sizeof(PetscInt) +
         static_cast<std::size_t>(start.back()) * (sizeof(PetscInt) + sizeof(double));
}

void PressureMatrix::build(MPI_Comm comm, MatrixRows& rows, const Halo& halo, PetscInt all_rows) {
  comm_ = comm;
  rows_ = &rows;
  halo_ = &halo;
  const auto n = static_cast<PetscInt>(rows.diagonal.size());
  petsc_check(MatCreateSeqSBAIJWithArrays(PETSC_COMM_SELF, 1, n, n, rows.own.start.data(), rows.own.column.data(),
                                          rows.own.value.data(), own_.address()));
  petsc_check(MatSetOption(own_, MAT_SPD, PETSC_TRUE));
  if (ranks_of(comm) == 1) return;

  const PetscInt n_halo = halo.exchange().n_receive();
  petsc_check(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n_halo, rows.others.start.data(), rows.others.column.data(),
                                        rows.others.value.data(), others_.address()));
  sent_.resize(halo.index().size());
  halo_x_.resize(static_cast<std::size_t>(n_halo));
  petsc_check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, nullptr, own_x_.address()));
  petsc_check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, nullptr, own_y_.address()));
  petsc_check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n_halo, halo_x_.data(), halo_x_view_.address()));
  petsc_check(MatCreateShell(comm, n, n, all_rows, all_rows, this, shell_.address()));
  using Product = PetscErrorCode (*)(Mat, ::Vec, ::Vec);
  const Product product = [](Mat shell, ::Vec x, ::Vec y) -> PetscErrorCode {
    void* self = nullptr;
    PetscCall(MatShellGetContext(shell, &self));
    return code_of([&] { static_cast<PressureMatrix*>(self)->multiply(x, y); });
  };
  petsc_check(MatShellSetOperation(shell_, MATOP_MULT, reinterpret_cast<void (*)()>(product)));
  petsc_check(MatSetOption(shell_, MAT_SPD, PETSC_TRUE));
}

void PressureMatrix::multiply(::Vec x, ::Vec y) {
  const double* from = nullptr;
  double* to = nullptr;
  petsc_check(VecGetArrayRead(x, &from));
  petsc_check(VecGetArray(y, &to));
  halo_->pack(from, sent_);
  halo_->exchange().begin_forward(sent_.data(), halo_x_.data());
  petsc_check(VecPlaceArray(own_x_, from));
  petsc_check(VecPlaceArray(own_y_, to));
  petsc_check(MatMult(own_, own_x_, own_y_));
  halo_->exchange().end_forward();
  petsc_check(MatMultAdd(others_, halo_x_view_, own_y_, own_y_));
  petsc_check(VecResetArray(own_x_));
  petsc_check(VecResetArray(own_y_));
  petsc_check(VecRestoreArray(y, &to));
  petsc_check(VecRestoreArrayRead(x, &from));
}

PetscMatrix PressureMatrix::whole_matrix(std::span<const PetscInt> row) const {
  PetscMatrix own;
  petsc_check(MatConvert(own_, MATSEQAIJ, MAT_INITIAL_MATRIX, own.address()));
  petsc_check(MatSetOption(own, MAT_SPD, PETSC_TRUE));
  if (ranks_of(comm_) == 1) return own;

  const MatrixRows::Block& others = rows_->others;
  const auto n = static_cast<PetscInt>(rows_->diagonal.size());
  std::vector<PetscInt> own_entries, other_entries;
  for (PetscInt i = 0; i < n; ++i) {
    PetscInt entries = 0;
    petsc_check(MatGetRow(own, i, &entries, nullptr, nullptr));
    own_entries.push_back(entries);
    petsc_check(MatRestoreRow(own, i, &entries, nullptr, nullptr));
    other_entries.push_back(others.start[static_cast<std::size_t>(i) + 1] - others.start[static_cast<std::size_t>(i)]);
  }
  PetscMatrix whole;
  petsc_check(MatCreateAIJ(comm_, n, n, PETSC_DETERMINE, PETSC_DETERMINE, 0, own_entries.data(), 0,
                           other_entries.data(), whole.address()));
  std::vector<PetscInt> columns;
  for (PetscInt i = 0; i < n; ++i) {
    const auto self = static_cast<std::size_t>(i);
    PetscInt entries = 0;
    const PetscInt* own_column = nullptr;
    const double* own_value = nullptr;
    petsc_check(MatGetRow(own, i, &entries, &own_column, &own_value));
    columns.resize(static_cast<std::size_t>(entries));
    std::transform(own_column, own_column + entries, columns.begin(), [&](PetscInt j) { return row[0] + j; });
    petsc_check(MatSetValues(whole, 1, &row[self], entries, columns.data(), own_value, INSERT_VALUES));
    petsc_check(MatRestoreRow(own, i, &entries, &own_column, &own_value));
    const auto begin = static_cast<std::size_t>(others.start[self]);
    columns.resize(static_cast<std::size_t>(other_entries[self]));
    for (std::size_t k = 0; k < columns.size(); ++k)
      columns[k] = row[static_cast<std::size_t>(n + others.column[begin + k])];
    petsc_check(MatSetValues(whole, 1, &row[self], other_entries[self], columns.data(), others.value.data() + begin,
                             INSERT_VALUES));
  }
  petsc_check(MatAssemblyBegin(whole, MAT_FINAL_ASSEMBLY));
  petsc_check(MatAssemblyEnd(whole, MAT_FINAL_ASSEMBLY));
  petsc_check(MatSetOption(whole, MAT_SPD, PETSC_TRUE));
  return whole;
}

}  // namespace impinge
