#pragma once
// What a run needs to go on from the end of a step as if it had never stopped.

#include <map>
#include <string>
#include <vector>

#include "impinge/parallel/cell_owners.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

/// Most entries of a row of the preconditioner's coarse matrix: the 5^Dim nodes around its own.
template <int Dim>
constexpr std::size_t coarse_stencil = Dim == 2 ? 25 : 125;

/// This rank's rows of the preconditioner's coarse matrix.
struct CoarseRows {
  std::vector<std::int64_t> cell;    ///< each row's cell, ascending
  std::vector<std::int64_t> length;  ///< entries of each row
  std::vector<std::int64_t> column;  ///< global, row after row
  std::vector<double> value;
};

/// The state between two steps. `segments` and `coarse` are empty where the number of ranks has changed since it was
/// saved.
template <int Dim>
struct Checkpoint {
  Particles<Dim> particles;                    ///< owned
  std::vector<Vector<Dim>> searched_position;  ///< where they stood when their neighbours were searched [m]
  std::map<std::string, double> numbers;       ///< all that is one number, the same on every rank
  std::vector<Segment> segments;               ///< of the owners of the background cells, the same on every rank
  CoarseRows coarse;
};

/// What no run can have saved in this rank's state and what could do harm: numbers that are out of range, indices that
/// point to nothing; empty if all is well. `first_node`: number of this rank's first row of the coarse matrix; `nodes`:
/// rows of all ranks. Not collective.
template <int Dim>
std::string problem_of(const Checkpoint<Dim>& state, int ranks, std::int64_t first_node, std::int64_t nodes);

}  // namespace impinge
