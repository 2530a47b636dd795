#include "impinge/programs/standard_streams.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <utility>

namespace impinge {
namespace {

int failure = 0;  // errno of the first write to standard output that failed

ssize_t write_or_drop(void*, const char* text, std::size_t size) {
  for (std::size_t written = 0; failure == 0 && written < size;) {
    const ssize_t now = write(STDOUT_FILENO, text + written, size - written);
    if (now >= 0) {
      written += static_cast<std::size_t>(now);
    } else if (errno != EINTR) {
      failure = errno;
    }
  }
  return static_cast<ssize_t>(size);
}

}  // namespace

void prepare_streams() {
  int next = 0;
  while (next >= 0 && next <= STDERR_FILENO) next = open("/dev/null", O_RDWR);
  if (next >= 0) close(next);
  std::signal(SIGXFSZ, SIG_IGN);
  // Standard error stays as it is: Open MPI asks for its descriptor, and errno would no longer tell why a write failed.
  if (std::FILE* const file = fopencookie(nullptr, "w", {nullptr, write_or_drop, nullptr, nullptr})) {
    std::setvbuf(file, nullptr, isatty(STDOUT_FILENO) ? _IOLBF : _IOFBF, BUFSIZ);
    stdout = file;
  }
}

bool flush_output(const char* program) {
  std::fflush(stdout);
  if (failure == 0) return true;
  static bool told = false;
  if (!std::exchange(told, true))
    fmt::print(stderr, "{}: cannot write to standard output: {}\n", program, std::strerror(failure));
  return false;
}

}  // namespace impinge
