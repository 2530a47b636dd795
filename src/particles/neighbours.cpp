#include "impinge/particles/neighbours.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#ifdef __AVX512F__
#include <immintrin.h>
#endif

namespace impinge {
namespace {

constexpr std::size_t lanes = 8;  // that arrays are read and written beyond their ends

// A box of more cells than this is searched by its occupied cells alone.
constexpr std::int64_t most_box_cells = 1 << 20, most_cells_of_a_particle = 16;

// Writes the entries of the places [first, last) whose square of the distance to the centre is between two bounds, and
// these squares; returns how many.
template <int Dim>
std::size_t pick_within(const std::array<const double*, Dim>& position, const int* entry, std::size_t first,
                        std::size_t last, const Vector<Dim>& centre, double above, double below, int* index,
                        double* square) {
  std::size_t used = 0;
#if defined(__AVX512F__) && defined(__AVX512VL__)
  for (std::size_t place = first; place < last; place += lanes) {
    __m512d sum = _mm512_setzero_pd();
    for (std::size_t k = 0; k < Dim; ++k) {
      const __m512d offset =
          _mm512_sub_pd(_mm512_loadu_pd(position[k] + place), _mm512_set1_pd(centre[static_cast<int>(k)]));
      sum = _mm512_fmadd_pd(offset, offset, sum);
    }
    const auto there = static_cast<__mmask8>(last - place < lanes ? (1U << (last - place)) - 1U : 0xffU);
    const __mmask8 inside = _mm512_mask_cmp_pd_mask(there, sum, _mm512_set1_pd(below), _CMP_LT_OQ) &
                            _mm512_cmp_pd_mask(sum, _mm512_set1_pd(above), _CMP_GT_OQ);
    const __m256i entries = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(entry + place));
    _mm512_storeu_pd(square + used, _mm512_maskz_compress_pd(inside, sum));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(index + used), _mm256_maskz_compress_epi32(inside, entries));
    used += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(inside)));
  }
#else
  for (std::size_t place = first; place < last; ++place) {
    double sum = 0.0;
    for (std::size_t k = 0; k < Dim; ++k) {
      const double offset = position[k][place] - centre[static_cast<int>(k)];
      sum += offset * offset;
    }
    index[used] = entry[place];
    square[used] = sum;
    used += static_cast<std::size_t>(sum < below) & static_cast<std::size_t>(sum > above);  // a branch would be guessed
  }
#endif
  return used;
}

}  // namespace

template <int Dim>
NeighbourSearch<Dim>::NeighbourSearch(const CellGrid<Dim>& cells, int reach, KernelType kernel, double near_radius,
                                      double far_radius, bool walls_measure)
    : cells_(cells),
      reach_(reach),
      kernel_(kernel),
      near_radius_(near_radius),
      far_radius_(far_radius),
      walls_measure_(walls_measure) {
  gap2_.fill(std::vector<double>(static_cast<std::size_t>(2 * reach + 1)));
}

template <int Dim>
void NeighbourSearch<Dim>::find(const Particles<Dim>& particles, const PairFilter<Dim>* filter) {
  filter_ = filter;
  tested_start_.clear();
  own_square_.clear();
  if (filter) find_tested(particles);
  find_near(particles);
}

template <int Dim>
void NeighbourSearch<Dim>::arrange(const Particles<Dim>& particles) {
  type_.assign(particles.type.begin(), particles.type.begin() + particles.owned);
  const auto n = static_cast<std::size_t>(particles.size());
  std::array<int, Dim> low{}, high{};
  std::vector<std::array<int, Dim>> at(n);
  for (std::size_t i = 0; i < n; ++i) {
    at[i] = cells_.coordinates(particles.position[i]);
    for (std::size_t k = 0; k < Dim; ++k) {
      low[k] = i == 0 ? at[i][k] : std::min(low[k], at[i][k]);
      high[k] = i == 0 ? at[i][k] : std::max(high[k], at[i][k]);
    }
  }
  std::int64_t box_cells = 1;
  for (std::size_t k = 0; k < Dim; ++k) {
    box_low_[k] = low[k] - reach_;
    box_extent_[k] = high[k] - low[k] + 1 + 2 * reach_;
    box_cells *= box_extent_[k];
  }
  const auto box_cell = [&](std::size_t i) {
    std::int64_t cell = 0;
    for (std::size_t k = 0; k < Dim; ++k) cell = cell * box_extent_[k] + at[i][k] - box_low_[k];
    return cell;
  };
  occupied_.clear();
  lines_of_ = -1;
  if (box_cells > most_box_cells + most_cells_of_a_particle * static_cast<std::int64_t>(n)) {
    for (std::size_t i = 0; i < n; ++i) occupied_.push_back(box_cell(i));
    std::ranges::sort(occupied_);
    occupied_.erase(std::unique(occupied_.begin(), occupied_.end()), occupied_.end());
  }
  const std::size_t n_cells = occupied_.empty() ? static_cast<std::size_t>(box_cells) : occupied_.size();
  const auto is_left_out = [&](std::size_t i) { return walls_measure_ && particles.type[i] == ParticleType::wall; };
  // A counting sort by cells and, within a cell, by ids: the order of the owned particles and of what one rank sent.
  local_cell_.resize(n);
  cell_start_.assign(n_cells + 2, 0);
  const auto next = cell_start_.begin() + 1;  // of each cell; ends as the start of the cell behind
  for (std::size_t i = 0; i < n; ++i) {
    std::int64_t cell = box_cell(i);
    if (!occupied_.empty()) cell = std::ranges::lower_bound(occupied_, cell) - occupied_.begin();
    local_cell_[i] = static_cast<int>(cell);
    if (!is_left_out(i)) ++next[cell + 1];
  }
  for (std::size_t c = 0; c < n_cells; ++c) cell_start_[c + 2] += cell_start_[c + 1];
  entry_.resize(n + lanes);
  place_.resize(n);
  for (std::size_t i = 0; i < n; ++i)
    if (!is_left_out(i)) entry_[static_cast<std::size_t>(next[local_cell_[i]]++)] = static_cast<int>(i);
  // Images of the particles of several ranks may stand in one cell.
  for (std::size_t c = 0; walls_measure_ && c < n_cells; ++c) {
    const auto first = entry_.begin() + cell_start_[c], last = entry_.begin() + cell_start_[c + 1];
    const auto id = [&](int i) { return particles.id[static_cast<std::size_t>(i)]; };
    if (!std::ranges::is_sorted(first, last, {}, id)) std::ranges::stable_sort(first, last, {}, id);
  }
  const auto n_entries = static_cast<std::size_t>(cell_start_[n_cells]);
  for (auto& coordinates : entry_position_) coordinates.resize(n_entries + lanes);
  for (std::size_t place = 0; place < n_entries; ++place) {
    const auto i = static_cast<std::size_t>(entry_[place]);
    for (int k = 0; k < Dim; ++k) entry_position_[static_cast<std::size_t>(k)][place] = particles.position[i][k];
    place_[i] = static_cast<int>(place);
  }
}

// Valid until the next call.
template <int Dim>
typename NeighbourSearch<Dim>::Lines NeighbourSearch<Dim>::lines_around(int cell) {
  const std::int64_t second = box_extent_[Dim - 1];
  const std::int64_t first = Dim == 3 ? box_extent_[1] * second : second;
  if (occupied_.empty()) return {cell_start_.data() + cell, first, second};
  const int second_reach = Dim == 3 ? reach_ : 0;
  const int length = 2 * reach_ + 2;  // of a line with its end
  if (lines_of_ != cell) {
    lines_of_ = cell;
    line_start_.clear();
    for (int a = -reach_; a <= reach_; ++a) {
      for (int b = -second_reach; b <= second_reach; ++b) {
        const std::int64_t centre = occupied_[static_cast<std::size_t>(cell)] + a * first + b * second;
        auto next = std::ranges::lower_bound(occupied_, centre - reach_);
        for (int c = -reach_; c <= reach_ + 1; ++c) {
          while (next != occupied_.end() && *next < centre + c) ++next;
          line_start_.push_back(cell_start_[static_cast<std::size_t>(next - occupied_.begin())]);
        }
      }
    }
  }
  const int lines = 2 * second_reach + 1;
  return {line_start_.data() + (reach_ * lines + second_reach) * length + reach_, lines * length, length};
}

// Appends the particles within a radius of the centre of particle i, whose squares of distances are `above`, to the
// first `used` of the row; returns how many it then has.
template <int Dim>
std::size_t NeighbourSearch<Dim>::append_within(double radius, double above, int i, const Vector<Dim>& centre,
                                                std::size_t used) {
  const double radius2 = radius * radius;
  // Of the layers of cells around that of i along each axis, from -reach on.
  const Vector<Dim> at = cells_.in_edges(centre);
  for (int axis = 0; axis < Dim; ++axis) {
    const double inside = at[axis] - std::floor(at[axis]);
    for (int layer = -reach_; layer <= reach_; ++layer) {
      const double edges = layer > 0 ? layer - inside : layer < 0 ? inside - layer - 1 : 0.0;
      const double gap = edges * cells_.edge()[axis];
      gap2_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(layer + reach_)] = gap * gap;
    }
  }
  const auto gap2 = [&](int axis, int layer) {
    return gap2_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(layer + reach_)];
  };
  std::array<const double*, Dim> position;
  for (std::size_t k = 0; k < Dim; ++k) position[k] = entry_position_[k].data();
  const Lines lines = lines_around(local_cell_[static_cast<std::size_t>(i)]);
  const int second_reach = Dim == 3 ? reach_ : 0;
  for (int a = -reach_; a <= reach_; ++a) {
    for (int b = -second_reach; b <= second_reach; ++b) {
      // A run of cells along the last axis, as far as the sphere reaches.
      double rest = (1.0 + 1e-12) * radius2 - gap2(0, a);
      if constexpr (Dim == 3) rest -= gap2(1, b);
      if (rest <= 0.0) continue;
      int from = 0, to = 0;
      while (from > -reach_ && gap2(Dim - 1, from - 1) < rest) --from;
      while (to < reach_ && gap2(Dim - 1, to + 1) < rest) ++to;
      const int* start = lines.start + a * lines.first + b * lines.second;
      const auto first = static_cast<std::size_t>(start[from]);
      const auto last = static_cast<std::size_t>(start[to + 1]);
      if (const std::size_t most = used + (last - first) + lanes; most > index_.size()) {
        index_.resize(2 * most);
        square_.resize(2 * most);
        weight_.resize(2 * most);
      }
      used += pick_within<Dim>(position, entry_.data(), first, last, centre, above, radius2, index_.data() + used,
                               square_.data() + used);
    }
  }
  return used;
}

template <int Dim>
std::span<const int> NeighbourSearch<Dim>::around(int i, const Vector<Dim>& position) {
  const std::size_t count = append_within(std::max(near_radius_, far_radius_), -1.0, i, position, 0);
  return {index_.data(), count};
}

// Asks the filter once for what both radii need.
template <int Dim>
void NeighbourSearch<Dim>::find_tested(const Particles<Dim>& particles) {
  tested_start_.assign(1, 0);
  tested_.clear();
  tested_factor_.clear();
  own_square_.resize(static_cast<std::size_t>(particles.owned));
  const double largest = std::max(near_radius_, far_radius_);
  for (int i = 0; i < particles.owned; ++i) {
    const auto self = static_cast<std::size_t>(i);
    const bool has_row = type_[self] == ParticleType::fluid || type_[self] == ParticleType::wall;
    if (has_row) {
      for (const auto& pair : filter_->own_pairs(i)) {
        const Vector<Dim> way = particles.position[static_cast<std::size_t>(pair.index)] - particles.position[self];
        own_square_[self].push_back(dot(way, way));
      }
    }
    if (has_row && filter_->has_tests(i)) {
      const std::size_t count = append_within(largest, -1.0, i, particles.position[self], 0);
      for (std::size_t k = 0; k < count; ++k) {
        const double factor = index_[k] == i ? 1.0 : filter_->factor(i, index_[k]);
        if (factor == 0.0) continue;
        tested_.push_back(index_[k]);
        tested_factor_.push_back(factor);
      }
    } else if (has_row) {
      tested_.push_back(-1);  // all count
      tested_factor_.push_back(1.0);
    }
    tested_start_.push_back(static_cast<int>(tested_.size()));
  }
}

// The row of particle i: what stands in the cells, as far as the filter leaves it, and its own pairs.
template <int Dim>
std::size_t NeighbourSearch<Dim>::append_row(double radius, double above, int i, const Vector<Dim>& centre) {
  std::size_t count = append_within(radius, above, i, centre, 0);
  factor_.clear();
  if (!filter_) return count;
  const auto self = static_cast<std::size_t>(i);
  auto next = static_cast<std::size_t>(tested_start_[self]);
  const auto last = static_cast<std::size_t>(tested_start_[self + 1]);
  const std::span<const typename PairFilter<Dim>::OwnPair> own = filter_->own_pairs(i);
  const bool tests = !(last - next == 1 && tested_[next] == -1);
  if (!tests && own.empty()) return count;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < count; ++k) {
    double factor = 1.0;
    if (tests) {
      // Both lists are in the same order, and this one is a part of the other but for what the filter took.
      std::size_t here = next;
      while (here < last && tested_[here] != index_[k]) ++here;
      if (here == last) continue;
      next = here + 1;
      factor = tested_factor_[here];
    }
    index_[kept] = index_[k];
    square_[kept] = square_[k];
    factor_.push_back(factor);
    ++kept;
  }
  const std::size_t most = kept + own.size() + lanes;
  if (most > index_.size()) {
    index_.resize(2 * most);
    square_.resize(2 * most);
    weight_.resize(2 * most);
  }
  for (std::size_t k = 0; k < own.size(); ++k) {
    const double square = own_square_[self][k];
    if (!(square > above && square < radius * radius)) continue;
    index_[kept] = own[k].index;
    square_[kept] = square;
    factor_.push_back(own[k].factor);
    ++kept;
  }
  return kept;
}

// Weights of the first `count` particles of the row; 0 at distance 0.
template <int Dim>
void NeighbourSearch<Dim>::weigh(double radius, std::size_t count, double* weight) const {
  with_kernel(kernel_, [&](auto kernel) {
    for (std::size_t k = 0; k < count; ++k) {
      const double value = decltype(kernel)::weight(std::sqrt(square_[k]), radius);
      weight[k] = square_[k] > 0.0 ? value : 0.0;
    }
  });
  for (std::size_t k = 0; k < factor_.size(); ++k) weight[k] *= factor_[k];
}

template <int Dim>
void NeighbourSearch<Dim>::find_near(const Particles<Dim>& particles) {
  if (const auto last = static_cast<std::size_t>(near_.pairs()); near_.index.size() < last + last / 4) {
    near_.index = Buffer<int>(2 * last);  // room that nobody writes costs nothing
    near_.weight = Buffer<double>(2 * last);
  }
  near_.start.assign(1, 0);
  std::size_t used = 0;
  for (int i = 0; i < particles.owned; ++i) {
    const ParticleType type = type_[static_cast<std::size_t>(i)];
    if (type != ParticleType::inlet && type != ParticleType::ghost) {
      const std::size_t count = append_row(near_radius_, 0.0, i, particles.position[static_cast<std::size_t>(i)]);
      if (used + count > near_.index.size()) {
        near_.index.resize(2 * (used + count));
        near_.weight.resize(2 * (used + count));
      }
      std::copy_n(index_.begin(), count, near_.index.begin() + static_cast<std::ptrdiff_t>(used));
      weigh(near_radius_, count, near_.weight.data() + used);
      used += count;
    }
    near_.start.push_back(static_cast<int>(used));
  }
}

template <int Dim>
Vector<Dim> NeighbourSearch<Dim>::searched_position(int i) const {
  const auto place = static_cast<std::size_t>(place_[static_cast<std::size_t>(i)]);
  Vector<Dim> position;
  for (int k = 0; k < Dim; ++k) position[k] = entry_position_[static_cast<std::size_t>(k)][place];
  return position;
}

template <int Dim>
PairRow NeighbourSearch<Dim>::far_row(int i) {
  const ParticleType type = type_[static_cast<std::size_t>(i)];
  if (type != ParticleType::fluid && (type != ParticleType::wall || walls_measure_)) return {};
  if (far_radius_ == near_radius_) {
    const auto first = static_cast<std::size_t>(near_.begin(i)), count = static_cast<std::size_t>(near_.end(i)) - first;
    return {{near_.index.data() + first, count}, {near_.weight.data() + first, count}};
  }
  const std::size_t count = append_row(far_radius_, -1.0, i, searched_position(i));
  weigh(far_radius_, count, weight_.data());
  return {{index_.data(), count}, {weight_.data(), count}};
}

template <int Dim>
std::size_t NeighbourSearch<Dim>::bytes() const {
  std::size_t sum =
      near_.bytes() +
      (cell_start_.capacity() + entry_.capacity() + place_.capacity() + local_cell_.capacity()) * sizeof(int) +
      occupied_.capacity() * sizeof(std::int64_t);
  for (const auto& coordinates : entry_position_) sum += coordinates.capacity() * sizeof(double);
  return sum + type_.capacity() * sizeof(ParticleType);
}

template class NeighbourSearch<2>;
template class NeighbourSearch<3>;

}  // namespace impinge
