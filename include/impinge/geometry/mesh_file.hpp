#pragma once
// Surfaces from files: STL, OBJ, PLY.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "impinge/geometry/mesh.hpp"

namespace impinge {

/// The endings of files that hold surfaces.
inline constexpr std::string_view mesh_endings[] = {".stl", ".obj", ".ply"};

/// True for a name with such an ending, in small or capital letters.
bool is_mesh_file(std::string_view name);

/// The facets of a file with such a name and content; faces with more corners are cut. Nothing, and what is wrong, if
/// it is damaged or has none. Not collective.
std::optional<Facets> read_facets(std::string_view name, std::string_view content, std::vector<std::string>& mistakes);

/// A number that tells whether two contents are the same, as 16 hexadecimal digits (FNV-1a).
std::string digest_of(std::string_view content);

}  // namespace impinge
