#pragma once
// A place for the files that a fuzzer writes.

#include <unistd.h>

#include <filesystem>
#include <string>

/// An empty directory in memory, removed at the end.
class FuzzDirectory {
 public:
  FuzzDirectory() : path_("/dev/shm/impinge_fuzz_" + std::to_string(getpid())) {
    std::filesystem::create_directories(path_);
  }
  ~FuzzDirectory() { std::filesystem::remove_all(path_); }
  FuzzDirectory(const FuzzDirectory&) = delete;
  FuzzDirectory& operator=(const FuzzDirectory&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};
