#include "impinge/programs/command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>

#include "impinge/cases/case.hpp"
#include "impinge/cases/new_cases.hpp"
#include "impinge/observe/history.hpp"
#include "impinge/programs/program_directory.hpp"

namespace impinge {
namespace {

constexpr const char* description =
    "Impinge computes free-surface flow by the MPS particle method on any number of MPI ranks.\n"
    "  mpirun -n 2 impinge CASE.toml [--set key=value ...] [-petsc_option [value] ...]\n"
    "  mpirun -n 2 impinge --restart DIR [--set key=value ...] [-petsc_option [value] ...]";

constexpr const char* footer = R"(
PETSc options have a single dash; the pressure solver's start with -ppe_. An option that nobody uses is an error.
  -ppe_ksp_type cg                    Krylov method
  -ppe_pc_type two_level|hypre|gamg   preconditioner
  -ppe_coarse_pc_type hypre|gamg      preconditioner of two_level's coarse grid
  -ppe_ksp_monitor                    residual of every iteration
  -log_view                           time of every phase of the step

SIGTERM, SIGINT, SIGUSR1, SIGHUP and the like end a run after its step, with a checkpoint; a second SIGINT ends it at
once. A signal that was ignored at the start (nohup) stays ignored.

Exit codes: 0 done, 1 environment or bug, 2 wrong input, 3 failed solve or diverged flow, 4 ended by a signal with a
checkpoint: --restart goes on)";

bool is_petsc_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1])) && word != "-h";
}

/// The value of a PETSc option may be a negative number, but neither an option nor the case file.
bool may_be_value(const std::string& word) {
  return !is_petsc_option(word) && !word.starts_with("--") && word != "-h" && !word.ends_with(".toml");
}

std::vector<std::string> names_of_new_cases() {
  std::vector<std::string> names;
  for (const NewCase& one : new_cases()) names.emplace_back(one.name);
  return names;
}

/// A case to start from. Where the schema is built or installed, the first line names it for editors.
std::string new_case(const std::string& name) {
  const auto schema = program_directory().parent_path() / "share/impinge/impinge.schema.json";
  std::error_code error;
  return fmt::format("{}{}",
                     std::filesystem::exists(schema, error) ? fmt::format("#:schema {}\n", schema.string()) : "",
                     std::ranges::find(new_cases(), name, &NewCase::name)->text);
}

}  // namespace

CommandLine parse_command_line(const std::vector<std::string>& arguments) {
  CommandLine line;
  std::vector<std::string> own;
  for (auto word = arguments.begin(); word != arguments.end(); ++word) {
    if (!is_petsc_option(*word)) {
      own.push_back(*word);
      continue;
    }
    line.petsc_arguments.push_back(*word);
    const auto next = std::next(word);
    if (next != arguments.end() && may_be_value(*next)) line.petsc_arguments.push_back(*++word);
  }

  for (const std::string& word : own)  // no word of ours has a '_'
    if (word.starts_with("--") && word.substr(0, word.find('=')).find('_') != word.npos)
      throw InputError(
          {fmt::format("command line: {}: options of PETSc have a single dash: {}", word, word.substr(1))});

  bool describe = false, schema = false;
  std::string new_name;
  CLI::App app(description, "impinge");
  app.get_formatter()->column_width(32);
  app.footer(footer);
  app.set_help_flag("-h,--help", "Print this text");
  app.set_version_flag("--version", "impinge " IMPINGE_VERSION, "Print the version");
  app.add_flag("--describe", describe,
               "Print every key of a case file and every column of the history with unit and meaning")
      ->disable_flag_override();
  app.add_flag("--schema", schema, "Print a JSON schema of case files, by which editors check and complete them")
      ->disable_flag_override();
  app.add_option("--new", new_name, "Print a case to start from")
      ->option_text(fmt::format("{}", fmt::join(names_of_new_cases(), "|")))
      ->check(CLI::IsMember(names_of_new_cases()).description(""));
  app.add_flag("--check", line.check,
               "Validate the case; print its particles, memory, scene and time step limits; draw the scene")
      ->disable_flag_override();
  app.add_option("--plan", line.plan_ranks, "Decompose the case for 1 to 1000000 ranks; print balance, halo, memory")
      ->option_text("RANKS")
      ->check(CLI::Range(1, 1000000).description(""))
      ->excludes("--check");
  app.add_option("--restart", line.restart_directory,
                 "Go on with the run in DIR from its last checkpoint, with --set over its case")
      ->option_text("DIR")
      ->excludes("--check")
      ->excludes("--plan");
  app.add_option("--set", line.settings, "Set a key of the case, over its files; may be repeated")
      ->option_text("KEY=VALUE")
      ->allow_extra_args(false);
  app.add_option("case", line.case_path, "The case file")->option_text("CASE.toml")->excludes("--restart");

  const auto fail = [](const std::string& what) {
    throw InputError({fmt::format("command line: {}; see impinge --help", what)});
  };
  try {
    std::ranges::reverse(own);  // CLI11 takes the words from the back
    app.parse(own);
    if (describe) line.text = describe_keys() + "\n" + describe_history();
    if (schema) line.text = schema_of_keys();
    if (!new_name.empty()) line.text = new_case(new_name);
  } catch (const CLI::CallForHelp&) {
    line.text = app.help();
  } catch (const CLI::CallForVersion& version) {
    line.text = fmt::format("{}\n", version.what());
  } catch (const CLI::ParseError& error) {
    fail(error.what());
  }
  if (line.text.empty() && line.case_path.empty() && line.restart_directory.empty()) {
    fail(line.petsc_arguments.empty() || is_petsc_option(line.petsc_arguments.back())
             ? "the case file is missing"
             : fmt::format("the case file is missing ({} is taken for the value of a PETSc option)",
                           line.petsc_arguments.back()));
  }
  return line;
}

}  // namespace impinge
