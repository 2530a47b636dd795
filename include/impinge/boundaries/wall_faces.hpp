#pragma once
// The faces of all walls as they stand at a time, and which lines they leave free: the geometry of specular images.

#include "impinge/boundaries/wall_lines.hpp"
#include "impinge/boundaries/wall_surfaces.hpp"
