#pragma once
// All files of a run together.

#include <mpi.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "impinge/io/run_directory.hpp"
#include "impinge/io/run_lock.hpp"
#include "impinge/io/series.hpp"
#include "impinge/io/snapshot.hpp"
#include "impinge/io/table_file.hpp"
#include "impinge/method/simulation.hpp"
#include "impinge/observe/observers.hpp"

namespace impinge {

/// Writes into the case's output directory:
///   <name>_<step>.vtkhdf   snapshots
///   <name>.xmf             XDMF, the snapshots as a time series
///   <name>.vtkhdf.series   ParaView's file series, the same
///   <name>_history.csv     one row per step
///   <name>_probes.csv, _gauges.csv, _sections.csv, _forces.csv, _outlets.csv  what is observed
///   <name>_<step>.checkpoint  the last two checkpoints
///   <name>.lock            who writes them, while the run lasts
/// A new run moves the files of an earlier one of the same name into a folder of their own; a restarted one removes
/// those after the step that it goes on from, and cuts the tables there.
class Output {
 public:
  /// The directory exists. `observed`: the headers of the tables besides the history. `restart_step`: of the checkpoint
  /// that the run goes on from. Collective. Throws FileError, InputError where another process writes this run.
  Output(MPI_Comm comm, RunFiles files, const std::vector<TableLine>& observed = {},
         std::optional<std::int64_t> restart_step = {});

  /// The folder that the files of an earlier run were moved to; empty if there were none. On rank 0.
  const std::string& set_aside() const { return set_aside_; }

  /// Appends a row to the history. `seconds`: wall-clock time of the step. The next save throws what went wrong. Not
  /// collective.
  void record(const StepReport& report, double seconds);

  /// Appends rows to the tables of what is observed, likewise.
  void record(const std::vector<TableLine>& rows);

  /// The last row before the step of the restart of such a table; empty if there is none. Collective.
  std::string last_row(const std::string& kind) const;

  /// Writes a snapshot and puts it into the time series. Returns its path. Collective; throws FileError.
  template <int Dim>
  std::string save(const Simulation<Dim>& simulation, const std::string& status, const std::string& message = "");

  /// Writes a checkpoint, then removes all but the last two. Returns its path. Collective; throws FileError.
  template <int Dim>
  std::string save_checkpoint(const Simulation<Dim>& simulation);

 private:
  void start();
  void go_on(std::int64_t step);
  void check_tables() const;
  template <int Dim>
  SnapshotHeader header(const Simulation<Dim>& simulation, const std::string& status, const std::string& message) const;

  MPI_Comm comm_;
  RunFiles files_;
  RunLock lock_;  // on rank 0
  std::string set_aside_;
  TableFile history_;                                      // open on rank 0
  std::vector<std::pair<std::string, TableFile>> tables_;  // likewise, each with its kind
  Series series_;
};

}  // namespace impinge
