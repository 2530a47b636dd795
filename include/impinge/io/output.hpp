#pragma once
// All files of a run together.

#include <mpi.h>

#include <cstdint>
#include <optional>
#include <string>

#include "impinge/io/run_directory.hpp"
#include "impinge/io/series.hpp"
#include "impinge/io/snapshot.hpp"
#include "impinge/io/table_file.hpp"
#include "impinge/method/simulation.hpp"

namespace impinge {

/// Writes into the case's output directory:
///   <name>_<step>.vtkhdf   snapshots
///   <name>.xmf             XDMF, the snapshots as a time series
///   <name>_history.csv     one row per step
///   <name>_<step>.checkpoint  the last two checkpoints
/// A new run removes snapshots and checkpoints of an earlier one of the same name; a restarted one those after the step
/// that it goes on from, and cuts the history there.
class Output {
 public:
  /// The directory exists. `restart_step`: of the checkpoint that the run goes on from. Collective. Throws FileError.
  Output(MPI_Comm comm, RunFiles files, std::optional<std::int64_t> restart_step = {});

  /// How many files of an earlier run were removed.
  int removed() const { return removed_; }

  /// Appends a row to the history. `seconds`: wall-clock time of the step. The next save throws what went wrong. Not
  /// collective.
  void record(const StepReport& report, double seconds);

  /// Writes a snapshot and puts it into the time series. Returns its path. Collective; throws FileError.
  template <int Dim>
  std::string save(const Simulation<Dim>& simulation, const std::string& status, const std::string& message = "");

  /// Writes a checkpoint, then removes all but the last two. Returns its path. Collective; throws FileError.
  template <int Dim>
  std::string save_checkpoint(const Simulation<Dim>& simulation);

 private:
  void start();
  void go_on(std::int64_t step);
  template <int Dim>
  SnapshotHeader header(const Simulation<Dim>& simulation, const std::string& status, const std::string& message) const;

  MPI_Comm comm_;
  RunFiles files_;
  int removed_ = 0;
  TableFile history_;  // open on rank 0
  Series series_;
};

}  // namespace impinge
