#pragma once
// Zones that damp waves: [[damping]] of a case file.

#include <string>
#include <vector>

#include "impinge/config/key.hpp"
#include "impinge/core/vector.hpp"

namespace impinge {

/// One table of [[damping]]: a box in which the fluid is slowed down.
struct DampingSettings {
  std::string name{};
  Numbers low{}, high{};  ///< corners [m]
  double strength = 0.0;  ///< largest rate [1/s]
  Numbers direction{};    ///< in which the rate rises; 0: it is the same everywhere
};

/// Declares [[damping]].
void declare_damping(Keys& keys, std::vector<DampingSettings>& zones);

/// Sets names that are not given.
void derive_damping(const Keys& keys, std::vector<DampingSettings>& zones);

/// Notes names that are used twice and boxes without an inside. The key of `dimension` is usable.
void check_damping(Keys& keys, int dimension, const std::vector<DampingSettings>& zones);

/// A sponge layer after Israeli & Orszag (1981), J. Comput. Phys. 41, 115: du/dt = -rate u. The rate rises from 0 where
/// a wave enters the zone to the strength at its end as the square of the way, so that little is reflected.
template <int Dim>
class DampingZones {
 public:
  explicit DampingZones(const std::vector<DampingSettings>& settings);

  bool empty() const { return zones_.empty(); }

  /// The rate at a position [1/s]: the sum of all zones there.
  double rate(const Vector<Dim>& position) const;

  /// Change of a velocity over a time [s] by the damping alone; exact, so that no rate is too large for a time step.
  Vector<Dim> velocity_change(const Vector<Dim>& position, const Vector<Dim>& velocity, double dt) const;

 private:
  struct Zone {
    Box<Dim> box;
    double strength;
    Vector<Dim> direction;  // a unit vector, or 0
    double begin, length;   // of the ramp along the direction [m]
  };

  std::vector<Zone> zones_;
};

}  // namespace impinge
