// The MPS operators: exact where the lattice makes them so, conserving on any cloud.

#include "impinge/operators.hpp"

#include <cmath>

#include "cloud.hpp"
#include "dimensions.hpp"

namespace impinge {
namespace {

constexpr double near_radius = 2.1;
constexpr double far_radius = 4.01;
constexpr int reach = 2;

/// A cloud with its pairs.
template <int Dim>
struct Cloud {
  static constexpr std::array<int, Dim> extent() {
    std::array<int, Dim> points;
    points.fill(11);
    return points;
  }

  explicit Cloud(double jitter, KernelType kernel = KernelType::non_singular)
      : sums(lattice_sums<Dim>(kernel, near_radius)), far_sums(lattice_sums<Dim>(kernel, far_radius)) {
    Box<Dim> box;
    for (int k = 0; k < Dim; ++k) box.high[k] = extent()[static_cast<std::size_t>(k)];
    const auto cells = CellGrid<Dim>(box, {}, far_radius).refined(reach);
    particles = sorted(cells, make_cloud<Dim>(extent(), jitter), [](const auto&) { return true; });
    NeighbourSearch<Dim> search(cells, reach, kernel, near_radius, far_radius);
    search.search(particles);
    near = search.near();
    far = search.far();
  }

  /// The particle nearest to a point.
  int at(const Vec<Dim>& point) const {
    int nearest = 0;
    for (int i = 0; i < particles.owned; ++i)
      if (distance(i, point) < distance(nearest, point)) nearest = i;
    return nearest;
  }
  double distance(int i, const Vec<Dim>& point) const {
    return norm(particles.position[static_cast<std::size_t>(i)] - point);
  }

  int centre() const {
    Vec<Dim> middle;
    for (int k = 0; k < Dim; ++k) middle[k] = 5.5;
    return at(middle);
  }

  /// In the middle of the top, with the normal along the last axis.
  int on_surface() const {
    Vec<Dim> top;
    for (int k = 0; k < Dim; ++k) top[k] = k == Dim - 1 ? 10.5 : 5.5;
    return at(top);
  }

  /// The sum of pressure_gradient over all particles.
  Vec<Dim> gradient_sum() const {
    Vec<Dim> sum;
    for (int i = 0; i < particles.owned; ++i) sum += gradient(i);
    return sum;
  }
  Vec<Dim> gradient(int i) const {
    const std::vector<Vec<Dim>> no_wall(particles.type.size());
    return pressure_gradient<Dim>(near, particles.position, particles.pressure, particles.type, no_wall,
                                  sums.number_density, i);
  }

  LatticeSums sums, far_sums;
  Particles<Dim> particles;
  PairList near, far;
};

template <class Dimension>
class Operators : public testing::Test {};
TYPED_TEST_SUITE(Operators, Dimensions);

TYPED_TEST(Operators, NumberDensityIsThatOfTheFullLattice) {
  for (const KernelType kernel : {KernelType::non_singular, KernelType::singular}) {
    const Cloud<TypeParam::value> lattice(0.0, kernel);
    std::vector<double> density(lattice.particles.number_density.size(), -1.0);
    number_density(lattice.near, density);
    EXPECT_NEAR(density[static_cast<std::size_t>(lattice.centre())], lattice.sums.number_density, 1e-12);
    EXPECT_LT(density[static_cast<std::size_t>(lattice.on_surface())], 0.8 * lattice.sums.number_density);
    number_density(lattice.far, density);
    EXPECT_NEAR(density[static_cast<std::size_t>(lattice.centre())], lattice.far_sums.number_density, 1e-11);
  }
}

TYPED_TEST(Operators, AsymmetryIsThatOfAFlatSurface) {
  constexpr int Dim = TypeParam::value;
  const Cloud<Dim> lattice(0.0);
  const auto asymmetry_of = [&](int i) {
    return asymmetry<Dim>(lattice.near, lattice.particles.position, lattice.sums.number_density, i);
  };
  EXPECT_NEAR(asymmetry_of(lattice.centre()), 0.0, 1e-14);
  EXPECT_NEAR(asymmetry_of(lattice.on_surface()), lattice.sums.surface_asymmetry, 1e-14);
}

TYPED_TEST(Operators, DivergenceIsExactOnLinearFields) {
  constexpr int Dim = TypeParam::value;
  for (const KernelType kernel : {KernelType::non_singular, KernelType::singular}) {
    Cloud<Dim> lattice(0.0, kernel);
    // u_k = (k + 2) x_k + 3 x_0 - x_1 + 1: the trace is sum (k + 2) + 3 - 1.
    double trace = 2.0;
    for (int k = 0; k < Dim; ++k) trace += k + 2;
    for (std::size_t i = 0; i < lattice.particles.velocity.size(); ++i) {
      const Vec<Dim> x = lattice.particles.position[i];
      for (int k = 0; k < Dim; ++k) lattice.particles.velocity[i][k] = (k + 2) * x[k] + 3.0 * x[0] - x[1] + 1.0;
    }
    EXPECT_NEAR(divergence<Dim>(lattice.near, lattice.particles.position, lattice.particles.velocity,
                                lattice.sums.number_density, lattice.centre()),
                trace, 1e-12);
  }
}

TYPED_TEST(Operators, VelocityLaplacianIsExactOnQuadraticFields) {
  constexpr int Dim = TypeParam::value;
  for (const KernelType kernel : {KernelType::non_singular, KernelType::singular}) {
    Cloud<Dim> lattice(0.0, kernel);
    const double factor = 2.0 * Dim / (lattice.far_sums.number_density * lattice.far_sums.lambda);
    for (std::size_t i = 0; i < lattice.particles.velocity.size(); ++i) {
      const Vec<Dim> x = lattice.particles.position[i];
      lattice.particles.velocity[i] = {};
      lattice.particles.velocity[i][0] = x[0] * x[0] + 3.0 * x[1] * x[1] + 2.0 * x[0] * x[1] - 5.0 * x[1];
      lattice.particles.velocity[i][1] = -2.0 * x[Dim - 1] * x[Dim - 1] + x[0];
    }
    const Vec<Dim> laplacian =
        velocity_laplacian<Dim>(lattice.far, lattice.particles.velocity, factor, lattice.centre());
    EXPECT_NEAR(laplacian[0], 8.0, 1e-11);
    EXPECT_NEAR(laplacian[1], -4.0, 1e-11);
    EXPECT_EQ(laplacian[Dim - 1], Dim == 2 ? laplacian[1] : 0.0);
  }
}

TYPED_TEST(Operators, PressureGradientIsExactOnLinearFields) {
  constexpr int Dim = TypeParam::value;
  Cloud<Dim> lattice(0.0);
  for (std::size_t i = 0; i < lattice.particles.pressure.size(); ++i) {
    const Vec<Dim> x = lattice.particles.position[i];
    lattice.particles.pressure[i] = 7.0 + 2.0 * x[0] - 3.0 * x[Dim - 1];
  }
  const Vec<Dim> gradient = lattice.gradient(lattice.centre());
  for (int k = 0; k < Dim; ++k) EXPECT_NEAR(gradient[k], k == 0 ? 2.0 : k == Dim - 1 ? -3.0 : 0.0, 1e-12);
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
  std::vector<Vec<Dim>> position, velocity;
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

  std::vector<Vec<Dim>> no_wall() const { return std::vector<Vec<Dim>>(type.size()); }

  /// With dt = 0.1, distance 0.5 and restitution 0.2.
  Vec<Dim> change(int i) const { return change(i, no_wall()); }
  Vec<Dim> change(int i, const std::vector<Vec<Dim>>& normal) const {
    return collision<Dim>(pairs(), position, velocity, type, normal, 0.1, 0.5, 0.2, i);
  }
};

TYPED_TEST(Operators, PressureGradientIsThatOfEquation4ForAPair) {
  constexpr int Dim = TypeParam::value;
  Group<Dim> pair;
  pair.add(0.0, 0.0, 0.0, 0.0);
  pair.add(0.6, 0.8, 0.0, 0.0);
  pair.add(0.0, 1.0, 0.0, 0.0, ParticleType::ghost);
  const double n0 = 4.0;
  const Vec<Dim> gradient =
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
  std::vector<Vec<Dim>> normal = pair.no_wall();
  normal[1][1] = -1.0;
  const double n0 = 4.0;
  const Vec<Dim> gradient =
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
  const Vec<Dim> first = pair.change(0);
  const Vec<Dim> second = pair.change(1);
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
    const Vec<Dim> change = pair.change(0, normal);
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
  const std::vector<Vec<Dim>> no_wall(cloud.particles.type.size());
  Vec<Dim> sum;
  int collided = 0;
  for (int i = 0; i < cloud.particles.owned; ++i) {
    const Vec<Dim> change = collision<Dim>(cloud.near, cloud.particles.position, cloud.particles.velocity,
                                           cloud.particles.type, no_wall, 0.1, 0.8, 0.2, i);
    sum += change;
    collided += norm(change) > 0.0;
  }
  EXPECT_GT(collided, 10);
  EXPECT_LT(norm(sum), 1e-13 * cloud.particles.owned);
}

TYPED_TEST(Operators, AreZeroWhereTheRowIsEmpty) {
  constexpr int Dim = TypeParam::value;
  Group<Dim> single;
  single.add(0.0, 0.0, 1.0, 1.0);
  const PairList none = single.pairs();
  std::vector<double> density{-1.0};
  number_density(none, density);
  EXPECT_EQ(density[0], 0.0);
  EXPECT_EQ(asymmetry<Dim>(none, single.position, 4.0, 0), 0.0);
  EXPECT_EQ(divergence<Dim>(none, single.position, single.velocity, 4.0, 0), 0.0);
  EXPECT_EQ(velocity_laplacian<Dim>(none, single.velocity, 4.0, 0), Vec<Dim>{});
  EXPECT_EQ(pressure_gradient<Dim>(none, single.position, single.pressure, single.type, single.no_wall(), 4.0, 0),
            Vec<Dim>{});
}

}  // namespace
}  // namespace impinge
