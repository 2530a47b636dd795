#pragma once
// The steady round jet on a plate.

namespace impinge {

/// An inviscid, weightless jet of radius R and speed U that meets an infinite plate at a right angle. Solved by
/// jobs/round_jet.py, with ring vortices along the free surface; the table here is its result. Its errors are below
/// 2e-5; those between the points of the table, and of the thin film beyond it, below 5e-5 of rho U^2 / 2 and, from
/// 1.3 R on, of the film's thickness.
class RoundJet {
 public:
  static constexpr double film_begin = 1.2;  ///< the film's thickness is known from here on [R]

  /// Radius [m], speed [m/s], density [kg/m^3]. Throws std::invalid_argument where one is not positive.
  RoundJet(double radius, double speed, double density);

  /// Force on the plate, rho U^2 pi R^2 [N].
  double force() const;

  /// Pressure on the plate at a distance from the stagnation point [Pa].
  double wall_pressure(double distance) const;

  /// Thickness of the film at a distance from the stagnation point, at least film_begin R; far away R^2 / (2 r) [m].
  double film(double distance) const;

 private:
  double radius_, speed_, density_;
};

/// Distance over R of the edge of a round jet, continued to the plate, from the focus of that ellipse, R cot a off the
/// axis' foot: sin a / (1 - cos a cos psi), for an angle between jet and plate [rad] and an azimuth [rad].
double footprint(double angle, double azimuth);

/// Thickness times radius of a round jet's film over R^2 at an azimuth [rad], for an angle between jet and plate [rad]:
/// sin^3 a / (2 (1 - cos a cos psi)^2), about the stagnation point R cot a off the axis' foot (Hasson & Peck 1964). Its
/// flux is that of the jet and its momentum is exact for any angle; the law itself is exact at 90 degrees only.
double film_law(double angle, double azimuth);

}  // namespace impinge
