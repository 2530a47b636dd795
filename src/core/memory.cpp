#include "impinge/core/memory.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

namespace impinge {
namespace {

namespace fs = std::filesystem;

constexpr double unlimited = std::numeric_limits<double>::infinity();
constexpr double kilobyte = 1024.0;  // of /proc

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// What the control group of a directory leaves; the cache of its files can be dropped [bytes].
double free_in_group(const fs::path& group) {
  const double most = number_behind("", text_of(group / "memory.max"));
  if (most == unlimited) return unlimited;
  const double used = number_behind("", text_of(group / "memory.current"));
  const double cache = number_behind("file", text_of(group / "memory.stat"));
  return std::max(0.0, most - used + (cache == unlimited ? 0.0 : cache));
}

}  // namespace

double number_behind(std::string_view name, std::string_view text) {
  for (std::size_t begin = 0; begin < text.size();) {
    const std::string_view line = text.substr(begin, text.find('\n', begin) - begin);
    begin += line.size() + 1;
    if (!line.starts_with(name)) continue;
    const std::string_view rest = line.substr(name.size());
    if (!name.empty() && !rest.starts_with(':') && !rest.starts_with(' ')) continue;
    const std::string_view number = rest.substr(std::min(rest.find_first_not_of(": \t"), rest.size()));
    double value = 0.0;
    if (std::from_chars(number.data(), number.data() + number.size(), value).ec == std::errc()) return value;
  }
  return unlimited;
}

double free_memory_of_node() {
  double least = kilobyte * number_behind("MemAvailable", text_of("/proc/meminfo"));
  // The line "0::/group" of control groups, version 2; each group bounds those below it.
  const std::string groups = text_of("/proc/self/cgroup");
  const auto begin = groups.find("0::/");
  if (begin == groups.npos) return least;
  const fs::path root = "/sys/fs/cgroup";
  fs::path group = root / groups.substr(begin + 4, groups.find('\n', begin) - begin - 4);
  for (; group != root && group.has_relative_path(); group = group.parent_path())
    least = std::min(least, free_in_group(group));
  return std::min(least, free_in_group(root));  // within a container, the root is its own group
}

double free_memory_of_process() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unlimited;
  const double used = kilobyte * number_behind("VmSize", text_of("/proc/self/status"));
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - (used == unlimited ? 0.0 : used));
}

std::string bytes_text(double bytes) {
  if (bytes == unlimited) return "any memory";
  return bytes < 1e9 ? fmt::format("{:.3g} MB", bytes / 1e6) : fmt::format("{:.3g} GB", bytes / 1e9);
}

}  // namespace impinge
