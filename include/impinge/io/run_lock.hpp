#pragma once
// One owner of an output directory at a time.

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>

namespace impinge {

/// A file that names the process which writes a run's files: `<directory>/<name>.lock`, with host, process and batch
/// job. It goes with the object. A lock whose owner is dead gives way: on the same host, a process that is no more; on
/// another host or in another container, a file that has not been touched for two minutes. Works on shared file
/// systems. Nothing here is collective.
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

  /// Throws std::runtime_error where another process has taken the directory over, for this one stood still too long.
  void check() const;

  /// Now and then checks the file and touches it. To be called before each write, at least every half minute.
  void beat();

 private:
  using Clock = std::chrono::system_clock;  // goes on while the machine sleeps
  using Inode = std::pair<std::uintmax_t, std::uintmax_t>;

  static Inode inode_of(const std::string& path);

  std::string path_;
  Inode inode_{};
  Clock::time_point last_beat_;
};

}  // namespace impinge
