#pragma once
// The short forms of a scene in a case file. SI units.

#include "impinge/config/key.hpp"
#include "impinge/method/settings.hpp"
#include "impinge/scenes/fluid_region.hpp"
#include "impinge/scenes/opening_settings.hpp"
#include "impinge/scenes/wall_settings.hpp"

namespace impinge {

enum class SceneType { jet, tank, periodic_box, scene };
enum class JetStart { impact, steady };

constexpr auto words(SceneType) { return std::to_array<std::string_view>({"jet", "tank", "periodic_box", "scene"}); }
constexpr auto words(JetStart) { return std::to_array<std::string_view>({"impact", "steady"}); }

struct JetSettings {
  double width = 0.0;           ///< H [m]
  double speed = 0.0;           ///< U [m/s]
  double angle = 0.0;           ///< between jet and plate [deg]
  double inlet_distance = 3.5;  ///< from the plate along the axis [H]
  JetStart start = JetStart::impact;
};

struct PlateSettings {
  double begin = 0.0;  ///< [m] from the stagnation point; default from the analytic jet, a multiple of dp
  double end = 0.0;    ///< [m], likewise
};

struct TankSettings {
  Numbers size{};             ///< inner lengths; the vertical one is the walls' height [m]
  double fluid_height = 0.0;  ///< [m]; 0: the fluid is that of the regions
};

struct PeriodicBoxSettings {
  Numbers size{};             ///< periods [m]
  double shear_speed = 0.0;   ///< amplitude of u_x = U sin(2 pi y / L_y) [m/s]
  double vortex_speed = 0.0;  ///< largest u_x of Taylor-Green vortices [m/s]
};

struct DomainSettings {
  Numbers low{};   ///< corner of the bounds [m]
  Numbers high{};  ///< likewise
};

/// The scene's part of a case.
struct SceneSettings {
  SceneType geometry = SceneType::jet;
  JetSettings jet;
  PlateSettings plate;
  TankSettings tank;
  PeriodicBoxSettings periodic_box;
  DomainSettings domain;
  std::vector<FluidRegion> regions;    ///< of a tank or a scene
  std::vector<WallEntry> scene_walls;  ///< of a scene
  std::vector<MotionEntry> motions;    ///< of its walls
  std::vector<InletEntry> inlets;      ///< of a scene
  std::vector<OutletEntry> outlets;    ///< of a scene
};

/// The settings of other modules that a scene depends on.
struct SceneInputs {
  const int& dimension;
  const double& spacing;  ///< dp [m]
  const KernelSettings& kernel;
  const FluidSettings& fluid;
  const TimeSettings& time;
  const WallSettings& walls;
};

/// Declares the tables of the scenes. `geometry` must be declared before.
void declare_scenes(Keys& keys, SceneSettings& settings);

/// Speed of the jet, of a fall from the tank's fluid height, of the box' flow, or of the regions' fluid [m/s]; 0 if it
/// is unknown.
double reference_speed(const Keys& keys, const SceneSettings& settings, const SceneInputs& inputs);

/// Sets the defaults that depend on other keys: the plate's ends, from the analytic jet.
void derive_scene(const Keys& keys, SceneSettings& settings, const SceneInputs& inputs);

/// Notes where the scene's keys contradict each other or those of other modules.
void check_scene(Keys& keys, const SceneSettings& settings, const SceneInputs& inputs);

}  // namespace impinge
