#include "impinge/io/snapshot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <optional>
#include <regex>
#include <string_view>
#include <utility>

#include "impinge/parallel/exchange.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;

constexpr int format_version = 1;
constexpr const char* point_data = "/VTKHDF/PointData/";
constexpr const char* checkpoint_group = "/checkpoint";
const std::string snapshot_ending = ".vtkhdf";
const std::string checkpoint_ending = ".checkpoint";
const std::string partial_ending = ".partial";
constexpr const char* checksum_name = "checksum";

/// An HDF5 object, closed on destruction.
template <herr_t (*close)(hid_t)>
class Hdf5 {
 public:
  Hdf5(hid_t id = H5I_INVALID_HID) : id_(id) {}
  Hdf5(Hdf5&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Hdf5& operator=(Hdf5&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Hdf5() {
    if (id_ >= 0) close(id_);
  }
  operator hid_t() const { return id_; }
  hid_t release() { return std::exchange(id_, H5I_INVALID_HID); }

 private:
  hid_t id_;
};

using File = Hdf5<H5Fclose>;
using Group = Hdf5<H5Gclose>;
using Dataset = Hdf5<H5Dclose>;
using Dataspace = Hdf5<H5Sclose>;
using Datatype = Hdf5<H5Tclose>;
using Attribute = Hdf5<H5Aclose>;
using Properties = Hdf5<H5Pclose>;

template <class T>
hid_t native_type() {
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
  if constexpr (std::is_same_v<T, std::int32_t>) return H5T_NATIVE_INT32;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_NATIVE_UINT8;
}

/// While it lives, HDF5 prints no error traces.
class QuietErrors {
 public:
  QuietErrors() {
    H5dont_atexit();  // every file is closed here; what HDF5 itself keeps of a damaged one it cannot close at the exit
    H5open();
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~QuietErrors() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

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

/// Throws FileError on all ranks, with the message of the first rank that has one. Collective.
void throw_together(MPI_Comm comm, const std::string& own_message) {
  const int ranks = ranks_of(comm);
  int first = own_message.empty() ? ranks : rank_of(comm);
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, comm);
  if (first == ranks) return;
  throw FileError(broadcast(comm, own_message, first));
}

/// The file that is being written on several ranks, for the wrappers of MPI-IO at the end of this file.
struct {
  MPI_Comm comm = MPI_COMM_NULL;
  std::string path;
} shared_file;

/// A file that all ranks write. Where it cannot be created all ranks throw FileError. Later, a write may fail on one
/// rank while the others wait for it inside HDF5: among several ranks, that ends the job at once. A rank by itself
/// keeps the failure until finish.
class Writer {
 public:
  /// `checked`: every dataset carries a checksum, as HDF5's own structures do in any case.
  Writer(MPI_Comm comm, std::string path, bool checked = false)
      : comm_(comm), path_(std::move(path)), partial_(path_ + partial_ending), checked_(checked) {
    const Properties access(H5Pcreate(H5P_FILE_ACCESS));
    keep(H5Pset_fapl_mpio(access, comm, MPI_INFO_NULL));
    keep(H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18));  // its metadata have checksums
    file_ = File(keep(H5Fcreate(partial_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access)));
    throw_together(comm, message());
    if (ranks_of(comm) > 1) shared_file = {comm, path_};
    transfer_ = Properties(H5Pcreate(H5P_DATASET_XFER));
    keep(H5Pset_dxpl_mpio(transfer_, H5FD_MPIO_COLLECTIVE));
  }

  void create_group(const std::string& name) {
    const Group group(keep(H5Gcreate2(file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)));
  }

  template <class T>
  void attribute(const std::string& object, const char* name, std::span<const T> values) {
    const hsize_t size = values.size();
    const Dataspace space(size == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &size, nullptr));
    const Attribute attribute(keep(H5Acreate_by_name(file_, object.c_str(), name, native_type<T>(), space, H5P_DEFAULT,
                                                     H5P_DEFAULT, H5P_DEFAULT)));
    keep(H5Awrite(attribute, native_type<T>(), values.data()));
  }

  template <class T>
  void attribute(const std::string& object, const char* name, T value) {
    attribute(object, name, std::span<const T>(&value, 1));
  }

  void attribute(const std::string& object, const char* name, const std::string& text) {
    const Datatype type(H5Tcopy(H5T_C_S1));
    keep(H5Tset_size(type, std::max<std::size_t>(text.size(), 1)));
    keep(H5Tset_strpad(type, H5T_STR_NULLPAD));
    const Dataspace space(H5Screate(H5S_SCALAR));
    const Attribute attribute(
        keep(H5Acreate_by_name(file_, object.c_str(), name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)));
    keep(H5Awrite(attribute, type, text.c_str()));
  }

  /// The rows of all ranks, one rank's after the other's; columns = 0: a one-dimensional dataset.
  template <class T>
  void dataset(const std::string& name, const std::vector<T>& values, int columns = 0, const char* unit = nullptr) {
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
      attribute(name, checksum_name,
                sum_of_checksums(comm_, checksum(first * static_cast<std::int64_t>(width), values)));
  }

  /// Closes the file, forces it to the disk and gives it its name. Throws FileError on all ranks.
  void finish() {
    keep(H5Fflush(file_, H5F_SCOPE_GLOBAL));  // what other nodes hold
    keep(H5Fclose(file_.release()));
    shared_file.comm = MPI_COMM_NULL;
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

 private:
  template <class Code>
  Code keep(Code code) {
    if (code < 0 && failure_.empty()) {
      const int reason = errno;  // of the system call inside
      failure_ = hdf5_reason();
      if (reason != 0 && failure_.find("MPI error") == failure_.npos)
        failure_ += fmt::format(" ({})", std::strerror(reason));
    }
    errno = 0;
    return code;
  }

  std::string message() const { return failure_.empty() ? "" : fmt::format("cannot write {}: {}", path_, failure_); }

  QuietErrors quiet_;
  MPI_Comm comm_;
  std::string path_;
  std::string partial_;
  bool checked_;
  File file_;
  Properties transfer_;
  std::string failure_;
};

/// Does what may throw FileError on any rank; if it did, throws it on all. Collective.
template <class Action>
void together(MPI_Comm comm, Action&& action) {
  std::string failure;
  try {
    action();
  } catch (const FileError& error) {
    failure = error.what();
  }
  throw_together(comm, failure);
}

/// A file that one rank reads by itself. Throws FileError.
class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path) {
    check_signature();
    file_ = File(need(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)));
    if (H5Aexists(file_, "format_version") <= 0 || H5Lexists(file_, "VTKHDF", H5P_DEFAULT) <= 0)
      fail("not a snapshot of Impinge");
    const auto version = number<int>("format_version");
    if (version != format_version)
      fail(fmt::format("format version {}, but this Impinge reads version {}", version, format_version));
  }

  template <class T>
  T number(const char* name, const char* object = "/") const {
    T value{};
    const Attribute attribute(need(H5Aopen_by_name(file_, object, name, H5P_DEFAULT, H5P_DEFAULT), name));
    const Dataspace space(need(H5Aget_space(attribute)));
    const Datatype type(need(H5Aget_type(attribute)));
    if (H5Sget_simple_extent_npoints(space) != 1 || H5Tequal(type, native_type<T>()) <= 0)
      fail(fmt::format("attribute {} is not a single number of its type", name));
    need(H5Aread(attribute, native_type<T>(), &value));
    return value;
  }

  std::string text(const char* name) const {
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

  std::int64_t rows(const std::string& name) const {
    const Dataset set(need(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), name));
    return extent(set, name)[0];
  }

  /// Rows [first, first + count) of a dataset of `columns` columns (0: one-dimensional).
  template <class T>
  std::vector<T> dataset(const std::string& name, std::int64_t first, std::int64_t count, int columns = 0) const {
    const auto width = static_cast<hsize_t>(std::max(columns, 1));
    const Dataset set(need(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), name));
    const auto whole = extent(set, name);
    if (first + count > whole[0] || whole[1] != columns)
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

  /// Rows [first, first + count) on this rank, other rows on the others, so that all ranks together read all. Throws
  /// FileError on all ranks where the checksum does not match. Collective.
  template <class T>
  std::vector<T> checked_dataset(MPI_Comm comm, const std::string& name, std::int64_t first, std::int64_t count,
                                 int columns = 0) const {
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

  /// The attributes of an object that are numbers.
  std::map<std::string, double> numbers(const char* object) const {
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

  bool has(const char* object) const { return H5Lexists(file_, object, H5P_DEFAULT) > 0; }

  [[noreturn]] void fail(const std::string& reason) const {
    throw FileError(fmt::format("cannot read {}: {}", path_, reason));
  }

 private:
  template <class Code>
  Code need(Code code, const std::string& name = "") const {
    if (code < 0) fail(fmt::format("{}{}{}", name, name.empty() ? "" : ": ", hdf5_reason()));
    return code;
  }

  // HDF5 trusts metadata of the oldest form, which have no checksums, and may crash where they are damaged.
  void check_signature() {
    std::error_code error;
    size_ = fs::file_size(path_, error);
    if (error) fail(error == std::errc::no_such_file_or_directory ? "no such file" : error.message());
    std::array<char, 9> start{};
    std::ifstream(path_, std::ios::binary).read(start.data(), start.size());
    if (!std::string_view(start.data(), start.size()).starts_with("\x89HDF\r\n\x1a\n")) fail("not an HDF5 file");
    if (start[8] < 2) fail("not a snapshot of Impinge, or one whose metadata have no checksums yet");
  }

  // The values stand in one piece within the file.
  void check_storage(hid_t set, const std::string& name, hsize_t rows, hsize_t row_bytes) const {
    const Properties properties(need(H5Dget_create_plist(set)));
    const bool contiguous = H5Pget_layout(properties) == H5D_CONTIGUOUS && H5Pget_external_count(properties) == 0;
    if (!contiguous || rows > size_ / row_bytes || H5Dget_storage_size(set) != rows * row_bytes ||
        (rows > 0 && H5Dget_offset(set) > size_ - rows * row_bytes))
      fail(fmt::format("dataset {} is not stored in one piece", name));
  }

  // Rows and columns; 0 columns for a one-dimensional dataset.
  std::array<std::int64_t, 2> extent(hid_t set, const std::string& name) const {
    const Dataspace space(need(H5Dget_space(set)));
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank != 1 && rank != 2) fail(fmt::format("dataset {} has {} dimensions", name, rank));
    std::array<hsize_t, 2> size{0, 0};
    H5Sget_simple_extent_dims(space, size.data(), nullptr);
    return {static_cast<std::int64_t>(size[0]), static_cast<std::int64_t>(size[1])};
  }

  QuietErrors quiet_;
  std::string path_;
  std::uintmax_t size_ = 0;
  File file_;
};

/// Three columns, by rows, as vectors.
template <int Dim>
std::vector<Vector<Dim>> vectors(const std::vector<double>& rows) {
  std::vector<Vector<Dim>> result(rows.size() / 3);
  for (std::size_t i = 0; i < result.size(); ++i)
    for (int k = 0; k < Dim; ++k) result[i][k] = rows[3 * i + static_cast<std::size_t>(k)];
  return result;
}

/// Rows of three components.
template <int Dim>
void append(std::vector<double>& rows, const Vector<Dim>& vector) {
  for (int k = 0; k < 3; ++k) rows.push_back(k < Dim ? vector[k] : 0.0);
}

template <int Dim>
std::vector<double> three_columns(const std::vector<Vector<Dim>>& vectors, int count) {
  std::vector<double> rows;
  rows.reserve(3 * static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) append(rows, vectors[static_cast<std::size_t>(i)]);
  return rows;
}

/// The first `count` values, as the type of the file.
template <class Stored, class T>
std::vector<Stored> column(const std::vector<T>& values, int count) {
  std::vector<Stored> result(static_cast<std::size_t>(count));
  std::transform(values.begin(), values.begin() + count, result.begin(),
                 [](const T& value) { return static_cast<Stored>(value); });
  return result;
}

std::string mpi_version() {
  std::array<char, MPI_MAX_LIBRARY_VERSION_STRING> text{};
  int length = 0;
  MPI_Get_library_version(text.data(), &length);
  const std::string whole(text.data());
  return whole.substr(0, whole.find(','));
}

std::string hdf5_version() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return fmt::format("{}.{}.{}", major, minor, release);
}

void write_header(Writer& file, const SnapshotHeader& header) {
  file.attribute("/", "format_version", format_version);
  file.attribute("/", "dimension", header.dimension);
  file.attribute("/", "step", header.step);
  file.attribute("/", "time", header.time);
  file.attribute("/", "dt", header.dt);
  file.attribute("/", "window_begin", header.window_begin);
  file.attribute("/", "window_end", header.window_end);
  file.attribute("/", "status", header.status);
  file.attribute("/", "message", header.message);
  file.attribute("/", "case", header.case_text);
  file.attribute("/", "code_version", std::string("impinge " IMPINGE_VERSION));
  file.attribute("/", "petsc_version", petsc_version());
  file.attribute("/", "hdf5_version", hdf5_version());
  file.attribute("/", "mpi_version", mpi_version());
}

SnapshotHeader header_of(const Reader& file) {
  SnapshotHeader header;
  header.dimension = file.number<int>("dimension");
  header.step = file.number<std::int64_t>("step");
  header.time = file.number<double>("time");
  header.dt = file.number<double>("dt");
  header.window_begin = file.number<double>("window_begin");
  header.window_end = file.number<double>("window_end");
  header.status = file.text("status");
  header.message = file.text("message");
  header.case_text = file.text("case");
  header.code_version = file.text("code_version");
  return header;
}

/// One vertex cell per particle; one piece per rank.
void write_cells(Writer& file, int count) {
  std::vector<std::int64_t> places(static_cast<std::size_t>(count) + 1);
  std::iota(places.begin(), places.end(), std::int64_t{0});
  const std::vector<std::int64_t> size{count};
  for (const char* name : {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"})
    file.dataset(fmt::format("/VTKHDF/{}", name), size);
  file.dataset("/VTKHDF/Offsets", places);
  places.pop_back();
  file.dataset("/VTKHDF/Connectivity", places);
  constexpr std::uint8_t vtk_vertex = 1;
  file.dataset("/VTKHDF/Types", std::vector<std::uint8_t>(static_cast<std::size_t>(count), vtk_vertex));
}

template <int Dim>
void write_wall(Writer& file, const Particles<Dim>& particles, double window_begin, double window_end) {
  std::vector<double> position, mean_pressure;
  std::vector<std::int64_t> id;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.type[i] != ParticleType::wall) continue;
    append(position, particles.position[i]);
    mean_pressure.push_back(particles.pressure_impulse[i] / (window_end - window_begin));
    id.push_back(particles.id[i]);
  }
  file.create_group("/wall");
  file.attribute("/wall", "window_begin", window_begin);
  file.attribute("/wall", "window_end", window_end);
  file.dataset("/wall/position", position, 3, "m");
  file.dataset("/wall/mean_pressure", mean_pressure, 0, "Pa");
  file.dataset("/wall/id", id, 0, "1");
}

/// Case name and step of `<name>_<step, 8 digits or more><ending>`, whatever the directory; nothing for other names.
std::optional<std::pair<std::string, std::int64_t>> name_and_step_before(const std::string& ending,
                                                                         const std::string& path) {
  static const std::regex form(R"((.+)_(\d{8,18}))");
  const std::string file = fs::path(path).filename().string();
  std::smatch match;
  if (!file.ends_with(ending)) return {};
  const std::string stem = file.substr(0, file.size() - ending.size());
  if (!std::regex_match(stem, match, form)) return {};
  return std::pair{match[1].str(), static_cast<std::int64_t>(std::stoll(match[2]))};
}

/// Files of one case, or of all if `name` is empty, and of one ending, ordered by step.
std::vector<std::string> list_files(const std::string& directory, const std::string& name, const std::string& ending) {
  std::vector<std::pair<std::int64_t, std::string>> found;
  std::error_code error;
  for (auto entry = fs::directory_iterator(directory, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    const auto at = name_and_step_before(ending, entry->path().string());
    if (at && (name.empty() || at->first == name)) found.emplace_back(at->second, entry->path().string());
  }
  if (error) throw FileError(fmt::format("cannot read the directory {}: {}", directory, error.message()));
  std::sort(found.begin(), found.end());
  std::vector<std::string> paths;
  for (auto& [step, path] : found) paths.push_back(std::move(path));
  return paths;
}

/// Header, particles and mean wall pressure: what snapshots and checkpoints have in common.
template <int Dim>
void write_state(Writer& file, int rank, const Particles<Dim>& particles, const SnapshotHeader& header) {
  const int n = particles.owned;
  write_header(file, header);
  file.create_group("/VTKHDF");
  file.attribute<std::int64_t>("/VTKHDF", "Version", std::array<std::int64_t, 2>{1, 0});
  file.attribute("/VTKHDF", "Type", std::string("UnstructuredGrid"));
  file.dataset("/VTKHDF/Points", three_columns(particles.position, n), 3, "m");
  write_cells(file, n);
  file.create_group("/VTKHDF/PointData");
  const auto field = [](const char* name) { return std::string(point_data) + name; };
  file.dataset(field("velocity"), three_columns(particles.velocity, n), 3, "m/s");
  file.dataset(field("pressure"), column<double>(particles.pressure, n), 0, "Pa");
  file.dataset(field("pressure_impulse"), column<double>(particles.pressure_impulse, n), 0, "Pa s");
  file.dataset(field("number_density"), column<double>(particles.number_density, n), 0, "1");
  file.dataset(field("type"), column<std::uint8_t>(particles.type, n), 0, "1");
  file.dataset(field("free_surface"), column<std::uint8_t>(particles.free_surface, n), 0, "1");
  file.dataset(field("id"), column<std::int64_t>(particles.id, n), 0, "1");
  file.dataset(field("rank"), std::vector<std::int32_t>(static_cast<std::size_t>(n), rank), 0, "1");
  if (header.window_end > header.window_begin) write_wall(file, particles, header.window_begin, header.window_end);
}

/// This rank's particles of the file, rows [first, first + count), by `read`(name, first value, columns).
template <int Dim, class Read>
Particles<Dim> read_particles(const Reader& file, std::int64_t count, Read&& read) {
  const auto field = [&](const char* name, auto type) { return read(std::string(point_data) + name, type, 0); };
  Particles<Dim> particles;
  particles.owned = static_cast<int>(count);
  particles.position = vectors<Dim>(read("/VTKHDF/Points", double{}, 3));
  particles.velocity = vectors<Dim>(read(std::string(point_data) + "velocity", double{}, 3));
  particles.pressure = field("pressure", double{});
  particles.pressure_impulse = field("pressure_impulse", double{});
  particles.number_density = field("number_density", double{});
  particles.free_surface = field("free_surface", std::uint8_t{});
  particles.id = field("id", std::int64_t{});
  for (const std::uint8_t type : field("type", std::uint8_t{})) {
    if (type > static_cast<std::uint8_t>(ParticleType::ghost))
      file.fail(fmt::format("a particle has the unknown type {}", type));
    particles.type.push_back(static_cast<ParticleType>(type));
  }
  return particles;
}

}  // namespace

// HDF5 closes its files in MPI_Finalize where it found MPI initialised.
void leave_files_to_their_owners() {
  H5dont_atexit();
  H5open();
}

std::string snapshot_path(const std::string& directory, const std::string& name, std::int64_t step) {
  return (fs::path(directory) / fmt::format("{}_{:08}{}", name, step, snapshot_ending)).string();
}

std::string checkpoint_path(const std::string& directory, const std::string& name, std::int64_t step) {
  return (fs::path(directory) / fmt::format("{}_{:08}{}", name, step, checkpoint_ending)).string();
}

std::vector<std::string> list_snapshots(const std::string& directory, const std::string& name) {
  return list_files(directory, name, snapshot_ending);
}

std::vector<std::string> list_checkpoints(const std::string& directory, const std::string& name) {
  return list_files(directory, name, checkpoint_ending);
}

std::vector<std::string> list_partial_files(const std::string& directory, const std::string& name) {
  std::vector<std::string> all = list_files(directory, name, snapshot_ending + partial_ending);
  for (std::string& path : list_files(directory, name, checkpoint_ending + partial_ending))
    all.push_back(std::move(path));
  return all;
}

std::pair<std::string, std::int64_t> name_and_step(const std::string& path) {
  for (const std::string& ending : {snapshot_ending, checkpoint_ending})
    if (const auto found = name_and_step_before(ending, path)) return *found;
  throw FileError(fmt::format("{} is not named as a snapshot or checkpoint", path));
}

template <int Dim>
void write_snapshot(MPI_Comm comm, const std::string& path, const Particles<Dim>& particles,
                    const SnapshotHeader& header) {
  Writer file(comm, path);
  write_state(file, rank_of(comm), particles, header);
  file.finish();
}

std::string synchronise(const std::string& path) {
  const int descriptor = open(path.c_str(), O_RDONLY);
  const bool done = descriptor >= 0 && fsync(descriptor) == 0;
  const std::string reason = done ? "" : std::strerror(errno);
  if (descriptor >= 0) close(descriptor);
  return reason;
}

SnapshotHeader read_header(const std::string& path) { return header_of(Reader(path)); }

std::int64_t count_particles(const std::string& path) { return Reader(path).rows("/VTKHDF/Points"); }

template <int Dim>
SnapshotHeader read_snapshot(MPI_Comm comm, const std::string& path, Particles<Dim>& particles) {
  SnapshotHeader header;
  together(comm, [&] {
    const Reader file(path);
    header = header_of(file);
    if (header.dimension != Dim) file.fail(fmt::format("it has {} dimensions, not {}", header.dimension, Dim));
    const std::int64_t all = file.rows("/VTKHDF/Points");
    const std::int64_t first = all * rank_of(comm) / ranks_of(comm);
    const std::int64_t count = all * (rank_of(comm) + 1) / ranks_of(comm) - first;
    particles = read_particles<Dim>(file, count, [&]<class T>(const std::string& name, T, int columns) {
      if (const auto rows = file.rows(name); rows != all)
        file.fail(fmt::format("dataset {} has {} rows, not {} as /VTKHDF/Points", name, rows, all));
      return file.dataset<T>(name, first, count, columns);
    });
  });
  return header;
}

template <int Dim>
void write_checkpoint(MPI_Comm comm, const std::string& path, const Checkpoint<Dim>& state,
                      const SnapshotHeader& header) {
  Writer file(comm, path, true);
  write_state(file, rank_of(comm), state.particles, header);
  file.create_group(checkpoint_group);
  for (const auto& [name, value] : state.numbers) file.attribute(checkpoint_group, name.c_str(), value);
  const auto name = [](const char* part) { return fmt::format("{}/{}", checkpoint_group, part); };
  file.dataset(name("searched_position"), three_columns(state.searched_position, state.particles.owned), 3, "m");
  file.dataset(name("cell_owner"), rank_of(comm) == 0 ? state.owner : std::vector<int>{});
  const CoarseRows& coarse = state.coarse;
  file.dataset(name("coarse_rows"), std::vector<std::int64_t>{static_cast<std::int64_t>(coarse.cell.size())});
  file.dataset(name("coarse_entries"), std::vector<std::int64_t>{static_cast<std::int64_t>(coarse.column.size())});
  file.dataset(name("coarse_cell"), coarse.cell);
  file.dataset(name("coarse_length"), coarse.length);
  file.dataset(name("coarse_column"), coarse.column);
  file.dataset(name("coarse_value"), coarse.value);
  file.finish();
}

template <int Dim>
Checkpoint<Dim> read_checkpoint(MPI_Comm comm, const std::string& path) {
  std::optional<Reader> file;
  std::vector<std::int64_t> pieces;
  std::int64_t all = 0;
  Checkpoint<Dim> state;
  const auto name = [](const char* part) { return fmt::format("{}/{}", checkpoint_group, part); };
  // Every rank reads these as a whole.
  const auto whole = [&]<class T>(const std::string& dataset, T) {
    const std::int64_t rows = file->rows(dataset);
    std::vector<T> values = file->dataset<T>(dataset, 0, rows);
    if (static_cast<std::int64_t>(checksum(0, values)) != file->number<std::int64_t>(checksum_name, dataset.c_str()))
      file->fail(fmt::format("the checksum of {} does not match", dataset));
    return values;
  };
  together(comm, [&] {
    file.emplace(path);
    if (!file->has(checkpoint_group)) file->fail("a snapshot, not a checkpoint");
    if (const int dimension = file->number<int>("dimension"); dimension != Dim)
      file->fail(fmt::format("it has {} dimensions, not {}", dimension, Dim));
    state.numbers = file->numbers(checkpoint_group);
    pieces = whole("/VTKHDF/NumberOfPoints", std::int64_t{});
    all = file->rows("/VTKHDF/Points");
    if (std::accumulate(pieces.begin(), pieces.end(), std::int64_t{0}) != all)
      file->fail("the ranks' numbers of particles do not make the whole");
  });

  const int rank = rank_of(comm);
  const auto ranks = static_cast<std::int64_t>(ranks_of(comm));
  const bool own_parts = static_cast<std::int64_t>(pieces.size()) == ranks;
  // Where a rank's part of an array of one piece per rank begins.
  const auto before = [&](const std::vector<std::int64_t>& sizes) {
    return std::accumulate(sizes.begin(), sizes.begin() + rank, std::int64_t{0});
  };
  const std::int64_t first = own_parts ? before(pieces) : all * rank / ranks;
  const std::int64_t count = own_parts ? pieces[static_cast<std::size_t>(rank)] : all * (rank + 1) / ranks - first;
  const auto share = [&]<class T>(const std::string& dataset, T, int columns = 0) {
    return file->checked_dataset<T>(comm, dataset, first, count, columns);
  };
  together(comm, [&] { state.particles = read_particles<Dim>(*file, count, share); });
  state.searched_position = vectors<Dim>(share(name("searched_position"), double{}, 3));
  if (!own_parts) return state;

  std::vector<std::int64_t> rows, entries;
  together(comm, [&] {
    state.owner = whole(name("cell_owner"), int{});
    rows = whole(name("coarse_rows"), std::int64_t{});
    entries = whole(name("coarse_entries"), std::int64_t{});
    if (rows.size() != pieces.size() || entries.size() != pieces.size())
      file->fail("its parts are of different numbers of ranks");
  });
  const auto part = [&]<class T>(const char* dataset, const std::vector<std::int64_t>& sizes, T) {
    return file->checked_dataset<T>(comm, name(dataset), before(sizes), sizes[static_cast<std::size_t>(rank)]);
  };
  state.coarse.cell = part("coarse_cell", rows, std::int64_t{});
  state.coarse.length = part("coarse_length", rows, std::int64_t{});
  state.coarse.column = part("coarse_column", entries, std::int64_t{});
  state.coarse.value = part("coarse_value", entries, double{});
  return state;
}

template void write_snapshot(MPI_Comm, const std::string&, const Particles<2>&, const SnapshotHeader&);
template void write_snapshot(MPI_Comm, const std::string&, const Particles<3>&, const SnapshotHeader&);
template SnapshotHeader read_snapshot(MPI_Comm, const std::string&, Particles<2>&);
template SnapshotHeader read_snapshot(MPI_Comm, const std::string&, Particles<3>&);
template void write_checkpoint(MPI_Comm, const std::string&, const Checkpoint<2>&, const SnapshotHeader&);
template void write_checkpoint(MPI_Comm, const std::string&, const Checkpoint<3>&, const SnapshotHeader&);
template Checkpoint<2> read_checkpoint(MPI_Comm, const std::string&);
template Checkpoint<3> read_checkpoint(MPI_Comm, const std::string&);

namespace {

/// Ends the job where a call that writes the shared file failed on this rank.
int end_job_unless(bool done, int code) {
  if (done || shared_file.comm == MPI_COMM_NULL) return code;
  const int reason = errno;
  fmt::print(stderr, "impinge: rank {}: cannot write {}: {}\n", rank_of(shared_file.comm), shared_file.path,
             reason != 0 ? std::strerror(reason) : "MPI-IO failed");
  std::fflush(nullptr);
  MPI_Abort(shared_file.comm, 1);
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
