// Background cells: numbering, wrapping, the outside.

#include "impinge/particles/cell_grid.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "dimensions.hpp"

namespace impinge {
namespace {

template <class Dimension>
class CellGrids : public testing::Test {
 protected:
  static constexpr int Dim = Dimension::value;

  /// [-1, 2.5) x [2, 4.2) (x [0, 2)) in cells of at least 1.
  static CellGrid<Dim> make(bool periodic) {
    Box<Dim> box;
    const double low[] = {-1.0, 2.0, 0.0};
    const double high[] = {2.5, 4.2, 2.0};
    for (int k = 0; k < Dim; ++k) {
      box.low[k] = low[k];
      box.high[k] = high[k];
    }
    std::array<bool, Dim> all;
    all.fill(periodic);
    return {box, all, 1.0};
  }

  static Vector<Dim> point(double x, double y) {
    Vector<Dim> position;
    position[0] = x;
    position[1] = y;
    if constexpr (Dim == 3) position[2] = 1.5;  // second of two cells
    return position;
  }
};
TYPED_TEST_SUITE(CellGrids, Dimensions);

TYPED_TEST(CellGrids, DivideTheBoxExactly) {
  for (const bool periodic : {false, true}) {
    const auto grid = this->make(periodic);
    EXPECT_EQ(grid.extent()[0], 3);
    EXPECT_EQ(grid.extent()[1], 2);
    EXPECT_EQ(grid.count(), TestFixture::Dim == 2 ? 6 : 12);
    EXPECT_GE(grid.cell(this->point(2.4999, 4.1999)), 0);
    EXPECT_EQ(grid.cell(this->point(2.5001, 4.1999)), -1);
    EXPECT_EQ(grid.cell(this->point(2.4999, 4.2001)), -1);
  }
}

TYPED_TEST(CellGrids, AreNumberedWithTheLastAxisFastest) {
  const auto grid = this->make(false);
  const std::int64_t cell = grid.cell(this->point(1.5, 3.5));  // cell 2, 1 (, 1)
  EXPECT_EQ(cell, TestFixture::Dim == 2 ? 2 * 2 + 1 : (2 * 2 + 1) * 2 + 1);
  for (int c = 0; c < grid.count(); ++c) {
    Vector<TestFixture::Dim> shift;
    EXPECT_EQ(grid.wrapped_cell(grid.coordinates(c), shift), c);
    EXPECT_EQ(shift, Vector<TestFixture::Dim>{});
  }
}

TYPED_TEST(CellGrids, HoldNoPositionOutside) {
  const auto grid = this->make(false);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double x : {-1.0001, 2.5001, 1e300, -1e300, infinity, -infinity, std::nan("")}) {
    EXPECT_EQ(grid.cell(this->point(x, 3.0)), -1) << x;
    EXPECT_EQ(grid.cell(this->point(0.0, x > 0.0 ? x + 2.0 : x)), -1) << x;
  }
  EXPECT_EQ(grid.cell(this->point(-1.0, 2.0)), grid.cell(this->point(-0.9, 2.1)));  // the low corner is inside
}

TYPED_TEST(CellGrids, RefinedCellsLieInTheirCoarseOne) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(-1.0, 2.5), y(2.0, 4.2);
  for (const bool periodic : {false, true}) {
    const auto coarse = this->make(periodic);
    const auto fine = coarse.refined(2);
    EXPECT_EQ(fine.count(), coarse.count() * (TestFixture::Dim == 2 ? 4 : 8));
    for (int k = 0; k < 1000; ++k) {
      const auto position = this->point(x(random), y(random));
      auto at = fine.coordinates(fine.cell(position));
      EXPECT_EQ(at, fine.coordinates(position));
      for (int& coordinate : at) coordinate /= 2;
      EXPECT_EQ(at, coarse.coordinates(position));
    }
  }
}

TYPED_TEST(CellGrids, WrapAlongPeriodicAxesOnly) {
  Vector<TestFixture::Dim> shift;
  const auto periodic = this->make(true);
  auto at = periodic.coordinates(0);
  at[0] = -1;
  EXPECT_EQ(periodic.coordinates(periodic.wrapped_cell(at, shift))[0], 2);
  EXPECT_NEAR(shift[0], 3.5, 1e-14);  // a particle of cell 0 appears one period on, beside cell 2
  EXPECT_EQ(shift[1], 0.0);
  at[0] = 3;
  EXPECT_EQ(periodic.coordinates(periodic.wrapped_cell(at, shift))[0], 0);
  EXPECT_NEAR(shift[0], -3.5, 1e-14);
  for (const int beyond : {-1, 3}) {
    at[0] = beyond;
    EXPECT_EQ(this->make(false).wrapped_cell(at, shift), -1);
  }
}

TYPED_TEST(CellGrids, CoordinatesGoOnBeyondTheBox) {
  const auto grid = this->make(true);
  const double edge = 3.5 / 3.0;
  EXPECT_EQ(grid.coordinates(this->point(-1.0 - 0.5 * edge, 3.0))[0], -1);
  EXPECT_EQ(grid.coordinates(this->point(2.5 + 1.5 * edge, 3.0))[0], 4);
}

TYPED_TEST(CellGrids, WrappedPositionsAreInside) {
  const auto grid = this->make(true);
  EXPECT_NEAR(grid.wrapped(this->point(-1.25, 3.0))[0], 2.25, 1e-14);
  EXPECT_NEAR(grid.wrapped(this->point(2.75, 3.0))[0], -0.75, 1e-14);
  EXPECT_EQ(grid.wrapped(this->point(0.1, 3.0)), this->point(0.1, 3.0));
  EXPECT_EQ(this->make(false).wrapped(this->point(-1.25, 3.0)), this->point(-1.25, 3.0));
}

// Wall particles stand as near to the high end as numbers can be.
TYPED_TEST(CellGrids, PositionsBelowTheHighEndHaveACellInAnyBox) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(0.1, 10.0);
  for (int trial = 0; trial < 2000; ++trial) {
    Box<TestFixture::Dim> box;
    for (int k = 0; k < TestFixture::Dim; ++k) {
      box.low[k] = trial % 2 == 0 ? 0.0 : uniform(random) - 5.0;
      box.high[k] = box.low[k] + uniform(random);
    }
    const CellGrid<TestFixture::Dim> grid(box, {}, 0.099);
    Vector<TestFixture::Dim> position = box.high;
    for (int k = 0; k < TestFixture::Dim; ++k) position[k] = std::nextafter(position[k], -1e9);
    ASSERT_EQ(grid.cell(position), grid.count() - 1) << "trial " << trial;
    ASSERT_EQ(grid.refined(2).cell(position), grid.refined(2).count() - 1) << "trial " << trial;
    ASSERT_EQ(grid.cell(box.high), -1) << "trial " << trial;
  }
}

// A particle that rounding puts on the very end of the period must not be lost.
TYPED_TEST(CellGrids, WrappedPositionsHaveACellAtTheEndsOfAnyBox) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.1, 10.0);
  for (int trial = 0; trial < 2000; ++trial) {
    std::array<bool, TestFixture::Dim> periodic;
    periodic.fill(true);
    Box<TestFixture::Dim> box;
    for (int k = 0; k < TestFixture::Dim; ++k) {
      box.low[k] = trial % 2 == 0 ? 0.0 : uniform(random) - 5.0;
      box.high[k] = box.low[k] + uniform(random);
    }
    const CellGrid<TestFixture::Dim> grid(box, periodic, 0.099);
    for (Vector<TestFixture::Dim> end : {box.low, box.high}) {
      for (int ulp = -3; ulp <= 3; ++ulp) {
        Vector<TestFixture::Dim> position = end;
        for (int k = 0; k < TestFixture::Dim; ++k)
          for (int n = 0; n < std::abs(ulp); ++n) position[k] = std::nextafter(position[k], ulp < 0 ? -1e9 : 1e9);
        ASSERT_GE(grid.cell(grid.wrapped(position)), 0) << "trial " << trial << ", " << ulp << " ulp";
        ASSERT_GE(grid.refined(2).cell(grid.wrapped(position)), 0) << "trial " << trial << ", " << ulp << " ulp";
      }
    }
  }
}

}  // namespace
}  // namespace impinge
