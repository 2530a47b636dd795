#pragma once
// The report on a run with a jet: the files in its directory against the exact solution.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "impinge/io/snapshot.hpp"
#include "impinge/validation/jet_comparison.hpp"
#include "impinge/validation/round_jet_comparison.hpp"

namespace impinge {

/// A span of time [s].
struct TimeSpan {
  double begin, end;
};

/// Which snapshots are compared [s]. Without either bound: those within the window of the wall-pressure average; if
/// there is no such window, the last snapshot alone.
struct SnapshotSelection {
  std::optional<double> from, to;
};

/// What is found out about a run.
struct Validation {
  Case config;          ///< the case as the last snapshot has it
  SnapshotHeader last;  ///< of the last snapshot
  std::string last_path;
  JetTarget target;                      ///< what the jet meets; of two jets through the stagnation point that is found
  double force = 0.0;                    ///< that metrics.force_ratio refers to [N/m]; of a round jet [N]
  std::vector<std::string> differences;  ///< what acts on the run and not on the analytic jet, with its strength
  std::optional<TimeSpan> window;        ///< of the wall-pressure average
  std::vector<double> times;             ///< of the compared snapshots [s]
  JetMetrics metrics;
  /// Fluid particles in (those of the start included) minus out minus stored, by the history's last line; stored are
  /// those of the last snapshot where it is of the same step. 0 unless particles are lost or made. Empty without a
  /// history.
  std::optional<std::int64_t> particle_balance;
  std::vector<PlatePoint> wall;
  std::vector<FilmColumn> film;
  std::vector<WallMapPoint> wall_map;                        ///< of a round jet
  std::optional<double> analytic_film_h1, analytic_film_h2;  ///< film_h1, film_h2 of the analytic jet [-]
};

/// Reads the run in a directory, which may have failed, and compares it. Wall averages are those of the last snapshot
/// that has one. Needs MPI (the HDF5 library is the parallel one) but is not collective. Throws InputError where there
/// is no directory, no snapshot, a case without a jet_target, more than one case, or no snapshot in the selection;
/// FileError where a file cannot be read.
Validation validate(const std::string& directory, const SnapshotSelection& selection = {});

/// The report as JSON; empty values are null.
std::string to_json(const Validation& validation);

/// The report as a table for the terminal; empty values are "-".
std::string to_table(const Validation& validation);

/// Writes into `directory`, which it creates: validation.json, the profiles wall_pressure.csv and film_thickness.csv,
/// the analytic jet of a plate or of two jets as lines, surface.csv and isobars.csv, and of a round jet the averaged
/// pressure at all wall particles, wall_map.csv. Throws FileError.
void write_report(const Validation& validation, const std::string& directory);

}  // namespace impinge
