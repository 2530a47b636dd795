// The zero of the pressure outside the surface particles, on a lattice with a flat surface.

#include <cmath>

#include "cloud_with_pairs.hpp"
#include "dimensions.hpp"
#include "impinge/method/operators.hpp"
#include "impinge/method/surface.hpp"

namespace impinge {
namespace {

/// A lattice below a flat surface at 11 along the last axis; its top row is marked.
template <class Dimension>
class FreeSurface : public testing::Test {
 protected:
  static constexpr int Dim = Dimension::value;

  FreeSurface() {
    for (int i = 0; i < lattice_.particles.owned; ++i) {
      asymmetry_.push_back(lattice_.asymmetry_of(i));
      marked_.push_back(lattice_.particles.position[static_cast<std::size_t>(i)][Dim - 1] > 10.0);
      // An asymmetry counts only where the surface is.
      if (!marked_.back()) asymmetry_.back().component.fill(7.0);
    }
  }

  int at_depth(double depth) const {
    Vector<Dim> point;
    point.component.fill(5.5);
    point[Dim - 1] = 11.0 - depth;
    return lattice_.at(point);
  }
  double depth_of(int i, double spacing = 1.0) const {
    return surface_depth<Dim>(lattice_.far_row(i).index, lattice_.particles.position, asymmetry_, marked_, layer_,
                              spacing, i);
  }
  Vector<Dim> normal_at(double depth) const {
    return surface_normal<Dim>(lattice_.near, asymmetry_, marked_, at_depth(depth));
  }

  /// Sum of W over the lattice points beyond the surface, and of W d_g; `below`: of a particle at that depth.
  static std::pair<double, double> missing(KernelType kernel, double below) {
    double weight = 0.0, height = 0.0;
    for (int x = -5; x <= 5; ++x) {
      for (int z = Dim == 2 ? 0 : -5; z <= (Dim == 2 ? 0 : 5); ++z) {
        for (double d = 0.5; d < 6.0; d += 1.0) {
          const double r = std::hypot(x, z, below + d);
          const double w = with_kernel(kernel, [&](auto type) { return decltype(type)::weight(r, far_radius); });
          weight += w;
          height += w * d;
        }
      }
    }
    return {weight, height};
  }

  Cloud<Dim> lattice_{0.0};
  std::vector<Vector<Dim>> asymmetry_;
  std::vector<std::uint8_t> marked_;
  std::vector<double> layer_ = std::vector<double>(lattice_.particles.position.size(), 0.5);
};
TYPED_TEST_SUITE(FreeSurface, Dimensions);

TYPED_TEST(FreeSurface, ClosesTheLaplacianOfAHydrostaticPressure) {
  for (const KernelType kernel : all_kernels) {
    const Cloud<TestFixture::Dim> lattice(0.0, kernel);
    const SurfaceClosure<TestFixture::Dim> closure(kernel, far_radius, near_radius);
    const auto pressure = [&](int i) {
      return 11.0 - lattice.particles.position[static_cast<std::size_t>(i)][TestFixture::Dim - 1];
    };
    for (const double depth : {0.5, 1.5, 2.5, 3.5}) {
      const int i = this->at_depth(depth);
      double sum = -closure.weight(depth) * pressure(i);
      for (int k = lattice.far.begin(i); k < lattice.far.end(i); ++k) {
        const auto pair = static_cast<std::size_t>(k);
        sum += lattice.far.weight[pair] * (pressure(lattice.far.index[pair]) - pressure(i));
      }
      EXPECT_NEAR(sum, 0.0, 1e-10) << "depth " << depth;
      EXPECT_EQ(closure.weight(depth) > 0.0, depth < 3.51) << "depth " << depth;
    }
    EXPECT_EQ(closure.weight(4.1), 0.0);
    EXPECT_EQ(closure.weight(std::numeric_limits<double>::infinity()), 0.0);
    EXPECT_EQ(closure.weight(0.1), closure.weight(0.3));
  }
}

// p = 11 y - y^2 below y = 0: lap p = -2, with a slope that the weight on the diagonal takes.
TYPED_TEST(FreeSurface, ClosesTheLaplacianOfACurvedPressure) {
  constexpr int dim = TestFixture::Dim;
  for (const KernelType kernel : all_kernels) {
    const Cloud<dim> lattice(0.0, kernel);
    const SurfaceClosure<dim> closure(kernel, far_radius, near_radius);
    const LatticeSums sums = lattice_sums<dim>(kernel, far_radius);
    const auto pressure = [&](int i) {
      const double height = lattice.particles.position[static_cast<std::size_t>(i)][dim - 1] - 11.0;
      return -11.0 * height - height * height;
    };
    for (const double depth : {0.5, 1.5, 2.5, 3.5, 4.5}) {
      const int i = this->at_depth(depth);
      double sum = -2.0 * closure.flux_of_curvature(depth) - closure.weight(depth) * pressure(i);
      for (int k = lattice.far.begin(i); k < lattice.far.end(i); ++k) {
        const auto pair = static_cast<std::size_t>(k);
        sum += lattice.far.weight[pair] * (pressure(lattice.far.index[pair]) - pressure(i));
      }
      const double laplacian = 2.0 * dim / (sums.number_density * sums.lambda) * sum;
      EXPECT_NEAR(laplacian, -2.0, 1e-10) << "depth " << depth;
    }
    EXPECT_GT(closure.flux_of_curvature(0.5), 1.0);
    EXPECT_EQ(closure.flux_of_curvature(4.5), 0.0);
    EXPECT_EQ(closure.flux_of_curvature(std::numeric_limits<double>::infinity()), 0.0);
  }
}

TYPED_TEST(FreeSurface, CompletesThePackingOfTheRowsBelow) {
  constexpr int dim = TestFixture::Dim;
  for (const KernelType kernel : all_kernels) {
    const Cloud<dim> lattice(0.0, kernel);
    const SurfaceClosure<dim> closure(kernel, far_radius, near_radius);
    const double whole = lattice_sums<dim>(kernel, near_radius).packing;
    for (const double depth : {0.5, 1.5, 2.5}) {
      const double here =
          packing<dim>(lattice.near, lattice.particles.position, kernel, near_radius, 1 << 30, this->at_depth(depth));
      EXPECT_NEAR(here + closure.packing(depth), whole, 1e-10) << "depth " << depth;
      EXPECT_EQ(closure.packing(depth) > 0.0, depth + 0.5 < near_radius) << "depth " << depth;
    }
  }
}

TYPED_TEST(FreeSurface, ClosureIsInterpolatedBetweenTheRows) {
  const SurfaceClosure<TestFixture::Dim> closure(KernelType::non_singular, far_radius, near_radius);
  for (double depth = 0.5; depth < 4.0; depth += 0.037) {
    const auto [weight, height] = this->missing(KernelType::non_singular, depth);
    const double expected = weight + height / depth;
    EXPECT_NEAR(closure.weight(depth), expected, 0.01 + 1e-3 * expected) << "depth " << depth;
  }
}

TYPED_TEST(FreeSurface, DepthIsThatBelowAFlatSurface) {
  for (const double depth : {0.5, 1.5, 2.5, 3.5, 4.5}) EXPECT_NEAR(this->depth_of(this->at_depth(depth)), depth, 1e-12);
  EXPECT_NEAR(this->depth_of(this->at_depth(2.5), 0.5), 4.5, 1e-12);  // 2 m in spacings of 0.5 m, and half of one
  EXPECT_EQ(this->depth_of(this->at_depth(5.5)), std::numeric_limits<double>::infinity());
  std::fill(this->marked_.begin(), this->marked_.end(), std::uint8_t{0});
  EXPECT_EQ(this->depth_of(this->at_depth(1.5)), std::numeric_limits<double>::infinity());
}

TYPED_TEST(FreeSurface, DepthIsTheMeanBelowThePlanesOfWhichTheNearestCount) {
  const auto top = static_cast<std::size_t>(this->at_depth(0.5));
  const int below = this->at_depth(2.5);
  const auto turn = [&](const Vector<TestFixture::Dim>& normal) { this->asymmetry_[top] = normal; };
  Vector<TestFixture::Dim> up, across;
  up[TestFixture::Dim - 1] = 5.0;  // only the direction counts
  across[0] = 1.0;
  turn(up);
  EXPECT_NEAR(this->depth_of(below), 2.5, 1e-12);
  turn(across);  // a depth of 0.5 with the weight of the nearest, 2^-6
  double others = 0.0;
  for (const int j : this->lattice_.far_row(below).index) {
    if (!this->marked_[static_cast<std::size_t>(j)] || j == static_cast<int>(top)) continue;
    others +=
        std::pow(this->lattice_.distance(j, this->lattice_.particles.position[static_cast<std::size_t>(below)]), -6);
  }
  const double nearest = std::pow(2.0, -6);
  EXPECT_NEAR(this->depth_of(below), (0.5 * nearest + 2.5 * others) / (nearest + others), 1e-12);
  turn({});  // none
  EXPECT_NEAR(this->depth_of(below), 2.5, 1e-12);
  turn(-1.0 * up);
  EXPECT_EQ(this->depth_of(this->at_depth(1.5)), 0.5);  // at least
}

TYPED_TEST(FreeSurface, NormalIsTheUnitVectorOutOfTheFluid) {
  Vector<TestFixture::Dim> up;
  up[TestFixture::Dim - 1] = 1.0;
  for (const double depth : {0.5, 1.5, 2.5}) EXPECT_NEAR(norm(this->normal_at(depth) - up), 0.0, 1e-14) << depth;
  EXPECT_EQ(this->normal_at(3.5), Vector<TestFixture::Dim>{});
  Vector<TestFixture::Dim>& own = this->asymmetry_[static_cast<std::size_t>(this->at_depth(0.5))];
  own[0] = own[TestFixture::Dim - 1];
  const Vector<TestFixture::Dim> tilted = this->normal_at(0.5);
  EXPECT_NEAR(norm(tilted), 1.0, 1e-14);
  EXPECT_GT(tilted[0], this->normal_at(1.5)[0]);  // its own counts most
  EXPECT_GT(this->normal_at(1.5)[0], 0.01);
}

TYPED_TEST(FreeSurface, IsFlatWhereItsNormalsAgree) {
  const auto flatness = [&](int i) {
    return surface_flatness<TestFixture::Dim>(this->lattice_.near, this->asymmetry_, this->marked_, i);
  };
  const int top = this->at_depth(0.5), below = this->at_depth(1.5);
  EXPECT_EQ(flatness(top), 1.0);
  EXPECT_EQ(flatness(below), 1.0);
  EXPECT_EQ(flatness(this->at_depth(5.5)), 1.0);  // no surface there
  // The length of an asymmetry does not count.
  this->asymmetry_[static_cast<std::size_t>(top)] *= 0.1;
  EXPECT_EQ(flatness(below), 1.0);
  // One normal across of n: |sum|/n = sqrt((n - 1)^2 + 1)/n.
  Vector<TestFixture::Dim>& own = this->asymmetry_[static_cast<std::size_t>(top)];
  own = {};
  own[0] = 2.0;
  double n = 1.0;
  for (int k = this->lattice_.near.begin(top); k < this->lattice_.near.end(top); ++k)
    n += this->marked_[static_cast<std::size_t>(this->lattice_.near.index[static_cast<std::size_t>(k)])];
  EXPECT_NEAR(flatness(top), std::clamp((std::hypot(n - 1.0, 1.0) / n - 0.8) / 0.15, 0.0, 1.0), 1e-12);
  EXPECT_LT(flatness(top), 1.0);
  // A surface particle alone has no surface around it.
  std::fill(this->marked_.begin(), this->marked_.end(), std::uint8_t{0});
  this->marked_[static_cast<std::size_t>(top)] = 1;
  EXPECT_EQ(flatness(top), 0.0);
}

}  // namespace
}  // namespace impinge
