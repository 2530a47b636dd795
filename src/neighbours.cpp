#include "impinge/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace impinge {
namespace {

// Makes room for `more` entries behind the first `used`.
void make_room(PairList& list, int used, int more) {
  const auto needed = static_cast<std::size_t>(used + more);
  if (needed <= list.index.size()) return;
  const std::size_t size = needed + needed / 8;
  list.index.resize(size);
  list.weight.resize(size);
}

}  // namespace

template <int Dim>
NeighbourSearch<Dim>::NeighbourSearch(const CellGrid<Dim>& cells, int reach, KernelType kernel, double near_radius,
                                      double far_radius, bool mirrored)
    : cells_(cells),
      reach_(reach),
      kernel_(kernel),
      near_radius_(near_radius),
      far_radius_(far_radius),
      mirrored_(mirrored) {}

template <int Dim>
void NeighbourSearch<Dim>::search(const Particles<Dim>& particles) {
  search(particles, {});
}

template <int Dim>
void NeighbourSearch<Dim>::search(const Particles<Dim>& particles, std::span<const int> column) {
  arrange(particles);
  with_kernel(kernel_, [&](auto kernel) { find_pairs<decltype(kernel)>(particles, column); });
}

template <int Dim>
void NeighbourSearch<Dim>::arrange(const Particles<Dim>& particles) {
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
  std::size_t n_cells = 1;
  for (std::size_t k = 0; k < Dim; ++k) {
    box_low_[k] = low[k] - reach_;
    box_extent_[k] = high[k] - low[k] + 1 + 2 * reach_;
    n_cells *= static_cast<std::size_t>(box_extent_[k]);
  }
  const auto is_left_out = [&](std::size_t i) { return mirrored_ && particles.type[i] == ParticleType::wall; };
  // A counting sort by cells and, within a cell, by ids: the order of the owned particles and of what one rank sent.
  box_cell_.resize(n);
  cell_start_.assign(n_cells + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    int cell = 0;
    for (std::size_t k = 0; k < Dim; ++k) cell = cell * box_extent_[k] + at[i][k] - box_low_[k];
    box_cell_[i] = cell;
    if (is_left_out(i)) continue;
    ++cell_start_[static_cast<std::size_t>(cell) + 1];
  }
  for (std::size_t c = 0; c < n_cells; ++c) cell_start_[c + 1] += cell_start_[c];
  entry_.resize(n);
  place_.resize(n);
  entry_position_.resize(n);
  std::vector<int> next(cell_start_.begin(), cell_start_.end() - 1);
  for (std::size_t i = 0; i < n; ++i) {
    if (is_left_out(i)) continue;
    const auto place = static_cast<std::size_t>(next[static_cast<std::size_t>(box_cell_[i])]++);
    entry_[place] = static_cast<int>(i);
  }
  // Mirror images in one cell may have come from several ranks.
  for (std::size_t c = 0; mirrored_ && c < n_cells; ++c) {
    const auto first = entry_.begin() + cell_start_[c], last = entry_.begin() + cell_start_[c + 1];
    const auto id = [&](int i) { return particles.id[static_cast<std::size_t>(i)]; };
    if (!std::ranges::is_sorted(first, last, {}, id)) std::ranges::stable_sort(first, last, {}, id);
  }
  const auto n_entries = static_cast<std::size_t>(cell_start_[n_cells]);
  for (std::size_t place = 0; place < n_entries; ++place) {
    entry_position_[place] = particles.position[static_cast<std::size_t>(entry_[place])];
    place_[static_cast<std::size_t>(entry_[place])] = static_cast<int>(place);
  }
}

// Makes one pair of those with the same neighbour in the far list's entries [begin, end), in the order of the places.
template <int Dim>
void NeighbourSearch<Dim>::merge_columns(int begin, int& end) {
  merged_.clear();
  for (auto k = static_cast<std::size_t>(begin); k < static_cast<std::size_t>(end); ++k)
    merged_.emplace_back(place_[static_cast<std::size_t>(far_.index[k])], far_.weight[k]);
  std::ranges::stable_sort(merged_, {}, &std::pair<int, double>::first);
  end = begin;
  int last = -1;
  for (const auto& [place, weight] : merged_) {
    if (std::exchange(last, place) == place) {
      far_.weight[static_cast<std::size_t>(end - 1)] += weight;
    } else {
      far_.index[static_cast<std::size_t>(end)] = entry_[static_cast<std::size_t>(place)];
      far_.weight[static_cast<std::size_t>(end++)] = weight;
    }
  }
}

template <int Dim>
template <class Kernel>
void NeighbourSearch<Dim>::find_pairs(const Particles<Dim>& particles, std::span<const int> column) {
  // Starts of the runs of cells along the last axis around a cell, relative to the cell.
  std::vector<int> runs;
  const int span = 2 * reach_ + 1;
  for (int code = 0; code < (Dim == 2 ? span : span * span); ++code) {
    if constexpr (Dim == 2) {
      runs.push_back((code - reach_) * box_extent_[1] - reach_);
    } else {
      runs.push_back(((code / span - reach_) * box_extent_[1] + code % span - reach_) * box_extent_[2] - reach_);
    }
  }
  const double near2 = near_radius_ * near_radius_;
  const double far2 = far_radius_ * far_radius_;
  near_.start.assign(1, 0);
  far_.start.assign(1, 0);
  int n_near = 0;
  int n_far = 0;
  // Appends the pairs of particle i to those rows that are asked for.
  const auto append_pairs = [&](int i, bool with_near, bool with_far) {
    const auto self = static_cast<std::size_t>(i);
    const Vec<Dim> centre = particles.position[self];
    for (const int run : runs) {
      const auto first_cell = static_cast<std::size_t>(box_cell_[self] + run);
      const int first = cell_start_[first_cell];
      const int last = cell_start_[first_cell + static_cast<std::size_t>(span)];
      make_room(near_, n_near, last - first);
      make_room(far_, n_far, last - first);
      for (int place = first; place < last; ++place) {
        const auto k = static_cast<std::size_t>(place);
        const Vec<Dim> offset = entry_position_[k] - centre;
        const double r2 = dot(offset, offset);
        if (r2 >= far2 || r2 == 0.0) continue;  // itself, or its image where it touches a mirror
        const double r = std::sqrt(r2);
        if (with_far) {
          far_.index[static_cast<std::size_t>(n_far)] = entry_[k];
          far_.weight[static_cast<std::size_t>(n_far++)] = Kernel::weight(r, far_radius_);
        }
        if (r2 >= near2 || !with_near) continue;
        near_.index[static_cast<std::size_t>(n_near)] = entry_[k];
        near_.weight[static_cast<std::size_t>(n_near++)] = Kernel::weight(r, near_radius_);
      }
    }
  };
  // Members of the columns of this rank: ghosts by wall particle.
  std::vector<std::pair<int, int>> members;
  for (std::size_t i = 0; i < std::min(column.size(), static_cast<std::size_t>(particles.owned)); ++i)
    if (column[i] != static_cast<int>(i)) members.emplace_back(column[i], static_cast<int>(i));
  std::sort(members.begin(), members.end());
  auto member = members.begin();

  for (int i = 0; i < particles.owned; ++i) {
    const ParticleType type = particles.type[static_cast<std::size_t>(i)];
    if (type == ParticleType::wall && mirrored_) {
      append_pairs(i, true, false);
    } else if (type == ParticleType::fluid || type == ParticleType::wall) {
      const int begin = n_far;
      append_pairs(i, true, true);
      if (!column.empty()) {
        for (; member != members.end() && member->first == i; ++member) append_pairs(member->second, false, true);
        bool shared = type == ParticleType::wall;
        int kept = begin;
        for (int k = begin; k < n_far; ++k) {
          const int j = far_.index[static_cast<std::size_t>(k)];
          const int owner = column[static_cast<std::size_t>(j)];
          if (owner == i) continue;
          shared |= owner != j;
          far_.index[static_cast<std::size_t>(kept)] = owner;
          far_.weight[static_cast<std::size_t>(kept++)] = far_.weight[static_cast<std::size_t>(k)];
        }
        n_far = kept;
        if (shared) merge_columns(begin, n_far);
      }
    } else if (type == ParticleType::ghost && !column.empty()) {
      append_pairs(i, true, false);
    }
    near_.start.push_back(n_near);
    far_.start.push_back(n_far);
  }
}

template <int Dim>
std::size_t NeighbourSearch<Dim>::bytes() const {
  return near_.bytes() + far_.bytes() +
         (box_cell_.capacity() + cell_start_.capacity() + entry_.capacity() + place_.capacity()) * sizeof(int) +
         entry_position_.capacity() * sizeof(Vec<Dim>);
}

template class NeighbourSearch<2>;
template class NeighbourSearch<3>;

}  // namespace impinge
