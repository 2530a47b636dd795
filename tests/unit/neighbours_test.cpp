// The neighbour search against brute force.

#include "impinge/particles/neighbours.hpp"

#include <set>

#include "cloud.hpp"
#include "dimensions.hpp"

namespace impinge {
namespace {

constexpr double near_radius = 2.1;
constexpr double far_radius = 4.01;
constexpr int reach = 2;

template <class Dimension>
class Neighbours : public testing::Test {
 protected:
  static constexpr int Dim = Dimension::value;

  static constexpr std::array<int, Dim> extent() {
    if constexpr (Dim == 2) {
      return {17, 14};
    } else {
      return {9, 8, 10};
    }
  }

  static CellGrid<Dim> cells() {
    Box<Dim> box;
    for (int k = 0; k < Dim; ++k) box.high[k] = extent()[static_cast<std::size_t>(k)];
    return CellGrid<Dim>(box, {}, far_radius).refined(reach);
  }

  /// A cloud of all types.
  static Particles<Dim> cloud() {
    Particles<Dim> all = make_cloud<Dim>(extent(), 0.45);
    for (std::size_t i = 0; i < all.type.size(); ++i) all.type[i] = static_cast<ParticleType>((i * i + i / 7) % 4);
    return all;
  }

  static Particles<Dim> all_owned() {
    return sorted(cells(), cloud(), [](const auto&) { return true; });
  }

  /// The cells of the first half along x are owned; those of the second stand in the halo, sent by two ranks, each of
  /// which may have sent a part of a cell.
  static Particles<Dim> half_owned(bool parts = false) {
    const CellGrid<Dim> grid = cells();
    const int half = grid.extent()[0] / 2;
    const auto part = [&](const ParticleRecord<Dim>& record) {
      const auto at = grid.coordinates(record.position);
      return at[0] < half ? 0 : (parts ? record.id : at[1]) % 2 == 0 ? 1 : 2;
    };
    Particles<Dim> particles = sorted(grid, cloud(), [&](const auto& record) { return part(record) == 0; });
    const int owned = particles.owned;
    for (const int sender : {2, 1}) {
      const Particles<Dim> sent = sorted(grid, cloud(), [&](const auto& record) { return part(record) == sender; });
      for (int i = 0; i < sent.owned; ++i) particles.append(sent.record(i));
    }
    particles.owned = owned;
    return particles;
  }

  static NeighbourSearch<Dim> search(const Particles<Dim>& particles, KernelType kernel = KernelType::non_singular) {
    NeighbourSearch<Dim> found(cells(), reach, kernel, near_radius, far_radius);
    found.search(particles);
    return found;
  }

  static NeighbourSearch<Dim> search_mirrored(const Particles<Dim>& particles) {
    NeighbourSearch<Dim> found(cells(), reach, KernelType::non_singular, near_radius, far_radius, true);
    found.search(particles);
    return found;
  }

  /// The far rows, each of which, unless it is empty, must hold the particle itself, once, with weight 0.
  static PairList far_of(NeighbourSearch<Dim>& found) {
    found.for_far_rows([&](int i, const PairRow& row) {
      if (row.index.empty()) return;
      const auto self = std::ranges::find(row.index, i);
      ASSERT_NE(self, row.index.end());
      EXPECT_EQ(row.weight[static_cast<std::size_t>(self - row.index.begin())], 0.0);
      EXPECT_EQ(std::ranges::count(row.index, i), 1);
    });
    return far_list(found, false);
  }

  static bool has_row(ParticleType type) { return type == ParticleType::fluid || type == ParticleType::wall; }
  static bool is_any(ParticleType) { return true; }

  static std::vector<std::int64_t> neighbour_ids(const PairList& list, const Particles<Dim>& particles, int i) {
    std::vector<std::int64_t> ids;
    for (int k = list.begin(i); k < list.end(i); ++k)
      ids.push_back(particles.id[static_cast<std::size_t>(list.index[static_cast<std::size_t>(k)])]);
    return ids;
  }

  /// Pairs of those with a row and those in a row.
  template <class Kernel>
  static void expect_brute_force_pairs(const Particles<Dim>& particles, const PairList& list, double radius,
                                       bool (*is_row)(ParticleType) = has_row,
                                       bool (*is_in_row)(ParticleType) = is_any) {
    ASSERT_EQ(list.rows(), particles.owned);
    std::int64_t pairs = 0;
    for (int i = 0; i < particles.owned; ++i) {
      const auto self = static_cast<std::size_t>(i);
      std::set<std::pair<int, double>> expected, actual;
      if (is_row(particles.type[self])) {
        for (int j = 0; j < particles.size(); ++j) {
          if (!is_in_row(particles.type[static_cast<std::size_t>(j)])) continue;
          const double r = norm(particles.position[static_cast<std::size_t>(j)] - particles.position[self]);
          if (j != i && r < radius) expected.emplace(j, Kernel::weight(r, radius));
        }
      }
      for (int k = list.begin(i); k < list.end(i); ++k)
        actual.emplace(list.index[static_cast<std::size_t>(k)], list.weight[static_cast<std::size_t>(k)]);
      ASSERT_EQ(actual, expected) << "particle " << i;
      ASSERT_EQ(static_cast<int>(actual.size()), list.end(i) - list.begin(i)) << "a pair is listed twice";
      pairs += static_cast<std::int64_t>(actual.size());
    }
    EXPECT_EQ(list.pairs(), pairs);
    EXPECT_GT(pairs, 0);
  }
};
TYPED_TEST_SUITE(Neighbours, Dimensions);

TYPED_TEST(Neighbours, AreThoseOfBruteForce) {
  for (const auto& particles : {this->all_owned(), this->half_owned()}) {
    auto non_singular = this->search(particles);
    this->template expect_brute_force_pairs<NonSingularKernel>(particles, non_singular.near(), near_radius);
    this->template expect_brute_force_pairs<NonSingularKernel>(particles, this->far_of(non_singular), far_radius);
    auto singular = this->search(particles, KernelType::singular);
    this->template expect_brute_force_pairs<SingularKernel>(particles, singular.near(), near_radius);
    this->template expect_brute_force_pairs<SingularKernel>(particles, this->far_of(singular), far_radius);
  }
}

// A box around all particles would have some 10^11 cells.
TYPED_TEST(Neighbours, MayBeFarFromOneAnother) {
  constexpr int dim = TestFixture::Dim;
  for (const bool walls_measure : {false, true}) {
    Box<dim> box;
    for (int k = 0; k < dim; ++k) box.high[k] = dim == 2 ? 1e6 : 2e4;
    const auto cells = CellGrid<dim>(box, {}, far_radius).refined(reach);
    const Particles<dim> cloud = this->cloud();
    Particles<dim> particles;
    for (int i = 0; i < cloud.owned; ++i) {
      auto record = cloud.record(i);
      for (int k = 0; k < dim; ++k)  // a third on its way along the diagonal, the others in two clouds
        record.position[k] += i % 3 == 0 ? 30.0 * i : i % 3 == 1 ? 0.9 * box.high[k] : 5.0;
      particles.append(record);
    }
    particles = sorted(cells, particles, [](const auto&) { return true; });
    NeighbourSearch<dim> found(cells, reach, KernelType::non_singular, near_radius, far_radius, walls_measure);
    found.search(particles);
    const auto is_in_row = [](ParticleType type) { return type != ParticleType::wall; };
    const auto is_fluid = [](ParticleType type) { return type == ParticleType::fluid; };
    if (walls_measure) {
      this->template expect_brute_force_pairs<NonSingularKernel>(particles, found.near(), near_radius, this->has_row,
                                                                 is_in_row);
      this->template expect_brute_force_pairs<NonSingularKernel>(particles, this->far_of(found), far_radius, is_fluid,
                                                                 is_in_row);
    } else {
      this->template expect_brute_force_pairs<NonSingularKernel>(particles, found.near(), near_radius);
      this->template expect_brute_force_pairs<NonSingularKernel>(particles, this->far_of(found), far_radius);
    }
    EXPECT_LT(found.bytes(), 10'000'000);
  }
}

TYPED_TEST(Neighbours, RowsKeepTheirOrderWhoeverOwnsTheParticles) {
  const auto whole = this->all_owned();
  const auto half = this->half_owned();
  ASSERT_GT(half.owned, 0);
  ASSERT_LT(half.owned, half.size());
  auto in_whole = this->search(whole);
  auto in_half = this->search(half);
  const PairList half_far = this->far_of(in_half), whole_far = this->far_of(in_whole);
  for (int i = 0; i < half.owned; ++i) {
    const auto id = half.id[static_cast<std::size_t>(i)];
    const int j = static_cast<int>(std::find(whole.id.begin(), whole.id.end(), id) - whole.id.begin());
    EXPECT_EQ(this->neighbour_ids(half_far, half, i), this->neighbour_ids(whole_far, whole, j));
    EXPECT_EQ(this->neighbour_ids(in_half.near(), half, i), this->neighbour_ids(in_whole.near(), whole, j));
  }
}

// Mirror images of one cell may come from several ranks.
TYPED_TEST(Neighbours, RowsBesideMirrorsKeepTheirOrderWhoeverSentTheImages) {
  const auto whole = this->half_owned(), parts = this->half_owned(true);
  auto in_whole = this->search_mirrored(whole), in_parts = this->search_mirrored(parts);
  const PairList parts_far = this->far_of(in_parts), whole_far = this->far_of(in_whole);
  for (int i = 0; i < whole.owned; ++i)
    EXPECT_EQ(this->neighbour_ids(parts_far, parts, i), this->neighbour_ids(whole_far, whole, i));
}

TYPED_TEST(Neighbours, WallParticlesOnMirrorsMeasureOnly) {
  const auto is_no_wall = [](ParticleType type) { return type != ParticleType::wall; };
  const auto is_fluid = [](ParticleType type) { return type == ParticleType::fluid; };
  for (const auto& particles : {this->all_owned(), this->half_owned()}) {
    auto found = this->search_mirrored(particles);
    this->template expect_brute_force_pairs<NonSingularKernel>(particles, found.near(), near_radius, this->has_row,
                                                               is_no_wall);
    this->template expect_brute_force_pairs<NonSingularKernel>(particles, this->far_of(found), far_radius, is_fluid,
                                                               is_no_wall);
  }
}

TYPED_TEST(Neighbours, ColumnsOfOwnedParticlesAscend) {
  const auto particles = this->half_owned();
  auto found = this->search(particles);
  for (const PairList& list : {found.near(), far_list(found)}) {
    for (int i = 0; i < particles.owned; ++i) {
      int last = -1;
      for (int k = list.begin(i); k < list.end(i); ++k) {
        const int column = list.index[static_cast<std::size_t>(k)];
        if (column >= particles.owned) continue;
        EXPECT_GT(column, last);
        last = column;
      }
    }
  }
}

TYPED_TEST(Neighbours, OfNoParticlesAreNone) {
  auto found = this->search({});
  EXPECT_EQ(found.near().rows(), 0);
  EXPECT_EQ(this->far_of(found).rows(), 0);
  EXPECT_EQ(this->far_of(found).pairs(), 0);
}

TYPED_TEST(Neighbours, AreSearchedAnewEachTime) {
  auto particles = this->all_owned();
  auto found = this->search(particles);
  const auto pairs = this->far_of(found).pairs();
  particles = this->half_owned();
  found.search(particles);
  EXPECT_LT(this->far_of(found).pairs(), pairs);
  this->template expect_brute_force_pairs<NonSingularKernel>(particles, this->far_of(found), far_radius);
}

}  // namespace
}  // namespace impinge
