#pragma once
// The scenes of the short forms of a case: jet, tank, periodic box.

#include "impinge/boundaries/scene.hpp"
#include "impinge/method/settings.hpp"
#include "impinge/scenes/settings.hpp"

namespace impinge {

/// The scene that a case names. Walls of particles: the surface lies half a spacing in front of the row of wall
/// particles, and ghost rows stand behind it. Mirrors: wall particles stand on the surface and measure the pressure.
/// Throws InputError where the scene does not exist in Dim dimensions.
template <int Dim>
Scene<Dim> make_scene(const MethodSettings& method, const SceneSettings& scene);

/// A plane jet that enters through a rigid inlet buffer and hits a plate. Frame: plate surface y = 0, stagnation point
/// of the analytic jet at the origin, incoming velocity U (cos a, -sin a).
Scene<2> make_jet(const MethodSettings& method, const JetSettings& jet, const PlateSettings& plate);

/// A box open at the top, partly filled with fluid at rest, or by regions; the last axis is the vertical one.
template <int Dim>
Scene<Dim> make_tank(const MethodSettings& method, const TankSettings& tank, const std::vector<FluidRegion>& regions);

/// Fluid that fills a box periodic along every axis, in a shear flow u_x = U sin(2 pi y/L_y).
template <int Dim>
Scene<Dim> make_periodic_box(const MethodSettings& method, const PeriodicBoxSettings& box);

/// Regions of fluid between walls of any shape, or without walls.
template <int Dim>
Scene<Dim> make_open_scene(const MethodSettings& method, const SceneSettings& settings);

/// What is left of a region between the walls of its scene, and the volume of its particles there [m^3, m^2 in 2D].
struct RegionVolume {
  double expected;
  double of_particles;
};
template <int Dim>
RegionVolume volume_between_walls(const MethodSettings& method, const SceneSettings& settings,
                                  const FluidRegion& region);

}  // namespace impinge
