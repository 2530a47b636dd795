#pragma once
// The flat wall that a jet meets in three dimensions.

#include "impinge/cases/case.hpp"
#include "impinge/validation/jet_target.hpp"

namespace impinge {

/// The target of the inlet of a scene in three dimensions, a flat wall at rest, with JetTarget::space. Coplanar faces
/// of walls are one. It ends at its edges, where outlets begin and where other walls stand on it, as seen from the
/// stagnation point.
/// A round jet: the type is flat_wall and the width the jet's diameter. The wall must reach in all directions to 2.75
/// times the distance of the jet's footprint; at 90 degrees the exact pressure there is a hundredth of rho U^2 / 2.
/// A jet of rectangular section that fills the gap between two walls: the type is plate and all is per depth.
/// Throws InputError where there is no target that is measured.
JetTarget space_target(const Case& config);

/// The particles of a slot jet in the plane frame of its plate, x along and y off it. Wall particles are means over the
/// depth of the slot, one for each column of width dp.
Particles<2> in_frame(const JetTarget& target, const Particles<3>& particles);

}  // namespace impinge
