#pragma once
// One search per step that feeds every operator.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "impinge/core/buffer.hpp"
#include "impinge/particles/cell_grid.hpp"
#include "impinge/particles/kernel.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

/// The pairs of one particle: local indices of the neighbours (owned, halo or image) and the kernel's weights W(r_ij)
/// [-].
struct PairRow {
  std::span<const int> index;
  std::span<const double> weight;
};

/// Pairs in compressed rows, one row per owned particle. The arrays may be longer than start.back(); what is beyond has
/// no value.
struct PairList {
  std::vector<int> start{0};
  Buffer<int> index;
  Buffer<double> weight;

  int begin(int i) const { return start[static_cast<std::size_t>(i)]; }
  int end(int i) const { return start[static_cast<std::size_t>(i) + 1]; }
  std::span<const int> row(int i) const {
    return std::span<const int>(index.data(), index.size())
        .subspan(static_cast<std::size_t>(begin(i)), static_cast<std::size_t>(end(i) - begin(i)));
  }
  int rows() const { return static_cast<int>(start.size()) - 1; }
  std::int64_t pairs() const { return start.back(); }
  std::size_t bytes() const {
    return start.capacity() * sizeof(int) + static_cast<std::size_t>(pairs()) * (sizeof(int) + sizeof(double));
  }
};

/// What stands between particles: which pairs count, and which only one particle has.
template <int Dim>
class PairFilter {
 public:
  /// A neighbour of one particle alone, by its index, and its share in the sums.
  struct OwnPair {
    int index;
    double factor;
  };

  virtual ~PairFilter() = default;
  /// False if every pair of an owned particle counts in full.
  virtual bool has_tests(int i) const = 0;
  /// Share of a pair in the sums [-]; 0 where the two do not see each other. The same for both.
  virtual double factor(int i, int j) const = 0;
  /// Neighbours of an owned particle that stand in no cell.
  virtual std::span<const OwnPair> own_pairs(int i) const = 0;
};

/// Finds all pairs within two radii: the near ones as a list, the far ones row by row as they are asked for, since
/// there may be too many to keep; at equal radii both are the list. A row's order is that of the cells and, within a
/// cell, of the ids, so sums over a row are bitwise the same for every decomposition; columns of owned particles
/// ascend.
template <int Dim>
class NeighbourSearch {
 public:
  /// Radii in metres, near_radius <= far_radius; `cells`: the cells along which the particles are sorted, with
  /// far_radius <= reach cells. `walls_measure`: a wall particle has a near row but stands in no other row.
  NeighbourSearch(const CellGrid<Dim>& cells, int reach, KernelType kernel, double near_radius, double far_radius,
                  bool walls_measure = false);

  /// Puts owned particles (sorted), halo and images into cells. Reads their positions and types. Not collective.
  void arrange(const Particles<Dim>& particles);

  /// The particles within the larger radius of an owned one and its position, itself among them but for a wall particle
  /// that measures, in the order of a row. Valid until the next call. After arrange.
  std::span<const int> around(int i, const Vector<Dim>& position);

  /// Finds the pairs, and of those of each particle what the filter leaves. Inlet particles and ghosts get empty rows.
  /// Reads positions and types, also of particles that were added behind the arranged ones. The filter, which may be
  /// none, must live until the last far row was used. After arrange. Not collective.
  void find(const Particles<Dim>& particles, const PairFilter<Dim>* filter = nullptr);

  /// Both.
  void search(const Particles<Dim>& particles) {
    arrange(particles);
    find(particles);
  }

  const PairList& near() const { return near_; }

  /// Calls use(i, row) for every owned particle in their order, with its pairs within the far radius at the last
  /// search; the particle itself may stand in its place, with weight 0. Rows of inlet particles, ghosts, and walls that
  /// measure are empty. A row is valid during the call. Not collective.
  template <class Use>
  void for_far_rows(Use&& use) {
    for (int i = 0; i < near_.rows(); ++i) use(i, far_row(i));
  }

  /// Where an owned particle, no wall particle that measures, stood at the last search [m].
  Vector<Dim> searched_position(int i) const;

  /// Memory that the list and the search hold [bytes].
  std::size_t bytes() const;

 private:
  void find_tested(const Particles<Dim>& particles);
  void find_near(const Particles<Dim>& particles);
  PairRow far_row(int i);
  std::size_t append_row(double radius, double above, int i, const Vector<Dim>& centre);
  std::size_t append_within(double radius, double above, int i, const Vector<Dim>& centre, std::size_t used);
  void weigh(double radius, std::size_t count, double* weight) const;
  // Lines of cells along the last axis around a cell: where the places of the cell a lines on along the first axis, in
  // space b along the second, and c along the line begin is start[a * first + b * second + c].
  struct Lines {
    const int* start;
    std::ptrdiff_t first, second;
  };
  Lines lines_around(int cell);

  CellGrid<Dim> cells_;
  int reach_;
  KernelType kernel_;
  double near_radius_;
  double far_radius_;
  bool walls_measure_;
  PairList near_;
  // Particles in the order of the local cells: those of a box around all particles, padded by the reach, or, where
  // these are very many, those of them that have particles.
  std::array<int, Dim> box_low_;
  std::array<int, Dim> box_extent_;
  std::vector<int> local_cell_;  // per particle
  std::vector<int> cell_start_;
  std::vector<std::int64_t>
      occupied_;                 // place in the box of the local cells with particles; empty: all are local cells
  int lines_of_ = -1;            // local cell whose lines are line_start_
  std::vector<int> line_start_;  // of the lines of cells around a cell: cell_start_ from -reach to reach + 1
  std::vector<int> entry_;       // particle of each place in cell order
  std::vector<int> place_;       // inverse of entry_
  std::array<std::vector<double>, Dim> entry_position_;  // by axis
  std::vector<ParticleType> type_;                       // of the owned particles
  // Of one row.
  std::array<std::vector<double>, Dim> gap2_;  // squares of the distances to layers of cells, by axis
  Buffer<int> index_;
  Buffer<double> square_;  // of the distances
  Buffer<double> weight_;
  std::vector<double> factor_;  // empty: 1
  // What the filter leaves of the pairs within the larger radius, of the rows that it tests.
  const PairFilter<Dim>* filter_ = nullptr;
  std::vector<int> tested_start_;  // per owned particle; empty without tests
  std::vector<int> tested_;
  std::vector<double> tested_factor_;
  std::vector<std::vector<double>> own_square_;  // of the distances of own pairs, per owned particle; empty without
};

}  // namespace impinge
