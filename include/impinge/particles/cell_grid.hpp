#pragma once
// Background cells: a box cut into equal cells, numbered with the last axis fastest.

#include <array>

#include "impinge/core/vector.hpp"

namespace impinge {

/// Where a periodic or mirror image stands: r' = sign r + shift along each axis.
template <int Dim>
struct Image {
  Vector<Dim> sign = all_ones();  // 1, or -1 where the axis is reflected
  Vector<Dim> shift;              // [m]

  bool reflects() const { return sign != all_ones(); }
  Vector<Dim> of_position(const Vector<Dim>& r) const { return of_direction(r) + shift; }
  Vector<Dim> of_direction(Vector<Dim> v) const {
    for (int k = 0; k < Dim; ++k) v[k] *= sign[k];
    return v;
  }
  friend bool operator==(const Image&, const Image&) = default;

 private:
  static Vector<Dim> all_ones() {
    Vector<Dim> ones;
    ones.component.fill(1.0);
    return ones;
  }
};

/// What is beyond an end of a box: nothing, the other end, or the mirror image.
enum class Edge { open, periodic, mirror };

/// The ends of each axis; both are periodic or none.
struct AxisEdges {
  Edge low = Edge::open;
  Edge high = Edge::open;
};

template <int Dim>
using Edges = std::array<AxisEdges, Dim>;

/// Equal cells that divide a box along each axis.
template <int Dim>
class CellGrid {
 public:
  CellGrid(const Box<Dim>& box, const Edges<Dim>& edges, double smallest_edge);

  /// The same box with every cell cut into `parts` along each axis.
  CellGrid refined(int parts) const;

  int count() const;

  /// Cell of a position, or -1 outside the box (a position that is not a number is outside).
  int cell(const Vector<Dim>& position) const;

  /// The position from the low corner in units of the cells' edges [-].
  Vector<Dim> in_edges(const Vector<Dim>& position) const;

  /// Integer coordinates of the cell that holds a position; beyond the box they go on, as periodic images need.
  std::array<int, Dim> coordinates(const Vector<Dim>& position) const;

  std::array<int, Dim> coordinates(int cell) const;

  /// Cell at integer coordinates, beyond periodic and mirror ends that of which the images stand there; -1 outside.
  /// `image` is what makes a particle of the cell next door appear beside the cell.
  int wrapped_cell(std::array<int, Dim> coordinates, Image<Dim>& image) const;

  /// The position inside the period and on this side of the mirrors, by up to one image along each axis; `image`
  /// receives the reflection, without the shifts by periods.
  Vector<Dim> wrapped(Vector<Dim> position, Image<Dim>& image) const;
  Vector<Dim> wrapped(const Vector<Dim>& position) const {
    Image<Dim> image;
    return wrapped(position, image);
  }

  /// The original of a mirror image beyond the box; other positions as they are.
  Vector<Dim> unmirrored(Vector<Dim> position) const;

  const Vector<Dim>& edge() const { return edge_; }  ///< lengths of a cell [m]
  const std::array<int, Dim>& extent() const { return extent_; }
  const Edges<Dim>& edges() const { return edges_; }

 private:
  Vector<Dim> low_;
  Vector<Dim> edge_;
  std::array<int, Dim> extent_;
  Edges<Dim> edges_;
};

/// Calls use(cell, image) for the cells up to `reach` cells away from `cell` along every axis, itself included, in a
/// fixed order; image: see wrapped_cell.
template <int Dim, class Use>
void for_cells_around(const CellGrid<Dim>& cells, int cell, int reach, Use&& use) {
  const auto centre = cells.coordinates(cell);
  const int span = 2 * reach + 1;
  const int count = Dim == 2 ? span * span : span * span * span;
  for (int code = 0; code < count; ++code) {
    auto at = centre;
    int rest = code;
    for (int& coordinate : at) {
      coordinate += rest % span - reach;
      rest /= span;
    }
    Image<Dim> image;
    const int near = cells.wrapped_cell(at, image);
    if (near >= 0) use(near, image);
  }
}

}  // namespace impinge
