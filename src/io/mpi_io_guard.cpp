#include "impinge/io/mpi_io_guard.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "impinge/core/mpi.hpp"

namespace impinge {
namespace {

/// Ends the job where a call that writes the shared file failed on this rank. The system gives no reason where it
/// writes a part of what it was given.
int end_job_unless(bool done, int code) {
  const SharedFile* file = SharedFile::current();
  if (done || file == nullptr) return code;
  const int reason = errno;
  fmt::print(stderr, "impinge: rank {}: cannot write {}: {}\n", rank_of(file->comm()), file->path(),
             reason != 0           ? std::strerror(reason)
             : code == MPI_SUCCESS ? "no space left on device, or beyond the limit of a file's size"
                                   : "MPI-IO failed");
  std::fflush(nullptr);
  MPI_Abort(file->comm(), 1);
  return code;
}

/// Whether a write has written all of it.
bool is_whole(int code, MPI_Status* status, int count, MPI_Datatype type) {
  int size = 0;
  MPI_Count written = 0;
  PMPI_Type_size(type, &size);
  if (code == MPI_SUCCESS) PMPI_Get_elements_x(status, MPI_BYTE, &written);
  return code == MPI_SUCCESS && written == static_cast<MPI_Count>(count) * size;
}

}  // namespace
}  // namespace impinge

// HDF5 calls these by MPI's profiling interface.
extern "C" {

int MPI_File_write_at(MPI_File file, MPI_Offset offset, const void* data, int count, MPI_Datatype type,
                      MPI_Status* status) {
  errno = 0;
  const int code = PMPI_File_write_at(file, offset, data, count, type, status);
  return impinge::end_job_unless(impinge::is_whole(code, status, count, type), code);
}

int MPI_File_write_at_all(MPI_File file, MPI_Offset offset, const void* data, int count, MPI_Datatype type,
                          MPI_Status* status) {
  errno = 0;
  const int code = PMPI_File_write_at_all(file, offset, data, count, type, status);
  return impinge::end_job_unless(impinge::is_whole(code, status, count, type), code);
}

int MPI_File_set_size(MPI_File file, MPI_Offset size) {
  errno = 0;
  const int code = PMPI_File_set_size(file, size);
  return impinge::end_job_unless(code == MPI_SUCCESS, code);
}

int MPI_File_sync(MPI_File file) {
  errno = 0;
  const int code = PMPI_File_sync(file);
  return impinge::end_job_unless(code == MPI_SUCCESS, code);
}

}  // extern "C"
