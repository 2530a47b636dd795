// impinge-validate: measures a run with a plane jet against the exact solution and draws it.

#include <fmt/format.h>
#include <mpi.h>
#include <spawn.h>
#include <sys/wait.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "impinge/cases/case.hpp"
#include "impinge/core/errors.hpp"
#include "impinge/core/mpi.hpp"
#include "impinge/validation/validation.hpp"

namespace {

namespace fs = std::filesystem;
using namespace impinge;

enum ExitCode { done = 0, broken = 1, wrong_input = 2 };

struct Arguments {
  std::string directory;
  SnapshotSelection selection;
  bool no_figures = false;
};

/// Runs `impinge-plot DIR`, which stands beside this program. Where Python or its packages are missing, that is told
/// and no error. Throws FileError.
void draw(const std::string& directory) {
  std::string program = (fs::read_symlink("/proc/self/exe").parent_path() / "impinge-plot").string();
  std::string argument = directory;
  const std::array<char*, 3> words{program.data(), argument.data(), nullptr};
  pid_t child = 0;
  int status = 0;
  const int error = posix_spawn(&child, program.c_str(), nullptr, nullptr, words.data(), environ);
  if (error == 0 && waitpid(child, &status, 0) == child && status == 0) return;
  const std::string problem =
      fmt::format("no figures: {} {}; the report is complete", program, error ? std::strerror(error) : "failed");
  constexpr int no_packages = 3, no_interpreter = 127;
  const bool is_missing =
      error == 0 && WIFEXITED(status) && (WEXITSTATUS(status) == no_packages || WEXITSTATUS(status) == no_interpreter);
  if (!is_missing) throw FileError(problem);
  fmt::print(stderr, "impinge-validate: {}\n", problem);
}

int run_program(const Arguments& arguments) {
  try {
    const std::string folder = (fs::path(arguments.directory) / "validation").string();
    const Validation validation = validate(arguments.directory, arguments.selection);
    write_report(validation, folder);
    fmt::print("{}\nreport     {}/validation.json\n", to_table(validation), folder);
    std::fflush(stdout);
    if (!arguments.no_figures) draw(arguments.directory);
    return done;
  } catch (const InputError& error) {
    for (const std::string& mistake : error.mistakes()) fmt::print(stderr, "impinge-validate: {}\n", mistake);
    return wrong_input;
  } catch (const std::exception& error) {
    fmt::print(stderr, "impinge-validate: {}\n", error.what());
    return broken;
  }
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app(
      "Measures a run with a plane jet against the exact solution: geometry = \"jet\", or a jet of a scene on a plate, "
      "a "
      "wedge, a cup or another jet. Reads the snapshots in DIR; writes the report, profiles "
      "and figures into DIR/validation.",
      "impinge-validate");
  app.footer("\nExit codes: 0 done, 1 a file could not be read or written, 2 wrong input");
  app.set_version_flag("--version", "impinge " IMPINGE_VERSION, "Print the version");
  app.add_option("directory", arguments.directory, "Output directory of the run")->required()->option_text("DIR");
  app.add_option("--from", arguments.selection.from,
                 "Compare snapshots from this time [s]. Without either bound: those of the wall-pressure average")
      ->option_text("T");
  app.add_option("--to", arguments.selection.to, "Compare snapshots up to this time [s]")->option_text("T");
  app.add_flag("--no-figures", arguments.no_figures, "Draw no figures")->disable_flag_override();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? done : wrong_input;
  }
  MPI_Init(&argc, &argv);
  const int code = launched_process().rank == 0 ? run_program(arguments) : done;  // of several processes the first
  MPI_Finalize();
  return code;
}
