#pragma once
// Who owns which particle: background cells, their partition, migration, and the halo. No physics.

#include <span>
#include <vector>

#include "impinge/parallel/cell_partition.hpp"
#include "impinge/parallel/exchange.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

/// True for a particle with a row of neighbours; others are only seen by these.
constexpr bool has_row(ParticleType type) { return type == ParticleType::fluid || type == ParticleType::wall; }

/// What `particles` cost a rank, `rows` of them with a row of neighbours.
constexpr std::int64_t work_of(std::int64_t particles, std::int64_t rows) { return particles + 3 * rows; }

/// A rank that has a cell's particles in its halo, as they are or moved by periods.
template <int Dim>
struct HaloTarget {
  int rank;
  Vector<Dim> shift;  ///< [m]
  friend bool operator==(const HaloTarget&, const HaloTarget&) = default;
};

/// Appends all that have the particles of `cell` in their halo, each once. Not collective.
template <int Dim>
void append_halo_targets(const CellGrid<Dim>& cells, const CellOwners<Dim>& owner, std::int64_t cell,
                         std::vector<HaloTarget<Dim>>& targets);

/// Particles of this rank that have no cell.
struct Strays {
  std::int64_t outside = 0;     ///< outside the background grid
  std::int64_t not_finite = 0;  ///< with a position that is not a number
};

/// Decomposition of the particles over the ranks by background cells whose edge is at least the largest effective
/// radius. A rank holds arrays over its particles, over cells that have some of them, and over the segments of the
/// cells' owners; none over all cells.
template <int Dim>
class Decomposition {
 public:
  /// How many parts a background cell is cut into along each axis for sorting and searching.
  static constexpr int cell_parts = 2;

  /// What build_halo sends of a particle.
  struct HaloRecord {
    ParticleRecord<Dim> particle;
    PetscInt row;
  };

  /// `reach`: largest effective radius [m]. Rank 0 starts with all cells; call partition before migrate. Not
  /// collective.
  Decomposition(MPI_Comm comm, const Box<Dim>& box, const std::array<bool, Dim>& periodic, double reach,
                Partitioner partitioner);

  MPI_Comm comm() const { return comm_; }

  /// The background cells and the rank of each.
  const CellGrid<Dim>& cells() const { return cells_; }
  const CellOwners<Dim>& owners() const { return owner_; }

  /// How often the cells were distributed.
  int partitions() const { return partitions_; }

  /// The cells in whose order owned particles are sorted.
  const CellGrid<Dim>& sorting_cells() const { return fine_; }

  /// Assigns every cell to a rank so that the work of the particles, wherever they are now, is balanced (see
  /// distribute_cells). Reads owned positions and types. Collective.
  void partition(const Particles<Dim>& particles);

  /// Assigns the cells as an earlier partition did. Not collective.
  void set_owners(Cut cut);

  /// Largest over mean work of the ranks. Collective.
  double imbalance(const Particles<Dim>& particles) const;

  /// The imbalance right after the last partition.
  double achieved_imbalance() const { return achieved_imbalance_; }

  /// Memory of what is known of cells and ranks [bytes].
  std::size_t bytes() const;

  /// True if the position lies in a cell of this rank.
  bool owns(const Vector<Dim>& position) const;

  /// Drops the halo, moves every owned particle to the rank that owns its cell, and sorts along the cells and, within a
  /// cell, by id. Number density and free surface are not carried. Returns how many of this rank's particles were
  /// dropped because they have no cell. Collective.
  Strays migrate(Particles<Dim>& particles);

  /// Appends the halo, with all that travels but the pressure impulse, and numbers the rows. Needs sorted owned
  /// particles. Collective.
  void build_halo(Particles<Dim>& particles);

  const Halo& halo() const { return halo_; }

  /// Copies the positions of owned particles to their copies in the halo, moved by periods. Collective.
  void refresh_positions(Particles<Dim>& particles) const;

  /// Global row of every particle, owned and halo: consecutive on each rank, in the order of the ranks.
  std::span<const PetscInt> rows() const { return rows_; }

 private:
  std::size_t place_of_targets(std::int64_t cell);
  void forget_targets();
  void sort_along_cells(Particles<Dim>& particles) const;

  MPI_Comm comm_;
  CellGrid<Dim> cells_;
  CellGrid<Dim> fine_;
  Partitioner partitioner_;
  CellOwners<Dim> owner_;
  CellIndex seen_;                         // cells of this rank whose targets are known
  std::vector<std::size_t> target_start_;  // of each: range in targets_
  std::vector<HaloTarget<Dim>> targets_;   // who sees the particles of a cell of this rank
  double achieved_imbalance_ = 1.0;
  int partitions_ = 0;
  Halo halo_;
  std::vector<Vector<Dim>> halo_shift_;  // per particle sent [m]
  std::vector<PetscInt> rows_;
};

}  // namespace impinge
