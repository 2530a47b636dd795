#pragma once
// A space-filling curve through the background cells.

#include <array>
#include <cstdint>

#include "impinge/particles/cell_grid.hpp"

namespace impinge {

/// The Hilbert curve through the smallest cube of 2^k cells along each axis that holds a grid, by the transform of J.
/// Skilling, "Programming the Hilbert curve", AIP Conf. Proc. 707 (2004) 381. The grid's cells have keys on it, with
/// gaps where the grid fills its cube in part.
template <int Dim>
class CellCurve {
 public:
  explicit CellCurve(const CellGrid<Dim>& cells);

  /// Keys are below 2 to this power.
  int bits() const { return Dim * levels_; }

  /// Place along the curve of the cell at these coordinates, which lie in the grid.
  std::int64_t key(const std::array<int, Dim>& coordinates) const;

  /// The coordinates of a key.
  std::array<int, Dim> coordinates(std::int64_t key) const;

 private:
  int levels_;
};

}  // namespace impinge
