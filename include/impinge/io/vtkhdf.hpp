#pragma once
// Grids in the VTKHDF layout (UnstructuredGrid, one piece per rank), which ParaView opens.

#include <cstdint>
#include <vector>

#include "impinge/io/hdf5_file.hpp"

namespace impinge {

/// VTK's numbers for types of cells.
inline constexpr std::uint8_t vtk_vertex = 1, vtk_poly_line = 4, vtk_triangle = 5;

/// Creates the group /VTKHDF of an unstructured grid. Collective.
void create_grid(Hdf5Writer& file);

/// Writes this rank's cells. Cell k has the points from `begin[k]` to before `begin[k + 1]`, each point one cell; the
/// last entry is the number of points. `types`: of each cell. Collective.
void write_cells(Hdf5Writer& file, const std::vector<std::int64_t>& begin, const std::vector<std::uint8_t>& types);

}  // namespace impinge
