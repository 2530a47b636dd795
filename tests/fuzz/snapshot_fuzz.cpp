// Fuzzes the reader of snapshots: whatever the file, it gives a state or an FileError, and leaves no HDF5 object
// open.
//
// Bytes that begin as an HDF5 file does are a file. Checksums refuse nearly all such files, so other bytes are a list
// of changes that HDF5 itself makes to a sound snapshot: see change().

#include <hdf5.h>
#include <mpi.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz_directory.hpp"
#include "impinge/io/snapshot.hpp"

namespace {

namespace fs = std::filesystem;
using namespace impinge;

const FuzzDirectory& directory() {
  static const FuzzDirectory one;
  return one;
}

template <class Read>
void expect_state_or_error(Read read) {
  try {
    read();
  } catch (const FileError&) {
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

/// A snapshot of seven particles.
const std::string& sound_snapshot() {
  static const std::string path = [] {
    Particles<2> particles;
    for (int k = 0; k < 7; ++k) particles.append({{{0.1 * k, 0.2}}, {{1.0, 0.0}}, 3.0, 4.0, k, ParticleType::wall});
    const std::string file = directory().path() / "sound.vtkhdf";
    write_snapshot(MPI_COMM_SELF, file, particles,
                   {.window_end = 1.0, .status = "running", .message = "", .case_text = "x = 1", .code_version = {}});
    return file;
  }();
  return path;
}

using Bytes = std::span<const std::uint8_t>;

/// The next byte; 0 at the end.
std::size_t take(Bytes& bytes) {
  if (bytes.empty()) return 0;
  const std::size_t value = bytes.front();
  bytes = bytes.subspan(1);
  return value;
}

template <class Table>
auto choose(const Table& table, Bytes& bytes) {
  return table[take(bytes) % std::size(table)];
}

/// Removes a dataset, a group or an attribute and mostly puts another into its place: bytes choose which, its type,
/// layout, number of dimensions, lengths and values.
void change(hid_t file, Bytes& bytes) {
  static constexpr const char* attributes[] = {"format_version", "dimension",  "step",   "time",    "dt",
                                               "window_begin",   "window_end", "status", "message", "case",
                                               "code_version"};
  static constexpr const char* datasets[] = {"/VTKHDF/Points",
                                             "/VTKHDF/PointData/velocity",
                                             "/VTKHDF/PointData/pressure",
                                             "/VTKHDF/PointData/pressure_impulse",
                                             "/VTKHDF/PointData/number_density",
                                             "/VTKHDF/PointData/type",
                                             "/VTKHDF/PointData/free_surface",
                                             "/VTKHDF/PointData/id",
                                             "/VTKHDF/PointData",
                                             "/VTKHDF"};
  const hid_t variable = H5Tcopy(H5T_C_S1);
  H5Tset_size(variable, H5T_VARIABLE);
  const hid_t long_text = H5Tcopy(H5T_C_S1);
  H5Tset_size(long_text, 40);
  const hid_t types[] = {H5T_NATIVE_DOUBLE, H5T_NATIVE_INT32, H5T_NATIVE_INT64, H5T_NATIVE_UINT8, H5T_NATIVE_FLOAT,
                         H5T_IEEE_F64BE,    H5T_C_S1,         long_text,        variable,         H5T_STD_REF_OBJ};
  static constexpr hsize_t lengths[] = {
      7, 3, 0, 1, 2, 6, 8, 14, 100, hsize_t{1} << 32, hsize_t{1} << 58, hsize_t{1} << 63};

  const bool attribute = take(bytes) % 2 == 0;
  const std::string name = attribute ? choose(attributes, bytes) : choose(datasets, bytes);
  if (attribute) {
    H5Adelete(file, name.c_str());
  } else {
    H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  }
  const std::size_t kind = take(bytes) % 8;
  const hid_t type = choose(types, bytes);
  std::vector<hsize_t> size(take(bytes) % 4);
  hsize_t all = 1;
  for (hsize_t& length : size) all *= length = choose(lengths, bytes);
  const hid_t space =
      size.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr);
  const std::vector<std::uint8_t> values(4096, static_cast<std::uint8_t>(take(bytes)));
  const bool writes = all <= 100 && type != variable && type != H5T_STD_REF_OBJ && space >= 0;

  if (kind == 0 || (attribute && all > 100)) {
    // Removed only.
  } else if (attribute) {
    const hid_t id = H5Acreate2(file, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT);
    if (id >= 0 && writes) H5Awrite(id, type, values.data());
    if (id >= 0) H5Aclose(id);
  } else if (kind == 1) {
    H5Lcreate_soft(choose(datasets, bytes), file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
  } else if (kind == 2) {
    const hid_t id = H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (id >= 0) H5Gclose(id);
  } else {
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_layout(properties, kind == 3 ? H5D_COMPACT : kind == 4 ? H5D_CHUNKED : H5D_CONTIGUOUS);
    if (kind == 4) H5Pset_chunk(properties, static_cast<int>(size.size()), size.data());
    const hid_t id = H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    if (id >= 0 && writes) H5Dwrite(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    if (id >= 0) H5Dclose(id);
    H5Pclose(properties);
  }
  if (space >= 0) H5Sclose(space);
  H5Tclose(long_text);
  H5Tclose(variable);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 1);  // no daemon beside the fuzzer
  setenv("OMPI_MCA_opal_signal", "", 1);              // crashes are the fuzzer's
  MPI_Init(argc, argv);
  std::atexit([] { MPI_Finalize(); });
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = directory().path() / "fuzz_00000000.vtkhdf";
  if (std::string_view(reinterpret_cast<const char*>(data), size).starts_with("\x89HDF")) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  } else {
    // By streams, which go on after libFuzzer's timer.
    std::ofstream(path, std::ios::binary) << std::ifstream(sound_snapshot(), std::ios::binary).rdbuf();
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    for (Bytes bytes(data, size); !bytes.empty();) change(file, bytes);
    H5Fclose(file);
  }
  expect_state_or_error([&] { read_header(path); });
  read<2>(path);
  read<3>(path);
  return 0;
}
