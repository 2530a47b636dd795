// The coarse problem on few ranks: the same solution whichever ranks solve it.

#include "impinge/method/pressure/coarse_solver.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "impinge/core/errors.hpp"
#include "impinge/core/mpi.hpp"
#include "options.hpp"

namespace impinge {
namespace {

constexpr int no_rows_on = 1;  // of more ranks

/// Rows of a chain, -x[k - 1] + (2 + 1/10) x[k] - x[k + 1], in blocks on the ranks; a rank's nodes are its rows, those
/// next to them, and one without a row.
struct Chain {
  PetscInt first = 0, own = 0, all = 0;
  CoarseRows rows;
  std::vector<PetscInt> row_of_node;

  explicit Chain(PetscInt most) {
    const int rank = rank_of(MPI_COMM_WORLD);
    const auto rows_of = [&](int r) { return r == no_rows_on ? 0 : most + r; };
    own = rows_of(rank);
    for (int r = 0; r < ranks_of(MPI_COMM_WORLD); ++r) {
      all += rows_of(r);
      if (r < rank) first += rows_of(r);
    }
    for (PetscInt row = first; row < first + own; ++row) {
      const std::size_t before = rows.column.size();
      for (PetscInt column = std::max(row - 1, 0); column <= std::min(row + 1, all - 1); ++column) {
        rows.column.push_back(column);
        rows.value.push_back(column == row ? 2.1 : -1.0);
      }
      rows.cell.push_back(row - first);
      rows.length.push_back(static_cast<std::int64_t>(rows.column.size() - before));
    }
    row_of_node.push_back(-1);
    for (PetscInt row = std::max(first - 1, 0); row < std::min(first + own + 1, all); ++row) row_of_node.push_back(row);
  }

  static double exact(PetscInt row) { return std::sin(0.3 * row); }

  /// The chain's product with the exact solution at this rank's rows, 0 at its other nodes with a row.
  std::vector<double> parts() const {
    std::vector<double> value{7.0};
    for (std::size_t k = 1; k < row_of_node.size(); ++k) {
      const PetscInt row = row_of_node[k];
      const double left = row > 0 ? exact(row - 1) : 0.0, right = row + 1 < all ? exact(row + 1) : 0.0;
      const bool is_own = row >= first && row < first + own;
      value.push_back(is_own ? 2.1 * exact(row) - left - right : 0.0);
    }
    return value;
  }
};

void expect_exact(CoarseSolver& solver, const Chain& chain) {
  solver.set_up(chain.rows, chain.row_of_node);
  std::vector<double> value = chain.parts();
  solver.solve(value);
  EXPECT_EQ(value[0], 0.0);
  for (std::size_t k = 1; k < value.size(); ++k) EXPECT_NEAR(value[k], Chain::exact(chain.row_of_node[k]), 1e-12);
}

TEST(CoarseSolver, GivesEveryNodeTheSolutionWhicheverRanksSolve) {
  const Option exact("-ppe_coarse_pc_type", "redundant");
  const int ranks = ranks_of(MPI_COMM_WORLD);
  for (const int rows_per_rank : {1, 7, 15, 1000}) {
    const Option chosen("-ppe_coarse_rows_per_rank", std::to_string(rows_per_rank).c_str());
    CoarseSolver solver(MPI_COMM_WORLD, 2);
    const Chain chain(10);
    expect_exact(solver, chain);
    EXPECT_EQ(solver.ranks(), std::min(ranks, (chain.all + rows_per_rank - 1) / rows_per_rank));
  }
}

TEST(CoarseSolver, FollowsTheNumberOfRows) {
  const Option exact("-ppe_coarse_pc_type", "redundant");
  const Option chosen("-ppe_coarse_rows_per_rank", "12");
  CoarseSolver solver(MPI_COMM_WORLD, 3);
  for (int pass = 0; pass < 30; ++pass) expect_exact(solver, Chain(1 + pass * 7 % 20));
}

TEST(CoarseSolver, OneCycleIsTheSameOnAnyRanks) {
  // The default solver, on one rank from rows in blocks, against the same rows all on this rank.
  CoarseSolver solver(MPI_COMM_WORLD, 2);
  const Chain chain(10);
  solver.set_up(chain.rows, chain.row_of_node);
  EXPECT_EQ(solver.ranks(), 1);
  std::vector<double> value = chain.parts();
  solver.solve(value);

  CoarseRows all;
  std::vector<PetscInt> nodes;
  std::vector<double> expected;
  for (PetscInt row = 0; row < chain.all; ++row) {
    const std::size_t before = all.column.size();
    double residual = 0.0;
    for (PetscInt column = std::max(row - 1, 0); column <= std::min(row + 1, chain.all - 1); ++column) {
      all.column.push_back(column);
      all.value.push_back(column == row ? 2.1 : -1.0);
      residual += all.value.back() * Chain::exact(column);
    }
    all.length.push_back(static_cast<std::int64_t>(all.column.size() - before));
    nodes.push_back(row);
    expected.push_back(residual);
  }
  CoarseSolver alone(MPI_COMM_SELF, 2);
  alone.set_up(all, nodes);
  alone.solve(expected);
  for (std::size_t k = 1; k < value.size(); ++k)
    EXPECT_NEAR(value[k], expected[static_cast<std::size_t>(chain.row_of_node[k])], 1e-13);
}

TEST(CoarseSolver, HasNothingToDoWithoutRows) {
  CoarseSolver solver(MPI_COMM_WORLD, 2);
  solver.set_up({}, std::vector<PetscInt>{-1, -1});
  std::vector<double> value{1.0, 2.0};
  solver.solve(value);
  EXPECT_EQ(value, (std::vector<double>{0.0, 0.0}));
}

TEST(CoarseSolver, RefusesLessThanARowPerRank) {
  const Option none("-ppe_coarse_rows_per_rank", "0");
  EXPECT_THROW(CoarseSolver(MPI_COMM_WORLD, 2), InputError);
}

}  // namespace
}  // namespace impinge
