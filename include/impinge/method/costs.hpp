#pragma once
// What a run takes for each of its items.

#include "impinge/method/settings.hpp"

namespace impinge {

/// Sizes of the arrays and messages of a run, rows as on the full lattice.
struct UnitCosts {
  double particle_memory;  ///< of an owned or halo particle [bytes]
  double row_memory;       ///< of a row of pairs, matrix and interpolation on top of its particle [bytes]
  double halo_traffic;     ///< sent per halo particle and step, but for the iterations of the solver [bytes]
};

/// Touches nothing; not collective.
template <int Dim>
UnitCosts unit_costs(const MethodSettings& settings);

/// Memory of the arrays of one entry per particle [bytes].
template <int Dim>
std::size_t bytes_per_particle();

}  // namespace impinge
