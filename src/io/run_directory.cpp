#include "impinge/io/run_directory.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <optional>
#include <regex>

#include "impinge/core/errors.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;

const std::string snapshot_ending = ".vtkhdf";
const std::string checkpoint_ending = ".checkpoint";
const std::string partial_ending = ".partial";

std::string path_of(const std::string& directory, const std::string& file) {
  return (fs::path(directory) / file).string();
}

std::string path_of_step(const std::string& directory, const std::string& name, std::int64_t step,
                         const std::string& ending) {
  return path_of(directory, fmt::format("{}_{:08}{}", name, step, ending));
}

/// Case name and step of `<name>_<step, 8 digits or more><ending>`, whatever the directory; nothing for other names.
std::optional<std::pair<std::string, std::int64_t>> name_and_step_before(const std::string& ending,
                                                                         const std::string& path) {
  static const std::regex form(R"((.+)_(\d{8,18}))");
  const std::string file = fs::path(path).filename().string();
  std::smatch match;
  if (!file.ends_with(ending)) return {};
  const std::string stem = file.substr(0, file.size() - ending.size());
  if (!std::regex_match(stem, match, form)) return {};
  return std::pair{match[1].str(), static_cast<std::int64_t>(std::stoll(match[2]))};
}

/// Files of one case, or of all if `name` is empty, and of one ending, ordered by step.
std::vector<std::string> list_files(const std::string& directory, const std::string& name, const std::string& ending) {
  std::vector<std::pair<std::int64_t, std::string>> found;
  std::error_code error;
  for (auto entry = fs::directory_iterator(directory, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    const auto at = name_and_step_before(ending, entry->path().string());
    if (at && (name.empty() || at->first == name)) found.emplace_back(at->second, entry->path().string());
  }
  if (error) throw FileError(fmt::format("cannot read the directory {}: {}", directory, error.message()));
  std::sort(found.begin(), found.end());
  std::vector<std::string> paths;
  for (auto& [step, path] : found) paths.push_back(std::move(path));
  return paths;
}

}  // namespace

std::string snapshot_path(const std::string& directory, const std::string& name, std::int64_t step) {
  return path_of_step(directory, name, step, snapshot_ending);
}

std::string checkpoint_path(const std::string& directory, const std::string& name, std::int64_t step) {
  return path_of_step(directory, name, step, checkpoint_ending);
}

std::string table_path(const std::string& directory, const std::string& name, const std::string& kind) {
  return path_of(directory, fmt::format("{}_{}.csv", name, kind));
}

std::string history_path(const std::string& directory, const std::string& name) {
  return table_path(directory, name, "history");
}

std::string series_path(const std::string& directory, const std::string& name) {
  return path_of(directory, name + ".xmf");
}

std::string file_series_path(const std::string& directory, const std::string& name) {
  return path_of(directory, name + snapshot_ending + ".series");
}

std::string scene_path(const std::string& directory, const std::string& name) {
  return path_of(directory, name + "_scene" + snapshot_ending);
}

std::vector<std::string> list_snapshots(const std::string& directory, const std::string& name) {
  return list_files(directory, name, snapshot_ending);
}

std::vector<std::string> list_checkpoints(const std::string& directory, const std::string& name) {
  return list_files(directory, name, checkpoint_ending);
}

std::vector<std::string> list_partial_files(const std::string& directory, const std::string& name) {
  std::vector<std::string> all = list_files(directory, name, snapshot_ending + partial_ending);
  for (std::string& path : list_files(directory, name, checkpoint_ending + partial_ending))
    all.push_back(std::move(path));
  return all;
}

std::pair<std::string, std::int64_t> name_and_step(const std::string& path) {
  for (const std::string& ending : {snapshot_ending, checkpoint_ending})
    if (const auto found = name_and_step_before(ending, path)) return *found;
  throw FileError(fmt::format("{} is not named as a snapshot or checkpoint", path));
}

std::string try_longest_name(const std::string& directory, const std::string& name) {
  constexpr std::int64_t largest_step = 999'999'999'999'999'999;
  const std::string path = partial_path(checkpoint_path(directory, name, largest_step));
  errno = 0;
  if (!std::ofstream(path)) return std::strerror(errno);
  std::error_code ignored;
  fs::remove(path, ignored);
  return "";
}

std::string partial_path(const std::string& path) { return path + partial_ending; }

bool holds_run(const std::string& directory, const std::string& name) {
  return fs::exists(directory) &&
         (fs::exists(history_path(directory, name)) || !list_snapshots(directory, name).empty() ||
          !list_checkpoints(directory, name).empty());
}

std::string set_run_aside(const std::string& directory, const std::string& name) {
  const std::time_t now = std::time(nullptr);
  const fs::path stem = fs::path(directory) / fmt::format("{}_before_{:%Y-%m-%d_%H%M%S}", name, fmt::localtime(now));
  fs::path folder = stem;
  std::error_code error;
  for (int k = 2; !fs::create_directory(folder, error) && !error; ++k) folder = fmt::format("{}_{}", stem.string(), k);
  std::vector<std::string> files = list_snapshots(directory, name);
  for (std::string& path : list_checkpoints(directory, name)) files.push_back(std::move(path));
  std::vector<std::string> others{series_path(directory, name), file_series_path(directory, name)};
  for (const std::string& own : {std::string("validation"), name + "_figures", name + "_report.html"})
    others.push_back(path_of(directory, own));
  for (const char* kind : table_kinds) others.push_back(table_path(directory, name, kind));
  for (std::string& path : others)
    if (fs::exists(path)) files.push_back(std::move(path));
  for (const std::string& path : files)
    if (!error) fs::rename(path, folder / fs::path(path).filename(), error);
  if (error) throw FileError(fmt::format("cannot set the earlier run in {} aside: {}", directory, error.message()));
  return folder.string();
}

std::string synchronise(const std::string& path) {
  const int descriptor = open(path.c_str(), O_RDONLY);
  const bool done = descriptor >= 0 && fsync(descriptor) == 0;
  const std::string reason = done ? "" : std::strerror(errno);
  if (descriptor >= 0) close(descriptor);
  return reason;
}

void write_text(const std::string& path, const std::string& text) {
  const std::string partial = partial_path(path);
  errno = 0;
  std::ofstream file(partial);
  file << text;
  file.close();
  std::string reason = file ? synchronise(partial) : std::strerror(errno);
  if (reason.empty() && std::rename(partial.c_str(), path.c_str()) != 0) reason = std::strerror(errno);
  if (!reason.empty()) throw FileError(fmt::format("cannot write {}: {}", path, reason));
}

void remove_file(const std::string& path) {
  std::error_code error;
  fs::remove(path, error);
  if (error) throw FileError(fmt::format("cannot remove {}: {}", path, error.message()));
}

}  // namespace impinge
