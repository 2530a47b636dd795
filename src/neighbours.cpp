#include "impinge/neighbours.hpp"

#include <algorithm>
#include <cmath>

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
                                      double far_radius)
    : cells_(cells), reach_(reach), kernel_(kernel), near_radius_(near_radius), far_radius_(far_radius) {}

template <int Dim>
void NeighbourSearch<Dim>::search(const Particles<Dim>& particles) {
  arrange(particles);
  with_kernel(kernel_, [&](auto kernel) { find_pairs<decltype(kernel)>(particles); });
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
  // A stable counting sort; a cell's particles are all owned or all of one sender, so they stay ordered by id.
  box_cell_.resize(n);
  cell_start_.assign(n_cells + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    int cell = 0;
    for (std::size_t k = 0; k < Dim; ++k) cell = cell * box_extent_[k] + at[i][k] - box_low_[k];
    box_cell_[i] = cell;
    ++cell_start_[static_cast<std::size_t>(cell) + 1];
  }
  for (std::size_t c = 0; c < n_cells; ++c) cell_start_[c + 1] += cell_start_[c];
  entry_.resize(n);
  entry_position_.resize(n);
  std::vector<int> next(cell_start_.begin(), cell_start_.end() - 1);
  for (std::size_t i = 0; i < n; ++i) {
    const auto place = static_cast<std::size_t>(next[static_cast<std::size_t>(box_cell_[i])]++);
    entry_[place] = static_cast<int>(i);
    entry_position_[place] = particles.position[i];
  }
}

template <int Dim>
template <class Kernel>
void NeighbourSearch<Dim>::find_pairs(const Particles<Dim>& particles) {
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
  for (int i = 0; i < particles.owned; ++i) {
    const auto self = static_cast<std::size_t>(i);
    const ParticleType type = particles.type[self];
    if (type == ParticleType::fluid || type == ParticleType::wall) {
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
          if (r2 >= far2 || entry_[k] == i) continue;
          const double r = std::sqrt(r2);
          far_.index[static_cast<std::size_t>(n_far)] = entry_[k];
          far_.weight[static_cast<std::size_t>(n_far++)] = Kernel::weight(r, far_radius_);
          if (r2 >= near2) continue;
          near_.index[static_cast<std::size_t>(n_near)] = entry_[k];
          near_.weight[static_cast<std::size_t>(n_near++)] = Kernel::weight(r, near_radius_);
        }
      }
    }
    near_.start.push_back(n_near);
    far_.start.push_back(n_far);
  }
}

template <int Dim>
std::size_t NeighbourSearch<Dim>::bytes() const {
  return near_.bytes() + far_.bytes() +
         (box_cell_.capacity() + cell_start_.capacity() + entry_.capacity()) * sizeof(int) +
         entry_position_.capacity() * sizeof(Vec<Dim>);
}

template class NeighbourSearch<2>;
template class NeighbourSearch<3>;

}  // namespace impinge
