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

struct Stream {
  int descriptor;
  int failure = 0;  // errno of the first write that failed
};

Stream output{STDOUT_FILENO}, errors{STDERR_FILENO};

ssize_t write_or_drop(void* cookie, const char* text, std::size_t size) {
  Stream& stream = *static_cast<Stream*>(cookie);
  for (std::size_t written = 0; stream.failure == 0 && written < size;) {
    const ssize_t now = write(stream.descriptor, text + written, size - written);
    if (now >= 0) {
      written += static_cast<std::size_t>(now);
    } else if (errno != EINTR) {
      stream.failure = errno;
    }
  }
  return static_cast<ssize_t>(size);
}

std::FILE* tolerant(Stream& stream, int buffering, std::FILE* otherwise) {
  std::FILE* const file = fopencookie(&stream, "w", {nullptr, write_or_drop, nullptr, nullptr});
  if (!file) return otherwise;
  std::setvbuf(file, nullptr, buffering, BUFSIZ);
  return file;
}

}  // namespace

void prepare_streams() {
  int next = 0;
  while (next >= 0 && next <= STDERR_FILENO) next = open("/dev/null", O_RDWR);
  if (next >= 0) close(next);
  std::signal(SIGXFSZ, SIG_IGN);
  stdout = tolerant(output, isatty(STDOUT_FILENO) ? _IOLBF : _IOFBF, stdout);
  stderr = tolerant(errors, _IONBF, stderr);
}

bool flush_output(const char* program) {
  std::fflush(stdout);
  if (output.failure == 0) return true;
  static bool told = false;
  if (!std::exchange(told, true))
    fmt::print(stderr, "{}: cannot write to standard output: {}\n", program, std::strerror(output.failure));
  return false;
}

}  // namespace impinge
