// The pressure equation against a dense one built by brute force, on any number of ranks.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "cloud.hpp"
#include "gather.hpp"
#include "impinge/core/mpi.hpp"
#include "impinge/method/pressure/solver.hpp"
#include "impinge/method/pressure/two_level.hpp"
#include "impinge/parallel/decomposition.hpp"

namespace impinge {
namespace {

constexpr double radius = 4.01;
constexpr double factor = 0.04;  // 2 Dim/(n0 lambda) [1/m^2]
constexpr double n0 = 24.671676;
constexpr Edge edges[] = {Edge::open, Edge::periodic, Edge::mirror};

/// Particles with what they are to the pressure equation, by id.
struct Problem {
  Particles<2> particles;
  std::vector<PressureRole> role;
  std::vector<double> source;
  Vector<2> size;
  Edge edge = Edge::open;  // of the box [0, size], on all sides

  std::size_t count() const { return role.size(); }

  /// Weights of particle j and its images in the row of particle i.
  double weight(std::size_t i, std::size_t j) const {
    const Vector<2>& at = particles.position[j];
    double sum = 0.0;
    for (const double x : images(at[0], size[0]))
      for (const double y : images(at[1], size[1]))
        sum += NonSingularKernel::weight(norm(Vector<2>{{x, y}} - particles.position[i]), radius);
    return sum;
  }

  std::vector<double> images(double at, double length) const {
    if (edge == Edge::periodic) return {at, at - length, at + length};
    if (edge == Edge::mirror) return {at, -at, 2.0 * length - at};
    return {at};
  }

  void add(const Vector<2>& position, PressureRole what, double strength) {
    particles.append({position, {}, 0.0, 0.0, particles.owned, ParticleType::fluid});
    role.push_back(what);
    source.push_back(strength);
  }
};

/// An irregular cloud of 24 x 14 particles; the source is irregular too.
Problem cloud(const std::function<PressureRole(const Vector<2>&)>& role_at, Edge edge = Edge::open) {
  const std::array<int, 2> extent{24, 14};
  const Particles<2> points = make_cloud<2>(extent, 0.3);
  Problem problem;
  problem.size = {{24.0, 14.0}};
  problem.edge = edge;
  for (std::size_t i = 0; i < points.position.size(); ++i)
    problem.add(points.position[i], role_at(points.position[i]), points.pressure[i]);
  return problem;
}

/// p = 0 above y = 12, a block that is not there, unknowns elsewhere.
PressureRole basin(const Vector<2>& at) {
  if (at[1] > 12.0) return PressureRole::zero;
  if (at[0] > 5.0 && at[0] < 9.0 && at[1] > 5.0 && at[1] < 8.0) return PressureRole::absent;
  return PressureRole::unknown;
}

PressureRole all_unknown(const Vector<2>&) { return PressureRole::unknown; }

/// A problem on the ranks of a communicator.
class Distributed {
 public:
  Distributed(MPI_Comm comm, const Problem& problem, double tolerance = 1e-12)
      : comm_(comm),
        n_(problem.count()),
        decomposition_(comm, {{}, problem.size}, periodic_axes<2>(problem.edge), radius, Partitioner::metis),
        search_(decomposition_.sorting_cells(), Decomposition<2>::cell_parts, KernelType::non_singular, 2.1, radius),
        walls_(mirrors_of<2>(problem.edge, {{}, problem.size}, radius)),
        solver_(comm, tolerance) {
    for_share(static_cast<std::int64_t>(n_), rank_of(comm), ranks_of(comm),
              [&](std::int64_t k) { particles_.append(problem.particles.record(static_cast<int>(k))); });
    decomposition_.partition(particles_);
    EXPECT_EQ(decomposition_.migrate(particles_).outside, 0);
    decomposition_.build_halo(particles_);
    for (const auto id : particles_.id) role_.push_back(problem.role[static_cast<std::size_t>(id)]);
    walls_.append_images(particles_);
    search_.search(particles_);
    assemble(problem.source);
  }

  /// `source` by id.
  void assemble(const std::vector<double>& source) {
    source_.clear();
    for (int i = 0; i < particles_.owned; ++i)
      source_.push_back(source[static_cast<std::size_t>(particles_.id[static_cast<std::size_t>(i)])]);
    solver_.assemble({.for_rows =
                          [&](const auto& use) {
                            search_.for_far_rows([&](int i, const PairRow& row) { use(i, {row, 0.0}); });
                          },
                      .role = role_,
                      .row = decomposition_.rows(),
                      .source = source_,
                      .laplacian_factor = factor,
                      .n0 = n0,
                      .usual_pairs = 48,
                      .original = walls_.originals()},
                     decomposition_.halo());
    if (!solver_.is_two_level()) return;
    if (!two_level_) {
      two_level_.emplace(comm_, decomposition_.cells());
      two_level_->set_owners(decomposition_.owners());
    }
    two_level_->update(solver_.rows(), role_, std::span<const Vector<2>>(particles_.position).first(role_.size()),
                       decomposition_.halo(), 0);
    two_level_->attach(solver_.preconditioner());
  }

  /// Solves from the guess in pressure(), at first zero.
  PressureReport solve() { return solver_.solve(particles_.pressure); }

  std::vector<double>& guess() { return particles_.pressure; }
  int owned() const { return particles_.owned; }

  /// The solution by id, on every rank.
  std::vector<double> pressure() const {
    std::vector<double> result;
    for (const auto& [id, value] : gather_by_id(comm_, particles_, particles_.pressure)) result.push_back(value);
    return result;
  }

  /// The matrix by ids, dense, on every rank.
  std::vector<double> matrix() const {
    const auto rows = decomposition_.rows();
    const std::vector<PetscInt> own_rows(rows.begin(), rows.begin() + particles_.owned);
    std::vector<std::size_t> id_of(n_);
    for (const auto& [id, row] : gather_by_id(comm_, particles_, own_rows))
      id_of[static_cast<std::size_t>(row)] = static_cast<std::size_t>(id);
    std::vector<double> dense(n_ * n_, 0.0);
    const PetscMatrix whole = solver_.whole_matrix(rows);
    for (const PetscInt row : own_rows) {
      PetscInt entries = 0;
      const PetscInt* columns = nullptr;
      const double* values = nullptr;
      petsc_check(MatGetRow(whole, row, &entries, &columns, &values));
      for (PetscInt k = 0; k < entries; ++k)
        dense[id_of[static_cast<std::size_t>(row)] * n_ + id_of[static_cast<std::size_t>(columns[k])]] += values[k];
      petsc_check(MatRestoreRow(whole, row, &entries, &columns, &values));
    }
    MPI_Allreduce(MPI_IN_PLACE, dense.data(), static_cast<int>(dense.size()), MPI_DOUBLE, MPI_SUM, comm_);
    return dense;
  }

  /// Largest difference of a component of the solver's product with some vector and the whole matrix's.
  double product_difference() const {
    const PetscMatrix whole = solver_.whole_matrix(decomposition_.rows());
    PetscVector x, product, expected;
    petsc_check(MatCreateVecs(whole, x.address(), product.address()));
    petsc_check(VecDuplicate(product, expected.address()));
    petsc_check(VecSetRandom(x, nullptr));
    petsc_check(MatMult(solver_.matrix(), x, product));
    petsc_check(MatMult(whole, x, expected));
    petsc_check(VecAXPY(product, -1.0, expected));
    double difference = 0.0;
    petsc_check(VecNorm(product, NORM_INFINITY, &difference));
    PetscBool known = PETSC_FALSE, definite = PETSC_FALSE;
    petsc_check(MatIsSPDKnown(whole, &known, &definite));
    EXPECT_TRUE(known && definite);
    return difference;
  }

 private:
  MPI_Comm comm_;
  std::size_t n_;
  Decomposition<2> decomposition_;
  NeighbourSearch<2> search_;
  MirrorWalls<2> walls_;
  PressureSolver solver_;
  std::optional<TwoLevelPreconditioner<2>> two_level_;
  Particles<2> particles_;
  std::vector<PressureRole> role_;
  std::vector<double> source_;
};

/// The Laplacian of paper eq. 6 for particle i, from a pressure by id.
double laplacian(const Problem& problem, const std::vector<double>& pressure, std::size_t i) {
  double sum = 0.0;
  for (std::size_t j = 0; j < problem.count(); ++j)
    if (j != i && problem.role[j] != PressureRole::absent) sum += (pressure[j] - pressure[i]) * problem.weight(i, j);
  return factor * sum;
}

/// Factors a symmetric matrix L L^T in place; false if it is not positive definite.
bool cholesky(std::vector<double>& matrix, std::size_t n) {
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = j; i < n; ++i) {
      double sum = matrix[i * n + j];
      for (std::size_t k = 0; k < j; ++k) sum -= matrix[i * n + k] * matrix[j * n + k];
      if (i == j && !(sum > 1e-10)) return false;
      matrix[i * n + j] = i == j ? std::sqrt(sum) : sum / matrix[j * n + j];
    }
  }
  return true;
}

double largest(const std::vector<double>& values) {
  double result = 0.0;
  for (const double value : values) result = std::max(result, std::abs(value));
  return result;
}

/// lap p = source where the pressure is unknown, less `mean` where `in_pocket`.
void expect_solution(
    const Problem& problem, const std::vector<double>& pressure,
    const std::function<bool(std::size_t)>& in_pocket = [](std::size_t) { return false; }) {
  double sum = 0.0, members = 0.0;
  for (std::size_t i = 0; i < problem.count(); ++i) {
    if (!in_pocket(i)) continue;
    sum += problem.source[i];
    members += 1.0;
  }
  ASSERT_EQ(pressure.size(), problem.count());
  double lowest = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < problem.count(); ++i) {
    if (problem.role[i] != PressureRole::unknown) {
      EXPECT_EQ(pressure[i], 0.0);
      continue;
    }
    EXPECT_NEAR(laplacian(problem, pressure, i), problem.source[i] - (in_pocket(i) ? sum / members : 0.0), 1e-9);
    if (in_pocket(i)) lowest = std::min(lowest, pressure[i]);
  }
  EXPECT_EQ(members > 0.0 ? lowest : 0.0, 0.0);
}

TEST(PressureMatrix, IsThatOfBruteForce) {
  for (const Edge edge : edges) {
    const Problem problem = cloud(basin, edge);
    const std::vector<double> matrix = Distributed(MPI_COMM_WORLD, problem).matrix();
    const std::size_t n = problem.count();
    for (std::size_t i = 0; i < n; ++i) {
      double diagonal = 0.0;
      for (std::size_t j = 0; j < n; ++j) {
        if (j == i || problem.role[j] == PressureRole::absent) continue;
        diagonal += problem.weight(i, j);
        const bool coupled = problem.role[i] == PressureRole::unknown && problem.role[j] == PressureRole::unknown;
        EXPECT_NEAR(matrix[i * n + j], coupled ? -problem.weight(i, j) : 0.0, edge == Edge::open ? 1e-14 : 1e-12);
      }
      EXPECT_NEAR(matrix[i * n + i], problem.role[i] == PressureRole::unknown ? diagonal : n0, 1e-12);
    }
  }
}

// To the last bit, but for the rounding of images.
TEST(PressureMatrix, IsSymmetricAndPositiveDefinite) {
  for (const Edge edge : edges) {
    for (const auto& roles : {basin, all_unknown}) {
      const Problem problem = cloud(roles, edge);
      std::vector<double> matrix = Distributed(MPI_COMM_WORLD, problem).matrix();
      const std::size_t n = problem.count();
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < i; ++j)
          EXPECT_NEAR(matrix[i * n + j], matrix[j * n + i], edge == Edge::open ? 0.0 : 1e-13);
      EXPECT_TRUE(cholesky(matrix, n));
    }
  }
}

TEST(PressureMatrix, HalfOfItGivesTheWholeProduct) {
  for (const Edge edge : edges)
    for (const auto& roles : {basin, all_unknown})
      EXPECT_LT(Distributed(MPI_COMM_WORLD, cloud(roles, edge)).product_difference(), 1e-12);
}

TEST(Pressure, SolvesTheEquation) {
  for (const Edge edge : edges) {
    const Problem problem = cloud(basin, edge);
    Distributed system(MPI_COMM_WORLD, problem);
    const PressureReport report = system.solve();
    EXPECT_EQ(report.failure, "");
    EXPECT_EQ(report.pockets, 0);
    EXPECT_GT(report.iterations, 0);
    EXPECT_LE(report.residual, 1e-11);
    EXPECT_GT(largest(system.pressure()), 1.0);
    expect_solution(problem, system.pressure());
  }
}

TEST(Pressure, IsThatOfASingleRank) {
  const Problem problem = cloud(basin);
  Distributed here(MPI_COMM_WORLD, problem), alone(MPI_COMM_SELF, problem);
  EXPECT_EQ(here.solve().failure, "");
  EXPECT_EQ(alone.solve().failure, "");
  const auto shared = here.pressure();
  const auto single = alone.pressure();
  for (std::size_t i = 0; i < single.size(); ++i) EXPECT_NEAR(shared[i], single[i], 1e-9 * largest(single));
}

TEST(Pressure, ReachesTheToleranceItWasAskedFor) {
  const Problem problem = cloud(basin);
  Distributed loose(MPI_COMM_WORLD, problem, 1e-2), tight(MPI_COMM_WORLD, problem, 1e-10);
  const PressureReport few = loose.solve();
  const PressureReport many = tight.solve();
  EXPECT_LE(few.residual, 1e-2);
  EXPECT_LE(many.residual, 1.01e-10);
  EXPECT_LT(few.iterations, many.iterations);
}

TEST(Pressure, StartsFromTheGuessIfItIsAGoodOne) {
  const Problem problem = cloud(basin);
  Distributed system(MPI_COMM_WORLD, problem, 1e-11);
  EXPECT_GT(system.solve().iterations, 0);
  EXPECT_EQ(system.solve().iterations, 0);
  for (double& value : system.guess()) value = 1e12;
  EXPECT_EQ(system.solve().failure, "");
  expect_solution(problem, system.pressure());
}

TEST(Pressure, IsZeroWithoutASource) {
  Problem problem = cloud(basin);
  std::fill(problem.source.begin(), problem.source.end(), 0.0);
  Distributed system(MPI_COMM_WORLD, problem);
  for (double& value : system.guess()) value = 3.0;
  const PressureReport report = system.solve();
  EXPECT_EQ(report.failure, "");
  EXPECT_EQ(report.residual, 0.0);
  EXPECT_EQ(largest(system.pressure()), 0.0);
}

// A cluster of unknowns far from the fluid that has no p = 0 particle of its own.
TEST(Pressure, OfAClusterWithoutFreeSurfaceIsFixedByItsLowestValue) {
  Problem problem = cloud(basin);
  const std::size_t first = problem.count();
  problem.size[0] += 20.0;
  for (int k = 0; k < 25; ++k)
    problem.add({{34.0 + 0.9 * (k % 5), 6.0 + 1.1 * (k / 5)}}, PressureRole::unknown, 1.0 + 0.1 * k * k);
  Distributed system(MPI_COMM_WORLD, problem);
  const PressureReport report = system.solve();
  EXPECT_EQ(report.failure, "");
  EXPECT_EQ(report.pockets, 1);
  expect_solution(problem, system.pressure(), [&](std::size_t i) { return i >= first; });

  // The rest does not feel it.
  Distributed without(MPI_COMM_WORLD, cloud(basin));
  EXPECT_EQ(without.solve().failure, "");
  const auto rest = without.pressure();
  const auto all = system.pressure();
  for (std::size_t i = 0; i < first; ++i) EXPECT_NEAR(all[i], rest[i], 1e-9 * largest(rest));
}

TEST(Pressure, OfSeveralClustersAndSingleParticlesIsFixedInEach) {
  Problem problem = cloud(basin);
  problem.size[0] += 40.0;
  const std::size_t pair = problem.count();
  problem.add({{34.0, 3.0}}, PressureRole::unknown, 2.0);
  problem.add({{35.0, 3.0}}, PressureRole::unknown, 5.0);
  const std::size_t single = problem.count();
  problem.add({{44.0, 8.0}}, PressureRole::unknown, 7.0);
  problem.add({{54.0, 8.0}}, PressureRole::unknown, -7.0);
  problem.add({{54.0, 9.0}}, PressureRole::absent, 1.0);  // no neighbour to speak of
  Distributed system(MPI_COMM_WORLD, problem);
  const PressureReport report = system.solve();
  EXPECT_EQ(report.failure, "");
  EXPECT_EQ(report.pockets, 3);
  const auto pressure = system.pressure();
  EXPECT_EQ(pressure[pair + 1], 0.0);
  EXPECT_NEAR(pressure[pair], 1.5 / (factor * problem.weight(pair, pair + 1)), 1e-8);
  for (std::size_t i = single; i < problem.count(); ++i) EXPECT_EQ(pressure[i], 0.0);
}

TEST(Pressure, OfABoxWithoutFreeSurfaceIsFixedByItsLowestValue) {
  for (const Edge edge : edges) {
    const Problem problem = cloud(all_unknown, edge);
    Distributed system(MPI_COMM_WORLD, problem);
    const PressureReport report = system.solve();
    EXPECT_EQ(report.failure, "");
    EXPECT_EQ(report.pockets, 1);
    expect_solution(problem, system.pressure(), [](std::size_t) { return true; });
  }
}

// A C of unknowns, spread over the ranks: a pocket until the tip of one arm gets p = 0.
TEST(Pressure, FindsWindingPockets) {
  const auto snake = [](const Vector<2>& at) {
    if (at[1] > 4.5 && at[1] < 9.5 && at[0] > 5.0) return PressureRole::absent;
    return PressureRole::unknown;
  };
  const Problem closed = cloud(snake);
  Distributed system(MPI_COMM_WORLD, closed);
  const PressureReport report = system.solve();
  EXPECT_EQ(report.failure, "");
  EXPECT_EQ(report.pockets, 1);
  expect_solution(closed, system.pressure(), [&](std::size_t i) { return closed.role[i] == PressureRole::unknown; });

  const Problem open =
      cloud([&](const Vector<2>& at) { return at[0] > 23.0 && at[1] < 4.5 ? PressureRole::zero : snake(at); });
  Distributed anchored(MPI_COMM_WORLD, open);
  EXPECT_EQ(anchored.solve().pockets, 0);
  expect_solution(open, anchored.pressure());
}

TEST(Pressure, NeedsNoRowsOnEveryRank) {
  Problem problem;
  problem.size = {{24.0, 14.0}};
  for (int k = 0; k < 9; ++k)
    problem.add({{0.5 + 0.9 * (k % 3), 0.5 + (k / 3)}}, k == 8 ? PressureRole::zero : PressureRole::unknown, 1.0 + k);
  Distributed system(MPI_COMM_WORLD, problem);
  EXPECT_EQ(max_over_ranks(MPI_COMM_WORLD, system.owned()), 9.0);  // all on one rank
  EXPECT_LT(system.product_difference(), 1e-12);
  EXPECT_EQ(system.solve().failure, "");
  expect_solution(problem, system.pressure());
}

TEST(Pressure, WithoutUnknownsIsZero) {
  const Problem problem =
      cloud([](const Vector<2>& at) { return at[0] < 9.0 ? PressureRole::zero : PressureRole::absent; });
  Distributed system(MPI_COMM_WORLD, problem);
  EXPECT_EQ(system.solve().failure, "");
  EXPECT_EQ(largest(system.pressure()), 0.0);
}

TEST(Pressure, ReportsASourceThatIsNotANumber) {
  for (const auto& roles : {basin, all_unknown}) {
    Problem problem = cloud(roles);
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      problem.source[3] = bad;
      Distributed system(MPI_COMM_WORLD, problem);
      EXPECT_FALSE(any_rank(MPI_COMM_WORLD, system.solve().failure.empty()));
    }
  }
}

TEST(Pressure, ReportsNonConvergenceOnEveryRank) {
  const Problem problem = cloud(basin);
  petsc_check(PetscOptionsSetValue(nullptr, "-ppe_ksp_max_it", "1"));
  Distributed system(MPI_COMM_WORLD, problem);
  petsc_check(PetscOptionsClearValue(nullptr, "-ppe_ksp_max_it"));
  const PressureReport report = system.solve();
  EXPECT_FALSE(any_rank(MPI_COMM_WORLD, report.failure.empty()));
  EXPECT_NE(report.failure.find("DIVERGED_ITS"), std::string::npos) << report.failure;
  EXPECT_EQ(report.iterations, 1);
}

TEST(Pressure, ObeysTheOptionsDatabase) {
  const Problem problem = cloud(basin);
  for (const char* preconditioner : {"jacobi", "gamg", "bjacobi", "hypre"}) {
    petsc_check(PetscOptionsSetValue(nullptr, "-ppe_pc_type", preconditioner));
    Distributed system(MPI_COMM_WORLD, problem);
    petsc_check(PetscOptionsClearValue(nullptr, "-ppe_pc_type"));
    EXPECT_EQ(system.solve().failure, "") << preconditioner;
    expect_solution(problem, system.pressure());
  }
}

TEST(Pressure, IsSolvedAgainAndAgain) {
  Problem problem = cloud(basin);
  Distributed system(MPI_COMM_WORLD, problem);
  for (int step = 0; step < 3; ++step) {
    for (double& value : problem.source) value = std::sin(17.0 * value + step);
    system.assemble(problem.source);
    EXPECT_EQ(system.solve().failure, "");
    expect_solution(problem, system.pressure());
  }
}

}  // namespace
}  // namespace impinge
