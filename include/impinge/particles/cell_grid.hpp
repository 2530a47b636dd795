#pragma once
// Background cells: a box cut into equal cells, numbered with the last axis fastest. It may repeat along its axes.

#include <array>
#include <cstdint>

#include "impinge/core/vector.hpp"

namespace impinge {

/// Equal cells that divide a box along each axis.
template <int Dim>
class CellGrid {
 public:
  /// Most cells along an axis, such that the parts of all have a number, and coordinates fit into int.
  static constexpr int most_extent = 1 << (58 / Dim);

  /// `periodic`: axes along which the box repeats; `smallest_edge`: of a cell [m].
  CellGrid(const Box<Dim>& box, const std::array<bool, Dim>& periodic, double smallest_edge);

  /// The same box with every cell cut into `parts` along each axis.
  CellGrid refined(int parts) const;

  std::int64_t count() const;

  /// Cell of a position, or -1 outside the box (a position that is not a number is outside).
  std::int64_t cell(const Vector<Dim>& position) const;

  /// The position from the low corner in units of the cells' edges [-]; below the number of cells for every position
  /// below the high end, whatever rounding does.
  Vector<Dim> in_edges(const Vector<Dim>& position) const;

  /// Integer coordinates of the cell that holds a position; beyond the box they go on, as periodic images need.
  std::array<int, Dim> coordinates(const Vector<Dim>& position) const;

  std::array<int, Dim> coordinates(std::int64_t cell) const;

  /// Cell at integer coordinates, beyond periodic ends the cell that repeats there; -1 outside. A particle of that cell
  /// moved by `shift` [m] appears at these coordinates.
  std::int64_t wrapped_cell(std::array<int, Dim> coordinates, Vector<Dim>& shift) const;

  /// The position inside the period, by up to one period along each axis.
  Vector<Dim> wrapped(Vector<Dim> position) const;

  const Vector<Dim>& edge() const { return edge_; }  ///< lengths of a cell [m]
  const std::array<int, Dim>& extent() const { return extent_; }
  const std::array<bool, Dim>& periodic() const { return periodic_; }

 private:
  Vector<Dim> low_;
  Vector<Dim> high_;
  Vector<Dim> edge_;
  std::array<int, Dim> extent_;
  std::array<bool, Dim> periodic_;
};

/// Calls use(cell, shift) for the cells up to `reach` cells away from `cell` along every axis, itself included, in a
/// fixed order; shift: see wrapped_cell.
template <int Dim, class Use>
void for_cells_around(const CellGrid<Dim>& cells, std::int64_t cell, int reach, Use&& use) {
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
    Vector<Dim> shift;
    const std::int64_t near = cells.wrapped_cell(at, shift);
    if (near >= 0) use(near, shift);
  }
}

}  // namespace impinge
