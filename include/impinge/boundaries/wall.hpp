#pragma once
// Walls.

namespace impinge {

/// Rows of a wall: one of wall particles and the ghosts behind it, enough for a Laplacian radius of 4.01 dp.
constexpr int wall_layers = 4;

}  // namespace impinge
