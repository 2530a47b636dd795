#include "impinge/particles/cell_grid.hpp"

#include <algorithm>
#include <cmath>

namespace impinge {

template <int Dim>
CellGrid<Dim>::CellGrid(const Box<Dim>& box, const std::array<bool, Dim>& periodic, double smallest_edge)
    : low_(box.low), high_(box.high), periodic_(periodic) {
  for (int k = 0; k < Dim; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    const double length = box.high[k] - box.low[k];
    extent_[axis] = std::max(1, static_cast<int>(std::floor(length / smallest_edge)));
    edge_[k] = length / extent_[axis];
  }
}

template <int Dim>
CellGrid<Dim> CellGrid<Dim>::refined(int parts) const {
  CellGrid fine = *this;
  for (int k = 0; k < Dim; ++k) {
    fine.extent_[static_cast<std::size_t>(k)] *= parts;
    fine.edge_[k] /= parts;
  }
  return fine;
}

template <int Dim>
std::int64_t CellGrid<Dim>::count() const {
  std::int64_t cells = 1;
  for (const int n : extent_) cells *= n;
  return cells;
}

template <int Dim>
Vector<Dim> CellGrid<Dim>::in_edges(const Vector<Dim>& position) const {
  Vector<Dim> at;
  for (int k = 0; k < Dim; ++k) {
    const double extent = extent_[static_cast<std::size_t>(k)];
    at[k] = (position[k] - low_[k]) / edge_[k];
    if (at[k] >= extent && position[k] < high_[k]) at[k] = std::nextafter(extent, 0.0);  // rounded up
  }
  return at;
}

template <int Dim>
std::array<int, Dim> CellGrid<Dim>::coordinates(const Vector<Dim>& position) const {
  const Vector<Dim> in_edges = this->in_edges(position);
  std::array<int, Dim> at;
  for (int k = 0; k < Dim; ++k) at[static_cast<std::size_t>(k)] = static_cast<int>(std::floor(in_edges[k]));
  return at;
}

template <int Dim>
std::array<int, Dim> CellGrid<Dim>::coordinates(std::int64_t cell) const {
  std::array<int, Dim> at;
  for (int k = Dim - 1; k >= 0; --k) {
    const auto axis = static_cast<std::size_t>(k);
    at[axis] = static_cast<int>(cell % extent_[axis]);
    cell /= extent_[axis];
  }
  return at;
}

template <int Dim>
std::int64_t CellGrid<Dim>::cell(const Vector<Dim>& position) const {
  const Vector<Dim> in_edges = this->in_edges(position);
  std::int64_t index = 0;
  for (int k = 0; k < Dim; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    const double at = std::floor(in_edges[k]);
    if (!(at >= 0.0 && at < extent_[axis])) return -1;
    index = index * extent_[axis] + static_cast<int>(at);
  }
  return index;
}

template <int Dim>
std::int64_t CellGrid<Dim>::wrapped_cell(std::array<int, Dim> coordinates, Vector<Dim>& shift) const {
  shift = {};
  std::int64_t index = 0;
  for (int k = 0; k < Dim; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    const int n = extent_[axis];
    int& at = coordinates[axis];
    if (at < 0 || at >= n) {
      if (!periodic_[axis]) return -1;
      const int periods = at < 0 ? n : -n;
      shift[k] = periods * edge_[k];
      at += periods;
    }
    index = index * n + at;
  }
  return index;
}

template <int Dim>
Vector<Dim> CellGrid<Dim>::wrapped(Vector<Dim> position) const {
  for (int k = 0; k < Dim; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    if (!periodic_[axis]) continue;
    const double length = extent_[axis] * edge_[k];
    if (position[k] < low_[k]) position[k] += length;
    // The condition is the one of cell(): whatever rounding does, a position between the ends has a cell.
    if ((position[k] - low_[k]) / edge_[k] >= extent_[axis]) position[k] = std::max(low_[k], position[k] - length);
  }
  return position;
}

template class CellGrid<2>;
template class CellGrid<3>;

}  // namespace impinge
