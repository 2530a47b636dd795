// impinge-validate: measures a run with a jet against the exact solution and draws it.

#include <fmt/format.h>
#include <mpi.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "impinge/cases/case.hpp"
#include "impinge/core/errors.hpp"
#include "impinge/core/mpi.hpp"
#include "impinge/programs/figures.hpp"
#include "impinge/programs/standard_streams.hpp"
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

int run_program(const Arguments& arguments) {
  try {
    const std::string folder = (fs::path(arguments.directory) / "validation").string();
    const Validation validation = validate(arguments.directory, arguments.selection);
    write_report(validation, folder);
    fmt::print("{}\nreport     {}/validation.json\n", to_table(validation), folder);
    flush_output("impinge-validate");
    if (!arguments.no_figures && !draw({arguments.directory}))
      fmt::print(stderr, "impinge-validate: no figures: impinge-plot failed; the report is complete\n");
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
  prepare_streams();
  Arguments arguments;
  CLI::App app(
      "Measures a run with a jet against the exact solution: geometry = \"jet\", or a jet of a scene on a plate, "
      "a wedge, a cup or another jet; in three dimensions a round jet or a slot jet on a flat wall. Reads the "
      "snapshots in DIR; writes the report, profiles "
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
    const int code = app.exit(error);
    if (!std::cout.flush()) return broken;
    return code == 0 ? done : wrong_input;
  }
  MPI_Init(&argc, &argv);
  const int code = launched_process().rank == 0 ? run_program(arguments) : done;  // of several processes the first
  MPI_Finalize();
  return code;
}
