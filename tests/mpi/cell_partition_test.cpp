// Cells distributed over ranks: balance, and independence of who knows of which work.

#include "impinge/parallel/cell_partition.hpp"

#include <numeric>
#include <random>

#include "dimensions.hpp"
#include "impinge/core/mpi.hpp"

namespace impinge {
namespace {

const MPI_Comm comm = MPI_COMM_WORLD;
constexpr std::array partitioners{Partitioner::metis, Partitioner::ptscotch, Partitioner::curve};

template <int Dim>
CellGrid<Dim> cells(int extent) {
  Box<Dim> box;
  for (int k = 0; k < Dim; ++k) box.high[k] = extent + 0.5;
  return CellGrid<Dim>(box, {}, 1.0);
}

/// Work in the lower part of a grid, of which each item is known to one rank, or to several in parts.
template <int Dim>
std::vector<CellWork> work_of_this_rank(const CellGrid<Dim>& grid, int least, int most, unsigned seed) {
  const CellCurve<Dim> curve(grid);
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> uniform(least, most), rank(0, ranks_of(comm) - 1);
  std::vector<CellWork> work;
  for (std::int64_t key = 0; key < std::int64_t{1} << curve.bits(); ++key) {
    const auto at = curve.coordinates(key);
    if (std::ranges::max(at) >= grid.extent()[0] || 2 * at[Dim - 1] >= grid.extent()[0]) continue;
    const int here = uniform(random), there = uniform(random);
    for (const int part : {here, there})
      if (rank(random) == rank_of(comm)) work.push_back({key, part});
  }
  merge_keys(work, [](CellWork& to, const CellWork& from) { to.work += from.work; });
  return work;
}

/// The work of each part, and of the largest cell.
template <int Dim>
std::pair<std::vector<std::int64_t>, std::int64_t> shares(const CellGrid<Dim>& grid, const std::vector<CellWork>& work,
                                                          const Cut& cut, int parts) {
  std::vector<std::int64_t> share(static_cast<std::size_t>(parts), 0), of_cell;
  const CellCurve<Dim> curve(grid);
  of_cell.resize(std::size_t{1} << curve.bits(), 0);
  const CellOwners<Dim> owner(grid, cut.segments);
  for (const CellWork& item : work) {
    Vector<Dim> shift;
    const int part = owner(grid.wrapped_cell(curve.coordinates(item.key), shift));
    share[static_cast<std::size_t>(part)] += item.work;
    of_cell[static_cast<std::size_t>(item.key)] += item.work;
  }
  MPI_Allreduce(MPI_IN_PLACE, share.data(), parts, MPI_INT64_T, MPI_SUM, comm);
  MPI_Allreduce(MPI_IN_PLACE, of_cell.data(), static_cast<int>(of_cell.size()), MPI_INT64_T, MPI_SUM, comm);
  return {share, std::ranges::max(of_cell)};
}

template <class T>
class CellPartitions : public testing::Test {};
TYPED_TEST_SUITE(CellPartitions, Dimensions);

TYPED_TEST(CellPartitions, OfTheCurveAreWithinACellOfTheirShares) {
  constexpr int Dim = TypeParam::value;
  const CellGrid<Dim> grid = cells<Dim>(Dim == 2 ? 37 : 13);
  for (const int parts : {1, 2, 7, 100, 5000}) {
    const auto work = work_of_this_rank(grid, 5, 60, 1);
    const Cut cut = distribute_cells<Dim>(comm, grid, work, parts, Partitioner::curve);
    const auto [share, largest_cell] = shares(grid, work, cut, parts);
    const std::int64_t all = std::accumulate(share.begin(), share.end(), std::int64_t{0});
    const auto mean = static_cast<double>(all) / parts;
    for (const std::int64_t here : share)
      EXPECT_NEAR(static_cast<double>(here), mean, static_cast<double>(largest_cell) + 1.0);
    EXPECT_NEAR(cut.imbalance, static_cast<double>(std::ranges::max(share)) / mean, 1e-12);
    EXPECT_LE(cut.segments.size(), static_cast<std::size_t>(parts));
  }
}

// Of equal cells, six and a half a part.
TYPED_TEST(CellPartitions, OfSixCellsARankHaveAtMostSeven) {
  constexpr int Dim = TypeParam::value;
  const CellGrid<Dim> grid = cells<Dim>(16);
  const auto work = work_of_this_rank(grid, 10, 10, 2);
  const int occupied = Dim == 2 ? 128 : 2048;
  const int parts = 2 * occupied / 13;
  const Cut cut = distribute_cells<Dim>(comm, grid, work, parts, Partitioner::curve);
  EXPECT_LE(cut.imbalance, 7.01 / (static_cast<double>(occupied) / parts));
}

TYPED_TEST(CellPartitions, DoNotDependOnWhoKnowsOfWhichWork) {
  constexpr int Dim = TypeParam::value;
  const CellGrid<Dim> grid = cells<Dim>(Dim == 2 ? 20 : 9);
  const auto work = work_of_this_rank(grid, 5, 60, 4);
  // All of it on the last rank.
  const int bits = CellCurve<Dim>(grid).bits();
  std::vector<std::int64_t> of_key(std::size_t{1} << bits, 0);
  for (const CellWork& item : work) of_key[static_cast<std::size_t>(item.key)] += item.work;
  MPI_Allreduce(MPI_IN_PLACE, of_key.data(), static_cast<int>(of_key.size()), MPI_INT64_T, MPI_SUM, comm);
  std::vector<CellWork> all;
  for (std::size_t key = 0; key < of_key.size(); ++key)
    if (of_key[key] > 0) all.push_back({static_cast<std::int64_t>(key), of_key[key]});
  for (const Partitioner partitioner : {Partitioner::metis, Partitioner::curve}) {
    const Cut spread = distribute_cells<Dim>(comm, grid, work, 6, partitioner);
    const bool is_last = rank_of(comm) == ranks_of(comm) - 1;
    const Cut together = distribute_cells<Dim>(
        comm, grid, is_last ? std::span<const CellWork>(all) : std::span<const CellWork>{}, 6, partitioner);
    const Cut alone = distribute_cells<Dim>(MPI_COMM_SELF, grid, all, 6, partitioner);
    EXPECT_EQ(spread.segments, together.segments);
    EXPECT_EQ(spread.segments, alone.segments);
    EXPECT_EQ(spread.imbalance, alone.imbalance);
    EXPECT_LT(spread.imbalance, 1.15);
  }
}

TYPED_TEST(CellPartitions, CoverAllCellsWithoutWork) {
  constexpr int Dim = TypeParam::value;
  const CellGrid<Dim> grid = cells<Dim>(9);
  for (const Partitioner partitioner : partitioners) {
    // PTScotch makes as many parts as it has ranks.
    const Cut none = distribute_cells<Dim>(comm, grid, {}, ranks_of(comm), partitioner);
    EXPECT_EQ(none.segments, (std::vector<Segment>{{0, 0}}));
    EXPECT_EQ(none.imbalance, 1.0);
  }
}

TEST(Partitioners, AreChosenBySize) {
  EXPECT_EQ(chosen_partitioner(Partitioner::automatic, 2, 1e5), Partitioner::metis);
  EXPECT_EQ(chosen_partitioner(Partitioner::automatic, 10'000, 1e5), Partitioner::curve);
  EXPECT_EQ(chosen_partitioner(Partitioner::automatic, 2, 1e9), Partitioner::curve);
  for (const Partitioner partitioner : partitioners) {
    EXPECT_EQ(chosen_partitioner(partitioner, 2, 1e5), partitioner);
    EXPECT_EQ(chosen_partitioner(partitioner, 10'000, 1e9), partitioner);
  }
}

}  // namespace
}  // namespace impinge
