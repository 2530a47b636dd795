#pragma once
// The files of a run: snapshots, the time series for ParaView and VisIt, the history.

#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "impinge/io/snapshot.hpp"
#include "impinge/method/simulation.hpp"
#include "impinge/programs/case.hpp"

namespace impinge {

/// Writes below the case's output directory:
///   <name>_<step>.vtkhdf   snapshots
///   <name>.xmf             XDMF, the snapshots as a time series
///   <name>_history.csv     one line per step
///   <name>_<step>.checkpoint  the last two checkpoints
/// A new run removes snapshots and checkpoints of an earlier one of the same name; a restarted one those after the step
/// that it goes on from, and cuts the history there.
class Output {
 public:
  /// `restart_step`: of the checkpoint that the run goes on from. Collective. Throws InputError where the directory is
  /// not writable, FileError.
  Output(MPI_Comm comm, const Case& config, std::optional<std::int64_t> restart_step = {});

  /// How many files of an earlier run were removed.
  int removed() const { return removed_; }

  /// Appends a line to the history. `seconds`: wall-clock time of the step. A failure is told by the next save. Not
  /// collective.
  void record(const StepReport& report, double seconds);

  /// Writes a snapshot and puts it into the time series. Returns its path. Collective; throws FileError.
  template <int Dim>
  std::string save(const Simulation<Dim>& simulation, const std::string& status, const std::string& message = "");

  /// Writes a checkpoint, then removes all but the last two. Returns its path. Collective; throws FileError.
  template <int Dim>
  std::string save_checkpoint(const Simulation<Dim>& simulation);

 private:
  struct SeriesEntry {
    std::string file;
    double time;
    std::int64_t particles;
  };

  void start();
  void go_on(std::int64_t step);
  void open_history(std::ios::openmode mode);
  template <int Dim>
  SnapshotHeader header(const Simulation<Dim>& simulation, const std::string& status, const std::string& message) const;

  std::string history_path() const;
  std::string history_failure() const;  // nothing if all is well
  std::string write_series() const;     // likewise

  MPI_Comm comm_;
  std::string directory_;
  std::string name_;
  std::string case_text_;
  int removed_ = 0;
  std::ofstream history_;       // open on rank 0
  std::string history_reason_;  // why it could not be written
  std::vector<SeriesEntry> series_;
};

}  // namespace impinge
