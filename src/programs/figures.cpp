#include "impinge/programs/figures.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "impinge/core/errors.hpp"
#include "impinge/programs/program_directory.hpp"

namespace impinge {
namespace {

/// Pointers to the texts, and a null behind them.
std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// This process' environment without what a launcher of MPI has put there: Python's h5py would take itself for a rank.
std::vector<std::string> environment_without_mpi() {
  constexpr std::array<std::string_view, 5> launchers{"OMPI_", "PMIX_", "PMI_", "PRTE_", "MPI_LOCAL"};
  std::vector<std::string> kept;
  for (char** entry = environ; *entry; ++entry) {
    const std::string_view text(*entry);
    if (std::ranges::none_of(launchers, [&](std::string_view name) { return text.starts_with(name); }))
      kept.emplace_back(text);
  }
  return kept;
}

}  // namespace

bool draw(const std::vector<std::string>& arguments) {
  const auto program = program_directory() / "impinge-plot";
  std::vector<std::string> words{program.string()}, environment = environment_without_mpi();
  words.insert(words.end(), arguments.begin(), arguments.end());
  pid_t child = 0;
  int status = 0;
  const int error = posix_spawn(&child, program.c_str(), nullptr, nullptr, pointers_to(words).data(),
                                pointers_to(environment).data());
  if (error == ENOENT) {
    fmt::print(stderr, "impinge: there is no {}\n", program.string());
    return false;
  }
  if (error == 0 && waitpid(child, &status, 0) == child && status == 0) return true;
  constexpr int no_packages = 3, no_interpreter = 127;
  if (error == 0 && WIFEXITED(status) && (WEXITSTATUS(status) == no_packages || WEXITSTATUS(status) == no_interpreter))
    return false;
  throw FileError(
      fmt::format("no figures: {} {}", program.string(), error ? std::strerror(error) : "failed, see above"));
}

}  // namespace impinge
