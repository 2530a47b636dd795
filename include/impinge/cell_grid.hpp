#pragma once
// Background cells: a box cut into equal cells, numbered with the last axis fastest.

#include <array>

#include "impinge/types.hpp"

namespace impinge {

/// Cells over a box. Along a periodic axis the cells divide the period exactly; along another the box grows at its high
/// end to a whole number of cells.
template <int Dim>
class CellGrid {
 public:
  CellGrid(const Box<Dim>& box, const std::array<bool, Dim>& periodic, double smallest_edge);

  /// The same box with every cell cut into `parts` along each axis.
  CellGrid refined(int parts) const;

  int count() const;

  /// Cell of a position, or -1 outside the box (a position that is not a number is outside).
  int cell(const Vec<Dim>& position) const;

  /// The position from the low corner in units of the cells' edges [-].
  Vec<Dim> in_edges(const Vec<Dim>& position) const;

  /// Integer coordinates of the cell that holds a position; beyond the box they go on, as periodic images need.
  std::array<int, Dim> coordinates(const Vec<Dim>& position) const;

  std::array<int, Dim> coordinates(int cell) const;

  /// Cell at integer coordinates, wrapped along periodic axes; -1 outside. `shift` [m] is what a particle of the cell
  /// next door has to move by to appear beside the cell (zero unless wrapped).
  int wrapped_cell(std::array<int, Dim> coordinates, Vec<Dim>& shift) const;

  /// The position inside the period.
  Vec<Dim> wrapped(Vec<Dim> position) const;

  const std::array<int, Dim>& extent() const { return extent_; }
  const std::array<bool, Dim>& periodic() const { return periodic_; }

 private:
  Vec<Dim> low_;
  Vec<Dim> edge_;
  std::array<int, Dim> extent_;
  std::array<bool, Dim> periodic_;
};

/// Calls use(cell, shift) for the cells up to `reach` cells away from `cell` along every axis, itself included, in a
/// fixed order; shift [m]: see wrapped_cell.
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
    Vec<Dim> shift;
    const int near = cells.wrapped_cell(at, shift);
    if (near >= 0) use(near, shift);
  }
}

}  // namespace impinge
