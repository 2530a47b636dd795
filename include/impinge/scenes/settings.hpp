#pragma once
// The short forms of a scene in a case file. SI units.

#include <array>

namespace impinge {

enum class SceneType { jet, tank, periodic_box };
enum class JetStart { impact, steady };

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
  std::array<double, 3> size{0.0, 0.0, 0.0};  ///< inner lengths; the vertical one is the walls' height [m]
  double fluid_height = 0.0;                  ///< [m]
};

struct PeriodicBoxSettings {
  std::array<double, 3> size{0.0, 0.0, 0.0};  ///< periods [m]
  double shear_speed = 0.0;                   ///< amplitude of u_x = U sin(2 pi y / L_y) [m/s]
};

/// The scene's part of a case.
struct SceneSettings {
  SceneType geometry = SceneType::jet;
  JetSettings jet;
  PlateSettings plate;
  TankSettings tank;
  PeriodicBoxSettings periodic_box;
};

}  // namespace impinge
