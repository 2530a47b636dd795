// Fuzzes the reader of snapshots: whatever the bytes, it gives a state or an OutputError, and leaves no HDF5 object
// open.

#include <hdf5.h>
#include <mpi.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "fuzz_directory.hpp"
#include "impinge/snapshot.hpp"

namespace {

using namespace impinge;

template <class Read>
void expect_state_or_error(Read read) {
  try {
    read();
  } catch (const OutputError&) {
  }
  if (H5Fget_obj_count(H5F_OBJ_ALL, H5F_OBJ_ALL) == 0) return;
  std::fprintf(stderr, "HDF5 objects are left open\n");
  std::abort();
}

template <int Dim>
void read(const std::string& path) {
  expect_state_or_error([&] {
    Particles<Dim> particles;
    read_snapshot(MPI_COMM_SELF, path, particles);
    if (particles.size() == particles.owned) return;
    std::fprintf(stderr, "%d particles, but %d owned ones\n", particles.size(), particles.owned);
    std::abort();
  });
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 1);  // no daemon beside the fuzzer
  setenv("OMPI_MCA_opal_signal", "", 1);              // crashes are the fuzzer's
  MPI_Init(argc, argv);
  std::atexit([] { MPI_Finalize(); });
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const FuzzDirectory directory;
  const std::string path = directory.path() / "fuzz_00000000.vtkhdf";
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  expect_state_or_error([&] { read_header(path); });
  read<2>(path);
  read<3>(path);
  return 0;
}
