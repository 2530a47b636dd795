#pragma once
// A case: typed, validated, immutable after it is read. SI units; lengths that the method scales are in dp.

#include <string>
#include <vector>

#include "impinge/config/case_file.hpp"
#include "impinge/core/errors.hpp"
#include "impinge/method/settings.hpp"
#include "impinge/observe/settings.hpp"
#include "impinge/scenes/settings.hpp"

namespace impinge {

/// Every key of a case file.
struct Case : MethodSettings, SceneSettings, ObserverSettings {
  std::string name;           ///< default: the case file's stem
  std::string spacing_place;  ///< where particles.spacing was given, for messages

  struct {
    std::string directory;        ///< default: output/<name>
    std::string directory_place;  ///< where it was given, for messages
    double interval = 0.0;        ///< time between snapshots [s]; 0: first and last only
  } output;

  struct {
    int steps = 0;          ///< a checkpoint every so many steps; 0: none by steps
    double interval = 0.0;  ///< and every so much simulated time [s]; 0: none by simulated time
    double minutes = 15.0;  ///< and every so many minutes of wall-clock time; 0: none by time
  } checkpoint;

  std::string resolved_text;  ///< the whole case as one TOML text, every key with its value
};

/// The case file followed by the files it includes (key `include`, relative to the including file) and by the .csv
/// files of its motions and walls, as texts. Reads the disk; not collective. Throws InputError (missing file, include
/// cycle) that also lists what else is wrong in the files it could read.
std::vector<NamedText> load_case_files(const std::string& path);

/// Parses and validates; later files are defaults for earlier ones, `settings` ("key=value") override all.
/// Touches no file. Throws InputError with every mistake, in the order of the files and their lines.
Case parse_case(const std::vector<NamedText>& files, const std::vector<std::string>& settings = {});

/// The case of a run that is restarted in `directory`: the case text of its checkpoint with `settings` over it. Reads
/// the meshes that it names. Throws InputError, also where a setting changes what a run cannot change; FileError where
/// the text itself is no case.
Case parse_restart(const NamedText& stored, const std::vector<std::string>& settings, const std::string& directory);

/// The case that a run stored with its results. Reads the meshes that it names; not collective. Throws InputError where
/// the text is no case.
Case parse_stored(const NamedText& stored);

/// True if both texts are the case of one run: they differ in keys that a restart can change, if in any. Throws
/// InputError where a text is no case.
bool are_of_one_run(const NamedText& one, const NamedText& other);

/// Every key with type, unit, default, range and doc line, as a text for the terminal.
std::string describe_keys();

/// Every key as a JSON schema of case files.
std::string schema_of_keys();

/// Creates the output directory where it does not exist and tries a file in it. Touches the disk; not collective.
/// Throws InputError that names the place of output.directory and the reason.
void check_writable(const Case& config);

}  // namespace impinge
