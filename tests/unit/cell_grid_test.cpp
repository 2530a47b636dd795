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
  static CellGrid<Dim> make(Edge edge) {
    Box<Dim> box;
    const double low[] = {-1.0, 2.0, 0.0};
    const double high[] = {2.5, 4.2, 2.0};
    for (int k = 0; k < Dim; ++k) {
      box.low[k] = low[k];
      box.high[k] = high[k];
    }
    Edges<Dim> all;
    all.fill({edge, edge});
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
  for (const Edge edge : {Edge::open, Edge::periodic, Edge::mirror}) {
    const auto grid = this->make(edge);
    EXPECT_EQ(grid.extent()[0], 3);
    EXPECT_EQ(grid.extent()[1], 2);
    EXPECT_EQ(grid.count(), TestFixture::Dim == 2 ? 6 : 12);
    EXPECT_GE(grid.cell(this->point(2.4999, 4.1999)), 0);
    EXPECT_EQ(grid.cell(this->point(2.5001, 4.1999)), -1);
    EXPECT_EQ(grid.cell(this->point(2.4999, 4.2001)), -1);
  }
}

TYPED_TEST(CellGrids, AreNumberedWithTheLastAxisFastest) {
  const auto grid = this->make(Edge::open);
  const int cell = grid.cell(this->point(1.5, 3.5));  // cell 2, 1 (, 1)
  EXPECT_EQ(cell, TestFixture::Dim == 2 ? 2 * 2 + 1 : (2 * 2 + 1) * 2 + 1);
  for (int c = 0; c < grid.count(); ++c) {
    Image<TestFixture::Dim> image;
    EXPECT_EQ(grid.wrapped_cell(grid.coordinates(c), image), c);
    EXPECT_EQ(image, Image<TestFixture::Dim>{});
  }
}

TYPED_TEST(CellGrids, HoldNoPositionOutside) {
  const auto grid = this->make(Edge::open);
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
  for (const Edge edge : {Edge::open, Edge::periodic}) {
    const auto coarse = this->make(edge);
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
  Image<TestFixture::Dim> image;
  const auto periodic = this->make(Edge::periodic);
  auto at = periodic.coordinates(0);
  at[0] = -1;
  EXPECT_EQ(periodic.coordinates(periodic.wrapped_cell(at, image))[0], 2);
  EXPECT_NEAR(image.shift[0], 3.5, 1e-14);  // a particle of cell 0 appears one period on, beside cell 2
  EXPECT_EQ(image.shift[1], 0.0);
  EXPECT_FALSE(image.reflects());
  at[0] = 3;
  EXPECT_EQ(periodic.coordinates(periodic.wrapped_cell(at, image))[0], 0);
  EXPECT_NEAR(image.shift[0], -3.5, 1e-14);
  for (const int beyond : {-1, 3}) {
    at[0] = beyond;
    EXPECT_EQ(this->make(Edge::open).wrapped_cell(at, image), -1);
  }
}

TYPED_TEST(CellGrids, HaveMirroredCellsBeyondAMirror) {
  Image<TestFixture::Dim> image;
  const auto grid = this->make(Edge::mirror);
  const auto expect_cell = [&](int beyond, int x) {
    auto at = grid.coordinates(0);
    at[0] = beyond;
    auto mirrored = at;
    mirrored[0] = x;
    ASSERT_EQ(grid.coordinates(grid.wrapped_cell(at, image)), mirrored);
    EXPECT_TRUE(image.reflects());
    EXPECT_NEAR(norm(image.of_position(this->point(0.25, 3.0)) - this->point(beyond < 0 ? -2.25 : 4.75, 3.0)), 0.0,
                1e-14);
  };
  expect_cell(-1, 0);
  expect_cell(-2, 1);
  expect_cell(3, 2);
  expect_cell(5, 0);
  for (const int too_far : {-4, 6}) {
    auto at = grid.coordinates(0);
    at[0] = too_far;
    EXPECT_EQ(grid.wrapped_cell(at, image), -1);
  }
}

// Every image within a cell's edge, also those of corners, is among the cells around.
TYPED_TEST(CellGrids, AroundACellHoldTheImagesThatAreNear) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> x(-1.0, 2.5), y(2.0, 4.2), sign(-1.0, 1.0);
  const auto grid = this->make(Edge::mirror);
  int near = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const auto one = this->point(x(random), y(random));
    const auto two = this->point(x(random), y(random));
    Image<TestFixture::Dim> image;
    image.sign[0] = image.sign[1] = -1.0;
    image.shift[0] = sign(random) < 0.0 ? -2.0 : 5.0;
    image.shift[1] = sign(random) < 0.0 ? 4.0 : 8.4;
    const auto offset = image.of_position(two) - one;
    if (std::abs(offset[0]) > 1.0 || std::abs(offset[1]) > 1.0) continue;
    ++near;
    int found = 0;
    for_cells_around(grid, grid.cell(one), 1, [&](int cell, const Image<TestFixture::Dim>& around) {
      found += cell == grid.cell(two) && norm(around.of_position(two) - one - offset) < 1e-12;
    });
    EXPECT_EQ(found, 1);
  }
  EXPECT_GT(near, 50);
}

TYPED_TEST(CellGrids, CoordinatesGoOnBeyondTheBox) {
  const auto grid = this->make(Edge::periodic);
  const double edge = 3.5 / 3.0;
  EXPECT_EQ(grid.coordinates(this->point(-1.0 - 0.5 * edge, 3.0))[0], -1);
  EXPECT_EQ(grid.coordinates(this->point(2.5 + 1.5 * edge, 3.0))[0], 4);
}

TYPED_TEST(CellGrids, WrappedPositionsAreInside) {
  const auto grid = this->make(Edge::periodic);
  EXPECT_NEAR(grid.wrapped(this->point(-1.25, 3.0))[0], 2.25, 1e-14);
  EXPECT_NEAR(grid.wrapped(this->point(2.75, 3.0))[0], -0.75, 1e-14);
  EXPECT_EQ(grid.wrapped(this->point(0.1, 3.0)), this->point(0.1, 3.0));
  EXPECT_EQ(this->make(Edge::open).wrapped(this->point(-1.25, 3.0)), this->point(-1.25, 3.0));
}

TYPED_TEST(CellGrids, WrappedPositionsAreOnThisSideOfTheMirrors) {
  Image<TestFixture::Dim> image;
  const auto grid = this->make(Edge::mirror);
  const auto expect_wrapped = [&](const Vector<TestFixture::Dim>& from, const Vector<TestFixture::Dim>& to,
                                  double sign_x, double sign_y) {
    EXPECT_NEAR(norm(grid.wrapped(from, image) - to), 0.0, 1e-14);
    EXPECT_NEAR(norm(image.of_position(from) - to), 0.0, 1e-14);
    EXPECT_EQ(image.of_direction(this->point(3.0, 5.0)), this->point(3.0 * sign_x, 5.0 * sign_y));
    EXPECT_NEAR(norm(grid.unmirrored(from) - to), 0.0, 1e-14);
  };
  expect_wrapped(this->point(-1.25, 3.0), this->point(-0.75, 3.0), -1.0, 1.0);
  expect_wrapped(this->point(2.75, 3.0), this->point(2.25, 3.0), -1.0, 1.0);
  expect_wrapped(this->point(2.75, 1.5), this->point(2.25, 2.5), -1.0, -1.0);
  expect_wrapped(this->point(0.1, 3.0), this->point(0.1, 3.0), 1.0, 1.0);
  EXPECT_FALSE(image.reflects());
  for (const Edge edge : {Edge::open, Edge::periodic})
    EXPECT_EQ(this->make(edge).unmirrored(this->point(-1.25, 4.3)), this->point(-1.25, 4.3));
}

TYPED_TEST(CellGrids, MayHaveAMirrorAtOneEnd) {
  Edges<TestFixture::Dim> edges;
  edges[1].low = Edge::mirror;
  Box<TestFixture::Dim> box;
  box.high.component.fill(3.0);
  const CellGrid<TestFixture::Dim> grid(box, edges, 1.0);
  EXPECT_EQ(grid.wrapped(this->point(1.5, -0.5)), this->point(1.5, 0.5));
  EXPECT_EQ(grid.cell(grid.wrapped(this->point(1.5, 3.5))), -1);
  EXPECT_EQ(grid.unmirrored(this->point(-0.5, 3.5)), this->point(-0.5, 3.5));
  Image<TestFixture::Dim> image;
  auto at = grid.coordinates(0);
  at[1] = 3;
  EXPECT_EQ(grid.wrapped_cell(at, image), -1);
  at[1] = -1;
  EXPECT_EQ(grid.wrapped_cell(at, image), 0);
}

// A particle that rounding puts on the very end of the period or on a mirror must not be lost.
TYPED_TEST(CellGrids, WrappedPositionsHaveACellAtTheEndsOfAnyBox) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.1, 10.0);
  for (int trial = 0; trial < 4000; ++trial) {
    const Edge edge = trial < 2000 ? Edge::periodic : Edge::mirror;
    Edges<TestFixture::Dim> edges;
    edges.fill({edge, edge});
    Box<TestFixture::Dim> box;
    for (int k = 0; k < TestFixture::Dim; ++k) {
      box.low[k] = trial % 2 == 0 ? 0.0 : uniform(random) - 5.0;
      box.high[k] = box.low[k] + uniform(random);
    }
    const CellGrid<TestFixture::Dim> grid(box, edges, 0.099);
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
