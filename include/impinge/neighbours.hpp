#pragma once
// One search per step that feeds every operator.

#include <span>
#include <utility>
#include <vector>

#include "impinge/cell_grid.hpp"
#include "impinge/kernel.hpp"
#include "impinge/particles.hpp"

namespace impinge {

/// Pairs in compressed rows, one row per owned particle: local index of the neighbour (owned or halo) and the kernel's
/// weight W(r_ij) [-]. The arrays may be longer than start.back().
struct PairList {
  std::vector<int> start{0};
  std::vector<int> index;
  std::vector<double> weight;

  int begin(int i) const { return start[static_cast<std::size_t>(i)]; }
  int end(int i) const { return start[static_cast<std::size_t>(i) + 1]; }
  int rows() const { return static_cast<int>(start.size()) - 1; }
  std::int64_t pairs() const { return start.back(); }
  std::size_t bytes() const {
    return (start.capacity() + index.capacity()) * sizeof(int) + weight.capacity() * sizeof(double);
  }
};

/// Finds all pairs within two radii. A row's order is that of the cells and, within a cell, of the ids, so sums over a
/// row are bitwise the same for every decomposition; columns of owned particles ascend.
template <int Dim>
class NeighbourSearch {
 public:
  /// Radii in metres, near_radius <= far_radius; `cells`: the cells along which the particles are sorted, with
  /// far_radius <= reach cells. `mirrored`: walls are mirrors; a wall particle then measures only: it has a near row
  /// and stands in no other row.
  NeighbourSearch(const CellGrid<Dim>& cells, int reach, KernelType kernel, double near_radius, double far_radius,
                  bool mirrored = false);

  /// Reads positions and types of owned particles (sorted) and halo. Inlet and ghost particles get empty rows. Not
  /// collective.
  void search(const Particles<Dim>& particles);

  /// The same where the ghosts behind a wall share its unknown. `column`: local index of the particle whose unknown a
  /// particle shares, for all particles; its own but for ghosts, whose wall particle stands on the same rank. The far
  /// list then holds the pairs of unknowns: a ghost's pairs stand in its wall particle's row, and its weight in the
  /// rows of others is added to that of its wall particle; pairs inside a column are left out. Ghosts have near rows.
  void search(const Particles<Dim>& particles, std::span<const int> column);

  const PairList& near() const { return near_; }
  const PairList& far() const { return far_; }

  /// Memory that the lists and the search hold [bytes].
  std::size_t bytes() const;

 private:
  void arrange(const Particles<Dim>& particles);
  template <class Kernel>
  void find_pairs(const Particles<Dim>& particles, std::span<const int> column);
  void merge_columns(int begin, int& end);

  CellGrid<Dim> cells_;
  int reach_;
  KernelType kernel_;
  double near_radius_;
  double far_radius_;
  bool mirrored_;
  PairList near_;
  PairList far_;
  // Particles in the order of the local cells: a box of cells around all of them, padded by the reach.
  std::array<int, Dim> box_low_;
  std::array<int, Dim> box_extent_;
  std::vector<int> box_cell_;  // per particle
  std::vector<int> cell_start_;
  std::vector<int> entry_;  // particle of each place in cell order
  std::vector<Vec<Dim>> entry_position_;
  std::vector<int> place_;                      // inverse of entry_
  std::vector<std::pair<int, double>> merged_;  // (place, weight) of a row
};

}  // namespace impinge
