#include "impinge/io/hdf5_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "impinge/io/run_directory.hpp"
#include "impinge/io/together.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;

constexpr const char* checksum_name = "checksum";

using Group = Hdf5Handle<H5Gclose>;
using Dataset = Hdf5Handle<H5Dclose>;
using Dataspace = Hdf5Handle<H5Sclose>;
using Datatype = Hdf5Handle<H5Tclose>;
using Attribute = Hdf5Handle<H5Aclose>;
using Properties = Hdf5Handle<H5Pclose>;

template <class T>
hid_t native_type() {
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
  if constexpr (std::is_same_v<T, std::int32_t>) return H5T_NATIVE_INT32;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_NATIVE_UINT8;
}

/// The deepest entry of HDF5's error stack.
std::string hdf5_reason() {
  std::string reason;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned depth, const H5E_error2_t* error, void* text) -> herr_t {
        if (depth == 0 && error->desc) *static_cast<std::string*>(text) = error->desc;
        return 0;
      },
      &reason);
  return reason.empty() ? "HDF5 failed" : reason;
}

/// Part that values [first, first + size) of a dataset have in its checksum: a sum over all values, whoever has them,
/// of their bits mixed with their place (the finaliser of splitmix64).
template <class T>
std::uint64_t checksum(std::int64_t first, const std::vector<T>& values) {
  std::uint64_t sum = 0;
  auto place = static_cast<std::uint64_t>(first);
  for (const T& value : values) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof value);
    bits += 0x9e3779b97f4a7c15 * ++place;
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111eb;
    sum += bits ^ (bits >> 31);
  }
  return sum;
}

std::int64_t sum_of_checksums(MPI_Comm comm, std::uint64_t own) {
  MPI_Allreduce(MPI_IN_PLACE, &own, 1, MPI_UINT64_T, MPI_SUM, comm);
  return static_cast<std::int64_t>(own);
}

}  // namespace

// HDF5 closes its files in MPI_Finalize where it found MPI initialised, and would try again there to close what it
// could not write: it crashes. Open MPI's component of shared file pointers, which HDF5 does not use, copies a file's
// path into 256 characters and more; the one that is chosen here has no such buffer.
void prepare_file_access() {
  setenv("OMPI_MCA_sharedfp", "individual", 0);
  H5dont_atexit();
  H5open();
}

std::string hdf5_version() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return fmt::format("{}.{}.{}", major, minor, release);
}

QuietHdf5::QuietHdf5() {
  H5dont_atexit();  // every file is closed here; what HDF5 itself keeps of a damaged one it cannot close at the exit
  H5open();
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

QuietHdf5::~QuietHdf5() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

Hdf5Writer::Hdf5Writer(MPI_Comm comm, std::string path, bool checked)
    : comm_(comm), path_(std::move(path)), partial_(partial_path(path_)), checked_(checked) {
  const Properties access(H5Pcreate(H5P_FILE_ACCESS));
  keep(H5Pset_fapl_mpio(access, comm, MPI_INFO_NULL));
  keep(H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18));  // its metadata have checksums
  file_ = Hdf5Handle<H5Fclose>(keep(H5Fcreate(partial_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access)));
  throw_together(comm, message());
  if (ranks_of(comm) > 1) shared_.emplace(comm, path_);
  transfer_ = Properties(H5Pcreate(H5P_DATASET_XFER));
  keep(H5Pset_dxpl_mpio(transfer_, H5FD_MPIO_COLLECTIVE));
}

void Hdf5Writer::create_group(const std::string& name) {
  const Group group(keep(H5Gcreate2(file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)));
}

template <class T>
void Hdf5Writer::attribute(const std::string& object, const char* name, std::span<const T> values) {
  const hsize_t size = values.size();
  const Dataspace space(size == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &size, nullptr));
  const Attribute attribute(keep(
      H5Acreate_by_name(file_, object.c_str(), name, native_type<T>(), space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)));
  keep(H5Awrite(attribute, native_type<T>(), values.data()));
}

void Hdf5Writer::attribute(const std::string& object, const char* name, const std::string& text) {
  const Datatype type(H5Tcopy(H5T_C_S1));
  keep(H5Tset_size(type, std::max<std::size_t>(text.size(), 1)));
  keep(H5Tset_strpad(type, H5T_STR_NULLPAD));
  const Dataspace space(H5Screate(H5S_SCALAR));
  const Attribute attribute(
      keep(H5Acreate_by_name(file_, object.c_str(), name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)));
  keep(H5Awrite(attribute, type, text.c_str()));
}

template <class T>
void Hdf5Writer::dataset(const std::string& name, const std::vector<T>& values, int columns, const char* unit) {
  const auto width = static_cast<hsize_t>(std::max(columns, 1));
  const std::int64_t rows = static_cast<std::int64_t>(values.size() / width);
  std::int64_t first = 0;
  MPI_Exscan(&rows, &first, 1, MPI_INT64_T, MPI_SUM, comm_);
  const int rank = columns > 0 ? 2 : 1;
  const std::array<hsize_t, 2> whole{static_cast<hsize_t>(sum_over_ranks(comm_, rows)), width};
  const std::array<hsize_t, 2> start{static_cast<hsize_t>(first), 0};
  const std::array<hsize_t, 2> count{static_cast<hsize_t>(rows), width};
  const Dataspace file_space(keep(H5Screate_simple(rank, whole.data(), nullptr)));
  const Dataspace memory_space(keep(H5Screate_simple(rank, count.data(), nullptr)));
  const Dataset set(
      keep(H5Dcreate2(file_, name.c_str(), native_type<T>(), file_space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)));
  if (rows > 0) {
    keep(H5Sselect_hyperslab(file_space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr));
  } else {
    keep(H5Sselect_none(file_space));
    keep(H5Sselect_none(memory_space));
  }
  if (whole[0] > 0) keep(H5Dwrite(set, native_type<T>(), memory_space, file_space, transfer_, values.data()));
  if (unit) attribute(name, "unit", std::string(unit));
  if (checked_)
    attribute(name, checksum_name, sum_of_checksums(comm_, checksum(first * static_cast<std::int64_t>(width), values)));
}

void Hdf5Writer::finish() {
  keep(H5Fflush(file_, H5F_SCOPE_GLOBAL));  // what other nodes hold
  keep(H5Fclose(file_.release()));
  shared_.reset();
  if (rank_of(comm_) == 0 && failure_.empty()) failure_ = synchronise(partial_);
  const bool failed = any_rank(comm_, !failure_.empty());
  if (rank_of(comm_) == 0) {
    std::error_code error;
    if (failed) {
      fs::remove(partial_, error);
    } else {
      fs::rename(partial_, path_, error);
      failure_ = error ? error.message() : synchronise(fs::path(path_).parent_path().string());
    }
  }
  throw_together(comm_, message());
}

template <class Code>
Code Hdf5Writer::keep(Code code) {
  if (code < 0 && failure_.empty()) {
    const int reason = errno;  // of the system call inside
    failure_ = hdf5_reason();
    if (reason != 0 && failure_.find("MPI error") == failure_.npos)
      failure_ += fmt::format(" ({})", std::strerror(reason));
  }
  errno = 0;
  return code;
}

std::string Hdf5Writer::message() const {
  return failure_.empty() ? "" : fmt::format("cannot write {}: {}", path_, failure_);
}

Hdf5Reader::Hdf5Reader(const std::string& path) : path_(path) {
  check_signature();
  file_ = Hdf5Handle<H5Fclose>(need(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)));
}

template <class T>
T Hdf5Reader::number(const char* name, const char* object) const {
  T value{};
  const Attribute attribute(need(H5Aopen_by_name(file_, object, name, H5P_DEFAULT, H5P_DEFAULT), name));
  const Dataspace space(need(H5Aget_space(attribute)));
  const Datatype type(need(H5Aget_type(attribute)));
  if (H5Sget_simple_extent_npoints(space) != 1 || H5Tequal(type, native_type<T>()) <= 0)
    fail(fmt::format("attribute {} is not a single number of its type", name));
  need(H5Aread(attribute, native_type<T>(), &value));
  return value;
}

std::string Hdf5Reader::text(const char* name) const {
  const Attribute attribute(need(H5Aopen(file_, name, H5P_DEFAULT), name));
  const Datatype type(need(H5Aget_type(attribute)));
  const Dataspace space(need(H5Aget_space(attribute)));
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 || H5Sget_simple_extent_npoints(space) != 1)
    fail(fmt::format("attribute {} is not a text of fixed length", name));
  if (H5Tget_size(type) > size_) fail(fmt::format("attribute {} is longer than the file", name));
  std::string value(H5Tget_size(type), '\0');
  need(H5Aread(attribute, type, value.data()));
  value.erase(std::find(value.begin(), value.end(), '\0'), value.end());
  return value;
}

std::int64_t Hdf5Reader::rows(const std::string& name) const {
  const Dataset set(need(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), name));
  return extent(set, name)[0];
}

template <class T>
std::vector<T> Hdf5Reader::dataset(const std::string& name, std::int64_t first, std::int64_t count, int columns) const {
  const auto width = static_cast<hsize_t>(std::max(columns, 1));
  const Dataset set(need(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), name));
  const auto whole = extent(set, name);
  if (first < 0 || count < 0 || count > whole[0] || first > whole[0] - count || whole[1] != columns)
    fail(fmt::format("dataset {} has {} x {} entries", name, whole[0], whole[1]));
  const Datatype type(need(H5Dget_type(set)));
  if (H5Tequal(type, native_type<T>()) <= 0) fail(fmt::format("dataset {} has another type", name));
  check_storage(set, name, static_cast<hsize_t>(whole[0]), width * sizeof(T));
  std::vector<T> values(static_cast<std::size_t>(count) * width);
  if (count == 0) return values;
  const int rank = columns > 0 ? 2 : 1;
  const std::array<hsize_t, 2> begin{static_cast<hsize_t>(first), 0};
  const std::array<hsize_t, 2> size{static_cast<hsize_t>(count), width};
  const Dataspace file_space(need(H5Dget_space(set)));
  const Dataspace memory_space(need(H5Screate_simple(rank, size.data(), nullptr)));
  need(H5Sselect_hyperslab(file_space, H5S_SELECT_SET, begin.data(), nullptr, size.data(), nullptr));
  need(H5Dread(set, native_type<T>(), memory_space, file_space, H5P_DEFAULT, values.data()));
  return values;
}

template <class T>
std::vector<T> Hdf5Reader::checked_whole(const std::string& name) const {
  std::vector<T> values = dataset<T>(name, 0, rows(name));
  if (static_cast<std::int64_t>(checksum(0, values)) != number<std::int64_t>(checksum_name, name.c_str()))
    fail(fmt::format("the checksum of {} does not match", name));
  return values;
}

template <class T>
std::vector<T> Hdf5Reader::checked_dataset(MPI_Comm comm, const std::string& name, std::int64_t first,
                                           std::int64_t count, int columns) const {
  std::vector<T> values;
  std::int64_t expected = 0;
  together(comm, [&] {
    values = dataset<T>(name, first, count, columns);
    expected = number<std::int64_t>(checksum_name, name.c_str());
  });
  const bool right = sum_of_checksums(comm, checksum(first * std::max(columns, 1), values)) == expected;
  together(comm, [&] {
    if (!right) fail(fmt::format("the checksum of {} does not match", name));
  });
  return values;
}

std::map<std::string, double> Hdf5Reader::numbers(const char* object) const {
  std::map<std::string, double> all;
  std::vector<std::string> names;
  need(H5Aiterate_by_name(
      file_, object, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr,
      [](hid_t, const char* name, const H5A_info_t*, void* list) -> herr_t {
        static_cast<std::vector<std::string>*>(list)->emplace_back(name);
        return 0;
      },
      &names, H5P_DEFAULT));
  for (const std::string& name : names) all[name] = number<double>(name.c_str(), object);
  return all;
}

bool Hdf5Reader::has_attribute(const char* name, const char* object) const {
  return H5Aexists_by_name(file_, object, name, H5P_DEFAULT) > 0;
}

bool Hdf5Reader::has(const char* object) const { return H5Lexists(file_, object, H5P_DEFAULT) > 0; }

void Hdf5Reader::fail(const std::string& reason) const {
  throw FileError(fmt::format("cannot read {}: {}", path_, reason));
}

template <class Code>
Code Hdf5Reader::need(Code code, const std::string& name) const {
  if (code < 0) fail(fmt::format("{}{}{}", name, name.empty() ? "" : ": ", hdf5_reason()));
  return code;
}

// HDF5 trusts metadata of the oldest form, which have no checksums, and may crash where they are damaged.
void Hdf5Reader::check_signature() {
  std::error_code error;
  size_ = fs::file_size(path_, error);
  if (error) fail(error == std::errc::no_such_file_or_directory ? "no such file" : error.message());
  std::array<char, 9> start{};
  std::ifstream(path_, std::ios::binary).read(start.data(), start.size());
  if (!std::string_view(start.data(), start.size()).starts_with("\x89HDF\r\n\x1a\n")) fail("not an HDF5 file");
  if (start[8] < 2) fail("not a file of Impinge: its metadata have no checksums");
}

// The values stand in one piece within the file.
void Hdf5Reader::check_storage(hid_t set, const std::string& name, hsize_t rows, hsize_t row_bytes) const {
  const Properties properties(need(H5Dget_create_plist(set)));
  const bool contiguous = H5Pget_layout(properties) == H5D_CONTIGUOUS && H5Pget_external_count(properties) == 0;
  if (!contiguous || rows > size_ / row_bytes || H5Dget_storage_size(set) != rows * row_bytes ||
      (rows > 0 && H5Dget_offset(set) > size_ - rows * row_bytes))
    fail(fmt::format("dataset {} is not stored in one piece", name));
}

// Rows and columns; 0 columns for a one-dimensional dataset.
std::array<std::int64_t, 2> Hdf5Reader::extent(hid_t set, const std::string& name) const {
  const Dataspace space(need(H5Dget_space(set)));
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank != 1 && rank != 2) fail(fmt::format("dataset {} has {} dimensions", name, rank));
  std::array<hsize_t, 2> size{0, 0};
  H5Sget_simple_extent_dims(space, size.data(), nullptr);
  return {static_cast<std::int64_t>(size[0]), static_cast<std::int64_t>(size[1])};
}

template void Hdf5Writer::attribute(const std::string&, const char*, std::span<const double>);
template void Hdf5Writer::attribute(const std::string&, const char*, std::span<const std::int64_t>);
template void Hdf5Writer::attribute(const std::string&, const char*, std::span<const std::int32_t>);
template void Hdf5Writer::dataset(const std::string&, const std::vector<double>&, int, const char*);
template void Hdf5Writer::dataset(const std::string&, const std::vector<std::int64_t>&, int, const char*);
template void Hdf5Writer::dataset(const std::string&, const std::vector<std::int32_t>&, int, const char*);
template void Hdf5Writer::dataset(const std::string&, const std::vector<std::uint8_t>&, int, const char*);
template double Hdf5Reader::number(const char*, const char*) const;
template std::int64_t Hdf5Reader::number(const char*, const char*) const;
template std::int32_t Hdf5Reader::number(const char*, const char*) const;
template std::vector<double> Hdf5Reader::dataset(const std::string&, std::int64_t, std::int64_t, int) const;
template std::vector<std::int64_t> Hdf5Reader::dataset(const std::string&, std::int64_t, std::int64_t, int) const;
template std::vector<std::int32_t> Hdf5Reader::dataset(const std::string&, std::int64_t, std::int64_t, int) const;
template std::vector<std::uint8_t> Hdf5Reader::dataset(const std::string&, std::int64_t, std::int64_t, int) const;
template std::vector<std::int64_t> Hdf5Reader::checked_whole(const std::string&) const;
template std::vector<std::int32_t> Hdf5Reader::checked_whole(const std::string&) const;
template std::vector<double> Hdf5Reader::checked_dataset(MPI_Comm, const std::string&, std::int64_t, std::int64_t,
                                                         int) const;
template std::vector<std::int64_t> Hdf5Reader::checked_dataset(MPI_Comm, const std::string&, std::int64_t, std::int64_t,
                                                               int) const;
template std::vector<std::int32_t> Hdf5Reader::checked_dataset(MPI_Comm, const std::string&, std::int64_t, std::int64_t,
                                                               int) const;
template std::vector<std::uint8_t> Hdf5Reader::checked_dataset(MPI_Comm, const std::string&, std::int64_t, std::int64_t,
                                                               int) const;

}  // namespace impinge
