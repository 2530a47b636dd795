#pragma once
// The files of a run: their names in its output directory, and how text files and names get onto the disk. Nothing here
// is collective.

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace impinge {

/// What the files of a run are called, and the case that they are of.
struct RunFiles {
  std::string directory;
  std::string name;       ///< of the case: how every file's name begins
  std::string case_text;  ///< the resolved case, TOML
};

/// `<directory>/<name>_<step, 8 digits>.vtkhdf`.
std::string snapshot_path(const std::string& directory, const std::string& name, std::int64_t step);

/// `<directory>/<name>_<step, 8 digits>.checkpoint`.
std::string checkpoint_path(const std::string& directory, const std::string& name, std::int64_t step);

/// Every kind of table: the history, and what is observed.
inline constexpr std::array table_kinds{"history", "probes", "gauges", "sections", "forces", "outlets"};

/// `<directory>/<name>_<kind>.csv`.
std::string table_path(const std::string& directory, const std::string& name, const std::string& kind);

/// `<directory>/<name>_history.csv`.
std::string history_path(const std::string& directory, const std::string& name);

/// `<directory>/<name>.xmf`.
std::string series_path(const std::string& directory, const std::string& name);

/// `<directory>/<name>.vtkhdf.series`.
std::string file_series_path(const std::string& directory, const std::string& name);

/// `<directory>/<name>_scene.vtkhdf`: the scene that --check draws. It is of the case, not of a run.
std::string scene_path(const std::string& directory, const std::string& name);

/// Snapshots in a directory, ordered by step: those of the case `name`, or all if it is empty. Throws FileError where
/// the directory cannot be read.
std::vector<std::string> list_snapshots(const std::string& directory, const std::string& name = "");

/// Checkpoints, likewise.
std::vector<std::string> list_checkpoints(const std::string& directory, const std::string& name = "");

/// Snapshots and checkpoints of the case `name` whose writing was broken off, likewise.
std::vector<std::string> list_partial_files(const std::string& directory, const std::string& name);

/// Case name and step in the name of a snapshot or checkpoint. Throws FileError for other names.
std::pair<std::string, std::int64_t> name_and_step(const std::string& path);

/// Tries in the directory the longest file name that a run of the case may have. Returns why there can be none; nothing
/// if all is well.
std::string try_longest_name(const std::string& directory, const std::string& name);

/// What a file is called until it is complete.
std::string partial_path(const std::string& path);

/// True if the directory has a snapshot or checkpoint of the case. Throws FileError.
bool holds_run(const std::string& directory, const std::string& name);

/// Moves all that a run of the case has left in the directory, its validation among it, into a new folder there,
/// `<name>_before_<date>_<time>`. Returns the folder. Throws FileError.
std::string set_run_aside(const std::string& directory, const std::string& name);

/// Forces a file or directory to the disk. Returns why it could not; nothing if all is well.
std::string synchronise(const std::string& path);

/// Writes a text file: complete under its name, or not at all. Throws FileError.
void write_text(const std::string& path, const std::string& text);

/// Removes a file. Throws FileError.
void remove_file(const std::string& path);

}  // namespace impinge
