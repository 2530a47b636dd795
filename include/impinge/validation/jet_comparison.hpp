#pragma once
// How far a computed jet is from the analytic one.

#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "impinge/particles/particles.hpp"
#include "impinge/scenes/analytic_jet.hpp"
#include "impinge/validation/analytic_wedge.hpp"
#include "impinge/validation/jet_target.hpp"

namespace impinge {

/// The analytic jet on a plate, or of one of two jets. Throws std::invalid_argument.
AnalyticJet analytic_jet(const JetTarget& target);

/// Measures of a run. H: jet width, U: speed, dp: particle spacing, p_a: analytic pressure. "Particles" are the fluid
/// particles with -2 H <= x <= 4 H, and at least 2 dp before the ends of the wall, in all compared snapshots; outside
/// the analytic fluid p_a = 0. A slot jet is measured in the plane, by space_target's in_frame. An empty value: the run
/// does not give it, there is no exact solution for it, or a number that it needs is not finite. Between two jets the
/// wall particles are those of in_frame, and a time average is that over the snapshots.
struct JetMetrics {
  /// sqrt(sum (p - p_a)^2 l / sum p_a^2 l) [-] over the wall particles with p_a > 1e-3 rho U^2 / 2; p: time average, l:
  /// length of wall that a particle stands for, dp on a plate.
  /// Of a round jet l is an area; near: r < 1.5 R.
  std::optional<double> wall_l2, wall_l2_near;
  /// Sum of p l over the wall particles / exact force [-]; p: time average. The force is that normal to a plate, rho
  /// U^2 H sin a or, of a round jet of section A, rho U^2 A sin a, or that along the jet, rho U^2 H (1 - cos b), with
  /// the angle b that a wedge or a cup turns the jet by.
  std::optional<double> force_ratio;
  /// Standard deviation over the snapshots of the same ratio at their times [-].
  std::optional<double> force_scatter;
  /// Largest time-averaged wall pressure [Pa] and its place, from the stagnation point [m]. Of a round jet the pressure
  /// is the mean over the wall particles within dp of a place.
  std::optional<double> peak_pressure, peak_x;
  /// Pressure of the wall particles within dp of the stagnation point: mean and standard deviation over the snapshots
  /// [Pa], and mean over rho U^2 / 2 [-]. Of an oblique round jet the place is that of peak_pressure.
  std::optional<double> stagnation_mean, stagnation_scatter, stagnation_ratio;
  /// Of a round jet: the centre of pressure on the wall, of the time average, from the foot of the jet's axis, along
  /// the incline and across it, over the diameter [-].
  std::optional<double> centre_x, centre_y;
  /// sqrt(sum (p - p_a)^2 / sum p_a^2) [-] over the particles of one snapshot; mean over the snapshots.
  std::optional<double> field_l2;
  /// The same of time averages: p and p_a are averaged over all snapshots' particles in a square bin of edge dp, and
  /// bins count by their number of particles [-].
  std::optional<double> mean_field_l2;
  /// sqrt(mean |u - u_a|^2) / U [-] over the particles; outside the analytic fluid u_a is that of the nearest point of
  /// the free surface.
  std::optional<double> velocity_rms;
  /// sqrt(mean (d - dp/2)^2) / dp [-] over all particles flagged as free surface, splash and voids too; d: depth below
  /// the analytic free surface.
  std::optional<double> surface_rms_dp;
  /// Film thickness over the sheets' far thickness h1, h2 [-]: number of fluid particles x dp^2 per length of plate,
  /// mean over the snapshots, from 1.5 H to 3 H and from 0.5 H to 1 H beyond the h2 side's Cp = 0.01; cut to the plate.
  /// Particles of the jet that passes over the sheet are left out. On a wedge and in a cup h1 = h2 = H/2, and the
  /// particles are those up to H above JetTarget::sheets.
  std::optional<double> film_h1, film_h2;
  /// Film of a round jet at 90 degrees over the exact one in the rings D - dp < r < D + dp and 1.5 D - dp < r < 1.5 D +
  /// dp
  /// [-]: volume of the fluid particles over area, mean over the snapshots.
  std::optional<double> film_at_d, film_at_1_5_d;
  /// Of the film of a round jet: flux over that of the jet, and at other angles than 90 degrees momentum flux along the
  /// incline over rho U^2 A cos a, mean over the snapshots; and the RMS distance over the azimuth of thickness times
  /// radius from film_law, over its mean R^2 / 2 [-]. See RoundJetComparison.
  std::optional<double> film_flux, film_momentum, film_law_rms;
  /// Mean velocity of the particles over a wedge's or cup's sheets, along the wall / U [-].
  std::optional<double> sheet_speed;
  /// Between two jets: the stagnation point's distance from the middle of the inlets along the first jet, mean over the
  /// snapshots [m], and the speed at which it moves, by a linear fit over the snapshots [m/s].
  std::optional<double> plane_x, plane_drift;
};

/// Time-averaged pressure at a wall particle.
struct PlatePoint {
  double x;         ///< [m]
  double pressure;  ///< [Pa]
  double analytic;  ///< [Pa]; not a number without an exact solution
};

/// The film on a short piece of the plate.
struct FilmColumn {
  double x;          ///< middle [m]
  double thickness;  ///< mean over the snapshots [m]
  double analytic;   ///< [m]
};

/// Compares the wall particles on a target with the exact pressure.
class WallComparison {
 public:
  /// `pressure` at an x [Pa]; `force` that force_ratio refers to [N/m].
  WallComparison(const JetTarget& target, double force, std::function<double(double)> pressure);

  /// Takes the time-averaged wall pressure, pressure_impulse / duration [s].
  void set_average(const Particles<2>& particles, double duration);

  void add_snapshot(const Particles<2>& particles);

  /// Sets the metrics of wall, force, peak and stagnation point.
  void measure(JetMetrics& metrics) const;

  /// In ascending x; empty without an average.
  std::vector<PlatePoint> profile() const;

 private:
  JetTarget target_;
  double force_;
  std::function<double(double)> pressure_;
  std::vector<std::pair<JetTarget::Point, double>> average_;  // in ascending x, with the pressure [Pa]
  std::vector<double> stagnation_, force_ratio_;              // [Pa], [-], one per snapshot
};

/// Compares the jet on a plate, or one of two jets, with the analytic jet, snapshot by snapshot.
class JetComparison {
 public:
  /// Throws std::invalid_argument.
  explicit JetComparison(const JetTarget& target);

  /// Takes the time-averaged wall pressure, pressure_impulse / duration [s], from the wall particles.
  void set_wall_average(const Particles<2>& particles, double duration) { wall_.set_average(particles, duration); }

  /// Adds a snapshot's owned particles, in the frame of the target (in_frame), to the comparison.
  void add_snapshot(const Particles<2>& particles);

  JetMetrics metrics() const;

  /// In ascending x; empty without an average.
  std::vector<PlatePoint> wall_profile() const { return wall_.profile(); }

  /// Columns some 2 dp wide where the analytic jet has a film on the plate; empty without a snapshot of finite numbers.
  std::vector<FilmColumn> film_profile() const;

  /// What film_h1 and film_h2 are for the analytic jet [-]: the sheets still converge where they are measured.
  std::optional<double> analytic_film(AnalyticJet::Side side) const;

 private:
  /// A stretch of the plate in equal columns, and the fluid particles met in each.
  struct Columns {
    struct Column {
      std::optional<double> analytic;  // thickness of the analytic film [m]
      double divider;                  // what is above belongs to the jet [m]
      std::int64_t count = 0;
    };
    double begin = 0.0, width = 0.0;  // [m]
    std::vector<Column> columns;
  };

  /// Sums over the particles of a bin.
  struct Bin {
    double count = 0.0, pressure = 0.0, analytic = 0.0;
  };

  Columns columns(double begin, double end) const;
  const Columns& stretch(AnalyticJet::Side side) const { return side == AnalyticJet::Side::h1 ? h1_ : h2_; }
  void count(const Vector<2>& position, Columns& stretch) const;
  std::optional<double> film_ratio(AnalyticJet::Side side) const;
  void add_field(const Particles<2>& particles);

  AnalyticJet jet_;
  double spacing_;
  double area_;  // of a particle [m^2]
  WallComparison wall_;
  double field_begin_, field_end_;  // range of x of the particles that count [m]
  Columns plate_, h1_, h2_;

  int snapshots_ = 0;
  bool finite_ = true;                             // every number of the fluid so far
  double field_l2_ = 0.0;                          // sum over the snapshots
  double particles_ = 0.0, velocity_error_ = 0.0;  // number and sum of squares
  double surface_ = 0.0, surface_error_ = 0.0;     // number and sum of squares
  std::map<std::pair<double, double>, Bin> bins_;  // by floor(position / dp)
};

/// Compares a jet that a wedge or a cup splits into halves with what is exact of it, snapshot by snapshot.
class SplitJetComparison {
 public:
  /// Throws std::invalid_argument.
  explicit SplitJetComparison(const JetTarget& target);

  /// Takes the time-averaged wall pressure, pressure_impulse / duration [s], from the wall particles.
  void set_wall_average(const Particles<2>& particles, double duration) { wall_.set_average(particles, duration); }

  /// Adds a snapshot's owned particles, as they stand in space.
  void add_snapshot(const Particles<2>& particles);

  JetMetrics metrics() const;

  /// In ascending x; empty without an average.
  std::vector<PlatePoint> wall_profile() const { return wall_.profile(); }

  /// Force along the jet, rho U^2 H (1 - cos b) [N/m].
  double force() const { return force_; }

 private:
  /// Sums over the particles of a sheet.
  struct Sum {
    double count = 0.0, speed = 0.0;
  };

  SplitJetComparison(const JetTarget& target, const std::optional<AnalyticWedge>& wedge);

  JetTarget target_;
  double force_;
  WallComparison wall_;
  int snapshots_ = 0;
  bool finite_ = true;       // every number of the fluid so far
  std::vector<Sum> sheets_;  // of target_.sheets
};

}  // namespace impinge
