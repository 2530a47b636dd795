#pragma once
// The steady plane jet that a wedge or a short plate splits into halves (free-streamline theory).

#include <vector>

namespace impinge {

/// An inviscid, weightless jet of width H and speed U that meets the edge of a wedge of half-angle a symmetrically. Its
/// faces have the length L; beyond them the sheets are free. a = 90 degrees: a plate of length 2 L across the jet. More
/// than 90: a groove.
///
/// With the hodograph variable zeta = (u - i v) / U of the upper half and t = zeta^{pi/a}, the fluid is the upper half
/// of the unit disc, with the source of the jet at t = 1 and the sink of the sheet, which leaves in the direction b, at
/// t = e^{-i pi b/a} (Milne-Thomson, Theoretical Hydrodynamics, ch. XI, and Lamb, Hydrodynamics, art. 76, have the
/// plate). On the face t = -s, with the speed s^m U, m = a/pi, at the distance
///   x(s) = H/pi (1 - c) int_0^s r^{-m} (1 - r) / ((1 + r) (1 + 2 c r + r^2)) dr,  c = cos(pi b/a),
/// from the edge; x(1) = L gives b. Of infinite faces b = a.
class AnalyticWedge {
 public:
  /// Width H [m], speed U [m/s], density [kg/m^3], half-angle a [rad], 0 < a < pi, length L of a face [m].
  /// Throws std::invalid_argument.
  AnalyticWedge(double width, double speed, double density, double half_angle, double face_length);

  /// The angle b that each half of the jet turns by [rad].
  double turn() const { return turn_; }

  /// Force along the jet per unit depth, rho U^2 H (1 - cos b) [N/m].
  double force() const { return force_; }

  /// Pressure on a face at a distance from the edge [Pa]; to 1e-5 of rho U^2 / 2.
  double pressure(double distance) const;

 private:
  std::vector<double> log_distance_;  // ln x of points of the face, rising
  std::vector<double> log_speed_;     // ln s there
  double dynamic_pressure_ = 0.0, exponent_ = 0.0, turn_ = 0.0, force_ = 0.0;
};

}  // namespace impinge
