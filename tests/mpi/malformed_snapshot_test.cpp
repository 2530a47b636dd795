// Files that are no snapshot, or one that was damaged or edited: refused on all ranks, with the file and the reason.

#include <gtest/gtest.h>
#include <hdf5.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <functional>

#include "impinge/io/snapshot.hpp"
#include "impinge/io/snapshot_layout.hpp"
#include "impinge/parallel/exchange.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;
constexpr int count = 50;

/// A directory with a sound snapshot, which all ranks share.
class MalformedSnapshot : public testing::Test {
 protected:
  void SetUp() override {
    const fs::path own = fs::temp_directory_path() / ("impinge_malformed_" + std::to_string(getpid()));
    directory_ = broadcast(MPI_COMM_WORLD, own.string(), 0);
    if (first()) fs::create_directories(directory_);
    MPI_Barrier(MPI_COMM_WORLD);
    Particles<2> particles;
    if (first())
      for (int k = 0; k < count; ++k)
        particles.append({{{0.1 * k, 0.2}}, {{1.0, 0.0}}, 3.0, 4.0, k, ParticleType::wall});
    write_snapshot(MPI_COMM_WORLD, sound(), particles,
                   {.window_end = 1.0, .status = "running", .message = "", .case_text = "x = 1", .code_version = {}});
  }
  void TearDown() override {
    MPI_Barrier(MPI_COMM_WORLD);
    if (first()) fs::remove_all(directory_);
  }

  static bool first() { return rank_of(MPI_COMM_WORLD) == 0; }
  std::string sound() const { return directory_ + "/sound_00000001.vtkhdf"; }
  std::string file() const { return directory_ + "/malformed_00000001.vtkhdf"; }

  /// What all ranks say of the file after `make` made it on one rank; nothing where they read it.
  std::string failure_after(const std::function<void()>& make) {
    if (first()) {
      fs::remove_all(file());
      make();
    }
    MPI_Barrier(MPI_COMM_WORLD);
    std::string failure;
    try {
      Particles<2> particles;
      read_snapshot(MPI_COMM_WORLD, file(), particles);
    } catch (const FileError& error) {
      failure = error.what();
    }
    EXPECT_EQ(failure, broadcast(MPI_COMM_WORLD, failure, 0));
    return failure;
  }

  void expect_refused(const std::function<void()>& make, const std::string& reason) {
    const std::string failure = failure_after(make);
    EXPECT_TRUE(failure.starts_with("cannot read " + file() + ": ")) << failure;
    EXPECT_NE(failure.find(reason), std::string::npos) << failure << "\nnot: " << reason;
  }

  /// `edit` changes a copy of the sound snapshot.
  void expect_refused_after(const std::function<void(hid_t)>& edit, const std::string& reason) {
    expect_refused(
        [&] {
          fs::copy_file(sound(), file());
          const hid_t id = H5Fopen(file().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
          ASSERT_GE(id, 0);
          edit(id);
          ASSERT_GE(H5Fclose(id), 0);
        },
        reason);
  }

 private:
  std::string directory_;
};

/// A new dataset of zeros; without a chunk it stands in one piece.
void create_dataset(hid_t file, const std::string& name, const std::vector<hsize_t>& size, hid_t type,
                    H5D_layout_t layout = H5D_CONTIGUOUS, bool written = true) {
  const hid_t space =
      size.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr);
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_layout(properties, layout);
  if (layout == H5D_CHUNKED) H5Pset_chunk(properties, static_cast<int>(size.size()), size.data());
  if (written) H5Pset_alloc_time(properties, H5D_ALLOC_TIME_EARLY);
  const hid_t set = H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
  ASSERT_GE(set, 0) << name;
  H5Dclose(set);
  H5Pclose(properties);
  H5Sclose(space);
}

std::function<void(hid_t)> replace(const std::string& name, const std::vector<hsize_t>& size, hid_t type,
                                   H5D_layout_t layout = H5D_CONTIGUOUS, bool written = true) {
  return [=](hid_t file) {
    H5Ldelete(file, name.c_str(), H5P_DEFAULT);
    create_dataset(file, name, size, type, layout, written);
  };
}

/// A root attribute of `size` equal numbers.
std::function<void(hid_t)> replace_attribute(const char* name, hid_t type, hsize_t size, std::int32_t value = 0) {
  return [=](hid_t file) {
    H5Adelete(file, name);
    const hid_t space = H5Screate_simple(1, &size, nullptr);
    const hid_t attribute = H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    const std::vector<std::int32_t> values(size, value);
    if (H5Tget_class(type) == H5T_INTEGER) H5Awrite(attribute, H5T_NATIVE_INT32, values.data());
    H5Aclose(attribute);
    H5Sclose(space);
  };
}

TEST_F(MalformedSnapshot, ASoundFileIsRead) {
  EXPECT_EQ(failure_after([&] { fs::copy_file(sound(), file()); }), "");
}

TEST_F(MalformedSnapshot, TruncatedAnywhere) {
  const auto size = fs::file_size(sound());
  for (const std::uintmax_t kept : {std::uintmax_t{0}, std::uintmax_t{1}, std::uintmax_t{8}}) {
    expect_refused([&] { fs::copy_file(sound(), file()), fs::resize_file(file(), kept); },
                   kept < 8 ? "not an HDF5 file" : "not a file of Impinge");
  }
  for (const std::uintmax_t kept : {std::uintmax_t{9}, std::uintmax_t{48}, size / 4, size / 2, size - 4096, size - 1})
    expect_refused([&] { fs::copy_file(sound(), file()), fs::resize_file(file(), kept); }, "");
}

TEST_F(MalformedSnapshot, AByteOfTheMetadataChanged) {
  // The root's first attribute messages.
  for (const std::streamoff place : {8, 20, 44, 60, 100, 150}) {
    expect_refused(
        [&] {
          fs::copy_file(sound(), file());
          std::fstream stream(file(), std::ios::in | std::ios::out | std::ios::binary);
          stream.seekg(place);
          const char byte = static_cast<char>(stream.get() ^ 0x10);
          stream.seekp(place);
          stream.put(byte);
        },
        "");
  }
}

TEST_F(MalformedSnapshot, FilesOfOthers) {
  expect_refused([] {}, "no such file");
  expect_refused([&] { fs::create_directory(file()); }, "s a directory");
  expect_refused([&] { std::ofstream(file()) << "not HDF5, but some text that is longer than its signature"; },
                 "not an HDF5 file");
  for (const bool old : {false, true}) {
    expect_refused(
        [&] {
          const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
          if (!old) H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_LATEST);
          const hid_t id = H5Fcreate(file().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
          create_dataset(id, "data", {10}, H5T_NATIVE_DOUBLE);
          H5Fclose(id);
          H5Pclose(access);
        },
        old ? "not a file of Impinge" : "not a snapshot of Impinge");
  }
  expect_refused_after(replace_attribute("format_version", H5T_NATIVE_INT32, 1, 99),
                       "format version 99, but this Impinge reads version 1");
}

TEST_F(MalformedSnapshot, WhatIsMissing) {
  for (const char* name :
       {"/VTKHDF", "/VTKHDF/Points", "/VTKHDF/PointData", "/VTKHDF/PointData/velocity", "/VTKHDF/PointData/pressure",
        "/VTKHDF/PointData/pressure_impulse", "/VTKHDF/PointData/number_density", "/VTKHDF/PointData/type",
        "/VTKHDF/PointData/free_surface", "/VTKHDF/PointData/id"})
    expect_refused_after([&](hid_t id) { H5Ldelete(id, name, H5P_DEFAULT); },
                         std::string(name) == "/VTKHDF"             ? "not a snapshot"
                         : std::string(name) == "/VTKHDF/PointData" ? "/VTKHDF/PointData/velocity: component not found"
                                                                    : name + std::string(": object '"));
  for (const char* name : {"format_version", "dimension", "step", "time", "dt", "window_begin", "window_end", "status",
                           "message", "case", "code_version"})
    expect_refused_after([&](hid_t id) { H5Adelete(id, name); }, std::string(name) == "format_version"
                                                                     ? "not a snapshot"
                                                                     : name + std::string(": can't locate attribute"));
}

TEST_F(MalformedSnapshot, WrongShapes) {
  const std::string pressure = "/VTKHDF/PointData/pressure", points = "/VTKHDF/Points";
  constexpr hsize_t n = count, huge = hsize_t{1} << 58;
  for (const hsize_t rows : {hsize_t{0}, n - 1, n + 1, 2 * n})
    expect_refused_after(replace(pressure, {rows}, H5T_NATIVE_DOUBLE),
                         "dataset " + pressure + " has " + std::to_string(rows) + " rows, not 50 as /VTKHDF/Points");
  expect_refused_after(replace(points, {n - 1, 3}, H5T_NATIVE_DOUBLE), "has 50 rows, not 49 as /VTKHDF/Points");
  expect_refused_after(replace(points, {n, 2}, H5T_NATIVE_DOUBLE), "dataset /VTKHDF/Points has 50 x 2 entries");
  expect_refused_after(replace(points, {n}, H5T_NATIVE_DOUBLE), "dataset /VTKHDF/Points has 50 x 0 entries");
  expect_refused_after(replace(pressure, {n, 1}, H5T_NATIVE_DOUBLE), "dataset " + pressure + " has 50 x 1 entries");
  expect_refused_after(replace(pressure, {n, 1, 1}, H5T_NATIVE_DOUBLE), "dataset " + pressure + " has 3 dimensions");
  expect_refused_after(replace(pressure, {}, H5T_NATIVE_DOUBLE), "dataset " + pressure + " has 0 dimensions");
  expect_refused_after(replace(points, {huge, 3}, H5T_NATIVE_DOUBLE, H5D_CONTIGUOUS, false), "");
  expect_refused_after(replace(points, {n, 3}, H5T_NATIVE_DOUBLE, H5D_CONTIGUOUS, false), "not stored in one piece");
  const auto replace_all = [&](hsize_t rows) {
    return [=](hid_t id) {
      for (const char* name :
           {"velocity", "pressure", "pressure_impulse", "number_density", "type", "free_surface", "id"})
        replace(std::string("/VTKHDF/PointData/") + name, {rows}, H5T_NATIVE_DOUBLE, H5D_CONTIGUOUS, false)(id);
      replace(points, {rows, 3}, H5T_NATIVE_DOUBLE, H5D_CONTIGUOUS, false)(id);
    };
  };
  expect_refused_after(replace_all(hsize_t{1} << 30), "not stored in one piece");
  expect_refused_after(replace_all(huge), "more than one rank can hold");
}

TEST_F(MalformedSnapshot, WrongTypesAndLayouts) {
  constexpr hsize_t n = count;
  const std::string field = "/VTKHDF/PointData/";
  for (const hid_t type : {H5T_NATIVE_FLOAT, H5T_NATIVE_INT64, H5T_C_S1, H5T_IEEE_F64BE})
    expect_refused_after(replace(field + "pressure", {n}, type), "dataset " + field + "pressure has another type");
  expect_refused_after(replace(field + "id", {n}, H5T_NATIVE_INT32), "has another type");
  expect_refused_after(replace(field + "type", {n}, H5T_NATIVE_INT8), "has another type");
  for (const H5D_layout_t layout : {H5D_COMPACT, H5D_CHUNKED})
    expect_refused_after(replace(field + "pressure", {n}, H5T_NATIVE_DOUBLE, layout), "not stored in one piece");
  expect_refused_after(
      [&](hid_t id) {
        H5Ldelete(id, (field + "id").c_str(), H5P_DEFAULT);
        H5Gclose(H5Gcreate2(id, (field + "id").c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
      },
      "not a dataset");
  expect_refused_after(
      [&](hid_t id) {
        H5Ldelete(id, (field + "id").c_str(), H5P_DEFAULT);
        H5Lcreate_soft((field + "id").c_str(), id, (field + "id").c_str(), H5P_DEFAULT, H5P_DEFAULT);
      },
      "too many");
  expect_refused_after(
      [&](hid_t id) {
        const hid_t set = H5Dopen2(id, (field + "type").c_str(), H5P_DEFAULT);
        const std::vector<std::uint8_t> values(count, 9);
        H5Dwrite(set, H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
        H5Dclose(set);
      },
      "has the unknown type 9");
}

TEST_F(MalformedSnapshot, MoreParticlesThanARankHolds) {
  const StateReader reader(sound());
  try {
    reader.particles<2>(std::int64_t{1} << 31, []<class Number>(const std::string&, int) {
      ADD_FAILURE() << "was read";
      return std::vector<Number>{};
    });
    ADD_FAILURE();
  } catch (const FileError& error) {
    EXPECT_EQ(error.what(),
              "cannot read " + sound() + ": 2147483648 particles are more than one rank can hold, which is 2147483647");
  }
}

TEST_F(MalformedSnapshot, WrongAttributes) {
  expect_refused_after(replace_attribute("dimension", H5T_NATIVE_INT32, 1, 3), "it has 3 dimensions, not 2");
  expect_refused_after(replace_attribute("dimension", H5T_NATIVE_INT32, 1, -2), "it has -2 dimensions, not 2");
  expect_refused_after(replace_attribute("dimension", H5T_NATIVE_INT32, 2),
                       "attribute dimension is not a single number");
  expect_refused_after(replace_attribute("dimension", H5T_NATIVE_INT64, 1),
                       "attribute dimension is not a single number");
  expect_refused_after(replace_attribute("time", H5T_NATIVE_INT32, 1), "attribute time is not a single number");
  expect_refused_after(replace_attribute("step", H5T_C_S1, 1), "attribute step is not a single number");
  expect_refused_after(replace_attribute("status", H5T_NATIVE_INT32, 1), "attribute status is not a text");
  expect_refused_after(replace_attribute("case", H5T_C_S1, 3), "attribute case is not a text");
  expect_refused_after(
      [](hid_t id) {
        const hid_t text = H5Tcopy(H5T_C_S1);
        H5Tset_size(text, H5T_VARIABLE);
        replace_attribute("case", text, 1)(id);
        H5Tclose(text);
      },
      "attribute case is not a text of fixed length");
}

}  // namespace
}  // namespace impinge
