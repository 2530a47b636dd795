#pragma once
// Where one rank cannot write a file that several ranks are writing, the others wait for it inside HDF5 for ever. A
// program that links io/mpi_io_guard.cpp ends the job in that case: the guard stands in for the MPI-IO functions that
// write. The library itself does not contain the guard.

#include <mpi.h>

#include <string>
#include <utility>

namespace impinge {

/// The file that the ranks of a communicator are writing together, from construction to destruction. One at a time.
class SharedFile {
 public:
  SharedFile(MPI_Comm comm, std::string path) : comm_(comm), path_(std::move(path)) { current_ = this; }
  ~SharedFile() { current_ = nullptr; }
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;

  MPI_Comm comm() const { return comm_; }
  const std::string& path() const { return path_; }

  /// nullptr while there is none.
  static const SharedFile* current() { return current_; }

 private:
  inline static const SharedFile* current_ = nullptr;

  MPI_Comm comm_;
  std::string path_;
};

}  // namespace impinge
