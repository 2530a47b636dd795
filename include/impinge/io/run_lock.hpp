#pragma once
// One owner of an output directory at a time.

#include <chrono>
#include <string>

namespace impinge {

/// A file that names the process which writes a run's files: `<directory>/<name>.lock`, with host, process and batch
/// job. It goes with the object. A lock whose owner is dead gives way: on the same host, a process that is no more; on
/// another, a file that has not been touched for two minutes. Works on shared file systems. Nothing here is collective.
class RunLock {
 public:
  /// Owns nothing.
  RunLock() = default;

  /// Throws InputError, with the owner's name, where another process owns the directory; FileError where the lock
  /// cannot be written.
  RunLock(const std::string& directory, const std::string& name);
  RunLock(RunLock&& other) noexcept;
  RunLock& operator=(RunLock&& other) noexcept;
  ~RunLock();

  /// Touches the file now and then. To be called at least every half minute.
  void beat();

 private:
  std::string path_;
  std::chrono::steady_clock::time_point last_beat_;
};

}  // namespace impinge
