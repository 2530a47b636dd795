// The two-level preconditioner: its algebra, its life cycle, and iterations that do not depend on the ranks.

#include "impinge/method/pressure/two_level.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "cloud.hpp"
#include "dimensions.hpp"
#include "impinge/core/mpi.hpp"
#include "impinge/parallel/decomposition.hpp"
#include "impinge/particles/kernel.hpp"
#include "options.hpp"

namespace impinge {
namespace {

constexpr double radius = 4.01;
constexpr double edge = 1.001 * radius;  // of a background cell

/// An irregular cloud of unit spacing between the centres of the outermost background cells.
template <int Dim>
class Cloud {
 public:
  Cloud(MPI_Comm comm, const std::array<int, Dim>& cells,
        const std::function<PressureRole(const Vector<Dim>&)>& role_at)
      : comm_(comm),
        decomposition_(comm, box(cells), {}, radius, Partitioner::metis),
        search_(decomposition_.sorting_cells(), Decomposition<Dim>::cell_parts, KernelType::non_singular, 2.1, radius),
        solver_(comm, 1e-8),
        two_level_(comm, decomposition_.cells()) {
    std::array<int, Dim> extent;
    for (std::size_t k = 0; k < Dim; ++k) extent[k] = static_cast<int>((cells[k] - 1) * radius);
    const Particles<Dim> points = make_cloud<Dim>(extent, 0.2);
    for_share(points.owned, rank_of(comm), ranks_of(comm), [&](std::int64_t k) {
      auto record = points.record(static_cast<int>(k));
      for (int axis = 0; axis < Dim; ++axis) record.position[axis] += 0.5 * edge;
      particles_.append(record);
    });
    decomposition_.partition(particles_);
    EXPECT_EQ(decomposition_.migrate(particles_).outside, 0);
    decomposition_.build_halo(particles_);
    search_.search(particles_);
    for (const auto& position : particles_.position) role_.push_back(role_at(position));
    const LatticeSums sums = lattice_sums<Dim>(KernelType::non_singular, radius);
    source_.assign(particles_.pressure.begin(), particles_.pressure.begin() + particles_.owned);
    solver_.assemble({.for_rows =
                          [&](const auto& use) {
                            search_.for_far_rows([&](int i, const PairRow& row) { use(i, {row, 0.0}); });
                          },
                      .role = role_,
                      .row = decomposition_.rows(),
                      .source = source_,
                      .laplacian_factor = 2.0 * Dim / (sums.number_density * sums.lambda),
                      .n0 = sums.number_density,
                      .usual_pairs = sums.neighbours},
                     decomposition_.halo());
    two_level_.set_owners(decomposition_.owners());
  }

  TwoLevelPreconditioner<Dim>& two_level() { return two_level_; }
  Decomposition<Dim>& domain() { return decomposition_; }
  const Particles<Dim>& particles() const { return particles_; }
  PressureRole role(std::size_t i) const { return role_[i]; }

  void update(int iterations) {
    two_level_.update(solver_.rows(), role_, particles_.position, decomposition_.halo(), iterations);
  }

  PressureReport solve() {
    two_level_.attach(solver_.preconditioner());
    std::fill(particles_.pressure.begin(), particles_.pressure.end(), 0.0);
    return solver_.solve(particles_.pressure);
  }

  std::vector<double> times_matrix(std::vector<double> x) const {
    std::vector<double> result(x.size());
    petsc_check(MatMult(solver_.matrix(), view(x), view(result)));
    return result;
  }

  std::vector<double> preconditioned(std::vector<double> x) {
    PC shell;
    petsc_check(PCCreate(comm_, &shell));
    petsc_check(PCSetType(shell, PCSHELL));
    petsc_check(PCSetOperators(shell, solver_.matrix(), solver_.matrix()));
    two_level_.attach(shell);
    std::vector<double> result(x.size());
    petsc_check(PCApply(shell, view(x), view(result)));
    petsc_check(PCDestroy(&shell));
    return result;
  }

  const std::vector<double>& diagonal() const { return solver_.rows().diagonal; }

  double dot_product(const std::vector<double>& a, const std::vector<double>& b) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum_over_ranks(comm_, sum);
  }

 private:
  static Box<Dim> box(const std::array<int, Dim>& cells) {
    Box<Dim> result;
    for (int k = 0; k < Dim; ++k) result.high[k] = cells[static_cast<std::size_t>(k)] * edge;
    return result;
  }

  PetscVector view(std::vector<double>& x) const {
    PetscVector vector;
    petsc_check(
        VecCreateMPIWithArray(comm_, 1, static_cast<PetscInt>(x.size()), PETSC_DETERMINE, x.data(), vector.address()));
    return vector;
  }

  MPI_Comm comm_;
  Decomposition<Dim> decomposition_;
  NeighbourSearch<Dim> search_;
  PressureSolver solver_;
  TwoLevelPreconditioner<Dim> two_level_;
  Particles<Dim> particles_;
  std::vector<PressureRole> role_;
  std::vector<double> source_;
};

template <int Dim>
std::array<int, Dim> cells(int first, int others) {
  std::array<int, Dim> result;
  result.fill(others);
  result[0] = first;
  return result;
}

template <int Dim>
PressureRole all_unknown(const Vector<Dim>&) {
  return PressureRole::unknown;
}

/// p = 0 in the uppermost rows, a hole, unknowns elsewhere.
template <int Dim>
PressureRole basin(const Vector<Dim>& at) {
  if (at[0] < 3.5) return PressureRole::zero;
  return std::abs(at[0] - 9.0) < 1.5 && std::abs(at[1] - 6.0) < 2.5 ? PressureRole::absent : PressureRole::unknown;
}

template <class T>
class TwoLevel : public testing::Test {};
TYPED_TEST_SUITE(TwoLevel, Dimensions);

// With an exact coarse solve, P A_c^-1 P^T A reproduces what P can represent: linear functions, but for the slight
// regularisation of A_c, which the constant of a cluster without p = 0 feels most.
TYPED_TEST(TwoLevel, IsExactForLinearFields) {
  constexpr int Dim = TypeParam::value;
  const Option exact("-ppe_coarse_pc_type", "redundant");
  Cloud<Dim> cloud(MPI_COMM_WORLD, cells<Dim>(6, 4), all_unknown<Dim>);
  cloud.update(0);
  std::vector<double> linear;
  for (int i = 0; i < cloud.particles().owned; ++i) {
    const Vector<Dim>& at = cloud.particles().position[static_cast<std::size_t>(i)];
    linear.push_back(2.0 - at[0] + 3.0 * at[Dim - 1]);
  }
  const auto residual = cloud.times_matrix(linear);
  const auto result = cloud.preconditioned(residual);
  const auto& diagonal = cloud.diagonal();
  for (std::size_t i = 0; i < linear.size(); ++i)
    EXPECT_NEAR(result[i] - 1.5 * residual[i] / diagonal[i], linear[i], 1e-4);
}

TYPED_TEST(TwoLevel, IsSymmetricAndPositive) {
  constexpr int Dim = TypeParam::value;
  const Option exact("-ppe_coarse_pc_type", "redundant");
  Cloud<Dim> cloud(MPI_COMM_WORLD, cells<Dim>(6, 4), basin<Dim>);
  cloud.update(0);
  std::mt19937 random(static_cast<unsigned>(rank_of(MPI_COMM_WORLD)));
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> x, y;
  for (int i = 0; i < cloud.particles().owned; ++i) {
    x.push_back(uniform(random));
    y.push_back(uniform(random));
  }
  const auto mx = cloud.preconditioned(x);
  const auto my = cloud.preconditioned(y);
  EXPECT_NEAR(cloud.dot_product(mx, y), cloud.dot_product(x, my), 1e-12 * cloud.dot_product(mx, x));
  EXPECT_GT(cloud.dot_product(mx, x), 0.0);
  EXPECT_GT(cloud.dot_product(my, y), 0.0);
  // Rows without an unknown get the Jacobi part alone.
  const auto& diagonal = cloud.diagonal();
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (cloud.role(i) != PressureRole::unknown) {
      EXPECT_DOUBLE_EQ(mx[i], 1.5 * x[i] / diagonal[i]);
    }
  }
}

TYPED_TEST(TwoLevel, NeedsFewIterationsWhateverTheRanks) {
  constexpr int Dim = TypeParam::value;
  const auto iterations = [](MPI_Comm comm) {
    Cloud<Dim> cloud(comm, Dim == 2 ? cells<Dim>(20, 12) : cells<Dim>(7, 5), basin<Dim>);
    cloud.update(0);
    const PressureReport report = cloud.solve();
    EXPECT_EQ(report.failure, "");
    EXPECT_LE(report.residual, 1e-8);
    return report.iterations;
  };
  const int here = iterations(MPI_COMM_WORLD);
  EXPECT_LE(here, 22);
  EXPECT_NEAR(here, iterations(MPI_COMM_SELF), 2);
}

TEST(TwoLevelCoarseMatrix, IsRenewedWhenItIsOldOrIterationsGrowOrCellsMove) {
  Cloud<2> cloud(MPI_COMM_WORLD, {6, 4}, basin<2>);
  const auto& builds = [&] { return cloud.two_level().builds(); };
  cloud.update(0);
  EXPECT_EQ(builds(), 1);
  for (int step = 1; step < 10; ++step) cloud.update(12);
  EXPECT_EQ(builds(), 1);
  cloud.update(12);
  EXPECT_EQ(builds(), 2);
  cloud.update(12);
  cloud.update(16);
  EXPECT_EQ(builds(), 2);
  cloud.update(17);
  EXPECT_EQ(builds(), 3);
  cloud.update(12);
  cloud.two_level().set_owners(cloud.domain().owners());
  cloud.update(12);
  EXPECT_EQ(builds(), 4);
  cloud.two_level().expire();
  cloud.update(12);
  EXPECT_EQ(builds(), 5);
  EXPECT_EQ(cloud.solve().failure, "");
}

}  // namespace
}  // namespace impinge
