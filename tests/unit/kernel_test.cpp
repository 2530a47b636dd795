// The kernels and their sums on the lattice.

#include "impinge/particles/kernel.hpp"

#include <gtest/gtest.h>

#include "cloud_with_pairs.hpp"
#include "impinge/core/vector.hpp"

namespace impinge {
namespace {

constexpr double printed = 5e-7;  // half a unit of the last printed digit

/// Number density of a particle `depth` rows below a flat surface of the square lattice, kernel (3), over n0.
double relative_density_below_surface(int depth) {
  constexpr double radius = 2.1;
  double sum = 0.0;
  for (int x = -3; x <= 3; ++x)
    for (int y = -3; y <= depth; ++y)
      if (x != 0 || y != 0) sum += NonSingularKernel::weight(norm(Vector<2>{{1.0 * x, 1.0 * y}}), radius);
  return sum / lattice_sums<2>(KernelType::non_singular, radius).number_density;
}

TEST(LatticeSums, OfTheNonSingularKernel) {
  EXPECT_NEAR(lattice_sums<2>(KernelType::non_singular, 2.1).number_density, 4.915982, printed);
  EXPECT_NEAR(lattice_sums<2>(KernelType::non_singular, 4.01).number_density, 24.671676, printed);
  EXPECT_NEAR(lattice_sums<2>(KernelType::non_singular, 4.01).lambda, 4.082879, printed);
}

TEST(LatticeSums, OfTheSingularKernel) {
  EXPECT_NEAR(lattice_sums<2>(KernelType::singular, 2.1).number_density, 6.539697, printed);
  EXPECT_NEAR(lattice_sums<2>(KernelType::singular, 4.01).number_density, 35.818246, printed);
  EXPECT_NEAR(lattice_sums<2>(KernelType::singular, 4.01).lambda, 3.721482, printed);
}

TEST(LatticeSums, OfAFlatSurface) {
  EXPECT_NEAR(lattice_sums<2>(KernelType::non_singular, 2.1).surface_asymmetry, 0.5648, 5e-5);
  EXPECT_NEAR(relative_density_below_surface(0), 0.6718, 5e-5);
  EXPECT_NEAR(relative_density_below_surface(1), 0.9914, 5e-5);
  EXPECT_NEAR(relative_density_below_surface(2), 1.0, 1e-14);
}

/// Packing of the square lattice, sheared by stretching it e^strain-fold along its diagonal, over that at rest.
double relative_packing(double strain) {
  constexpr double radius = 2.1;
  double sum = 0.0;
  for (int x = -5; x <= 5; ++x) {
    for (int y = -5; y <= 5; ++y) {
      if (x == 0 && y == 0) continue;
      const double along = std::exp(strain) * (x + y), across = std::exp(-strain) * (x - y);
      const double r = std::sqrt(0.5) * std::hypot(along, across);
      sum += packing_weight<2, NonSingularKernel>(NonSingularKernel::weight(r, radius));
    }
  }
  return sum / lattice_sums<2>(KernelType::non_singular, radius).packing;
}

// At a strain of ln(3)/4 the lattice has become the hexagonal one.
TEST(LatticeSums, PackingDoesNotSeeAShearOfTheLattice) {
  EXPECT_NEAR(relative_packing(0.0), 1.0, 1e-14);
  for (const double strain : {0.1, 0.2, 0.25 * std::log(3.0)}) EXPECT_NEAR(relative_packing(strain), 1.0, 0.0015);
}

// Water that turns round in a tank strains the cubic lattice along one axis and compresses it along another.
TEST(LatticeSums, PackingHardlySeesAStrainOfTheCubicLattice) {
  constexpr double radius = 2.6;
  for (const double strain : {0.1, 0.2, 0.3, 0.4}) {
    double sum = 0.0;
    for (int x = -5; x <= 5; ++x) {
      for (int y = -5; y <= 5; ++y) {
        for (int z = -5; z <= 5; ++z) {
          if (x == 0 && y == 0 && z == 0) continue;
          const double r = std::hypot((1.0 - strain) * x, y / (1.0 - strain), z);
          sum += packing_weight<3, NonSingularKernel>(NonSingularKernel::weight(r, radius));
        }
      }
    }
    EXPECT_NEAR(sum / lattice_sums<3>(KernelType::non_singular, radius).packing, 1.0, 0.012) << strain;
  }
}

// Radius 1.2 reaches the six nearest neighbours only, 1.5 the twelve behind them too.
TEST(LatticeSums, OfTheCubicLattice) {
  const LatticeSums nearest = lattice_sums<3>(KernelType::singular, 1.2);
  EXPECT_NEAR(nearest.number_density, 6.0 * 0.2, 1e-14);
  EXPECT_NEAR(nearest.lambda, 1.0, 1e-14);
  EXPECT_NEAR(nearest.surface_asymmetry, 3.0 / 6.0, 1e-14);
  EXPECT_EQ(nearest.neighbours, 6);

  const double diagonal = 1.5 / std::sqrt(2.0) - 1.0;
  const LatticeSums next = lattice_sums<3>(KernelType::singular, 1.5);
  EXPECT_NEAR(next.number_density, 6.0 * 0.5 + 12.0 * diagonal, 1e-14);
  EXPECT_NEAR(next.lambda, (6.0 * 0.5 + 24.0 * diagonal) / (6.0 * 0.5 + 12.0 * diagonal), 1e-14);
  EXPECT_EQ(next.neighbours, 6 + 12);
}

template <class Kernel>
void expect_invertible() {
  constexpr double radius = 0.042;
  for (int k = 1; k < 100; ++k)
    EXPECT_GT(Kernel::weight(0.01 * k * radius, radius), Kernel::weight(0.01 * (k + 1) * radius, radius));
  EXPECT_GT(Kernel::weight(0.999999 * radius, radius), 0.0);
  EXPECT_LT(Kernel::weight(0.999999 * radius, radius), 1e-5);
  EXPECT_EQ(Kernel::weight(radius, radius), 0.0);
  EXPECT_EQ(Kernel::weight(2.0 * radius, radius), 0.0);
  for (int k = 1; k < 100; ++k)
    EXPECT_NEAR(Kernel::reach(Kernel::weight(0.01 * k * radius, radius)), 1.0 - 0.01 * k, 1e-12);
}

TEST(Kernel, DecreasesToZeroAtTheEffectiveRadiusAndHasAnInverse) {
  for (const KernelType type : all_kernels)
    with_kernel(type, [](auto kernel) { expect_invertible<decltype(kernel)>(); });
}

TEST(Kernel, HasThePapersValues) {
  EXPECT_NEAR(NonSingularKernel::weight(0.0, 2.1), 1.0 / 0.15 - 1.0, 1e-14);
  EXPECT_NEAR(NonSingularKernel::weight(1.0, 2.0), 2.0 / 1.15 - 1.0, 1e-14);
  EXPECT_EQ(SingularKernel::weight(1.0, 2.0), 1.0);
}

TEST(Kernel, IsChosenByItsType) {
  const auto weight = [](KernelType type) {
    return with_kernel(type, [](auto kernel) { return decltype(kernel)::weight(1.0, 2.0); });
  };
  EXPECT_EQ(weight(KernelType::non_singular), NonSingularKernel::weight(1.0, 2.0));
  EXPECT_EQ(weight(KernelType::singular), SingularKernel::weight(1.0, 2.0));
  EXPECT_EQ(words(KernelType{})[static_cast<std::size_t>(KernelType::singular)], "singular");
}

}  // namespace
}  // namespace impinge
