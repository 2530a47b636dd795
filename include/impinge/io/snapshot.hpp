#pragma once
// One HDF5 file per snapshot, in the VTKHDF layout (UnstructuredGrid of vertices, one piece per rank), so that ParaView
// opens it as it is.

#include <mpi.h>

#include <string>
#include <vector>

#include "impinge/core/errors.hpp"
#include "impinge/method/checkpoint.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

/// The root attributes of a snapshot.
struct SnapshotHeader {
  int dimension = 2;
  std::int64_t step = 0;
  double time = 0.0;          ///< [s]
  double dt = 0.0;            ///< of the last step [s]
  double window_begin = 0.0;  ///< the wall pressure is averaged from here ... [s]
  double window_end = 0.0;    ///< ... to here; equal: no average yet [s]
  std::string status;         ///< "running", "finished" or "failed"
  std::string message;        ///< why it failed
  std::string case_text;      ///< the resolved case, TOML
  std::string code_version;   ///< set by the reader; the writer puts in its own
};

/// Keeps HDF5 from trying again in MPI_Finalize and at the exit to close what it could not write: it crashes there. To
/// be called before MPI_Init.
void leave_files_to_their_owners();

/// `<directory>/<name>_<step, 8 digits>.vtkhdf`.
std::string snapshot_path(const std::string& directory, const std::string& name, std::int64_t step);

/// Snapshots in a directory, ordered by step: those of the case `name`, or all if it is empty. Throws FileError where
/// the directory cannot be read. Not collective.
std::vector<std::string> list_snapshots(const std::string& directory, const std::string& name = "");

/// `<directory>/<name>_<step, 8 digits>.checkpoint`, and likewise those in a directory.
std::string checkpoint_path(const std::string& directory, const std::string& name, std::int64_t step);
std::vector<std::string> list_checkpoints(const std::string& directory, const std::string& name = "");

/// Snapshots and checkpoints of the case `name` whose writing was broken off. Otherwise as list_snapshots.
std::vector<std::string> list_partial_files(const std::string& directory, const std::string& name);

/// Case name and step in the name of a snapshot or checkpoint. Throws FileError for other names. Not collective.
std::pair<std::string, std::int64_t> name_and_step(const std::string& path);

/// Writes the owned particles of all ranks, the time-averaged pressure of the wall (/wall) and the header. The file
/// appears under its name when it is complete. Collective; throws FileError on all ranks.
template <int Dim>
void write_snapshot(MPI_Comm comm, const std::string& path, const Particles<Dim>& particles,
                    const SnapshotHeader& header);

/// Forces a file or directory to the disk. Returns why it could not; nothing if all is well. Not collective.
std::string synchronise(const std::string& path);

/// Reads the header alone. Not collective; throws FileError.
SnapshotHeader read_header(const std::string& path);

/// How many particles a snapshot has. Not collective; throws FileError.
std::int64_t count_particles(const std::string& path);

/// Reads the header and this rank's share of the particles: equal runs in the order of the file, all of them owned; all
/// fields but `rank` come back. Throws FileError on all ranks, also where the file's dimension is not Dim.
/// Collective.
template <int Dim>
SnapshotHeader read_snapshot(MPI_Comm comm, const std::string& path, Particles<Dim>& particles);

/// Writes a checkpoint: a snapshot with checksums and a group /checkpoint beside /VTKHDF. It is on the disk under its
/// name when this returns. Collective; throws FileError on all ranks.
template <int Dim>
void write_checkpoint(MPI_Comm comm, const std::string& path, const Checkpoint<Dim>& state,
                      const SnapshotHeader& header);

/// Reads a checkpoint: on as many ranks as wrote it each one's own part, on others equal shares of the particles in the
/// order of the file. Throws FileError on all ranks, also where a checksum does not match. Collective.
template <int Dim>
Checkpoint<Dim> read_checkpoint(MPI_Comm comm, const std::string& path);

}  // namespace impinge
