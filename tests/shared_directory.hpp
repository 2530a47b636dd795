#pragma once
// A directory for the files of a test.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "impinge/core/errors.hpp"
#include "impinge/parallel/exchange.hpp"

namespace impinge {

/// A directory that all ranks share, removed at the end.
class SharedDirectory : public testing::Test {
 protected:
  void SetUp() override {
    namespace fs = std::filesystem;
    path_ =
        broadcast(MPI_COMM_WORLD, (fs::temp_directory_path() / ("impinge_" + std::to_string(getpid()))).string(), 0);
    if (rank_of(MPI_COMM_WORLD) == 0) fs::create_directories(path_);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  void TearDown() override {
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank_of(MPI_COMM_WORLD) == 0) std::filesystem::remove_all(path_);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  std::string path(const std::string& name) const { return (std::filesystem::path(path_) / name).string(); }

  std::string path_;
};

/// What an action's FileError says; empty where there is none.
template <class Action>
std::string failure_of(Action action) {
  try {
    action();
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

}  // namespace impinge
