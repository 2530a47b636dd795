#include "impinge/particles/cell_grid.hpp"

#include <algorithm>
#include <cmath>

namespace impinge {

template <int Dim>
CellGrid<Dim>::CellGrid(const Box<Dim>& box, const Edges<Dim>& edges, double smallest_edge)
    : low_(box.low), edges_(edges) {
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
int CellGrid<Dim>::count() const {
  int cells = 1;
  for (const int n : extent_) cells *= n;
  return cells;
}

template <int Dim>
Vector<Dim> CellGrid<Dim>::in_edges(const Vector<Dim>& position) const {
  Vector<Dim> at;
  for (int k = 0; k < Dim; ++k) at[k] = (position[k] - low_[k]) / edge_[k];
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
std::array<int, Dim> CellGrid<Dim>::coordinates(int cell) const {
  std::array<int, Dim> at;
  for (int k = Dim - 1; k >= 0; --k) {
    const auto axis = static_cast<std::size_t>(k);
    at[axis] = cell % extent_[axis];
    cell /= extent_[axis];
  }
  return at;
}

template <int Dim>
int CellGrid<Dim>::cell(const Vector<Dim>& position) const {
  int index = 0;
  for (int k = 0; k < Dim; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    const double at = std::floor((position[k] - low_[k]) / edge_[k]);
    if (!(at >= 0.0 && at < extent_[axis])) return -1;
    index = index * extent_[axis] + static_cast<int>(at);
  }
  return index;
}

template <int Dim>
int CellGrid<Dim>::wrapped_cell(std::array<int, Dim> coordinates, Image<Dim>& image) const {
  image = {};
  int index = 0;
  for (int k = 0; k < Dim; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    const int n = extent_[axis];
    int& at = coordinates[axis];
    if (at < 0 || at >= n) {
      const bool low = at < 0;
      switch (low ? edges_[axis].low : edges_[axis].high) {
        case Edge::open:
          return -1;
        case Edge::periodic:
          image.shift[k] = (low ? n : -n) * edge_[k];
          at += low ? n : -n;
          break;
        case Edge::mirror:
          image.sign[k] = -1.0;
          image.shift[k] = 2.0 * (low ? low_[k] : low_[k] + n * edge_[k]);
          at = (low ? 0 : 2 * n) - 1 - at;
          if (at < 0 || at >= n) return -1;
      }
    }
    index = index * n + at;
  }
  return index;
}

template <int Dim>
Vector<Dim> CellGrid<Dim>::wrapped(Vector<Dim> position, Image<Dim>& image) const {
  image = {};
  for (int k = 0; k < Dim; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    const double length = extent_[axis] * edge_[k];
    // The condition is the one of cell(): whatever rounding does, a position between the ends has a cell.
    const auto is_beyond = [&] { return (position[k] - low_[k]) / edge_[k] >= extent_[axis]; };
    if (edges_[axis].low == Edge::periodic) {
      if (position[k] < low_[k]) position[k] += length;
      if (is_beyond()) position[k] = std::max(low_[k], position[k] - length);
      continue;
    }
    if (edges_[axis].low == Edge::mirror && position[k] < low_[k]) {
      image.sign[k] = -1.0;
      image.shift[k] = 2.0 * low_[k];
      position[k] = 2.0 * low_[k] - position[k];
    }
    if (edges_[axis].high == Edge::mirror && is_beyond()) {
      image.sign[k] *= -1.0;
      image.shift[k] = 2.0 * (low_[k] + length) - image.shift[k];
      position[k] = 2.0 * (low_[k] + length) - position[k];
      while (is_beyond()) position[k] = std::nextafter(position[k], low_[k]);
    }
  }
  return position;
}

template <int Dim>
Vector<Dim> CellGrid<Dim>::unmirrored(Vector<Dim> position) const {
  for (int k = 0; k < Dim; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    const double high = low_[k] + extent_[axis] * edge_[k];
    if (edges_[axis].low == Edge::mirror && position[k] < low_[k]) position[k] = 2.0 * low_[k] - position[k];
    if (edges_[axis].high == Edge::mirror && position[k] > high) position[k] = 2.0 * high - position[k];
  }
  return position;
}

template class CellGrid<2>;
template class CellGrid<3>;

}  // namespace impinge
