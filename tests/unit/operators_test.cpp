// The MPS operators: exact where the lattice makes them so, conserving on any cloud.

#include "impinge/method/operators.hpp"

#include <cmath>

#include "cloud_with_pairs.hpp"
#include "dimensions.hpp"
#include "impinge/method/viscosity.hpp"

namespace impinge {
namespace {

/// u_k = (k + 2) x_k + 3 x_0 - x_1 + 1.
template <int Dim>
Vector<Dim> linear_velocity(const Vector<Dim>& x) {
  Vector<Dim> u;
  for (int k = 0; k < Dim; ++k) u[k] = (k + 2) * x[k] + 3.0 * x[0] - x[1] + 1.0;
  return u;
}

template <int Dim>
constexpr double linear_divergence = Dim == 2 ? 2 + 3 + 2 : 2 + 3 + 4 + 2;  // of its gradient

template <int Dim>
void set_linear_fields(Particles<Dim>& particles) {
  for (std::size_t i = 0; i < particles.position.size(); ++i) {
    const Vector<Dim> x = particles.position[i];
    particles.velocity[i] = linear_velocity(x);
    particles.pressure[i] = 7.0 + 2.0 * x[0] - 3.0 * x[Dim - 1];
  }
}

template <int Dim>
void expect_gradient_of_linear_pressure(const Vector<Dim>& gradient, double tolerance) {
  for (int k = 0; k < Dim; ++k) EXPECT_NEAR(gradient[k], k == 0 ? 2.0 : k == Dim - 1 ? -3.0 : 0.0, tolerance);
}

template <class Dimension>
class Operators : public testing::Test {};
TYPED_TEST_SUITE(Operators, Dimensions);

TYPED_TEST(Operators, NumberDensityIsThatOfTheFullLattice) {
  for (const KernelType kernel : all_kernels) {
    const Cloud<TypeParam::value> lattice(0.0, kernel);
    std::vector<double> density(lattice.particles.number_density.size(), -1.0);
    number_density(lattice.near, density);
    EXPECT_NEAR(density[static_cast<std::size_t>(lattice.centre())], lattice.sums.number_density, 1e-12);
    EXPECT_LT(density[static_cast<std::size_t>(lattice.on_surface())], 0.8 * lattice.sums.number_density);
    number_density(lattice.far, density);
    EXPECT_NEAR(density[static_cast<std::size_t>(lattice.centre())], lattice.far_sums.number_density, 1e-11);
  }
}

TYPED_TEST(Operators, PackingIsTheSumOfItsOwnKernelWithEitherKernel) {
  constexpr int Dim = TypeParam::value;
  const auto packing_at = [](const Cloud<Dim>& at, KernelType kernel) {
    const std::span<const Vector<Dim>> position(at.particles.position);
    return packing<Dim>(at.near, position, kernel, near_radius, static_cast<int>(position.size()), at.centre());
  };
  for (const KernelType kernel : all_kernels) {
    const Cloud<Dim> lattice(0.0, kernel);
    EXPECT_NEAR(packing_at(lattice, kernel), lattice.sums.packing, 1e-12);
    const Cloud<Dim> cloud(0.2, kernel);
    const Vector<Dim> centre = cloud.particles.position[static_cast<std::size_t>(cloud.centre())];
    double sum = 0.0;
    for (int j = 0; j < cloud.particles.owned; ++j) {
      const double q = std::min(cloud.distance(j, centre) / near_radius, 1.0);
      if (j != cloud.centre()) sum += Dim == 3 ? std::pow(1.0 - q * q, 4) : std::pow(1.0 - q, 4) * (1.0 + 4.0 * q);
    }
    EXPECT_NEAR(packing_at(cloud, kernel), sum, 1e-12);
  }
}

TYPED_TEST(Operators, AsymmetryIsThatOfAFlatSurface) {
  constexpr int Dim = TypeParam::value;
  const Cloud<Dim> lattice(0.0);
  EXPECT_NEAR(norm(lattice.asymmetry_of(lattice.centre())), 0.0, 1e-14);
  Vector<Dim> outward;
  outward[Dim - 1] = lattice.sums.surface_asymmetry;
  EXPECT_NEAR(norm(lattice.asymmetry_of(lattice.on_surface()) - outward), 0.0, 1e-14);
}

TYPED_TEST(Operators, DivergenceIsExactOnLinearFields) {
  constexpr int Dim = TypeParam::value;
  for (const KernelType kernel : all_kernels) {
    Cloud<Dim> lattice(0.0, kernel);
    set_linear_fields(lattice.particles);
    EXPECT_NEAR(divergence<Dim>(lattice.near, lattice.particles.position, lattice.particles.velocity,
                                lattice.sums.number_density, lattice.centre()),
                linear_divergence<Dim>, 1e-12);
  }
}

/// Zero where it cannot be corrected.
template <int Dim>
Matrix<Dim> corrected_velocity_gradient(const Cloud<Dim>& cloud, int i) {
  const Particles<Dim>& p = cloud.particles;
  const double n0 = cloud.sums.number_density;
  const Matrix<Dim> correction = moment_correction<Dim>(cloud.near, p.position, n0, i);
  if (correction == Matrix<Dim>{}) return {};
  return velocity_gradient<Dim>(cloud.near, p.position, p.velocity, {}, correction, n0, i);
}

TYPED_TEST(Operators, CorrectedOnesAreExactOnLinearFieldsOfAnyCloud) {
  constexpr int Dim = TypeParam::value;
  for (const KernelType kernel : all_kernels) {
    Cloud<Dim> cloud(0.2, kernel);
    const Particles<Dim>& p = cloud.particles;
    set_linear_fields(cloud.particles);
    const std::vector<Vector<Dim>> no_wall(p.position.size());
    const double n0 = cloud.sums.number_density;
    for (const int i : {cloud.centre(), cloud.on_surface()}) {
      EXPECT_GT(std::abs(divergence<Dim>(cloud.near, p.position, p.velocity, n0, i) - linear_divergence<Dim>), 0.01);
      const Matrix<Dim> correction = moment_correction<Dim>(cloud.near, p.position, n0, i);
      const Matrix<Dim> slope = velocity_gradient<Dim>(cloud.near, p.position, p.velocity, no_wall, correction, n0, i);
      EXPECT_NEAR(trace(slope), linear_divergence<Dim>, 1e-10);
      const double own = p.pressure[static_cast<std::size_t>(i)];
      expect_gradient_of_linear_pressure(
          corrected_gradient<Dim>(cloud.near, p.position, p.pressure, own, correction, n0, i), 1e-10);
    }
  }
}

TYPED_TEST(Operators, TheVelocityGradientHasTheComponentsInItsRows) {
  constexpr int Dim = TypeParam::value;
  Cloud<Dim> cloud(0.2);
  const Particles<Dim>& p = cloud.particles;
  set_linear_fields(cloud.particles);
  const std::vector<Vector<Dim>> no_wall(p.position.size());
  const double n0 = cloud.sums.number_density;
  const int i = cloud.centre();
  const Matrix<Dim> correction = moment_correction<Dim>(cloud.near, p.position, n0, i);
  const Matrix<Dim> slope = velocity_gradient<Dim>(cloud.near, p.position, p.velocity, no_wall, correction, n0, i);
  double square = 0.0;
  for (int k = 0; k < Dim; ++k) {
    for (int l = 0; l < Dim; ++l) {
      const auto expected = [](int a, int b) {
        return (a == b ? a + 2.0 : 0.0) + (b == 0 ? 3.0 : b == 1 ? -1.0 : 0.0);
      };
      EXPECT_NEAR(slope.row[static_cast<std::size_t>(k)][l], expected(k, l), 1e-10);
      square += expected(k, l) * expected(l, k);
    }
  }
  EXPECT_NEAR(trace_of_square(slope), square, 1e-9);
}

TYPED_TEST(Operators, TheSurfaceGradientIsExactOnAPressureThatIsZeroThere) {
  constexpr int Dim = TypeParam::value;
  Cloud<Dim> lattice(0.0);
  Particles<Dim>& p = lattice.particles;
  const double n0 = lattice.sums.number_density;
  const int i = lattice.on_surface();
  Vector<Dim> up;
  up[Dim - 1] = 1.0;
  for (std::size_t j = 0; j < p.pressure.size(); ++j) p.pressure[j] = 4.0 * (11.0 - p.position[j][Dim - 1]);
  double curvature = 0.0;
  const auto gradient = [&] {
    return surface_gradient<Dim>(lattice.near, p.position, p.pressure, up, 0.5, curvature, n0, i);
  };
  ASSERT_TRUE(gradient());
  EXPECT_NEAR(norm(*gradient() + 4.0 * up), 0.0, 1e-12);
  // A pressure along the surface counts, too.
  for (std::size_t j = 0; j < p.pressure.size(); ++j)
    p.pressure[j] += 2.0 * (p.position[j][0] - p.position[static_cast<std::size_t>(i)][0]);
  EXPECT_NEAR((*gradient())[0], 2.0, 1e-12);
  // One that is curved is 4 y + 3 y^2/2 at the depth y.
  curvature = 3.0;
  for (std::size_t j = 0; j < p.pressure.size(); ++j) {
    const double y = 11.0 - p.position[j][Dim - 1];
    p.pressure[j] = 4.0 * y + 1.5 * y * y;
  }
  EXPECT_NEAR(norm(*gradient() + 5.5 * up), 0.0, 1e-12);
}

TYPED_TEST(Operators, CorrectedGradientPushesFromACrowdWhereItsBaseIsLow) {
  constexpr int Dim = TypeParam::value;
  Cloud<Dim> cloud(0.2);
  Particles<Dim>& p = cloud.particles;
  std::fill(p.pressure.begin(), p.pressure.end(), 3.0);
  const int i = cloud.centre();
  const double n0 = cloud.sums.number_density;
  const Matrix<Dim> correction = moment_correction<Dim>(cloud.near, p.position, n0, i);
  const Vector<Dim> even = corrected_gradient<Dim>(cloud.near, p.position, p.pressure, 3.0, correction, n0, i);
  const Vector<Dim> push = corrected_gradient<Dim>(cloud.near, p.position, p.pressure, 1.0, correction, n0, i);
  EXPECT_EQ(even, Vector<Dim>{});
  Vector<Dim> crowd;
  for (int k = cloud.near.begin(i); k < cloud.near.end(i); ++k) {
    const auto pair = static_cast<std::size_t>(k);
    const Vector<Dim> offset =
        p.position[static_cast<std::size_t>(cloud.near.index[pair])] - p.position[static_cast<std::size_t>(i)];
    crowd += 2.0 * Dim / n0 * cloud.near.weight[pair] / dot(offset, offset) * offset;
  }
  EXPECT_NEAR(norm(push - correction * crowd), 0.0, 1e-12);
}

TYPED_TEST(Operators, VelocityChangeIsExactOnLinearFields) {
  constexpr int Dim = TypeParam::value;
  for (const KernelType kernel : all_kernels) {
    Cloud<Dim> cloud(0.2, kernel);
    Particles<Dim>& p = cloud.particles;
    set_linear_fields(cloud.particles);
    Vector<Dim> displacement;
    for (int k = 0; k < Dim; ++k) displacement[k] = 0.1 - 0.07 * k;
    const auto expect_exact = [&](int i) {
      const Vector<Dim> centre = p.position[static_cast<std::size_t>(i)];
      const Vector<Dim> expected = linear_velocity(centre + displacement) - linear_velocity(centre);
      const Vector<Dim> change = corrected_velocity_gradient(cloud, i) * displacement;
      EXPECT_NEAR(norm(change - expected), 0.0, 1e-10);
    };
    expect_exact(cloud.centre());
    expect_exact(cloud.on_surface());
  }
}

TYPED_TEST(Operators, OffLinearIsNoiseAlone) {
  constexpr int Dim = TypeParam::value;
  Cloud<Dim> cloud(0.2);
  Particles<Dim>& p = cloud.particles;
  const auto off_linear_of_all = [&] {
    std::vector<Matrix<Dim>> gradient;
    for (int i = 0; i < cloud.near.rows(); ++i) gradient.push_back(corrected_velocity_gradient(cloud, i));
    std::vector<Vector<Dim>> result;
    for (int i = 0; i < cloud.near.rows(); ++i)
      result.push_back(off_linear<Dim>(cloud.near, p.position, p.velocity, gradient, cloud.sums.number_density, i));
    return result;
  };
  set_linear_fields(p);
  for (const Vector<Dim>& none : off_linear_of_all()) EXPECT_NEAR(norm(none), 0.0, 1e-10);

  std::vector<Vector<Dim>> noise(p.velocity.size());
  for (std::size_t i = 0; i < noise.size(); ++i)
    for (int k = 0; k < Dim; ++k) noise[i][k] = std::sin(37.0 * static_cast<double>(i) + k);
  for (std::size_t i = 0; i < noise.size(); ++i) p.velocity[i] += noise[i];
  const std::vector<Vector<Dim>> change = off_linear_of_all();
  Vector<Dim> momentum;
  double energy = 0.0;  // it takes of the noise
  for (std::size_t i = 0; i < change.size(); ++i) {
    momentum += change[i];
    energy += dot(change[i], noise[i]);
  }
  EXPECT_NEAR(norm(momentum), 0.0, 1e-9);
  EXPECT_LT(energy, -0.1 * static_cast<double>(change.size()));
}

TYPED_TEST(Operators, VelocityChangesNoFurtherThanToTheNeighbours) {
  constexpr int Dim = TypeParam::value;
  Cloud<Dim> lattice(0.0);
  set_linear_fields(lattice.particles);
  Vector<Dim> displacement;
  displacement[Dim - 1] = 5.0;
  const Particles<Dim>& p = lattice.particles;
  const Matrix<Dim> gradient = corrected_velocity_gradient(lattice, lattice.centre());
  const Vector<Dim> change =
      limited_change<Dim>(lattice.near, p.velocity, p.type, gradient * displacement, lattice.centre());
  const Vector<Dim> along = 1.0 / norm(change) * change;
  double most = 0.0;
  const auto self = static_cast<std::size_t>(lattice.centre());
  for (int k = lattice.near.begin(lattice.centre()); k < lattice.near.end(lattice.centre()); ++k) {
    const auto j = static_cast<std::size_t>(lattice.near.index[static_cast<std::size_t>(k)]);
    most = std::max(most, dot(lattice.particles.velocity[j] - lattice.particles.velocity[self], along));
  }
  EXPECT_NEAR(norm(change), most, 1e-12);
}

TYPED_TEST(Operators, VelocityLaplacianIsExactOnQuadraticFields) {
  constexpr int Dim = TypeParam::value;
  for (const KernelType kernel : all_kernels) {
    Cloud<Dim> lattice(0.0, kernel);
    const double factor = 2.0 * Dim / (lattice.far_sums.number_density * lattice.far_sums.lambda);
    for (std::size_t i = 0; i < lattice.particles.velocity.size(); ++i) {
      const Vector<Dim> x = lattice.particles.position[i];
      lattice.particles.velocity[i] = {};
      lattice.particles.velocity[i][0] = x[0] * x[0] + 3.0 * x[1] * x[1] + 2.0 * x[0] * x[1] - 5.0 * x[1];
      lattice.particles.velocity[i][1] = -2.0 * x[Dim - 1] * x[Dim - 1] + x[0];
    }
    const Vector<Dim> laplacian = velocity_laplacian<Dim>(lattice.far_row(lattice.centre()), lattice.particles.velocity,
                                                          factor, lattice.centre());
    EXPECT_NEAR(laplacian[0], 8.0, 1e-11);
    EXPECT_NEAR(laplacian[1], -4.0, 1e-11);
    EXPECT_EQ(laplacian[Dim - 1], Dim == 2 ? laplacian[1] : 0.0);
  }
}

TYPED_TEST(Operators, PressureGradientIsExactOnLinearFields) {
  constexpr int Dim = TypeParam::value;
  Cloud<Dim> lattice(0.0);
  set_linear_fields(lattice.particles);
  expect_gradient_of_linear_pressure(lattice.gradient(lattice.centre()), 1e-12);
}

TYPED_TEST(Operators, PressureForcesConserveMomentum) {
  constexpr int Dim = TypeParam::value;
  const Cloud<Dim> cloud(0.3);
  double largest = 0.0;
  for (int i = 0; i < cloud.particles.owned; ++i) largest = std::max(largest, norm(cloud.gradient(i)));
  EXPECT_GT(largest, 0.1);
  EXPECT_LT(norm(cloud.gradient_sum()), 1e-12 * largest * cloud.particles.owned);
}

/// Particles with hand-made pairs: everybody sees everybody.
template <int Dim>
struct Group {
  std::vector<Vector<Dim>> position, velocity;
  std::vector<double> pressure;
  std::vector<ParticleType> type;

  void add(double x, double y, double u, double v, ParticleType kind = ParticleType::fluid) {
    position.emplace_back();
    velocity.emplace_back();
    position.back()[0] = x;
    position.back()[1] = y;
    velocity.back()[0] = u;
    velocity.back()[1] = v;
    pressure.push_back(1.0 + static_cast<double>(pressure.size()));
    type.push_back(kind);
  }

  PairList pairs() const {
    PairList list;
    const int n = static_cast<int>(position.size());
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        if (j == i) continue;
        list.index.push_back(j);
        list.weight.push_back(NonSingularKernel::weight(
            norm(position[static_cast<std::size_t>(j)] - position[static_cast<std::size_t>(i)]), near_radius));
      }
      list.start.push_back(static_cast<int>(list.index.size()));
    }
    return list;
  }

  std::vector<Vector<Dim>> no_wall() const { return std::vector<Vector<Dim>>(type.size()); }

  /// With dt = 0.1, distance 0.5 and restitution 0.2.
  Vector<Dim> change(int i) const { return change(i, no_wall()); }
  Vector<Dim> change(int i, const std::vector<Vector<Dim>>& normal) const {
    return collision<Dim>(pairs(), position, velocity, type, normal, 0.1, 0.5, 0.2, 100.0, i);
  }
};

TYPED_TEST(Operators, AreNotCorrectedWhereNeighboursAreTooFewOrInLine) {
  constexpr int Dim = TypeParam::value;
  const double n0 = lattice_sums<Dim>(KernelType::non_singular, near_radius).number_density;
  Group<Dim> group;
  const auto expect_uncorrected = [&] {
    const Matrix<Dim> none = moment_correction<Dim>(group.pairs(), group.position, n0, 0);
    EXPECT_EQ(none, Matrix<Dim>{});
    EXPECT_EQ(
        velocity_gradient<Dim>(group.pairs(), group.position, group.velocity, {}, none, n0, 0),
        velocity_gradient<Dim>(group.pairs(), group.position, group.velocity, {}, Matrix<Dim>::identity(), n0, 0));
  };
  group.add(0.0, 0.0, 1.0, 0.0);
  expect_uncorrected();
  group.add(0.6, 0.8, 0.0, 1.0);
  group.add(-0.6, -0.8, 0.0, 2.0);
  group.add(1.2, 1.6, 0.0, 3.0);
  expect_uncorrected();
  group.add(0.8, -0.6, 2.0, 1.0);
  group.add(-0.8, 0.6, 2.0, 1.0);
  if constexpr (Dim == 2) {
    EXPECT_NE(moment_correction<Dim>(group.pairs(), group.position, n0, 0), Matrix<Dim>{});
  } else {
    expect_uncorrected();  // all in a plane
  }
}

TYPED_TEST(Operators, RepulsionPartsFluidThatIsTooNear) {
  constexpr int Dim = TypeParam::value;
  constexpr double spacing = 0.8;
  Group<Dim> pair;
  pair.add(0.0, 0.0, 0.0, 0.0);
  pair.add(0.3, -0.4, 0.0, 0.0);
  const auto of = [&](int i, double distance) {
    return repulsion<Dim>(pair.pairs(), pair.position, pair.type, distance, spacing, i);
  };
  const Vector<Dim> push = of(0, 0.9);  // at 0.625 dp
  EXPECT_NEAR(push[0], -0.275 * 0.6, 1e-14);
  EXPECT_NEAR(push[1], 0.275 * 0.8, 1e-14);
  EXPECT_EQ(of(1, 0.9), -1.0 * push);
  EXPECT_EQ(of(0, 0.62), Vector<Dim>{});
  EXPECT_EQ(of(0, 0.0), Vector<Dim>{});
  pair.type[1] = ParticleType::wall;
  EXPECT_EQ(of(0, 0.9), Vector<Dim>{});
}

TYPED_TEST(Operators, ViscousSumsAreOverThePairs) {
  constexpr int Dim = TypeParam::value;
  Group<Dim> group;
  group.add(0.0, 0.0, 1.0, -1.0);
  group.add(0.6, 0.8, 3.0, 0.0);
  group.add(0.0, -2.0, 0.0, 0.0);
  const std::vector<int> index{1, 2};
  const std::vector<double> weight{0.5, 0.25};
  const ViscousSums<Dim> sums = viscous_sums<Dim>({index, weight}, group.position, group.velocity, 0);
  EXPECT_DOUBLE_EQ(sums.differences[0], 0.5 * 2.0 - 0.25 * 1.0);
  EXPECT_DOUBLE_EQ(sums.differences[1], 0.5 * 1.0 + 0.25 * 1.0);
  EXPECT_DOUBLE_EQ(sums.offsets[0], 0.5 * 0.6);
  EXPECT_DOUBLE_EQ(sums.offsets[1], 0.5 * 0.8 - 0.25 * 2.0);
  EXPECT_DOUBLE_EQ(sums.spread, 0.5 * 1.0 + 0.25 * 4.0);
}

TYPED_TEST(Operators, EddyViscosityIsThatOfTheRateOfStrain) {
  constexpr int Dim = TypeParam::value;
  Matrix<Dim> shear, spin, stretch;
  shear.row[0][1] = 3.0;
  spin.row[0][1] = -2.0;
  spin.row[1][0] = 2.0;
  stretch.row[0][0] = 1.0;
  stretch.row[1][1] = -1.0;
  EXPECT_DOUBLE_EQ(eddy_viscosity(shear, 0.5), 0.25 * 3.0);
  EXPECT_EQ(eddy_viscosity(spin, 0.5), 0.0);
  EXPECT_DOUBLE_EQ(eddy_viscosity(stretch, 0.5), 0.25 * 2.0);
}

TYPED_TEST(Operators, AParticleThatLeavesAWallLeavesItsImageBehind) {
  constexpr int Dim = TypeParam::value;
  const double n0 = 4.0;
  Group<Dim> pair;  // a particle above the plane y = 0, and its image
  pair.add(0.0, 0.5, 3.0, 2.0);
  pair.add(0.0, -0.5, 3.0, -2.0);
  Matrix<Dim> correction = Matrix<Dim>::identity();
  correction.row[1][1] = 0.7;
  const auto left = [&](std::size_t first_image) {
    return gradient_to_images_left<Dim>(pair.pairs(), pair.position, pair.velocity, correction, n0, first_image, 0);
  };
  EXPECT_EQ(left(1), velocity_gradient<Dim>(pair.pairs(), pair.position, pair.velocity, {}, correction, n0, 0));
  EXPECT_NE(left(1), Matrix<Dim>{});
  EXPECT_EQ(left(2), Matrix<Dim>{});
  std::swap(pair.velocity[0], pair.velocity[1]);  // towards the wall
  EXPECT_EQ(left(1), Matrix<Dim>{});
}

TYPED_TEST(Operators, TheVelocityGradientLetsTheFluidSlipAlongWalls) {
  constexpr int Dim = TypeParam::value;
  const double n0 = 4.0;
  for (const ParticleType behind : {ParticleType::wall, ParticleType::ghost}) {
    Group<Dim> pair;
    pair.add(0.0, 0.0, 3.0, 0.0);
    pair.add(0.6, -0.8, 0.0, 0.0, behind);
    auto normal = pair.no_wall();
    normal[1][1] = 1.0;
    const auto of = [&](int i) {
      return trace(
          velocity_gradient<Dim>(pair.pairs(), pair.position, pair.velocity, normal, Matrix<Dim>::identity(), n0, i));
    };
    EXPECT_EQ(of(0), 0.0);
    EXPECT_EQ(of(1), 0.0);  // the wall's own row
    pair.velocity[0][1] = -1.0;
    const double factor = Dim / n0 * NonSingularKernel::weight(1.0, near_radius);
    EXPECT_NEAR(of(0), -0.8 * factor, 1e-14);
    EXPECT_NEAR(of(1), -0.8 * factor, 1e-14);
    normal[0][0] = 1.0;  // two walls: (-3, 1) has (-1, -1) along (1, 1)
    EXPECT_NEAR(of(0), 0.2 * factor, 1e-14);
  }
}

TEST(LeastPressure, IsThatOfAParticleAndItsNeighbours) {
  PairList pairs;
  pairs.start = {0, 2, 2};
  pairs.index = {1, 2};
  pairs.weight = {1.0, 3.0};
  EXPECT_EQ(least_pressure(pairs, std::vector{3.0, 2.0, 6.0, 0.0}, 0), 2.0);
  EXPECT_EQ(least_pressure(pairs, std::vector{1.0, 2.0, 6.0, 0.0}, 0), 1.0);
  EXPECT_EQ(least_pressure(pairs, std::vector{1.0, 2.0, 6.0, 0.0}, 1), 2.0);
}

TEST(Mean, IsWeighted) {
  PairList pairs;
  pairs.start = {0, 2, 2};
  pairs.index = {1, 2};
  pairs.weight = {1.0, 3.0};
  const std::vector<double> value{100.0, 2.0, 6.0};
  EXPECT_EQ(weighted_mean(pairs, value, 0), 5.0);
  EXPECT_EQ(weighted_mean(pairs, value, 1), 0.0);
}

TYPED_TEST(Operators, PressureGradientIsThatOfEquation4ForAPair) {
  constexpr int Dim = TypeParam::value;
  Group<Dim> pair;
  pair.add(0.0, 0.0, 0.0, 0.0);
  pair.add(0.6, 0.8, 0.0, 0.0);
  pair.add(0.0, 1.0, 0.0, 0.0, ParticleType::ghost);
  const double n0 = 4.0;
  const Vector<Dim> gradient =
      pressure_gradient<Dim>(pair.pairs(), pair.position, pair.pressure, pair.type, pair.no_wall(), n0, 0);
  const double size = Dim / n0 * (1.0 + 2.0) * NonSingularKernel::weight(1.0, near_radius);
  EXPECT_NEAR(gradient[0], 0.6 * size, 1e-14);
  EXPECT_NEAR(gradient[1], 0.8 * size, 1e-14);
}

TYPED_TEST(Operators, PressureGradientOfAWallIsAlongItsNormal) {
  constexpr int Dim = TypeParam::value;
  Group<Dim> pair;
  pair.add(0.0, 0.0, 0.0, 0.0);
  pair.add(0.6, 0.8, 0.0, 0.0, ParticleType::wall);
  std::vector<Vector<Dim>> normal = pair.no_wall();
  normal[1][1] = -1.0;
  const double n0 = 4.0;
  const Vector<Dim> gradient =
      pressure_gradient<Dim>(pair.pairs(), pair.position, pair.pressure, pair.type, normal, n0, 0);
  const double size = Dim / n0 * (1.0 + 2.0) * NonSingularKernel::weight(1.0, near_radius);
  EXPECT_EQ(gradient[0], 0.0);
  EXPECT_NEAR(gradient[1], 0.8 * size, 1e-14);
}

TYPED_TEST(Operators, CollidingFluidParticlesReboundWithTheRestitution) {
  constexpr int Dim = TypeParam::value;
  Group<Dim> pair;
  pair.add(0.0, 0.0, 1.0, 0.5);
  pair.add(0.55, 0.0, -1.0, -0.25);  // 0.35 apart after the step
  const Vector<Dim> first = pair.change(0);
  const Vector<Dim> second = pair.change(1);
  EXPECT_NEAR(norm(first + second), 0.0, 1e-15);
  const double approach = (1.0 + first[0]) - (-1.0 + second[0]);
  EXPECT_NEAR(approach, -0.2 * 2.0, 1e-15);
  EXPECT_EQ(first[1], 0.0);  // no friction
}

TYPED_TEST(Operators, WallsAndInletDoNotYieldInCollisions) {
  constexpr int Dim = TypeParam::value;
  for (const ParticleType rigid : {ParticleType::wall, ParticleType::inlet}) {
    Group<Dim> pair;
    // Beside a wall particle the pair is oblique, but the wall pushes along its normal.
    const bool is_wall = rigid == ParticleType::wall;
    pair.add(is_wall ? 0.1 : 0.0, 0.4, 0.3, -1.0);
    pair.add(0.0, 0.0, 0.0, 0.0, rigid);
    auto normal = pair.no_wall();
    if (is_wall) normal[1][1] = 1.0;
    const Vector<Dim> change = pair.change(0, normal);
    EXPECT_NEAR(-1.0 + change[1], 0.2, 1e-15);
    EXPECT_EQ(change[0], 0.0);
  }
}

TYPED_TEST(Operators, OnlyApproachingPairsThatWouldBeTooNearCollide) {
  constexpr int Dim = TypeParam::value;
  const auto change = [](double x, double speed, ParticleType type = ParticleType::fluid) {
    Group<Dim> pair;
    pair.add(0.0, 0.0, speed, 0.0);
    pair.add(x, 0.0, -speed, 0.0, type);
    return norm(pair.change(0));
  };
  EXPECT_EQ(change(0.3, -1.0), 0.0);  // receding
  EXPECT_EQ(change(0.3, 0.0), 0.0);   // side by side
  EXPECT_EQ(change(0.71, 1.0), 0.0);  // 0.51 after the step
  EXPECT_GT(change(0.69, 1.0), 0.0);  // 0.49 after the step
  EXPECT_EQ(change(0.3, 1.0, ParticleType::ghost), 0.0);
}

TYPED_TEST(Operators, CollisionsConserveMomentum) {
  constexpr int Dim = TypeParam::value;
  const Cloud<Dim> cloud(0.45);
  const std::vector<Vector<Dim>> no_wall(cloud.particles.type.size());
  Vector<Dim> sum;
  int collided = 0;
  for (int i = 0; i < cloud.particles.owned; ++i) {
    const Vector<Dim> change = collision<Dim>(cloud.near, cloud.particles.position, cloud.particles.velocity,
                                              cloud.particles.type, no_wall, 0.1, 0.8, 0.2, 100.0, i);
    sum += change;
    collided += norm(change) > 0.0;
  }
  EXPECT_GT(collided, 10);
  EXPECT_LT(norm(sum), 1e-13 * cloud.particles.owned);
}

TYPED_TEST(Operators, ThereIsNoSurfaceGradientWithoutNeighboursAround) {
  constexpr int Dim = TypeParam::value;
  Group<Dim> pair;
  pair.add(0.0, 0.0, 0.0, 1.0);
  pair.add(0.8, 0.0, 0.0, 2.0);
  EXPECT_FALSE(surface_gradient<Dim>(pair.pairs(), pair.position, pair.pressure, Vector<Dim>{}, 0.5, 0.0, 4.0, 0));
}

TYPED_TEST(Operators, TheMeanInsideLeavesOutTheSurface) {
  constexpr int Dim = TypeParam::value;
  Group<Dim> group;  // of the values 1, 2, 3
  group.add(0.0, 0.0, 0.0, 0.0);
  group.add(0.8, 0.0, 0.0, 0.0);
  group.add(0.0, 1.0, 0.0, 0.0);
  std::vector<std::uint8_t> free_surface{0, 0, 1};
  const double weight = NonSingularKernel::weight(0.8, near_radius);
  const auto mean = [&] { return mean_inside(group.pairs(), group.pressure, free_surface, 2.0, 0); };
  EXPECT_NEAR(mean(), (2.0 + 2.0 * weight) / (2.0 + weight), 1e-12);
  free_surface[1] = 1;
  EXPECT_EQ(mean(), 1.0);
}

TYPED_TEST(Operators, AreZeroWhereTheRowIsEmpty) {
  constexpr int Dim = TypeParam::value;
  Group<Dim> single;
  single.add(0.0, 0.0, 1.0, 1.0);
  const PairList none = single.pairs();
  std::vector<double> density{-1.0};
  number_density(none, density);
  EXPECT_EQ(density[0], 0.0);
  EXPECT_EQ(asymmetry<Dim>(none, single.position, 4.0, 0), Vector<Dim>{});
  EXPECT_EQ(trace(velocity_gradient<Dim>(none, single.position, single.velocity, single.no_wall(),
                                         Matrix<Dim>::identity(), 4.0, 0)),
            0.0);
  EXPECT_FALSE(surface_gradient<Dim>(none, single.position, single.pressure, Vector<Dim>{}, 0.5, 0.0, 4.0, 0));
  EXPECT_EQ(corrected_gradient<Dim>(none, single.position, single.pressure, 1.0, Matrix<Dim>::identity(), 4.0, 0),
            Vector<Dim>{});
  EXPECT_EQ(divergence<Dim>(none, single.position, single.velocity, 4.0, 0), 0.0);
  EXPECT_EQ(velocity_laplacian<Dim>(PairRow{}, single.velocity, 4.0, 0), Vector<Dim>{});
  EXPECT_EQ(pressure_gradient<Dim>(none, single.position, single.pressure, single.type, single.no_wall(), 4.0, 0),
            Vector<Dim>{});
}

}  // namespace
}  // namespace impinge
