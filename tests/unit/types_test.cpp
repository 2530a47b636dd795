// Small matrices, and images of points.

#include <random>

#include "dimensions.hpp"
#include "impinge/core/table.hpp"
#include "impinge/core/vector.hpp"
#include "impinge/particles/cell_grid.hpp"

namespace impinge {
namespace {

template <class Dimension>
class Types : public testing::Test {
 protected:
  static constexpr int Dim = Dimension::value;

  Vector<Dim> vector() {
    Vector<Dim> result;
    for (double& x : result.component) x = uniform_(random_);
    return result;
  }
  Matrix<Dim> matrix() {
    Matrix<Dim> result;
    for (Vector<Dim>& row : result.row) row = vector();
    return result;
  }

 private:
  std::mt19937 random_{1};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};
TYPED_TEST_SUITE(Types, Dimensions);

TYPED_TEST(Types, AMatrixTimesItsAdjugateIsTheDeterminant) {
  for (int trial = 0; trial < 100; ++trial) {
    const auto m = this->matrix();
    const auto v = this->vector();
    EXPECT_NEAR(norm(m * (adjugate(m) * v) - determinant(m) * v), 0.0, 1e-14);
    EXPECT_NEAR(norm(adjugate(m) * (m * v) - determinant(m) * v), 0.0, 1e-14);
  }
}

TYPED_TEST(Types, ADeterminantIsAVolume) {
  EXPECT_EQ(determinant(Matrix<TestFixture::Dim>::identity()), 1.0);
  EXPECT_EQ(determinant(2.0 * Matrix<TestFixture::Dim>::identity()), TestFixture::Dim == 2 ? 4.0 : 8.0);
  auto m = this->matrix();
  const double volume = determinant(m);
  std::swap(m.row[0], m.row[1]);
  EXPECT_NEAR(determinant(m), -volume, 1e-15);
  m.row[0] = -3.0 * m.row[1];
  EXPECT_NEAR(determinant(m), 0.0, 1e-15);
}

TYPED_TEST(Types, AProductOfVectorsMapsAlongTheFirst) {
  const auto m = this->matrix();
  const auto a = this->vector(), b = this->vector(), v = this->vector();
  auto sum = m;
  sum.add_product(a, b);
  EXPECT_NEAR(norm(sum * v - (m * v + dot(b, v) * a)), 0.0, 1e-15);
}

TYPED_TEST(Types, ABoxHoldsItsSurfaceAndAMargin) {
  constexpr int dim = TestFixture::Dim;
  Box<dim> box;
  for (int k = 0; k < dim; ++k) box.high[k] = 1.0 + k;
  EXPECT_TRUE(box.contains(box.low));
  EXPECT_TRUE(box.contains(box.high));
  for (int k = 0; k < dim; ++k) {
    for (const double beyond : {-0.1, 1.1 + k}) {
      Vector<dim> place = 0.5 * box.high;
      place[k] = beyond;
      EXPECT_FALSE(box.contains(place));
      EXPECT_TRUE(box.contains(place, 0.2));
    }
  }
}

TEST(PlaceInTable, IsFoundForEveryValue) {
  const std::vector<double> table{1.0, 2.0, 4.0};
  const auto is = [&](double value, std::size_t before, std::size_t after, double share) {
    const TablePlace place = place_in(table, value);
    EXPECT_EQ(place.before, before) << value;
    EXPECT_EQ(place.after, after) << value;
    EXPECT_DOUBLE_EQ(place.share, share) << value;
  };
  is(0.5, 0, 0, 0.0);
  is(1.0, 0, 1, 0.0);
  is(3.5, 1, 2, 0.75);
  is(4.0, 2, 2, 0.0);
  is(9.0, 2, 2, 0.0);
  EXPECT_EQ(place_in(std::vector<double>{3.0}, 5.0).before, 0u);
}

}  // namespace
}  // namespace impinge
