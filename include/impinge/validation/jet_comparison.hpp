#pragma once
// How far a computed jet is from the analytic one.

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "impinge/cases/case.hpp"
#include "impinge/particles/particles.hpp"
#include "impinge/scenes/analytic_jet.hpp"

namespace impinge {

/// The analytic jet of a jet case. Throws std::invalid_argument.
AnalyticJet analytic_jet(const Case& config);

/// Measures of a run. H: jet width, U: speed, dp: particle spacing, p_a: analytic pressure. "Particles" are the fluid
/// particles with -2 H <= x <= 4 H in all compared snapshots; outside the analytic fluid p_a = 0. An empty value: the
/// run does not give it, or a number that it needs is not finite.
struct JetMetrics {
  /// sqrt(sum (p - p_a)^2 / sum p_a^2) [-] over the wall particles with p_a > 1e-3 rho U^2 / 2; p: time average.
  std::optional<double> wall_l2;
  /// dp sum p over the wall particles / rho U^2 H sin a [-]; p: time average.
  std::optional<double> force_ratio;
  /// Largest time-averaged wall pressure [Pa] and its place, from the stagnation point [m].
  std::optional<double> peak_pressure, peak_x;
  /// Pressure of the wall particles within dp of the stagnation point: mean and standard deviation over the snapshots
  /// [Pa].
  std::optional<double> stagnation_mean, stagnation_scatter;
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
  /// Particles of the jet that passes over the sheet are left out.
  std::optional<double> film_h1, film_h2;
};

/// Time-averaged pressure at a wall particle.
struct PlatePoint {
  double x;         ///< [m]
  double pressure;  ///< [Pa]
  double analytic;  ///< [Pa]
};

/// The film on a short piece of the plate.
struct FilmColumn {
  double x;          ///< middle [m]
  double thickness;  ///< mean over the snapshots [m]
  double analytic;   ///< [m]
};

/// Compares wall and particles of a two-dimensional jet case with the analytic jet, snapshot by snapshot.
class JetComparison {
 public:
  /// `config` is a jet case. Throws std::invalid_argument.
  explicit JetComparison(const Case& config);

  /// Takes the time-averaged wall pressure, pressure_impulse / duration [s], from the wall particles.
  void set_wall_average(const Particles<2>& particles, double duration);

  /// Adds a snapshot's owned particles to the comparison.
  void add_snapshot(const Particles<2>& particles);

  JetMetrics metrics() const;

  /// In ascending x; empty without an average.
  std::vector<PlatePoint> wall_profile() const { return wall_; }

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
  Columns plate_, h1_, h2_;
  std::vector<PlatePoint> wall_;

  int snapshots_ = 0;
  bool finite_ = true;                             // every number of the fluid so far
  std::vector<double> stagnation_;                 // [Pa], one per snapshot
  double field_l2_ = 0.0;                          // sum over the snapshots
  double particles_ = 0.0, velocity_error_ = 0.0;  // number and sum of squares
  double surface_ = 0.0, surface_error_ = 0.0;     // number and sum of squares
  std::map<std::pair<double, double>, Bin> bins_;  // by floor(position / dp)
};

}  // namespace impinge
