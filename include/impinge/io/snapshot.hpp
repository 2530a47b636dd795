#pragma once
// One HDF5 file per snapshot, in the VTKHDF layout, so that ParaView opens it as it is.

#include <mpi.h>

#include <cstdint>
#include <string>

#include "impinge/core/errors.hpp"
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

/// Writes the owned particles of all ranks, the time-averaged pressure of the wall (/wall) and the header. The file
/// appears under its name when it is complete. Collective; throws FileError on all ranks.
template <int Dim>
void write_snapshot(MPI_Comm comm, const std::string& path, const Particles<Dim>& particles,
                    const SnapshotHeader& header);

/// Reads the header alone, of a snapshot or a checkpoint. Not collective; throws FileError.
SnapshotHeader read_header(const std::string& path);

/// How many particles a snapshot has. Not collective; throws FileError.
std::int64_t count_particles(const std::string& path);

/// Reads the header and this rank's share of the particles: equal runs in the order of the file, all of them owned; all
/// fields but `rank` come back. Throws FileError on all ranks, also where the file's dimension is not Dim.
/// Collective.
template <int Dim>
SnapshotHeader read_snapshot(MPI_Comm comm, const std::string& path, Particles<Dim>& particles);

}  // namespace impinge
