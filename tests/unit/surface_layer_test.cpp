// The depth of the particles at the free surface, on lattices that are strained, and where the surface bends.

#include "impinge/method/surface_layer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "dimensions.hpp"

namespace impinge {
namespace {

constexpr double radius = 2.6;

/// Four rows below a flat surface; lengths along it are shorter by a share, heights as much longer as keeps the volume.
template <int Dim>
struct Rows {
  explicit Rows(double strain) {
    constexpr int half = 6;
    const double along = 1.0 - strain, height = std::pow(along, 1 - Dim);
    for (int x = -half; x <= half; ++x) {
      for (int z = Dim == 2 ? 0 : -half; z <= (Dim == 2 ? 0 : half); ++z) {
        for (int row = 0; row < 4; ++row) {
          Vector<Dim> place, up;
          place[0] = along * x;
          if constexpr (Dim == 3) place[1] = along * z;
          place[Dim - 1] = -height * row;
          up[Dim - 1] = 3.0;
          if (x == 0 && z == 0 && row == 0) middle = static_cast<int>(position.size());
          position.push_back(place);
          asymmetry.push_back(up);
          marked.push_back(row == 0);
        }
      }
    }
    type.assign(position.size(), ParticleType::fluid);
    for (std::size_t i = 0; i < position.size(); ++i) {
      for (std::size_t j = 0; j < position.size(); ++j) {
        const double r = norm(position[j] - position[i]);
        if (j == i || r >= radius) continue;
        near.index.push_back(static_cast<int>(j));
        near.weight.push_back(radius / r - 1.0);
      }
      near.start.push_back(static_cast<int>(near.index.size()));
    }
  }

  typename SurfaceLayer<Dim>::View view() const { return {near, position, asymmetry, marked, type, 1.0}; }
  double depth() const { return SurfaceLayer<Dim>(radius).depth(view(), middle); }

  PairList near;
  std::vector<Vector<Dim>> position, asymmetry;
  std::vector<std::uint8_t> marked;
  std::vector<ParticleType> type;
  int middle = 0;
};

template <class Dimension>
class SurfaceLayerTest : public testing::Test {
 protected:
  static constexpr int Dim = Dimension::value;
};
TYPED_TEST_SUITE(SurfaceLayerTest, Dimensions);

TYPED_TEST(SurfaceLayerTest, KeepsItsVolume) {
  constexpr int dim = TestFixture::Dim;
  EXPECT_NEAR(Rows<dim>(0.0).depth(), 0.5, 1e-14);
  for (const double strain : {-0.06, 0.02, 0.06}) {
    const double exact = 0.5 * std::pow(1.0 - strain, 1 - dim);
    EXPECT_NEAR(Rows<dim>(strain).depth(), exact, 0.12 * std::abs(exact - 0.5)) << strain;
  }
  EXPECT_NEAR(Rows<dim>(0.5).depth(), 0.7, 1e-14);
  EXPECT_NEAR(Rows<dim>(-1.5).depth(), 0.3, 1e-14);
}

TYPED_TEST(SurfaceLayerTest, IsThickerByAQuarterOfTheBend) {
  constexpr int dim = TestFixture::Dim;
  Rows<dim> rows(0.0);
  constexpr double bend = 0.02;
  for (std::size_t i = 0; i < rows.position.size(); ++i)
    for (int k = 0; k < dim - 1; ++k) rows.asymmetry[i][k] = 3.0 * bend * rows.position[i][k];
  EXPECT_NEAR(rows.depth(), 0.5 * (1.0 + 0.25 * (dim - 1) * bend), 1e-5);
}

TYPED_TEST(SurfaceLayerTest, CountsRowsThatEnterAndNothingWhereTheSurfaceIsRough) {
  constexpr int dim = TestFixture::Dim;
  Rows<dim> rows(0.04);
  const double whole = rows.depth();
  for (std::size_t i = 0; i < rows.position.size(); ++i) {
    if (rows.position[i][0] < 0.5) continue;
    rows.type[i] = ParticleType::inlet;
    rows.marked[i] = 0;
  }
  EXPECT_NEAR(rows.depth(), whole, 1e-14);
  Rows<dim> rough(0.04);
  for (std::size_t i = 0; i < rough.position.size(); ++i) rough.asymmetry[i][0] = (i / 4) % 2 == 0 ? 4.0 : -4.0;
  EXPECT_NEAR(rough.depth(), 0.5, 1e-14);
  rough.asymmetry[static_cast<std::size_t>(rough.middle)] = {};
  EXPECT_EQ(rough.depth(), 0.5);
}

TYPED_TEST(SurfaceLayerTest, MeansAreTakenAlongTheSurface) {
  constexpr int dim = TestFixture::Dim;
  const Rows<dim> rows(0.0);
  const SurfaceLayer<dim> layer(radius);
  std::vector<double> depth(rows.position.size(), 0.4);
  for (std::size_t i = 0; i < depth.size(); ++i)
    if (!rows.marked[i]) depth[i] = 9.0;
  EXPECT_NEAR(layer.mean(rows.view(), depth, rows.middle), 0.4, 1e-14);
  for (std::size_t i = 0; i < depth.size(); ++i) depth[i] += 0.01 * rows.position[i][0];
  EXPECT_NEAR(layer.mean(rows.view(), depth, rows.middle), 0.4, 1e-14);
  depth[static_cast<std::size_t>(rows.middle)] = 0.6;
  EXPECT_GT(layer.mean(rows.view(), depth, rows.middle), 0.42);
}

}  // namespace
}  // namespace impinge
