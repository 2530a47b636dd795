#include "impinge/programs/case.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>

#include "impinge/boundaries/wall.hpp"
#include "impinge/core/errors.hpp"
#include "impinge/core/mpi.hpp"
#include "impinge/scenes/analytic_jet.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;
using Numbers = std::array<double, 3>;

constexpr double infinity = std::numeric_limits<double>::infinity();

// ---------------------------------------------------------------------------------------------------------------------
// The table of keys. Everything else in this file reads it.

/// The finite numbers that a key may take.
struct Range {
  double low = -infinity;
  double high = infinity;
  bool with_low = false;
  bool with_high = false;

  bool contains(double x) const {
    return std::isfinite(x) && (with_low ? x >= low : x > low) && (with_high ? x <= high : x < high);
  }
  std::string text() const {
    if (low == -infinity) return "any finite number";
    if (high == infinity) return fmt::format("{} {}", with_low ? ">=" : ">", low);
    return fmt::format("{}{}, {}{}", with_low ? '[' : '(', low, high, with_high ? ']' : ')');
  }
};
constexpr Range any_number{};
constexpr Range positive{0.0, infinity};
constexpr Range not_negative{0.0, infinity, true};
constexpr Range from_to(double low, double high) { return {low, high, true, true}; }
constexpr Range above_to(double low, double high) { return {low, high, false, true}; }

// The words of the enumerations, in the order of their values.
constexpr auto words(Scheme) { return std::to_array<std::string_view>({"consistent", "paper"}); }
constexpr auto words(WallModel) { return std::to_array<std::string_view>({"mirror", "particles"}); }
constexpr auto words(SceneType) { return std::to_array<std::string_view>({"jet", "tank", "periodic_box"}); }
constexpr auto words(KernelType) { return std::to_array<std::string_view>({"non_singular", "singular"}); }
constexpr auto words(JetStart) { return std::to_array<std::string_view>({"impact", "steady"}); }
constexpr auto words(Partitioner) { return std::to_array<std::string_view>({"metis", "ptscotch"}); }

template <class T>
using Member = T& (*)(Case&);
using AnyMember =
    std::variant<Member<double>, Member<int>, Member<bool>, Member<std::string>, Member<Numbers>, Member<Scheme>,
                 Member<WallModel>, Member<SceneType>, Member<KernelType>, Member<JetStart>, Member<Partitioner>>;

struct Key {
  std::string_view name;  ///< dotted, as in the case file
  AnyMember member;
  std::optional<SceneType> geometry;  ///< the only geometry that has this key; empty: all have it
  std::string_view unit;              ///< empty: dimensionless
  Range range;                        ///< of numbers
  std::string_view fallback;          ///< `required`, how a default is derived, or empty: the initial value in Case
  std::string_view doc;

  bool is_required() const;
};

constexpr std::string_view required = "required";
constexpr std::optional<SceneType> every{};
constexpr auto jet = SceneType::jet;
constexpr auto tank = SceneType::tank;
constexpr auto periodic_box = SceneType::periodic_box;

bool Key::is_required() const { return fallback == required; }

// A key's name is the path of its member.
// clang-format off
#define IMPINGE_KEY(path) #path, [](Case& config) -> auto& { return config.path; }
// clang-format on

const std::vector<Key>& keys() {
  static const std::vector<Key> table{
      {IMPINGE_KEY(name), every, "", {}, "the case file's stem", "name of the case, in the names of its output files"},
      {IMPINGE_KEY(geometry), every, "", {}, required, "what is computed"},
      {IMPINGE_KEY(dimension), every, "", from_to(2, 3), "", "dimension of space; the jet has 2"},

      {IMPINGE_KEY(scheme), every, "", {}, "", "paper: the operators of Tang & Wan; consistent: more accurate ones"},

      {IMPINGE_KEY(fluid.density), every, "kg/m^3", positive, "", "density rho"},
      {IMPINGE_KEY(fluid.viscosity), every, "m^2/s", not_negative, "", "kinematic viscosity nu"},
      {IMPINGE_KEY(fluid.gravity), every, "m/s^2", any_number, "", "gravity; the last component is the vertical one"},

      {IMPINGE_KEY(particles.spacing), every, "m", positive, required, "particle spacing dp"},

      {IMPINGE_KEY(kernel.type), every, "", {}, "", "non_singular: r_e/(0.85 r + 0.15 r_e) - 1; singular: r_e/r - 1"},
      {IMPINGE_KEY(kernel.radius), every, "dp", above_to(1, 6), "",
       "effective radius of number density, gradient and divergence"},
      {IMPINGE_KEY(kernel.laplacian_radius), every, "dp", above_to(1, 6), "", "effective radius of the Laplacian"},

      {IMPINGE_KEY(pressure.gamma), every, "", from_to(0, 1), "",
       "weight of the density term in the source of the pressure equation, unless pressure.density_speed is set; "
       "1 - gamma weighs the divergence"},
      {IMPINGE_KEY(pressure.density_speed), every, "u_max", from_to(0, 5), "0.35; paper: 0.0; 0.0 where gamma is given",
       "speed at which density errors are corrected, over the largest fluid speed, but at least sqrt(|g| dp): gamma is "
       "(speed dt/dp)^2, at most 1; 0: pressure.gamma"},
      {IMPINGE_KEY(pressure.packing),
       every,
       "",
       {},
       "true; paper: false",
       "measure density errors by the sum of (1 - r/r_e)^4 (1 + 4 r/r_e), which disorder leaves alone, instead of the "
       "number density"},
      {IMPINGE_KEY(pressure.corrected_divergence),
       every,
       "",
       {},
       "true; paper: false",
       "correct the divergence by the local moment matrix, so that it is exact on linear velocities"},
      {IMPINGE_KEY(pressure.corrected_gradient),
       every,
       "",
       {},
       "true; paper: false",
       "a gradient of pressure differences corrected likewise; at the surface particles the paper's, beside them of "
       "differences from the smallest pressure around"},
      {IMPINGE_KEY(pressure.tolerance), every, "", above_to(0, 1e-6), "",
       "relative residual at which the pressure equation counts as solved"},
      {IMPINGE_KEY(pressure.clamp_negative), every, "", {}, "", "set negative pressures to zero after the solve"},

      {IMPINGE_KEY(walls.model),
       every,
       "",
       {},
       "\"mirror\"; paper: \"particles\"",
       "mirror: the fluid's mirror images; particles: wall particles, and ghosts without a pressure"},

      {IMPINGE_KEY(free_surface.surface_density), every, "n0", from_to(0, 1), "",
       "a particle of smaller number density is on the free surface"},
      {IMPINGE_KEY(free_surface.interior_density), every, "n0", from_to(0, 2), "",
       "a particle of larger number density is inside the fluid"},
      {IMPINGE_KEY(free_surface.asymmetry), every, "|F|0", from_to(0, 2), "",
       "between the two densities: on the free surface if the asymmetry |F| is larger than this"},
      {IMPINGE_KEY(free_surface.zero_outside),
       every,
       "",
       {},
       "true; paper: false",
       "p = 0 half a spacing outside the surface particles instead of at them"},

      {IMPINGE_KEY(shifting.coefficient), every, "dp", from_to(0, 10), "1.0; paper: 0.0",
       "particles drift by this times the asymmetry F and u_ref dt/dp each step (u_ref: the largest fluid speed, at "
       "least sqrt(|g| dp)), "
       "at most by 0.1 dp, not through the free surface, spray not at all; 0: none do"},
      {IMPINGE_KEY(shifting.least_distance), every, "dp", from_to(0, 1), "0.9; paper: 0.0",
       "beside the free surface, fluid particles nearer than this drift apart, by the difference times "
       "shifting.coefficient and u_ref dt/dp; 0: none do"},
      {IMPINGE_KEY(shifting.correct_velocity),
       every,
       "",
       {},
       "true; paper: false",
       "a shifted particle takes the velocity of its new place, by the local gradient"},

      {IMPINGE_KEY(collision.distance), every, "dp", from_to(0, 1), "0.5; paper: 0.8",
       "approaching particles nearer than this collide; 0: none do"},
      {IMPINGE_KEY(collision.restitution), every, "", from_to(0, 1), "", "coefficient of restitution of a collision"},

      {IMPINGE_KEY(time.end), every, "s", positive, required, "time at which the run ends"},
      {IMPINGE_KEY(time.dt), every, "s", positive, required,
       "largest time step; the first has at most cfl = 0.05, and a step at most 1.1 times the last"},
      {IMPINGE_KEY(time.cfl), every, "", above_to(0, 1), "", "the time step is at most cfl dp / |u|max"},
      {IMPINGE_KEY(time.mean_velocity),
       every,
       "",
       {},
       "true; paper: false",
       "in a step, particles move with the mean of their old and their new velocity, not with the new one"},
      {IMPINGE_KEY(time.max_speed), every, "m/s", positive,
       "20 x jet.speed, sqrt(2 |gravity| tank.fluid_height) or periodic_box.shear_speed",
       "a faster particle counts as divergence and ends the run"},

      {IMPINGE_KEY(jet.width), jet, "m", positive, required, "jet width H, a multiple of dp"},
      {IMPINGE_KEY(jet.speed), jet, "m/s", positive, required, "jet speed U"},
      {IMPINGE_KEY(jet.angle), jet, "deg", from_to(1, 90), required, "angle between jet and plate"},
      {IMPINGE_KEY(jet.inlet_distance), jet, "H", positive, "",
       "distance of the inlet from the plate along the jet's axis"},
      {IMPINGE_KEY(jet.start), jet, "", {}, "", "impact: a column about to hit the plate; steady: the analytic jet"},

      {IMPINGE_KEY(plate.begin), jet, "m", any_number, "beyond the thin sheet's Cp = 0.01",
       "left end of the plate, from the stagnation point; negative"},
      {IMPINGE_KEY(plate.end), jet, "m", any_number, "beyond the thick sheet's Cp = 0.01",
       "right end of the plate, from the stagnation point; positive"},

      {IMPINGE_KEY(tank.size), tank, "m", positive, required,
       "inner lengths, multiples of dp; the last is the height of the walls"},
      {IMPINGE_KEY(tank.fluid_height), tank, "m", positive, required, "height of the fluid at rest, a multiple of dp"},

      {IMPINGE_KEY(periodic_box.size), periodic_box, "m", positive, required, "periods, multiples of dp"},
      {IMPINGE_KEY(periodic_box.shear_speed), periodic_box, "m/s", not_negative, "",
       "amplitude U of the initial velocity u_x = U sin(2 pi y / L_y)"},

      {IMPINGE_KEY(output.directory), every, "", {}, "output/<name>", "directory of the output files"},
      {IMPINGE_KEY(output.interval), every, "s", not_negative, "",
       "time between snapshots; 0: the first and the last only"},
      {"output.average_start", [](Case & config) -> auto& {return config.average_start;
}
, every, "s", not_negative, "0.8 x time.end", "start of the time average of the wall pressure"
}  // namespace
,

    {IMPINGE_KEY(checkpoint.steps),
     every,
     "",
     from_to(0, 1e9),
     "",
     "steps from one checkpoint to the next; 0: none by steps. With either key, a run also ends with one"},
    {IMPINGE_KEY(checkpoint.minutes),
     every,
     "min",
     not_negative,
     "",
     "wall-clock time from one checkpoint to the next; 0: none by time"},

    {IMPINGE_KEY(parallel.partitioner), every, "", {}, "", "library that distributes the cells over the ranks"},
    {IMPINGE_KEY(parallel.imbalance),
     every,
     "",
     from_to(1, 100),
     "",
     "largest over mean number of particles of a rank that calls for a new partition"},
};  // namespace impinge
return table;
}
#undef IMPINGE_KEY

const Key* find_key(std::string_view name) {
  const auto key = std::ranges::find(keys(), name, &Key::name);
  return key == keys().end() ? nullptr : &*key;
}

std::string_view table_of(std::string_view key) {
  const auto dot = key.rfind('.');
  return dot == key.npos ? std::string_view{} : key.substr(0, dot);
}

bool is_table(std::string_view name) {
  return std::ranges::any_of(keys(), [&](const Key& key) { return table_of(key.name) == name && !name.empty(); });
}

/// What a restarted run cannot change: its scene, and whatever its particles were made by.
bool is_fixed(const Key& key) {
  static const std::set<std::string_view> fixed{
      "name", "geometry", "dimension", "scheme", "fluid.density", "particles", "kernel", "walls", "output.directory"};
  return key.geometry || fixed.contains(key.name) || fixed.contains(table_of(key.name));
}

std::string_view word(SceneType geometry) { return words(geometry)[static_cast<std::size_t>(geometry)]; }

// ---------------------------------------------------------------------------------------------------------------------
// Values as text.

/// Shortest text that reads back to the same double, and that TOML takes for a float.
std::string number_text(double x) {
  std::string text = fmt::format("{}", x);
  if (std::isfinite(x) && text.find_first_of(".e") == text.npos) text += ".0";
  return text;
}

/// A TOML basic string.
std::string in_quotes(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      result += fmt::format("\\u{:04X}", static_cast<unsigned char>(c));
    } else {
      result += c;
    }
  }
  return result + '"';
}

/// The member's value as TOML.
std::string value_text(const Key& key, Case& config) {
  return std::visit(
      [&]<class T>(Member<T> member) -> std::string {
        const T& value = member(config);
        if constexpr (std::is_same_v<T, double>) {
          return number_text(value);
        } else if constexpr (std::is_same_v<T, std::string>) {
          return in_quotes(value);
        } else if constexpr (std::is_same_v<T, Numbers>) {
          std::vector<std::string> parts;
          for (int k = 0; k < config.dimension; ++k) parts.push_back(number_text(value[static_cast<std::size_t>(k)]));
          return fmt::format("[{}]", fmt::join(parts, ", "));
        } else if constexpr (std::is_enum_v<T>) {
          return in_quotes(words(value)[static_cast<std::size_t>(value)]);
        } else {
          return fmt::format("{}", value);
        }
      },
      key.member);
}

/// A value of a case file as TOML.
std::string value_text(const toml::node& node) {
  if (const auto* number = node.as_floating_point()) return number_text(number->get());
  if (const auto* text = node.as_string()) return in_quotes(text->get());
  if (node.is_table()) return "{...}";
  if (const auto* array = node.as_array()) {
    std::vector<std::string> parts;
    for (const toml::node& part : *array) parts.push_back(value_text(part));
    return fmt::format("[{}]", fmt::join(parts, ", "));
  }
  std::ostringstream stream;
  node.visit([&](const auto& value) { stream << value; });
  return stream.str();
}

std::string_view type_text(const Key& key) {
  return std::visit(
      []<class T>(Member<T>) -> std::string_view {
        if (std::is_same_v<T, double>) return "a number";
        if (std::is_same_v<T, int>) return "an integer";
        if (std::is_same_v<T, bool>) return "a boolean";
        if (std::is_same_v<T, Numbers>) return "an array of numbers";
        return std::is_enum_v<T> ? "a word" : "a string";
      },
      key.member);
}

/// What the key may be, with its unit: "> 0 (m)", "\"jet\", \"tank\", \"periodic_box\"".
std::string allowed_text(const Key& key) {
  return std::visit(
      [&]<class T>(Member<T>) -> std::string {
        if constexpr (std::is_enum_v<T>) {
          return fmt::format("\"{}\"", fmt::join(words(T{}), "\", \""));
        } else if constexpr (std::is_same_v<T, bool>) {
          return "true, false";
        } else if constexpr (std::is_same_v<T, std::string>) {
          return "not empty";
        } else {
          const std::string unit = key.unit.empty() ? "" : fmt::format(" ({})", key.unit);
          return (std::is_same_v<T, Numbers> ? "one per dimension, each " : "") + key.range.text() + unit;
        }
      },
      key.member);
}

// ---------------------------------------------------------------------------------------------------------------------
// Near misses.

/// Number of letters to insert, remove or exchange between two words.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t exchanged = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({exchanged, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

/// "; did you mean ...?" where a key's name is near, else the keys of the table where it exists, else nothing.
std::string suggestion(std::string_view unknown) {
  const auto last_part = [](std::string_view name) { return name.substr(name.rfind('.') + 1); };
  const auto distance = [&](const Key& key) {
    const bool near = unknown.size() <= 2 * key.name.size();
    const std::size_t whole = near ? edit_distance(unknown, key.name) : unknown.size();
    return last_part(unknown) == last_part(key.name) ? std::min<std::size_t>(whole, 2) : whole;
  };
  const auto nearest = std::ranges::min_element(keys(), {}, distance);
  if (distance(*nearest) <= std::max<std::size_t>(2, unknown.size() / 4)) {
    return fmt::format("; did you mean {}?", nearest->name);
  }
  std::vector<std::string_view> siblings;
  for (const Key& key : keys()) {
    if (table_of(key.name) == table_of(unknown)) siblings.push_back(key.name);
  }
  return siblings.empty() ? "" : fmt::format("; allowed: {}", fmt::join(siblings, ", "));
}

// ---------------------------------------------------------------------------------------------------------------------
// Reading.

/// The text as a table. Throws toml::parse_error, also where a line is longer than any honest one: the tables of a
/// dotted key are nested, and thousands of them overflow the stack.
toml::table parse_toml(std::string_view text, std::string_view name) {
  constexpr std::size_t longest = 8192;
  toml::source_position place{1, 1};
  for (std::string_view rest = text; rest.size() > longest; ++place.line) {
    const auto end = rest.find('\n');
    if (std::min(end, rest.size()) > longest) {
      throw toml::parse_error("a line of more than 8192 characters", place, std::make_shared<const std::string>(name));
    }
    rest.remove_prefix(end + 1);
  }
  return toml::parse(text, name);
}

/// Where a key was given. Orders the mistakes: command line, then the case file, then the files it includes.
struct Place {
  static constexpr unsigned whole_file = std::numeric_limits<unsigned>::max();

  std::size_t file = 0;        // 0: the command line
  unsigned line = whole_file;  // or the number of the setting
  std::string name = "--set";

  std::string text() const { return file == 0 || line == whole_file ? name : fmt::format("{}:{}", name, line); }
  friend bool operator<(const Place& a, const Place& b) { return std::tie(a.file, a.line) < std::tie(b.file, b.line); }
};

/// Gathers the values of all files and settings, then the mistakes in them.
class CaseReader {
 public:
  /// `number` counts the settings.
  void add_setting(const std::string& setting, std::size_t number);
  void add_file(const NamedText& file);
  /// Moves the gathered values into the Case and checks each by itself.
  void assign();
  /// Derives the defaults that depend on other keys, then checks what keys have to do with each other.
  void complete();
  Case finish();

  /// Some file is missing or unreadable: what is absent is no mistake then.
  void set_partial() { partial_ = true; }
  void mistake(const Place& place, std::string_view text) {
    mistakes_.emplace_back(place, fmt::format("{}: {}", place.text(), text));
  }
  void throw_mistakes();

 private:
  struct Entry {
    const toml::node* node;
    Place place;
  };

  void collect(const std::string& prefix, const toml::table& table, const Place& place);
  void add_entry(const std::string& name, const toml::node& node, Place place);
  std::string put(const Key& key, const toml::node& node);

  bool given(std::string_view name) const { return entries_.contains(name); }
  /// True if all these keys apply and hold allowed values.
  bool usable(std::initializer_list<std::string_view> names) const {
    return std::ranges::all_of(names, [&](std::string_view name) { return usable_.contains(name); });
  }
  bool is(SceneType geometry) const { return usable({"geometry"}) && config_.geometry == geometry; }
  /// A mistake in a key whose value is allowed by itself.
  void mistake(std::string_view name, std::string_view what);

  void derive_defaults();
  void derive_scheme();
  void derive_max_speed();
  void derive_plate();
  void check_any();
  void check_defaults();
  void check_count(double volume);
  void check_jet();
  void check_multiples(std::string_view name, std::span<const double> lengths);

  Case config_;
  std::vector<std::unique_ptr<toml::table>> texts_;  ///< own the nodes
  std::map<std::string, Entry, std::less<>> entries_;
  std::set<std::string_view> usable_;
  std::vector<Place> files_;
  std::vector<std::pair<Place, std::string>> mistakes_;
  bool partial_ = false;
};

void CaseReader::add_file(const NamedText& file) {
  files_.push_back({.file = files_.size() + 1, .name = file.first});
  Place place = files_.back();
  try {
    texts_.push_back(std::make_unique<toml::table>(parse_toml(file.second, file.first)));
    collect("", *texts_.back(), place);
  } catch (const toml::parse_error& error) {
    place.line = error.source().begin.line;
    mistake(place, fmt::format("not TOML: {}", error.description()));
    set_partial();
  }
}

/// A setting's value is TOML; a key that takes text also takes it without quotes.
void CaseReader::add_setting(const std::string& setting, std::size_t number) {
  const Place place{.line = static_cast<unsigned>(number)};
  const auto equals = setting.find('=');
  if (equals == setting.npos || equals == 0) {
    mistake(place, fmt::format("{}: not of the form key=value", setting));
    return;
  }
  const auto trimmed = [](std::string_view text) {
    const auto begin = text.find_first_not_of(" \t");
    return begin == text.npos ? "" : std::string(text.substr(begin, text.find_last_not_of(" \t") + 1 - begin));
  };
  const std::string name = trimmed(setting.substr(0, equals));
  const std::string text = trimmed(setting.substr(equals + 1));

  const Key* key = find_key(name);
  const std::string_view type = key ? type_text(*key) : "";
  const bool bare = (type == "a string" || type == "a word") && !text.starts_with('"') && !text.starts_with('\'');
  auto table = std::make_unique<toml::table>();
  if (!bare) {
    try {
      *table = parse_toml(fmt::format("value = {}", text), place.name);
    } catch (const toml::parse_error&) {
      table->clear();
    }
  }
  if (table->size() != 1) *table = toml::table{{"value", text}};
  const toml::node& value = *table->get("value");
  if (value.is_table() && !key) {
    collect(name, *value.as_table(), place);
  } else {
    add_entry(name, value, place);
  }
  texts_.push_back(std::move(table));
}

void CaseReader::collect(const std::string& prefix, const toml::table& table, const Place& place) {
  for (const auto& [name, node] : table) {
    const std::string key = prefix.empty() ? std::string(name.str()) : fmt::format("{}.{}", prefix, name.str());
    const toml::table* inner = node.as_table();
    const bool deep = std::ranges::count(key, '.') > 8;  // no key is: spare the stack
    if (inner && !find_key(key) && !deep) {
      collect(key, *inner, place);
    } else {
      add_entry(key, node, place);
    }
  }
}

void CaseReader::add_entry(const std::string& name, const toml::node& node, Place place) {
  const bool in_file = place.file > 0;
  if (in_file) place.line = node.source().begin.line;
  if (in_file && name == "include") {
    if (!node.is_string()) mistake(place, fmt::format("include = {}: not a string; allowed: a file", value_text(node)));
  } else if (is_table(name)) {
    mistake(place, fmt::format("{} = {}: not a table; allowed: [{}] with its keys", name, value_text(node), name));
  } else if (!find_key(name)) {
    mistake(place, fmt::format("{} = {}: unknown key{}", name, value_text(node), suggestion(name)));
  } else {
    entries_.try_emplace(name, Entry{&node, place});
  }
}

/// Puts a TOML value into the key's member. Returns what is wrong with it; nothing if all is well.
std::string CaseReader::put(const Key& key, const toml::node& node) {
  const auto wrong_type = [&] { return fmt::format("not {}", type_text(key)); };
  const auto check_range = [&](double x) -> std::string {
    if (!std::isfinite(x)) return "not a finite number";
    return key.range.contains(x) ? "" : "out of range";
  };
  return std::visit(
      [&]<class T>(Member<T> member) -> std::string {
        T& target = member(config_);
        if constexpr (std::is_same_v<T, bool>) {
          if (!node.is_boolean()) return wrong_type();
          target = node.as_boolean()->get();
          return "";
        } else if constexpr (std::is_same_v<T, double>) {
          if (!node.is_number()) return wrong_type();
          target = *node.value<double>();
          return check_range(target);
        } else if constexpr (std::is_same_v<T, int>) {
          if (!node.is_integer()) return wrong_type();
          const auto value = node.as_integer()->get();
          const std::string problem = check_range(static_cast<double>(value));
          if (problem.empty()) target = static_cast<int>(value);
          return problem;
        } else if constexpr (std::is_same_v<T, Numbers>) {
          const toml::array* array = node.as_array();
          if (!array || !std::ranges::all_of(*array, [](const toml::node& x) { return x.is_number(); })) {
            return wrong_type();
          }
          if (usable({"dimension"}) && array->size() != static_cast<std::size_t>(config_.dimension)) {
            return fmt::format("has {} numbers, but the dimension is {}", array->size(), config_.dimension);
          }
          for (std::size_t k = 0; k < std::min(array->size(), target.size()); ++k) {
            target[k] = *array->get(k)->template value<double>();
            if (const std::string problem = check_range(target[k]); !problem.empty()) return problem;
          }
          return "";
        } else if constexpr (std::is_same_v<T, std::string>) {
          if (!node.is_string()) return wrong_type();
          target = node.as_string()->get();
          if (target.empty()) return "empty";
          if (target.find('\0') != target.npos) return "has a null character";
          if (key.name == "name" && target.find('/') != target.npos) return "has a '/', but file names are made of it";
          if (key.name == "name" && target.size() > 200) return "longer than 200 bytes, but file names are made of it";
          if (in_quotes(target).size() > 4096) return "longer than 4096 bytes";
          return "";
        } else {
          if (!node.is_string()) return wrong_type();
          const auto all = words(T{});
          const auto found = std::ranges::find(all, std::string_view(node.as_string()->get()));
          if (found == all.end()) return "unknown word";
          target = static_cast<T>(found - all.begin());
          return "";
        }
      },
      key.member);
}

void CaseReader::assign() {
  const Place& case_file = files_.front();
  for (const Key& key : keys()) {  // geometry and dimension come first in the table
    const bool applies = !key.geometry || is(*key.geometry);
    const auto entry = entries_.find(key.name);
    if (entry == entries_.end()) {
      if (!key.is_required()) {
        if (applies) usable_.insert(key.name);
      } else if (applies && !partial_) {
        mistake(case_file, fmt::format("{}: required key is missing; allowed: {}", key.name, allowed_text(key)));
      }
      continue;
    }
    const auto& [node, place] = entry->second;
    const std::string assignment = fmt::format("{} = {}", key.name, value_text(*node));
    if (!applies && usable({"geometry"})) {
      mistake(place, fmt::format("{}: a key of geometry \"{}\", but this case's geometry is \"{}\"", assignment,
                                 word(*key.geometry), word(config_.geometry)));
      continue;
    }
    const std::string problem = put(key, *node);
    if (!problem.empty()) {
      mistake(place, fmt::format("{}: {}; allowed: {}", assignment, problem, allowed_text(key)));
    } else if (applies) {
      usable_.insert(key.name);
    }
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// What keys have to do with each other.

void CaseReader::mistake(std::string_view name, std::string_view what) {
  const auto entry = entries_.find(name);
  const Place& place = entry == entries_.end() ? files_.front() : entry->second.place;
  mistake(place, fmt::format("{} = {}: {}", name, value_text(*find_key(name), config_), what));
}

double radians(double degrees) { return std::min(degrees * std::numbers::pi / 180.0, 0.5 * std::numbers::pi); }

/// What the plate must catch, in the plate's coordinate [m].
struct Reach {
  double low, high;    ///< ends of the stretch that the straight, prolonged jet meets
  double thin, thick;  ///< where Cp falls to 0.01 in the thin and in the thick sheet
};

Reach reach(const Case& config) {
  const AnalyticJet flow(config.jet.width, 1.0, 1.0, radians(config.jet.angle));  // the shape knows no speed or density
  const double half = 0.5 * config.jet.width / std::sin(flow.angle());
  return {.low = flow.axis_position() - half,
          .high = flow.axis_position() + half,
          .thin = flow.plate_position_of_cp(0.01, AnalyticJet::Side::h2),
          .thick = flow.plate_position_of_cp(0.01, AnalyticJet::Side::h1)};
}

void CaseReader::derive_max_speed() {
  double reference = 0.0;
  if (is(jet) && usable({"jet.speed"})) reference = config_.jet.speed;
  if (is(tank) && usable({"fluid.gravity", "tank.fluid_height"})) {
    const auto& g = config_.fluid.gravity;
    reference = std::sqrt(2.0 * std::hypot(g[0], g[1], g[2]) * config_.tank.fluid_height);
  }
  if (is(periodic_box)) reference = config_.periodic_box.shear_speed;
  if (reference == 0.0 && usable({"particles.spacing", "time.dt"})) {
    reference = config_.particles.spacing / config_.time.dt;  // fluid at rest: one spacing a step
  }
  config_.time.max_speed = 20.0 * reference;
}

void CaseReader::derive_plate() {
  if (!usable({"jet.width", "jet.angle", "particles.spacing"})) return;
  const auto [low, high, thin, thick] = reach(config_);
  const double width = config_.jet.width;
  const double spacing = config_.particles.spacing;
  const double begin = std::min({-2.25 * width, thin - 1.25 * width, low - 0.75 * width});
  const double end = std::max({4.25 * width, thick + 0.75 * width, high + 0.75 * width});
  if (!given("plate.begin")) config_.plate.begin = std::floor(begin / spacing + 1e-6) * spacing;
  if (!given("plate.end")) config_.plate.end = std::ceil(end / spacing - 1e-6) * spacing;
}

/// Case's own initial values are those of the paper's scheme.
void CaseReader::derive_scheme() {
  if (config_.scheme == Scheme::paper) return;
  const auto derive = [&](std::string_view name, auto& value, auto by_scheme) {
    if (!given(name)) value = by_scheme;
  };
  derive("walls.model", config_.walls.model, WallModel::mirror);
  if (!given("pressure.gamma")) derive("pressure.density_speed", config_.pressure.density_speed, 0.35);
  derive("pressure.packing", config_.pressure.packing, true);
  derive("pressure.corrected_divergence", config_.pressure.corrected_divergence, true);
  derive("pressure.corrected_gradient", config_.pressure.corrected_gradient, true);
  derive("free_surface.zero_outside", config_.free_surface.zero_outside, true);
  derive("shifting.coefficient", config_.shifting.coefficient, 1.0);
  derive("shifting.least_distance", config_.shifting.least_distance, 0.9);
  derive("shifting.correct_velocity", config_.shifting.correct_velocity, true);
  derive("collision.distance", config_.collision.distance, 0.5);
  derive("time.mean_velocity", config_.time.mean_velocity, true);
}

void CaseReader::derive_defaults() {
  if (!given("name")) config_.name = fs::path(files_.front().name).stem();
  if (!given("output.directory")) config_.output.directory = fmt::format("output/{}", config_.name);
  config_.output.directory_place =
      given("output.directory") ? entries_.find("output.directory")->second.place.text() : files_.front().name;
  if (!given("output.average_start")) config_.average_start = 0.8 * config_.time.end;
  derive_scheme();
  if (!given("time.max_speed")) derive_max_speed();
  if (is(jet)) derive_plate();
}

void CaseReader::check_multiples(std::string_view name, std::span<const double> lengths) {
  if (!usable({name, "particles.spacing"})) return;
  for (const double length : lengths) {
    const double count = length / config_.particles.spacing;
    if (std::abs(count - std::round(count)) <= 1e-6 && count > 0.5) continue;
    mistake(name,
            fmt::format("{} m is {:.9g} particle spacings; allowed: integer multiples of particles.spacing = {} (m)",
                        number_text(length), count, number_text(config_.particles.spacing)));
  }
}

void CaseReader::check_any() {
  const Case& c = config_;
  if (usable({"kernel.radius", "kernel.laplacian_radius"}) && c.kernel.radius > c.kernel.laplacian_radius) {
    mistake("kernel.radius", fmt::format("larger than the Laplacian's radius; allowed: (1, {}] (dp)",
                                         number_text(c.kernel.laplacian_radius)));
  }
  if (usable({"free_surface.surface_density", "free_surface.interior_density"}) &&
      c.free_surface.surface_density > c.free_surface.interior_density) {
    mistake("free_surface.surface_density", fmt::format("larger than the interior's density; allowed: [0, {}] (n0)",
                                                        number_text(c.free_surface.interior_density)));
  }
  if (given("output.average_start") && usable({"output.average_start", "time.end"}) && c.average_start >= c.time.end) {
    mistake("output.average_start",
            fmt::format("the average starts after the end; allowed: [0, {}) (s)", number_text(c.time.end)));
  }
  if (usable({"fluid.viscosity", "particles.spacing", "time.dt"}) && c.fluid.viscosity > 0.0) {
    const double limit = 0.2 * c.particles.spacing * c.particles.spacing / c.fluid.viscosity;
    if (c.time.dt > limit) {
      mistake("time.dt", fmt::format("above the viscous limit 0.2 dp^2/nu; allowed: (0, {:.6g}] (s)", limit));
    }
  }
}

/// Particles that fill a volume [m^3, m^2 in 2D] are counted by 32-bit integers.
void CaseReader::check_count(double volume) {
  if (!usable({"particles.spacing", "dimension"})) return;
  constexpr int most = std::numeric_limits<std::int32_t>::max();
  const double count = volume / std::pow(config_.particles.spacing, config_.dimension);
  if (count <= most) return;
  mistake("particles.spacing", fmt::format("makes some {:.2g} particles; allowed: at most {}", count, most));
}

void CaseReader::check_jet() {
  const Case& c = config_;
  if (usable({"jet.width", "jet.inlet_distance"})) check_count(c.jet.inlet_distance * c.jet.width * c.jet.width);
  if (usable({"dimension"}) && c.dimension != 2) mistake("dimension", "the jet has two dimensions; allowed: 2");
  check_multiples("jet.width", {&c.jet.width, 1});
  if (usable({"jet.width", "particles.spacing"}) && c.jet.width < (5.0 - 1e-6) * c.particles.spacing) {
    mistake("jet.width", fmt::format("narrower than 5 particles; allowed: >= {:.6g} (m)", 5.0 * c.particles.spacing));
  }
  if (usable({"jet.angle", "jet.inlet_distance"})) {
    // The inlet's lower corner stands H above the plate: d sin a - cos a / 2 >= 1.
    const double angle = radians(c.jet.angle);
    const double least = (1.0 + 0.5 * std::cos(angle)) / std::sin(angle);
    if (c.jet.inlet_distance < least) {
      mistake("jet.inlet_distance",
              fmt::format("the inlet's lower corner is less than H above the plate; allowed: >= {:.6g} (H)", least));
    }
  }
  if (usable({"jet.width", "jet.angle"})) {
    const auto [low, high, thin, thick] = reach(c);
    const std::string misses = fmt::format(
        "the jet misses the plate, which must reach beyond the stagnation point x = 0 and from x = {:.6g} m "
        "to {:.6g} m; allowed: ",
        low, high);
    if (given("plate.begin") && usable({"plate.begin"}) && (c.plate.begin >= 0.0 || c.plate.begin > low)) {
      mistake("plate.begin", misses + (low < 0.0 ? fmt::format("<= {:.6g} (m)", low) : "< 0 (m)"));
    }
    if (given("plate.end") && usable({"plate.end"}) && c.plate.end < high) {
      mistake("plate.end", misses + fmt::format(">= {:.6g} (m)", high));
    }
  }
}

void CaseReader::complete() {
  if (partial_) return;
  derive_defaults();
  check_any();
  const Case& c = config_;
  const auto dimension = static_cast<std::size_t>(c.dimension);
  if (is(jet)) check_jet();
  const auto product = [&](const Numbers& size) {
    return std::accumulate(size.begin(), size.begin() + c.dimension, 1.0, std::multiplies{});
  };
  if (is(tank)) {
    if (usable({"tank.size"})) check_count(product(c.tank.size));
    check_multiples("tank.size", {c.tank.size.data(), dimension});
    check_multiples("tank.fluid_height", {&c.tank.fluid_height, 1});
    if (usable({"tank.size", "particles.spacing", "kernel.laplacian_radius"}) && c.walls.model == WallModel::mirror) {
      const double least = std::max<double>(c.kernel.laplacian_radius, wall_layers) * c.particles.spacing;
      if (std::ranges::any_of(std::span(c.tank.size.data(), dimension), [&](double x) { return x < least; })) {
        mistake("tank.size",
                fmt::format("mirrors nearer to each other than the kernel reaches; allowed: >= {:.6g} (m)", least));
      }
    }
    if (usable({"tank.size", "tank.fluid_height"}) && c.tank.fluid_height > c.tank.size[dimension - 1]) {
      mistake("tank.fluid_height",
              fmt::format("higher than the walls; allowed: (0, {}] (m)", number_text(c.tank.size[dimension - 1])));
    }
  }
  if (is(periodic_box)) {
    if (usable({"periodic_box.size"})) check_count(product(c.periodic_box.size));
    check_multiples("periodic_box.size", {c.periodic_box.size.data(), dimension});
    if (usable({"periodic_box.size", "particles.spacing", "kernel.laplacian_radius"})) {
      const double least = 3.0 * c.kernel.laplacian_radius * c.particles.spacing;
      if (std::ranges::any_of(std::span(c.periodic_box.size.data(), dimension), [&](double x) { return x < least; })) {
        mistake("periodic_box.size",
                fmt::format("a period is shorter than three Laplacian radii; allowed: >= {:.6g} (m)", least));
      }
    }
  }
}

/// Extreme values that are allowed by themselves may have defaults that are not.
void CaseReader::check_defaults() {
  for (const Key& key : keys()) {
    const auto* member = std::get_if<Member<double>>(&key.member);
    if (!member || given(key.name) || !usable({key.name})) continue;
    if (key.range.contains((*member)(config_))) continue;
    mistake(key.name, fmt::format("such a default follows from the other keys; allowed: {}", allowed_text(key)));
  }
}

void CaseReader::throw_mistakes() {
  if (mistakes_.empty()) return;
  std::ranges::stable_sort(mistakes_, [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> texts;
  for (const auto& [place, text] : mistakes_) texts.push_back(text);
  throw InputError(std::move(texts));
}

std::string resolved_text(Case& config) {
  std::string text;
  std::string_view table;
  for (const Key& key : keys()) {
    if (key.geometry && key.geometry != config.geometry) continue;
    const std::string_view own = table_of(key.name);
    if (own != table) text += fmt::format("\n[{}]\n", table = own);
    text += fmt::format("{} = {}\n", key.name.substr(own.empty() ? 0 : own.size() + 1), value_text(key, config));
  }
  return text;
}

Case CaseReader::finish() {
  throw_mistakes();
  check_defaults();
  throw_mistakes();
  config_.resolved_text = resolved_text(config_);
  return std::move(config_);
}

/// A file's text, or the reason why it cannot be read.
std::optional<std::string> read_text(const fs::path& path, std::string& reason) {
  constexpr std::size_t largest = 1 << 20;
  std::error_code error;
  std::string text(largest + 1, '\0');
  std::ifstream stream(path, std::ios::binary);
  const bool open = stream.is_open();
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  const int code = errno;
  if (fs::is_directory(path, error)) {
    reason = "is a directory";
  } else if (!open || stream.bad()) {
    reason = std::strerror(code);
  } else if (!stream.eof()) {
    reason = fmt::format("larger than {} bytes", largest);
  } else {
    text.resize(static_cast<std::size_t>(stream.gcount()));
    return text;
  }
  return {};
}

}  // namespace

std::vector<NamedText> load_case_files(const std::string& path) {
  std::vector<NamedText> files;
  const auto fail = [&](const Place& place, const std::string& text) {
    CaseReader reader;
    reader.set_partial();
    for (const NamedText& file : files) reader.add_file(file);
    if (!files.empty()) reader.assign();
    reader.mistake(place, text);
    reader.throw_mistakes();
  };

  std::set<fs::path> seen;
  fs::path next = path;
  Place place{.name = path};  // of the `include` that names `next`
  std::string key;            // "include = ...: "
  while (true) {
    std::error_code error;
    const fs::path canonical = fs::weakly_canonical(next, error);
    if (!seen.insert(error ? next : canonical).second) fail(place, key + "the files include each other in a circle");
    std::string reason;
    const std::optional<std::string> text = read_text(next, reason);
    if (!text) fail(place, fmt::format("{}cannot read {}: {}", key, next.string(), reason));
    files.emplace_back(next.string(), *text);
    try {
      const toml::table table = parse_toml(*text, next.string());
      const toml::node* include = table.get("include");
      if (!include || !include->is_string()) return files;
      const std::string& name = include->as_string()->get();
      place = {.file = files.size(), .line = include->source().begin.line, .name = next.string()};
      key = fmt::format("include = {}: ", in_quotes(name));
      next = next.parent_path() / name;
    } catch (const toml::parse_error&) {
      return files;  // parse_case says what is wrong
    }
  }
}

Case parse_case(const std::vector<NamedText>& files, const std::vector<std::string>& settings) {
  CaseReader reader;
  for (std::size_t k = settings.size(); k-- > 0;) reader.add_setting(settings[k], k);  // the last one counts
  for (const NamedText& file : files) reader.add_file(file);
  reader.assign();
  reader.complete();
  return reader.finish();
}

Case parse_restart(const NamedText& stored, const std::vector<std::string>& settings, const std::string& directory) {
  Case before;
  try {
    before = parse_case({stored});
  } catch (const InputError& error) {
    throw FileError(fmt::format("cannot read {}: its case is not valid: {}", stored.first, error.what()));
  }
  Case after = parse_case({stored}, settings);
  std::vector<std::string> mistakes;
  for (const Key& key : keys())
    if (is_fixed(key) && value_text(key, after) != value_text(key, before))
      mistakes.push_back(fmt::format("--set: {} = {}: a restart cannot change this key; allowed: {}", key.name,
                                     value_text(key, after), value_text(key, before)));
  if (!mistakes.empty()) throw InputError(std::move(mistakes));
  std::vector<std::string> all = settings;
  all.push_back("output.directory=" + in_quotes(directory));
  Case config = parse_case({stored}, all);
  config.output.directory_place = "--restart";
  return config;
}

std::string describe_keys() {
  std::string text =
      "Keys of a case file (TOML), each with what is allowed and its default.\n"
      "include = \"FILE\" at the top of a case file takes that file's values as defaults; FILE is relative to the case "
      "file.\n";
  Case defaults;
  std::string_view table;
  for (const Key& key : keys()) {
    const std::string_view own = table_of(key.name);
    if (own != table) {
      text += fmt::format("\n[{}]{}\n", own,
                          key.geometry ? fmt::format("  geometry \"{}\" only", word(*key.geometry)) : "");
    }
    table = own;
    std::string fallback(key.fallback);
    if (!key.is_required()) fallback = "default " + (fallback.empty() ? value_text(key, defaults) : fallback);
    text += fmt::format("  {:<29} {}: {}; {}\n  {:<29} {}\n", key.name, type_text(key), allowed_text(key), fallback, "",
                        key.doc);
  }
  return text;
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
