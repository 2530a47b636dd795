// The curve through the cells, the owners of its segments, and numbers of few cells among many.

#include "impinge/parallel/cell_curve.hpp"

#include <map>
#include <random>

#include "dimensions.hpp"
#include "impinge/parallel/cell_owners.hpp"

namespace impinge {
namespace {

template <int Dim>
CellGrid<Dim> cells(const std::array<int, Dim>& extent) {
  Box<Dim> box;
  for (int k = 0; k < Dim; ++k) box.high[k] = extent[static_cast<std::size_t>(k)] + 0.5;
  return CellGrid<Dim>(box, {}, 1.0);
}

template <int Dim>
std::array<int, Dim> cube(int extent) {
  std::array<int, Dim> all;
  all.fill(extent);
  return all;
}

template <class T>
class CellCurves : public testing::Test {};
TYPED_TEST_SUITE(CellCurves, Dimensions);

TYPED_TEST(CellCurves, PassFromCellToCellThroughAWholeCube) {
  constexpr int Dim = TypeParam::value;
  for (const int extent : {1, 2, 4, 8, 16}) {
    const CellGrid<Dim> grid = cells<Dim>(cube<Dim>(extent));
    const CellCurve<Dim> curve(grid);
    ASSERT_EQ(std::int64_t{1} << curve.bits(), grid.count());
    std::array<int, Dim> last = curve.coordinates(0);
    for (std::int64_t key = 0; key < grid.count(); ++key) {
      const std::array<int, Dim> at = curve.coordinates(key);
      ASSERT_EQ(curve.key(at), key);
      int steps = 0;
      for (std::size_t k = 0; k < Dim; ++k) steps += std::abs(at[k] - last[k]);
      ASSERT_EQ(steps, key == 0 ? 0 : 1) << "extent " << extent << ", key " << key;
      last = at;
    }
  }
}

TYPED_TEST(CellCurves, GiveEachCellOfTheLargestGridItsKey) {
  constexpr int Dim = TypeParam::value;
  constexpr int most = CellGrid<Dim>::most_extent;
  const CellGrid<Dim> grid = cells<Dim>(cube<Dim>(most));
  const CellCurve<Dim> curve(grid);
  EXPECT_LE(curve.bits(), 62);
  EXPECT_GT(grid.refined(2).count(), grid.count());
  std::mt19937 random(1);
  std::uniform_int_distribution<int> uniform(0, most - 1);
  for (int trial = 0; trial < 1000; ++trial) {
    std::array<int, Dim> at;
    for (int& k : at) k = trial == 0 ? 0 : trial == 1 ? most - 1 : uniform(random);
    const std::int64_t key = curve.key(at);
    EXPECT_GE(key, 0);
    EXPECT_LT(key, std::int64_t{1} << curve.bits());
    EXPECT_EQ(curve.coordinates(key), at);
    Vector<Dim> shift;
    EXPECT_EQ(grid.coordinates(grid.wrapped_cell(at, shift)), at);
  }
}

TYPED_TEST(CellCurves, SegmentsOwnAllCellsUpToTheNext) {
  constexpr int Dim = TypeParam::value;
  std::array<int, Dim> extent = cube<Dim>(5);
  extent[0] = 11;
  const CellGrid<Dim> grid = cells<Dim>(extent);
  const CellOwners<Dim> owner(grid, {{0, 4}, {30, 0}, {31, 4}, {100, 2}});
  for (std::int64_t cell = 0; cell < grid.count(); ++cell) {
    const std::int64_t key = owner.curve().key(grid.coordinates(cell));
    EXPECT_EQ(owner(cell), key < 30 ? 4 : key < 31 ? 0 : key < 100 ? 4 : 2) << key;
    EXPECT_EQ(CellOwners<Dim>(grid)(cell), 0);
  }
}

// More questions than are remembered, and again.
TYPED_TEST(CellCurves, OwnersOfManyCellsTakeLittleMemory) {
  constexpr int Dim = TypeParam::value;
  const CellGrid<Dim> grid = cells<Dim>(cube<Dim>(10'000));
  const std::int64_t half = std::int64_t{1} << (CellCurve<Dim>(grid).bits() - 1);
  const CellOwners<Dim> owner(grid, {{0, 0}, {half, 1}});
  for (int pass = 0; pass < 2; ++pass)
    for (std::int64_t k = 0; k < 300'000; ++k) {
      const std::int64_t cell = grid.count() / 300'000 * k;
      ASSERT_EQ(owner(cell), owner.curve().key(grid.coordinates(cell)) < half ? 0 : 1);
    }
  EXPECT_LT(owner.bytes(), 8'000'000);
}

TEST(CellIndices, NumberCellsInTheOrderInWhichTheyCome) {
  CellIndex index;
  EXPECT_EQ(index.find(7), -1);
  std::map<std::int64_t, int> expected;
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 20'000; ++trial) {
    const std::int64_t cell = static_cast<std::int64_t>(random() % 5000) * (trial % 2 == 0 ? 1 : 1'000'000'007) - 1;
    const auto [at, is_new] = expected.emplace(cell, static_cast<int>(expected.size()));
    EXPECT_EQ(index.find(cell), is_new ? -1 : at->second);
    ASSERT_EQ(index.insert(cell), at->second);
    ASSERT_EQ(index.cell(at->second), cell);
  }
  EXPECT_EQ(index.size(), static_cast<int>(expected.size()));
  index.clear();
  EXPECT_EQ(index.size(), 0);
  EXPECT_EQ(index.find(expected.begin()->first), -1);
  EXPECT_EQ(index.insert(42), 0);
}

}  // namespace
}  // namespace impinge
