#include "impinge/cases/case.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "impinge/config/schema.hpp"
#include "impinge/core/errors.hpp"
#include "impinge/geometry/mesh_file.hpp"
#include "impinge/scenes/scenes.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;

constexpr double most_intervals = 1e6;  // of output until time.end

void declare(Keys& keys, Case& c) {
  keys.add("name", c.name, "name of the case, in the names of its output files",
           {.fixed = true, .fallback = "the case file's stem"});
  keys.add("geometry", c.geometry, "what is computed", {.required = true, .fixed = true});
  declare_method(keys, c);
  declare_scenes(keys, c);

  keys.add("output.directory", c.output.directory, "directory of the output files",
           {.fixed = true, .fallback = "output/<name>"});
  keys.add("output.interval", c.output.interval, "time between snapshots; 0: the first and the last only",
           {.unit = "s", .range = not_negative});
  keys.add("output.average_start", c.average_start, "start of the time average of the wall pressure",
           {.unit = "s", .range = not_negative, .fallback = "0.8 x time.end"});
  declare_observers(keys, c);
  keys.add("checkpoint.steps", c.checkpoint.steps,
           "steps from one checkpoint to the next; 0: none by steps. With any of these keys, a run also ends with one",
           {.range = from_to(0, 1e9)});
  keys.add("checkpoint.interval", c.checkpoint.interval,
           "simulated time from one checkpoint to the next; 0: none by simulated time",
           {.unit = "s", .range = not_negative});
  keys.add("checkpoint.minutes", c.checkpoint.minutes,
           "wall-clock time from one checkpoint to the next; 0: none by time", {.unit = "min", .range = not_negative});
  declare_parallel(keys, c.parallel);
}

/// What is wrong with a text of which the names of files shall be made, within an XDMF file "name:dataset"; nothing if
/// all is well.
std::string file_name_problem(const std::string& name) {
  if (std::string problem = text_problem(name); !problem.empty()) return problem;
  if (const auto found = name.find_first_of("/:"); found != name.npos) return fmt::format("has a '{}'", name[found]);
  if (name.starts_with(' ') || name.ends_with(' ')) return "has a space at an end";
  if (name == "." || name == "..") return "is a directory";
  return name.size() > 200 ? "longer than 200 bytes" : "";
}

void derive(const Keys& keys, Case& c, const SceneInputs& inputs, const std::string& file) {
  if (!keys.given(c.name)) c.name = fs::path(file).stem();
  if (!keys.given(c.output.directory)) c.output.directory = fmt::format("output/{}", c.name);
  c.output.directory_place = keys.place(c.output.directory);
  c.spacing_place = keys.place(c.particles.spacing);
  if (!keys.given(c.average_start)) c.average_start = 0.8 * c.time.end;
  derive_scene(keys, c, inputs);
  derive_observers(keys, c.dimension, c);
  derive_method(keys, c, reference_speed(keys, c, inputs));
}

void check(Keys& keys, const Case& c, const SceneInputs& inputs) {
  if (keys.usable(c.name)) {
    if (const std::string problem = file_name_problem(c.name); !problem.empty())
      keys.mistake(c.name, fmt::format("{}, but file names are made of it; allowed: 1 to 200 bytes of UTF-8 without /, "
                                       ":, control characters and spaces at its ends",
                                       problem));
  }
  if (keys.usable(c.name, c.output.directory))
    if (const std::string problem = path_problem(c.output.directory); !problem.empty())
      keys.mistake(c.output.directory, problem);
  if (keys.given(c.average_start) && keys.usable(c.average_start, c.time.end) && c.average_start >= c.time.end) {
    keys.mistake(c.average_start,
                 fmt::format("the average starts after the end; allowed: [0, {}) (s)", number_text(c.time.end)));
  }
  for (const double* interval : {&c.output.interval, &c.checkpoint.interval}) {
    if (!keys.usable(*interval, c.time.end) || *interval == 0.0) continue;
    if (const double least = c.time.end / most_intervals; *interval < least)
      keys.mistake(*interval, fmt::format("more than a million files until time.end; allowed: 0 or from {} on (s)",
                                          number_text(least)));
  }
  check_method(keys, c);
  check_scene(keys, c, inputs);
  if (!keys.usable(c.dimension) || !c.observes()) return;
  const bool has_scene = keys.is_sound();
  check_observers(keys, c.dimension, c);
  if (has_scene && c.dimension == 2) check_observers_in(keys, make_scene<2>(c, c), c.particles.spacing, c);
  if (has_scene && c.dimension == 3) check_observers_in(keys, make_scene<3>(c, c), c.particles.spacing, c);
}

constexpr std::size_t largest_table = 1 << 20, largest_mesh = 200 << 20;  // [bytes]

bool is_table(std::string_view name) { return name.ends_with(".csv"); }

/// True for the name of a file that a case file names by a key.
bool is_named(std::string_view name) { return is_table(name) || is_mesh_file(name); }

/// Adds the meshes that the files name.
void load_meshes(std::vector<NamedText>& files) {
  for (const char* list : {"wall", "fluid.region", "outlet"})
    load_named_files(files, list, "file", is_mesh_file, largest_mesh);
}

/// A stored case with the meshes that it names.
std::vector<NamedText> with_meshes(const NamedText& stored) {
  std::vector<NamedText> files{stored};
  load_meshes(files);
  return files;
}

/// Names and values of the keys that a restart cannot change.
using FixedValues = std::vector<std::pair<std::string, std::string>>;

Case parse(const std::vector<NamedText>& all, const std::vector<std::string>& settings, FixedValues& fixed) {
  // The case file itself may have any name.
  const auto first_named =
      std::ranges::find_if(all.begin() + 1, all.end(), [](const NamedText& file) { return is_named(file.first); });
  const std::vector<NamedText> files(all.begin(), first_named), named(first_named, all.end());
  Case c;
  Keys keys(c.dimension);
  declare(keys, c);
  if (read_files(keys, files, settings)) {
    const SceneInputs inputs{c.dimension, c.particles.spacing, c.kernel, c.fluid, c.time, c.walls};
    if (keys.usable(c.dimension)) take_motion_tables(keys, c.dimension, named, c.motions);
    const auto take_meshes = [&](auto& shapes) {
      for (ShapeSettings& shape : shapes) take_mesh(keys, named, shape);
    };
    take_meshes(c.scene_walls);
    take_meshes(c.regions);
    take_meshes(c.outlets);
    derive(keys, c, inputs, files.front().first);
    check(keys, c, inputs);
  }
  keys.throw_mistakes();
  keys.check_defaults();
  keys.throw_mistakes();
  c.resolved_text = resolved_text(keys);
  for (const Key& key : keys.all())
    if (key.about.fixed) fixed.emplace_back(key.name, keys.value_text(key));
  return c;
}

}  // namespace

std::vector<NamedText> load_case_files(const std::string& path) {
  Case c;
  Keys keys(c.dimension);
  declare(keys, c);
  std::vector<NamedText> files = load_files(path, keys);
  load_named_files(files, "motion", "file", is_table, largest_table);
  load_meshes(files);
  return files;
}

Case parse_case(const std::vector<NamedText>& files, const std::vector<std::string>& settings) {
  FixedValues fixed;
  return parse(files, settings, fixed);
}

Case parse_restart(const NamedText& stored, const std::vector<std::string>& settings, const std::string& directory) {
  std::string problem = text_problem(directory);
  if (problem.empty()) problem = path_problem(directory);
  if (!problem.empty()) throw InputError({fmt::format("--restart {}: {}", in_quotes(directory), problem)});
  const std::vector<NamedText> files = with_meshes(stored);
  FixedValues before, after;
  try {
    parse(files, {}, before);
  } catch (const InputError& error) {
    throw FileError(fmt::format("cannot read {}: its case is not valid: {}", stored.first, error.what()));
  }
  parse(files, settings, after);
  std::vector<std::string> mistakes;
  for (std::size_t k = 0; k < before.size(); ++k) {
    const auto& [name, value] = before[k];
    if (value != after[k].second)
      mistakes.push_back(
          fmt::format("--set: {} = {}: a restart cannot change this key; allowed: {}", name, after[k].second, value));
  }
  if (!mistakes.empty()) throw InputError(std::move(mistakes));
  std::vector<std::string> all = settings;
  all.push_back("output.directory=" + in_quotes(directory));
  Case config = parse_case(files, all);
  config.output.directory_place = "--restart";
  return config;
}

Case parse_stored(const NamedText& stored) { return parse_case(with_meshes(stored)); }

bool are_of_one_run(const NamedText& one, const NamedText& other) {
  FixedValues here, there;
  parse(with_meshes(one), {}, here);
  parse(with_meshes(other), {}, there);
  const auto is_place = [](const auto& entry) { return entry.first == "output.directory"; };  // it may have moved
  std::erase_if(here, is_place);
  std::erase_if(there, is_place);
  return here == there;
}

std::string describe_keys() {
  Case c;
  Keys keys(c.dimension);
  declare(keys, c);
  return describe(keys);
}

std::string schema_of_keys() {
  Case c;
  Keys keys(c.dimension);
  declare(keys, c);
  return schema(keys);
}

void check_writable(const Case& config) {
  const std::string& directory = config.output.directory;
  const auto fail = [&](const std::string& reason) {
    throw InputError({fmt::format("{}: output.directory = {}: cannot write there: {}", config.output.directory_place,
                                  in_quotes(directory), reason)});
  };
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) fail(error.message());
  const fs::path probe = fs::path(directory) / fmt::format(".impinge_{}", getpid());
  if (!std::ofstream(probe)) fail(std::strerror(errno));
  fs::remove(probe, error);
}

}  // namespace impinge
