// Fuzzes the reader of case files: whatever the text, it gives a case or an InputError; and the resolved text of a case
// that it takes reads back to the same case. What --check tells of the case's scene can be told.
//
// The input is a case file and what belongs to it, parted by lines of "#--": a part that begins with the line "#set"
// has a setting in each further line; the other parts are the files case.toml, 1.toml, 2.toml, ...; what stands after a
// line "#csv", "#stl", "#obj" or "#ply" is 1.csv, 2.stl, ...

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz_directory.hpp"
#include "impinge/cases/case.hpp"
#include "impinge/observe/observer_report.hpp"
#include "impinge/scenes/scene_report.hpp"

namespace {

namespace fs = std::filesystem;
using namespace impinge;

std::vector<std::string_view> parts_of(std::string_view text) {
  constexpr std::string_view divider = "\n#--\n";
  std::vector<std::string_view> parts;
  for (auto end = text.find(divider); end != text.npos; end = text.find(divider)) {
    parts.push_back(text.substr(0, end));
    text.remove_prefix(end + divider.size());
  }
  parts.push_back(text);
  return parts;
}

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "%s\n", what.c_str());
  std::abort();
}

void expect_round_trip(const Case& config) {
  try {
    const Case again = parse_stored({"resolved.toml", config.resolved_text});
    if (again.resolved_text != config.resolved_text)
      fail("another case comes back:\n" + config.resolved_text + "\n" + again.resolved_text);
  } catch (const InputError& error) {
    fail("the resolved text is refused:\n" + config.resolved_text + "\n" + error.what());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const FuzzDirectory directory;
  std::vector<std::string> settings;
  std::vector<fs::path> files;
  for (const std::string_view part : parts_of({reinterpret_cast<const char*>(data), size})) {
    if (!files.empty() && part.starts_with("#set\n")) {
      std::istringstream lines{std::string(part.substr(5))};
      for (std::string line; std::getline(lines, line);) settings.push_back(line);
    } else if (files.empty()) {
      files.push_back(directory.path() / "case.toml");
      std::ofstream(files.back(), std::ios::binary) << part;
    } else {
      constexpr std::string_view endings[] = {"csv", "stl", "obj", "ply"};
      const bool is_named = part.size() > 4 && part[0] == '#' && part[4] == '\n' &&
                            std::ranges::find(endings, part.substr(1, 3)) != std::ranges::end(endings);
      const std::string ending(is_named ? part.substr(1, 3) : "toml");
      files.push_back(directory.path() / (std::to_string(files.size()) + "." + ending));
      std::ofstream(files.back(), std::ios::binary) << (is_named ? part.substr(5) : part);
    }
  }
  try {
    const std::vector<NamedText> texts = load_case_files(files.front());
    const Case config = parse_case(texts, settings);
    expect_round_trip(config);
    report_scene(config, config);
    observer_lines(config, config.dimension);
  } catch (const InputError& error) {
    if (error.mistakes().empty()) fail("an InputError without a mistake");
  }
  for (const fs::path& file : files) fs::remove(file);
  return 0;
}
