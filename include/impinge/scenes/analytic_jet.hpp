#pragma once
// The steady plane jet on a flat plate (free-streamline theory): the exact solution that runs start from and are
// measured against.

#include <array>
#include <complex>
#include <numbers>
#include <optional>
#include <vector>

#include "impinge/core/vector.hpp"

namespace impinge {

/// An inviscid, weightless jet of width H and speed U that meets an infinite plate at the angle a and splits into two
/// sheets of speed U (Milne-Thomson, Theoretical Hydrodynamics, ch. XI). Frame: plate y = 0, fluid y > 0, stagnation
/// point at the origin, incoming velocity U (cos a, -sin a); the thick sheet h1 runs to +x, the thin one h2 to -x.
/// p = 0 on the free surface. Every value is exact to rounding; functions are const and safe to call from threads.
///
/// With the hodograph variable zeta = (u - i v) / U, the fluid is the upper half of the unit disc and
///   z(zeta) = -sum_k A_k ln(1 - zeta / c_k),
/// where c_k = 1, -1, e^{ia}, e^{-ia} are the far ends of the sheets, of the jet and of the jet's mirror image, and
/// A_k = H/pi {1 + cos a, -(1 - cos a), -e^{-ia}, -e^{ia}}.
class AnalyticJet {
 public:
  /// The sheet that a piece of the plate or of the free surface belongs to.
  enum class Side { h1, h2 };

  struct State {
    Vector<2> velocity;  ///< [m/s]
    double pressure;     ///< [Pa]
  };

  /// The point of the free surface that is nearest to a given one.
  struct SurfacePoint {
    Vector<2> position;  ///< [m]
    Vector<2> velocity;  ///< [m/s], tangential, magnitude U
    double depth;        ///< distance of the given point below the free surface [m]; negative outside
  };

  /// The sheet above a point of the plate.
  struct Film {
    double top;      ///< height of the sheet's surface [m]
    double ceiling;  ///< height of the underside of the jet that passes over the sheet [m]; infinite without one
  };

  /// Width H [m], speed U [m/s], density [kg/m^3], angle a between jet and plate [rad], 0 < a <= pi/2.
  /// Throws std::invalid_argument.
  AnalyticJet(double width, double speed, double density, double angle);

  double width() const { return width_; }
  double speed() const { return speed_; }
  double density() const { return density_; }
  double angle() const { return angle_; }

  /// Far thickness of the sheet, H (1 +- cos a) / 2 [m].
  double sheet_thickness(Side side) const;

  /// Dynamic pressure of the jet, rho U^2 / 2 [Pa]: the pressure at the stagnation point.
  double stagnation_pressure() const { return 0.5 * density_ * speed_ * speed_; }

  /// Force on the plate per unit depth, rho U^2 H sin a [N/m].
  double normal_force() const;

  /// x where the straight axis of the incoming jet meets the plate [m].
  double axis_position() const;

  /// x of the resultant of the wall pressure, axis_position - H cot(a) / 2 [m].
  double centre_of_pressure() const;

  /// x on the plate where u = q U [m], -1 < q < 1. Throws std::domain_error.
  double plate_position(double q) const;

  /// u / U on the plate at x [-], the inverse of plate_position.
  double plate_speed(double x) const;

  /// Pressure on the plate at x [Pa].
  double wall_pressure(double x) const;

  /// x on the given side of the stagnation point where p / stagnation_pressure = cp [m], 0 < cp <= 1.
  /// Throws std::domain_error.
  double plate_position_of_cp(double cp, Side side) const;

  /// Point of the free surface where the velocity is U (cos theta, -sin theta) [m]: h1 side for 0 < theta < a,
  /// h2 side for a < theta < pi. Throws std::domain_error.
  Vector<2> surface_point(double theta) const;

  /// One free surface as a polyline [m], from the sheet's end to the jet's. The sheet ends at |x| = sheet_length, the
  /// jet at jet_length from the plate along the axis. Neighbouring points are at most `spacing` apart, closer
  /// where the surface bends.
  std::vector<Vector<2>> surface(Side side, double sheet_length, double jet_length, double spacing) const;

  /// The sheet above the plate at x; nothing where there is none, only the jet (0 >= x > foremost point of h2's
  /// surface, or top > H).
  std::optional<Film> film(double x) const;

  /// Whether a point lies in the fluid or on its boundary. Closed form.
  bool contains(const Vector<2>& point) const { return point[1] >= 0.0 && below_surface(point); }

  /// z(zeta) [m], for zeta in the closed upper half disc without c_k.
  Vector<2> position(std::complex<double> zeta) const;

  /// The inverse, zeta(z), by Newton's method; nothing outside the fluid. About 3 microseconds.
  std::optional<std::complex<double>> hodograph(const Vector<2>& point) const;

  /// Velocity and pressure p = rho U^2 (1 - |zeta|^2) / 2 at a point; nothing outside the fluid.
  std::optional<State> state(const Vector<2>& point) const;

  /// Nearest point of the two free surfaces (the plate does not count).
  SurfacePoint nearest_surface(const Vector<2>& point) const;

 private:
  using Complex = std::complex<double>;

  /// One logarithm of z(zeta).
  struct End {
    Complex location;  // c_k [-]
    Complex strength;  // A_k [m]
    Complex offset;    // z ~ strength omega + offset far out, omega = -ln(1 - zeta / c_k) [m]
  };

  /// zeta, seen from the far end k: zeta = c_k (1 - e^{-omega}). Exact however close zeta is to c_k.
  struct Hodograph {
    int end;
    Complex omega;
  };

  /// A tabulated pair, start of Newton's method.
  struct Sample {
    Complex zeta, position;
  };

  Complex zeta(const Hodograph& at) const;
  Complex position(const Hodograph& at) const;
  Complex derivative(const Hodograph& at) const;
  Hodograph nearest_end(Complex zeta) const;
  Hodograph start(Complex z) const;
  Hodograph solve(Complex z) const;
  double pressure_coefficient(const Hodograph& at) const;

  /// A free surface by its height above the far sheet, k = pi (y - h) / (H sin a), with k = ln(1 + e^tau): tau is
  /// proportional to the length both in the sheet (tau -> -inf) and in the jet (tau -> inf).
  Vector<2> surface_at(Side side, double k, Vector<2>* velocity = nullptr) const;
  double surface_parameter(Side side, double theta) const;
  double foremost_tau(Side side) const;
  bool below_surface(const Vector<2>& point) const;

  double width_, speed_, density_, angle_, sin_, cos_;
  std::array<End, 4> ends_;
  std::vector<Sample> samples_;
  std::array<std::vector<Vector<2>>, 2> outline_;  // the two free surfaces at equidistant tau
};

}  // namespace impinge
