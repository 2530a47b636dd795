#pragma once
// The scene of a case as a file for ParaView.

#include <mpi.h>

#include <array>
#include <string>
#include <string_view>

#include "impinge/cases/case.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

/// What a cell of the file shows.
enum class SceneItem : std::uint8_t { fluid, inlet, wall, outlet, probe, gauge, section, damping, path, domain };
constexpr auto words(SceneItem) {
  return std::to_array<std::string_view>(
      {"fluid", "inlet", "wall", "outlet", "probe", "gauge", "section", "damping", "path", "domain"});
}

/// Writes `<case>_scene.vtkhdf` into the output directory, in the place of an earlier one; returns its path. It has the
/// scene at the start: particles as vertices (of more than a million, some), walls, openings, what is observed and the
/// bounds as lines, and the paths of corners of walls that move [m]. Of each cell: `item`, a SceneItem; `number` in its
/// list in the case, from 1, 0: none; `normal`: of a wall out of the wet side that the cell stands for (a wall that is
/// wet on both sides has its lines twice), of an inlet along the flow. Root attributes: the case, the items' words;
/// /names: of each item. `particles`: at the start. Collective. Throws FileError.
template <int Dim>
std::string write_scene(MPI_Comm comm, const Case& config, const Particles<Dim>& particles);

}  // namespace impinge
