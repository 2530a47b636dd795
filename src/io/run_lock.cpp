#include "impinge/io/run_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <utility>

#include "impinge/core/errors.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds beat_interval{20};
constexpr double oldest_beat = 120.0;  // of a living owner on another host [s]

/// Who owns a directory.
struct Owner {
  std::string host;
  long process = 0;
  std::string started;  // by the kernel's clock, which tells a process from a later one of the same number
  std::string job;      // of the batch system, or "-"
  std::string space;    // of process numbers: that of a container is its own
};

/// When a process started, in the kernel's clock ticks; "-" where there is none, or one that has ended and only waits
/// for its parent.
std::string start_of(long process) {
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  std::string text((std::istreambuf_iterator<char>(file)), {});
  std::istringstream fields(text.substr(std::min(text.size(), text.rfind(')') + 1)));  // behind the program's name
  std::string state, field;
  fields >> state;
  for (int k = 4; k <= 22; ++k) fields >> field;
  return field.empty() || state == "Z" || state == "X" ? "-" : field;
}

Owner this_process() {
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  const char* job = "-";
  for (const char* name : {"SLURM_JOB_ID", "PBS_JOBID", "LSB_JOBID", "JOB_ID"})
    if (const char* value = std::getenv(name); value && *value) job = value;
  std::error_code error;
  const std::string space = fs::read_symlink("/proc/self/ns/pid", error).string();
  return {host, getpid(), start_of(getpid()), job, error ? "-" : space};
}

Owner owner_in(const std::string& path) {
  std::string text(4096, '\0');  // no honest lock is longer
  std::error_code error;
  if (fs::is_regular_file(path, error))
    std::ifstream(path).read(text.data(), static_cast<std::streamsize>(text.size()));
  Owner owner;
  std::istringstream(text.substr(0, text.find('\0'))) >> owner.host >> owner.process >> owner.started >> owner.job >>
      owner.space;
  return owner;
}

bool is_alive(const Owner& owner, const std::string& path) {
  const Owner self = this_process();
  if (owner.host == self.host && owner.space == self.space) return start_of(owner.process) == owner.started;
  struct stat status {};
  return stat(path.c_str(), &status) == 0 && std::difftime(std::time(nullptr), status.st_mtime) < oldest_beat;
}

/// A name beside the lock that no other process uses; short, since the case's name may be long.
std::string own_name(const std::string& path) {
  const Owner self = this_process();
  return fmt::format("{}.{:x}.{}", path, std::hash<std::string>{}(self.host + self.space), self.process);
}

/// Writes a file, opened with these flags beside O_WRONLY and O_CREAT; an error's number or 0.
int write_file(const std::string& path, int flags, const std::string& text) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | flags, 0644);
  if (file < 0) return errno;
  const bool written = write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  const int reason = written ? 0 : errno;
  close(file);
  if (!written) unlink(path.c_str());
  return reason;
}

/// Makes the lock unless there is one; an error's number or 0. It has its text from the start, so that whoever is
/// killed leaves none without; not so on file systems without links.
int create_lock(const std::string& path) {
  const Owner self = this_process();
  const std::string text = fmt::format("{} {} {} {} {}\n", self.host, self.process, self.started, self.job, self.space);
  const std::string own = own_name(path);
  int reason = write_file(own, O_TRUNC, text);
  if (reason != 0) return reason;
  if (link(own.c_str(), path.c_str()) != 0) reason = errno;
  unlink(own.c_str());
  return reason == EPERM || reason == ENOTSUP ? write_file(path, O_EXCL, text) : reason;
}

/// Takes a dead owner's lock away. Another process may do so at the same time and have put its own in the place: that
/// one is put back.
void remove_dead_lock(const std::string& path) {
  const std::string taken = own_name(path);
  if (rename(path.c_str(), taken.c_str()) != 0) return;
  std::error_code ignored;
  if (is_alive(owner_in(taken), taken)) fs::create_hard_link(taken, path, ignored);
  unlink(taken.c_str());
}

}  // namespace

RunLock::RunLock(const std::string& directory, const std::string& name)
    : path_((fs::path(directory) / (name + ".lock")).string()), last_beat_(Clock::now()) {
  for (int attempt = 0; attempt < 3; ++attempt) {
    errno = create_lock(path_);
    if (errno == 0) {
      inode_ = inode_of(path_);
      return;
    }
    if (errno != EEXIST) break;
    const Owner owner = owner_in(path_);
    if (is_alive(owner, path_)) {
      const std::string job = owner.job == "-" ? "" : fmt::format(", job {}", owner.job);
      const std::string own = std::exchange(path_, "");
      throw InputError(
          {fmt::format("{}: process {} on {}{} is writing this run; wait for its end, stop it, or choose "
                       "another output.directory",
                       own, owner.process, owner.host, job)});
    }
    remove_dead_lock(path_);
  }
  const std::string reason = std::strerror(errno);
  throw FileError(fmt::format("cannot write {}: {}", std::exchange(path_, ""), reason));
}

RunLock::RunLock(RunLock&& other) noexcept
    : path_(std::exchange(other.path_, "")), inode_(other.inode_), last_beat_(other.last_beat_) {}

RunLock& RunLock::operator=(RunLock&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(inode_, other.inode_);
  std::swap(last_beat_, other.last_beat_);
  return *this;
}

RunLock::~RunLock() {
  if (!path_.empty() && inode_of(path_) == inode_) unlink(path_.c_str());
}

RunLock::Inode RunLock::inode_of(const std::string& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 ? Inode{status.st_dev, status.st_ino} : Inode{};
}

void RunLock::check() const {
  if (path_.empty() || inode_of(path_) == inode_) return;
  const Owner owner = owner_in(path_);
  throw std::runtime_error(
      fmt::format("{}: {} has taken this run over; this process writes nothing more", path_,
                  owner.host.empty() ? "another process" : fmt::format("process {} on {}", owner.process, owner.host)));
}

void RunLock::beat() {
  if (path_.empty() || std::chrono::abs(Clock::now() - last_beat_) < beat_interval) return;
  check();
  last_beat_ = Clock::now();
  utimensat(AT_FDCWD, path_.c_str(), nullptr, 0);
}

}  // namespace impinge
