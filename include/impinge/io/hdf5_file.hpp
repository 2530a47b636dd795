#pragma once
// HDF5 files: one that all ranks write together, and one that a rank reads by itself. The numbers in a file are double,
// std::int64_t, std::int32_t and std::uint8_t.

#include <hdf5.h>
#include <mpi.h>

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "impinge/io/mpi_io_guard.hpp"

namespace impinge {

/// Sets up MPI-IO and HDF5 for this process. To be called before MPI_Init.
void prepare_file_access();

/// The version of HDF5, "1.10.8".
std::string hdf5_version();

/// An HDF5 object, closed on destruction.
template <herr_t (*close)(hid_t)>
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id = H5I_INVALID_HID) : id_(id) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Hdf5Handle() {
    if (id_ >= 0) close(id_);
  }
  operator hid_t() const { return id_; }
  hid_t release() { return std::exchange(id_, H5I_INVALID_HID); }

 private:
  hid_t id_;
};

/// While it lives, HDF5 prints no error traces.
class QuietHdf5 {
 public:
  QuietHdf5();
  ~QuietHdf5();
  QuietHdf5(const QuietHdf5&) = delete;
  QuietHdf5& operator=(const QuietHdf5&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// A file that all ranks write; every function is collective. Where it cannot be created all ranks throw FileError.
/// Later, a write may fail on one rank while the others wait for it inside HDF5: see mpi_io_guard.hpp. A rank by itself
/// keeps the failure until finish.
class Hdf5Writer {
 public:
  /// `checked`: every dataset carries a checksum, as HDF5's own structures do in any case.
  Hdf5Writer(MPI_Comm comm, std::string path, bool checked = false);

  void create_group(const std::string& name);

  /// An attribute of a group or dataset: one number, several, or a text.
  template <class T>
  void attribute(const std::string& object, const char* name, std::span<const T> values);
  template <class T>
  void attribute(const std::string& object, const char* name, T value) {
    attribute(object, name, std::span<const T>(&value, 1));
  }
  void attribute(const std::string& object, const char* name, const std::string& text);

  /// The rows of all ranks, one rank's after the other's; columns = 0: a one-dimensional dataset.
  template <class T>
  void dataset(const std::string& name, const std::vector<T>& values, int columns = 0, const char* unit = nullptr);

  /// Closes the file, forces it to the disk and gives it its name. Throws FileError on all ranks.
  void finish();

 private:
  template <class Code>
  Code keep(Code code);
  std::string message() const;

  QuietHdf5 quiet_;
  MPI_Comm comm_;
  std::string path_;
  std::string partial_;
  bool checked_;
  std::optional<SharedFile> shared_;  // among several ranks
  Hdf5Handle<H5Fclose> file_;
  Hdf5Handle<H5Pclose> transfer_;
  std::string failure_;
};

/// A file that one rank reads by itself. Every function throws FileError; none but checked_dataset is collective.
class Hdf5Reader {
 public:
  explicit Hdf5Reader(const std::string& path);

  /// Whether a group or dataset has an attribute.
  bool has_attribute(const char* name, const char* object = "/") const;

  /// Whether there is a group or dataset of this name.
  bool has(const char* object) const;

  /// An attribute that is one number.
  template <class T>
  T number(const char* name, const char* object = "/") const;

  /// The attributes of an object, all of which are numbers.
  std::map<std::string, double> numbers(const char* object) const;

  /// A text attribute of the file.
  std::string text(const char* name) const;

  /// Length of a dataset.
  std::int64_t rows(const std::string& name) const;

  /// Rows [first, first + count) of a dataset of `columns` columns (0: one-dimensional).
  template <class T>
  std::vector<T> dataset(const std::string& name, std::int64_t first, std::int64_t count, int columns = 0) const;

  /// A whole dataset of one dimension, whose checksum must match.
  template <class T>
  std::vector<T> checked_whole(const std::string& name) const;

  /// Rows [first, first + count) on this rank, other rows on the others, so that all ranks together read all. Throws
  /// FileError on all ranks where the checksum does not match. Collective.
  template <class T>
  std::vector<T> checked_dataset(MPI_Comm comm, const std::string& name, std::int64_t first, std::int64_t count,
                                 int columns = 0) const;

  /// Throws FileError with the file's name and the reason.
  [[noreturn]] void fail(const std::string& reason) const;

 private:
  template <class Code>
  Code need(Code code, const std::string& name = "") const;
  void check_signature();
  void check_storage(hid_t set, const std::string& name, hsize_t rows, hsize_t row_bytes) const;
  std::array<std::int64_t, 2> extent(hid_t set, const std::string& name) const;

  QuietHdf5 quiet_;
  std::string path_;
  std::uintmax_t size_ = 0;
  Hdf5Handle<H5Fclose> file_;
};

}  // namespace impinge
