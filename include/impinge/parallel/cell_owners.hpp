#pragma once
// Which rank owns a background cell, whether it has particles or not.

#include <vector>

#include "impinge/parallel/cell_curve.hpp"
#include "impinge/particles/cell_index.hpp"

namespace impinge {

/// Cells of one rank that follow one another along the curve, up to the next segment.
struct Segment {
  std::int64_t first;  ///< its first key
  int rank;
  friend bool operator==(const Segment&, const Segment&) = default;
};

/// The owner of each cell: the rank of the last segment that begins at or before the cell's key. Its size is that of
/// the segments, whatever the number of cells. Not for several threads: it remembers what it was asked.
template <int Dim>
class CellOwners {
 public:
  /// All cells are rank 0's.
  explicit CellOwners(const CellGrid<Dim>& cells) : CellOwners(cells, {{0, 0}}) {}

  /// `segments`: with ascending first keys, of which the first is 0.
  CellOwners(const CellGrid<Dim>& cells, std::vector<Segment> segments)
      : cells_(cells), curve_(cells), segments_(std::move(segments)) {}

  const CellCurve<Dim>& curve() const { return curve_; }
  const std::vector<Segment>& segments() const { return segments_; }

  /// Rank of a cell.
  int operator()(std::int64_t cell) const;

  /// Memory [bytes].
  std::size_t bytes() const {
    return segments_.capacity() * sizeof(Segment) + known_.bytes() + owner_.capacity() * sizeof(int);
  }

 private:
  CellGrid<Dim> cells_;
  CellCurve<Dim> curve_;
  std::vector<Segment> segments_;
  mutable CellIndex known_;         // the cells of the last questions
  mutable std::vector<int> owner_;  // of these
};

}  // namespace impinge
