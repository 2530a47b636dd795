// Partition, migration and halo: what a rank knows is what a single rank would know.

#include <cmath>
#include <set>

#include "cloud.hpp"
#include "dimensions.hpp"
#include "gather.hpp"
#include "impinge/core/mpi.hpp"
#include "impinge/method/operators.hpp"
#include "impinge/parallel/decomposition.hpp"
#include "impinge/particles/neighbours.hpp"

namespace impinge {
namespace {

const MPI_Comm comm = MPI_COMM_WORLD;
constexpr double near_radius = 2.1;
constexpr double far_radius = 4.01;

template <int Dim>
std::array<int, Dim> extent() {
  if constexpr (Dim == 2) {
    return {40, 30};
  } else {
    return {14, 13, 15};
  }
}

template <int Dim>
Particles<Dim> cloud() {
  Particles<Dim> all = make_cloud<Dim>(extent<Dim>(), 0.45);
  for (std::size_t i = 0; i < all.type.size(); ++i) all.type[i] = static_cast<ParticleType>(i % 13 < 10 ? 0 : i % 4);
  return all;
}

/// This rank's share of some particles.
template <int Dim>
Particles<Dim> share_of(const Particles<Dim>& all, MPI_Comm of = comm) {
  Particles<Dim> share;
  for_share(all.owned, rank_of(of), ranks_of(of),
            [&](std::int64_t k) { share.append(all.record(static_cast<int>(k))); });
  return share;
}

/// This rank's particles after a partition, with their halo.
template <int Dim>
Particles<Dim> settled_share(Decomposition<Dim>& domain, const Particles<Dim>& all, MPI_Comm of = comm) {
  Particles<Dim> particles = share_of(all, of);
  domain.partition(particles);
  domain.migrate(particles);
  domain.build_halo(particles);
  return particles;
}

template <int Dim>
Decomposition<Dim> make_domain(Edge edge, Partitioner partitioner = Partitioner::metis, MPI_Comm of = comm) {
  Box<Dim> box;
  for (int k = 0; k < Dim; ++k) box.high[k] = extent<Dim>()[static_cast<std::size_t>(k)];
  return {of, box, periodic_axes<Dim>(edge), far_radius, partitioner};
}

/// The mirrors around the box, if its edges are some.
template <int Dim>
MirrorWalls<Dim> mirrors(Edge edge) {
  Box<Dim> box;
  for (int k = 0; k < Dim; ++k) box.high[k] = extent<Dim>()[static_cast<std::size_t>(k)];
  return mirrors_of<Dim>(edge, box, far_radius);
}

/// Calls use(position) for a position and its images next to the box, those at edges and corners among them.
template <int Dim, class Use>
void for_images(Edge edge, const Vector<Dim>& position, Use&& use) {
  for (int code = 0; code < (Dim == 2 ? 9 : 27); ++code) {
    Vector<Dim> image = position;
    int rest = code;
    for (int k = 0; k < Dim; ++k, rest /= 3) {
      const double length = extent<Dim>()[static_cast<std::size_t>(k)];
      const int side = rest % 3 - 1;
      if (side == 0) continue;
      image[k] = edge == Edge::periodic ? position[k] + side * length : (side < 0 ? 0.0 : 2.0 * length) - position[k];
    }
    if (code == (Dim == 2 ? 4 : 13) || edge != Edge::open) use(image);
  }
}

/// Number densities of the owned particles, with their halo and the images behind mirrors, for both radii.
template <int Dim>
std::array<std::vector<double>, 2> densities(Edge edge, const Decomposition<Dim>& domain, Particles<Dim> particles) {
  mirrors<Dim>(edge).append_images(particles);
  NeighbourSearch<Dim> search(domain.sorting_cells(), Decomposition<Dim>::cell_parts, KernelType::non_singular,
                              near_radius, far_radius, edge == Edge::mirror);
  search.search(particles);
  std::array<std::vector<double>, 2> density;
  for (auto& values : density) values.resize(static_cast<std::size_t>(particles.owned));
  number_density(search.near(), density[0]);
  number_density(far_list(search), density[1]);
  return density;
}

template <int Dim>
void expect_record(const ParticleRecord<Dim>& record, const Particles<Dim>& all) {
  const ParticleRecord<Dim> expected = all.record(static_cast<int>(record.id));
  EXPECT_EQ(record.position, expected.position);
  EXPECT_EQ(record.velocity, expected.velocity);
  EXPECT_EQ(record.pressure, expected.pressure);
  EXPECT_EQ(record.pressure_impulse, expected.pressure_impulse);
  EXPECT_EQ(record.type, expected.type);
}

template <int Dim>
void expect_sorted(const Decomposition<Dim>& domain, const Particles<Dim>& particles) {
  std::pair<std::int64_t, std::int64_t> last{-1, -1};
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    const std::pair<std::int64_t, std::int64_t> here{domain.sorting_cells().cell(particles.position[i]),
                                                     particles.id[i]};
    EXPECT_LT(last, here);
    last = here;
  }
}

/// Every variant: all kinds of edges, each partitioner.
template <class Dimension>
class Domains : public testing::Test {
 protected:
  template <class Use>
  static void for_variants(Use&& use) {
    for (const Edge edge : {Edge::open, Edge::periodic, Edge::mirror}) {
      for (const Partitioner partitioner : {Partitioner::metis, Partitioner::ptscotch, Partitioner::curve}) {
        SCOPED_TRACE(testing::Message() << "edge " << static_cast<int>(edge) << ", partitioner "
                                        << static_cast<int>(partitioner));
        use(edge, partitioner);
      }
    }
  }
};
TYPED_TEST_SUITE(Domains, Dimensions);

TYPED_TEST(Domains, MigrationKeepsEveryParticleWithItsFields) {
  constexpr int Dim = TypeParam::value;
  this->for_variants([](Edge edge, Partitioner partitioner) {
    const Particles<Dim> all = cloud<Dim>();
    auto domain = make_domain<Dim>(edge, partitioner);
    Particles<Dim> particles = share_of(all);
    domain.partition(particles);
    EXPECT_EQ(domain.migrate(particles).outside, 0);
    for (int i = 0; i < particles.owned; ++i) {
      expect_record(particles.record(i), all);
      EXPECT_TRUE(domain.owns(particles.position[static_cast<std::size_t>(i)]));
    }
    expect_sorted(domain, particles);
    const auto ids = gather_by_id(comm, particles, particles.id);
    EXPECT_EQ(ids.size(), static_cast<std::size_t>(all.owned));
    EXPECT_EQ(sum_over_ranks(comm, std::int64_t{particles.owned}), all.owned);
  });
}

TYPED_TEST(Domains, PartitionBalancesTheWork) {
  constexpr int Dim = TypeParam::value;
  this->for_variants([](Edge edge, Partitioner partitioner) {
    const Particles<Dim> all = make_cloud<Dim>(extent<Dim>(), 0.2);
    auto domain = make_domain<Dim>(edge, partitioner);
    Particles<Dim> particles;
    if (rank_of(comm) == 0) particles = all;
    EXPECT_EQ(domain.imbalance(particles), ranks_of(comm));
    domain.partition(particles);
    domain.migrate(particles);
    EXPECT_LT(domain.imbalance(particles), 1.15);
    EXPECT_NEAR(domain.imbalance(particles), domain.achieved_imbalance(), 1e-12);
    EXPECT_GT(particles.owned, 0);
  });
}

TYPED_TEST(Domains, DensitiesAreBitwiseThoseOfASingleRank) {
  constexpr int Dim = TypeParam::value;
  this->for_variants([](Edge edge, Partitioner partitioner) {
    const Particles<Dim> all = cloud<Dim>();
    const auto measure = [&](MPI_Comm of) {
      auto domain = make_domain<Dim>(edge, partitioner, of);
      Particles<Dim> particles = settled_share(domain, all, of);
      const auto density = densities(edge, domain, particles);
      return std::array{gather_by_id(of, particles, density[0]), gather_by_id(of, particles, density[1])};
    };
    EXPECT_EQ(measure(comm), measure(MPI_COMM_SELF));
  });
}

TYPED_TEST(Domains, HaloCompletesTheDensityOfBruteForce) {
  constexpr int Dim = TypeParam::value;
  this->for_variants([](Edge edge, Partitioner partitioner) {
    const Particles<Dim> all = cloud<Dim>();
    auto domain = make_domain<Dim>(edge, partitioner);
    Particles<Dim> particles = settled_share(domain, all);
    const auto density = densities(edge, domain, particles);
    for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
      double near = 0.0, far = 0.0;
      const bool measures = edge == Edge::mirror && particles.type[i] == ParticleType::wall;
      const bool has_row = particles.type[i] == ParticleType::fluid || particles.type[i] == ParticleType::wall;
      for (int j = 0; j < all.owned && has_row; ++j) {
        if (edge == Edge::mirror && all.type[static_cast<std::size_t>(j)] == ParticleType::wall) continue;
        for_images<Dim>(edge, all.position[static_cast<std::size_t>(j)], [&](const Vector<Dim>& position) {
          const double r = norm(position - particles.position[i]);
          if (r == 0.0) return;
          near += NonSingularKernel::weight(r, near_radius);
          if (!measures) far += NonSingularKernel::weight(r, far_radius);
        });
      }
      EXPECT_NEAR(density[0][i], near, 1e-11);
      EXPECT_NEAR(density[1][i], far, 1e-11);
    }
  });
}

TYPED_TEST(Domains, HaloCarriesFieldsRowsAndShiftedPositions) {
  constexpr int Dim = TypeParam::value;
  this->for_variants([](Edge edge, Partitioner partitioner) {
    if (edge == Edge::mirror) return;  // images are no part of the halo
    const Particles<Dim> all = cloud<Dim>();
    auto domain = make_domain<Dim>(edge, partitioner);
    Particles<Dim> particles = settled_share(domain, all);
    const auto rows = domain.rows();
    ASSERT_EQ(rows.size(), static_cast<std::size_t>(particles.size()));
    const auto row_of =
        gather_by_id(comm, particles, std::vector<PetscInt>(rows.begin(), rows.begin() + particles.owned));
    std::set<PetscInt> distinct;
    for (const auto& [id, row] : row_of) distinct.insert(row);
    EXPECT_EQ(distinct.size(), row_of.size());
    EXPECT_EQ(*distinct.begin(), 0);
    EXPECT_EQ(*distinct.rbegin(), all.owned - 1);
    for (int i = 1; i < particles.owned; ++i)
      EXPECT_EQ(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(i) - 1] + 1);

    for (int i = particles.owned; i < particles.size(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      ParticleRecord<Dim> record = particles.record(i);
      EXPECT_EQ(rows[at], row_of.at(record.id));
      const Vector<Dim> original = all.position[static_cast<std::size_t>(record.id)];
      bool is_image = false;
      for_images<Dim>(edge, original,
                      [&](const Vector<Dim>& image) { is_image |= norm(image - record.position) < 1e-12; });
      EXPECT_TRUE(is_image);
      record.position = original;
      record.pressure_impulse = all.pressure_impulse[static_cast<std::size_t>(record.id)];  // stays with the owner
      expect_record(record, all);
    }

    // After a move of the owners the copies follow.
    const auto before = particles.position;
    const auto step = [](std::int64_t id, int k) { return 0.01 * std::sin(static_cast<double>(id + k)); };
    std::vector<Vector<Dim>> direction(particles.position.size());
    for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
      for (int k = 0; k < Dim; ++k) direction[i][k] = step(particles.id[i], k);
    for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) particles.position[i] += direction[i];
    domain.refresh_positions(particles);
    domain.halo().refresh(direction, particles.owned);
    for (std::size_t i = 0; i < before.size(); ++i) {
      for (int k = 0; k < Dim; ++k) {
        EXPECT_EQ(direction[i][k], step(particles.id[i], k));
        EXPECT_NEAR(particles.position[i][k], before[i][k] + direction[i][k], 1e-13);
      }
    }
  });
}

TYPED_TEST(Domains, ParticlesWanderWithoutLoss) {
  constexpr int Dim = TypeParam::value;
  const Particles<Dim> all = cloud<Dim>();
  auto domain = make_domain<Dim>(Edge::periodic);
  Particles<Dim> particles = share_of(all);
  domain.partition(particles);
  domain.migrate(particles);
  for (int step = 0; step < 20; ++step) {
    if (step == 10) domain.partition(particles);
    domain.build_halo(particles);
    for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
      particles.position[i] += 3.0 * particles.velocity[i];
    EXPECT_EQ(domain.migrate(particles).outside, 0);
    for (const auto& position : particles.position) EXPECT_TRUE(domain.owns(position));
    expect_sorted(domain, particles);
  }
  const auto velocity = gather_by_id(comm, particles, particles.velocity);
  ASSERT_EQ(velocity.size(), static_cast<std::size_t>(all.owned));
  for (const auto& [id, value] : velocity) EXPECT_EQ(value, all.velocity[static_cast<std::size_t>(id)]);
}

// All particles in one cell: one rank has them all, the others none.
TYPED_TEST(Domains, RanksMayBeEmpty) {
  constexpr int Dim = TypeParam::value;
  this->for_variants([](Edge edge, Partitioner partitioner) {
    const Particles<Dim> everywhere = cloud<Dim>();
    Particles<Dim> few;
    for (int i = 0; i < everywhere.owned; ++i) {
      auto record = everywhere.record(i);
      const auto& at = record.position.component;
      if (std::any_of(at.begin(), at.end(), [](double x) { return x > 4.0; })) continue;
      record.type = ParticleType::fluid;
      few.append(record);
    }
    auto domain = make_domain<Dim>(edge, partitioner);
    Particles<Dim> particles = share_of(few);
    domain.partition(particles);
    EXPECT_EQ(domain.migrate(particles).outside, 0);
    domain.build_halo(particles);
    EXPECT_EQ(sum_over_ranks(comm, std::int64_t{particles.owned}), few.owned);
    EXPECT_EQ(max_over_ranks(comm, particles.owned), few.owned);
    EXPECT_EQ(domain.imbalance(particles), ranks_of(comm));
    const auto density = densities(edge, domain, particles);
    EXPECT_EQ(density[0].size(), static_cast<std::size_t>(particles.owned));
    for (const double n : density[1]) EXPECT_GT(n, 1.0);
  });
}

TYPED_TEST(Domains, WithoutParticlesAreHarmless) {
  constexpr int Dim = TypeParam::value;
  this->for_variants([](Edge edge, Partitioner partitioner) {
    auto domain = make_domain<Dim>(edge, partitioner);
    Particles<Dim> none;
    domain.partition(none);
    EXPECT_EQ(domain.migrate(none).outside, 0);
    domain.build_halo(none);
    EXPECT_EQ(none.size(), 0);
    EXPECT_EQ(domain.imbalance(none), 1.0);
  });
}

// Two clouds far from one another in a box of 10^12 cells.
TYPED_TEST(Domains, MayBeHuge) {
  constexpr int Dim = TypeParam::value;
  Box<Dim> box;
  for (int k = 0; k < Dim; ++k) box.high[k] = (Dim == 2 ? 1e6 : 1e4) * 1.001 * far_radius;
  const Particles<Dim> near_by = cloud<Dim>();
  Particles<Dim> all;
  for (const double place : {0.3, 0.7}) {
    for (int i = 0; i < near_by.owned; ++i) {
      auto record = near_by.record(i);
      for (int k = 0; k < Dim; ++k) record.position[k] += place * box.high[k];
      record.id = all.owned;
      all.append(record);
    }
  }
  const auto measure = [&](MPI_Comm of, Partitioner partitioner) {
    Decomposition<Dim> domain(of, box, {}, far_radius, partitioner);
    EXPECT_GT(domain.cells().count(), 999'000'000'000);
    Particles<Dim> particles = settled_share(domain, all, of);
    EXPECT_EQ(sum_over_ranks(of, std::int64_t{particles.owned}), all.owned);
    EXPECT_LT(domain.imbalance(particles), 1.15);
    EXPECT_LT(domain.bytes(), 1'000'000);
    const auto density = densities(Edge::open, domain, particles);
    return std::array{gather_by_id(of, particles, density[0]), gather_by_id(of, particles, density[1])};
  };
  const auto alone = measure(MPI_COMM_SELF, Partitioner::automatic);
  for (const auto& [id, density] : alone[1]) {
    if (has_row(all.type[static_cast<std::size_t>(id)])) {
      EXPECT_GT(density, 0.5);
    }
  }
  for (const Partitioner partitioner : {Partitioner::metis, Partitioner::curve})
    EXPECT_EQ(measure(comm, partitioner), alone);
}

// Cells that all particles have left are not remembered for ever.
TYPED_TEST(Domains, ForgetCellsThatWereLeft) {
  constexpr int Dim = TypeParam::value;
  Box<Dim> box;
  for (int k = 0; k < Dim; ++k) box.high[k] = 1e5;
  Decomposition<Dim> domain(comm, box, {}, far_radius, Partitioner::curve);
  const Particles<Dim> everywhere = cloud<Dim>();
  Particles<Dim> few;
  for (int i = 0; i < 20; ++i) few.append(everywhere.record(i));
  Particles<Dim> particles = share_of(few);
  domain.partition(particles);
  for (int step = 0; step < 5000; ++step) {
    for (int i = 0; i < particles.owned; ++i) particles.position[static_cast<std::size_t>(i)][0] += 10.0;
    EXPECT_EQ(domain.migrate(particles).outside, 0);
    domain.build_halo(particles);
  }
  EXPECT_EQ(sum_over_ranks(comm, std::int64_t{particles.owned}), few.owned);
  EXPECT_LT(domain.bytes(), 10'000'000);
}

TYPED_TEST(Domains, CountParticlesThatLeaveTheGrid) {
  constexpr int Dim = TypeParam::value;
  const Particles<Dim> all = cloud<Dim>();
  auto domain = make_domain<Dim>(Edge::open);
  Particles<Dim> particles = share_of(all);
  domain.partition(particles);
  domain.migrate(particles);
  const auto mark = [](std::int64_t id) { return id % 50; };
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (mark(particles.id[i]) == 0) particles.position[i][0] = -0.5;
    if (mark(particles.id[i]) == 1) particles.position[i][Dim - 1] = std::nan("");
    if (mark(particles.id[i]) == 2) particles.position[i][1] = 1e30;
  }
  std::int64_t expected = 0;
  for (int k = 0; k < all.owned; ++k) expected += mark(k) < 3;
  const Strays strays = domain.migrate(particles);
  EXPECT_EQ(sum_over_ranks(comm, strays.outside + strays.not_finite), expected);
  std::int64_t not_finite = 0;
  for (int k = 0; k < all.owned; ++k) not_finite += mark(k) == 1;
  EXPECT_EQ(sum_over_ranks(comm, strays.not_finite), not_finite);
  const auto left = gather_by_id(comm, particles, particles.id);
  EXPECT_EQ(static_cast<std::int64_t>(left.size()), all.owned - expected);
  for (const auto& [id, same] : left) EXPECT_GE(mark(id), 3);
}

}  // namespace
}  // namespace impinge
