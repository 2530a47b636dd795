#pragma once
// How far a computed round jet on a flat wall is from the exact one.

#include <optional>
#include <utility>
#include <vector>

#include "impinge/particles/particles.hpp"
#include "impinge/validation/jet_comparison.hpp"
#include "impinge/validation/jet_target.hpp"
#include "impinge/validation/round_jet.hpp"

namespace impinge {

/// True where a jet meets a flat wall at 90 degrees.
bool is_perpendicular(const JetTarget& target);

/// Time-averaged pressure at a wall particle, in the frame of the wall.
struct WallMapPoint {
  double x, y;      ///< [m]
  double pressure;  ///< [Pa]
};

/// Compares a round jet with what is exact of it, snapshot by snapshot; see JetMetrics. D = 2 R: diameter, a: angle
/// between jet and wall, r and psi: distance and azimuth about SpacePlate::origin.
///
/// At 90 degrees wall pressure and film are those of RoundJet. At other angles exact are the force rho U^2 A sin a, the
/// centre of pressure at the foot of the jet's axis (by the moment of momentum), the largest pressure, and the film's
/// flux and momentum; film_law is approximate. Of force and moment SpacePlate::force_beyond, moment_beyond are taken
/// off. With s = r over the distance of the footprint, flux and momentum are those through the curves of constant s, in
/// the mean of 2.25 < s < 2.75: the sums of V u.grad(s) and V u_x u.grad(s) over the particles there, of the volume V =
/// dp^3, over the width of that range.
class RoundJetComparison {
 public:
  explicit RoundJetComparison(const JetTarget& target);

  /// Takes the time-averaged wall pressure, pressure_impulse / duration [s], from the wall particles. To be called
  /// before the snapshots are added: at other angles than 90 degrees the largest pressure is the stagnation point.
  void set_wall_average(const Particles<3>& particles, double duration);

  /// Adds a snapshot's owned particles, as they stand in space.
  void add_snapshot(const Particles<3>& particles);

  JetMetrics metrics() const;

  /// Means over the wall particles in bins of width dp, by x: at 90 degrees over rings, x = r; else over y within dp of
  /// the incline's axis. Empty without an average.
  std::vector<PlatePoint> wall_profile() const;

  /// The average at each wall particle.
  const std::vector<WallMapPoint>& wall_map() const { return map_; }

  /// At 90 degrees the film in rings of 2 dp, x = r [m]. Else its mean thickness in the sectors of the ring, x = psi
  /// [rad], beside that of film_law in the middle of the ring. Empty without a snapshot of finite numbers.
  std::vector<FilmColumn> film_profile() const;

  /// Force that JetMetrics::force_ratio refers to, rho U^2 A (sin a - force_beyond) [N].
  double force() const;

 private:
  /// Part of the film, and the fluid particles met there.
  struct Ring {
    double begin, end;  // [m]
    double count = 0.0;
  };
  /// The ring 2.25 < s < 2.75 between two azimuths, and sums over its particles.
  struct Sector {
    double depth = 0.0;  // of 1 over the width of the ring [1/m]
    double flux = 0.0;   // of u.grad(s) over the range of s [1/s]
  };

  void find_peak();
  double thickness(const Ring& ring) const;
  double exact_thickness(const Ring& ring) const;
  std::optional<double> film_ratio(const Ring& ring) const;
  double middle_of_ring(double azimuth) const;
  bool is_of_jet(const Vector<3>& place) const;
  void add_film(const Vector<3>& place, const Vector<3>& velocity);

  JetTarget target_;
  double radius_;
  RoundJet jet_;  // its wall pressure and film count at 90 degrees only
  std::vector<WallMapPoint> map_;
  std::vector<double> areas_;                            // of the points of map_ [m^2]
  std::optional<std::pair<double, double>> stagnation_;  // place of the stagnation pressure [m]
  std::optional<double> largest_;                        // average within dp of a place [Pa]
  std::pair<double, double> peak_{};                     // its place [m]
  std::vector<double> pressure_, force_ratio_;           // one per snapshot [Pa], [-]
  int snapshots_ = 0;
  bool finite_ = true;  // every number of the fluid so far
  std::vector<Ring> rings_;
  Ring at_d_, at_1_5_d_;
  std::vector<Sector> sectors_;
  double momentum_ = 0.0;  // sum of u_x u.grad(s) over the range of s [m/s^2]
};

}  // namespace impinge
