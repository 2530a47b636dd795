#pragma once
// The file of a checkpoint: a snapshot with checksums and a group /checkpoint beside /VTKHDF.

#include <mpi.h>

#include <string>

#include "impinge/io/snapshot.hpp"
#include "impinge/method/checkpoint.hpp"

namespace impinge {

/// Writes a checkpoint. It is on the disk under its name when this returns. Collective; throws FileError on all ranks.
template <int Dim>
void write_checkpoint(MPI_Comm comm, const std::string& path, const Checkpoint<Dim>& state,
                      const SnapshotHeader& header);

/// Reads a checkpoint: on as many ranks as wrote it each one's own part, on others equal shares of the particles in the
/// order of the file. Throws FileError on all ranks, also where a checksum does not match. Collective.
template <int Dim>
Checkpoint<Dim> read_checkpoint(MPI_Comm comm, const std::string& path);

}  // namespace impinge
