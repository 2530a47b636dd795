#pragma once
// The command line of `impinge`.

#include <string>
#include <vector>

namespace impinge {

/// What the command line asks for.
struct CommandLine {
  std::string text;                          ///< not empty: print this, do nothing else, exit with 0
  std::string case_path;                     ///< CASE.toml
  std::string restart_directory;             ///< not empty: go on from the last checkpoint there
  std::vector<std::string> settings;         ///< "key=value" of each --set, in order
  bool check = false;                        ///< validate the case and say what it costs, but do not run it
  int plan_ranks = 0;                        ///< not 0: decompose the case for so many ranks, but do not run it
  std::vector<std::string> petsc_arguments;  ///< single-dash words and their values, in order
};

/// Parses `CASE.toml [--set key=value ...] [--check | --plan RANKS] [-petsc_option [value] ...]`, `--restart DIR`
/// instead of the case, or --help, --describe, --schema, --new NAME, --version. `arguments` has no program name. A word
/// of '-' and a letter goes to PETSc, and so does the word after it unless that is an option too or ends in .toml.
/// Reads no file. Throws InputError.
CommandLine parse_command_line(const std::vector<std::string>& arguments);

}  // namespace impinge
