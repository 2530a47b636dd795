#include "impinge/config/case_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>

namespace impinge {
namespace {

namespace fs = std::filesystem;

// ---------------------------------------------------------------------------------------------------------------------
// TOML.

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

/// A value of a case file as TOML.
std::string node_text(const toml::node& node) {
  if (const auto* number = node.as_floating_point()) return number_text(number->get());
  if (const auto* text = node.as_string()) return in_quotes(text->get());
  if (node.is_table()) return "{...}";
  if (const auto* array = node.as_array()) {
    std::vector<std::string> parts;
    for (const toml::node& part : *array) parts.push_back(node_text(part));
    return fmt::format("[{}]", fmt::join(parts, ", "));
  }
  std::ostringstream stream;
  node.visit([&](const auto& value) { stream << value; });
  return stream.str();
}

/// The node's number; of an integer that no double has, the nearest double. (toml++'s value<double>() reads the bits of
/// such an integer as those of a double.)
std::optional<double> number(const toml::node& node) {
  if (const auto* value = node.as_floating_point()) return value->get();
  if (const auto* value = node.as_integer()) return static_cast<double>(value->get());
  return {};
}

std::optional<std::vector<double>> numbers(const toml::node& node) {
  const toml::array* array = node.as_array();
  if (!array) return {};
  std::vector<double> values;
  for (const toml::node& part : *array) {
    const std::optional<double> value = number(part);
    if (!value) return {};
    values.push_back(*value);
  }
  return values;
}

bool is_list_of_tables(const toml::node& node) {
  const toml::array* array = node.as_array();
  return array && std::ranges::all_of(*array, [](const toml::node& x) { return x.is_table(); });
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

/// How many tables a list has where it lacks the one that is named; "; did you mean ...?" where a key's name is near;
/// else the keys of the table where it exists, else nothing.
std::string suggestion(const Keys& keys, std::string_view unknown) {
  for (const Key& key : keys.all()) {
    if (key.is_list() && unknown.starts_with(key.name + '[') &&
        !keys.is_table(unknown.substr(0, unknown.find(']') + 1)))
      return fmt::format("; [[{}]] has {} table(s)", key.name, std::get<List>(key.target).size());
  }
  const auto last_part = [](std::string_view name) { return name.substr(name.rfind('.') + 1); };
  const auto dot = unknown.rfind('.');
  const std::string_view table = dot == unknown.npos ? "" : unknown.substr(0, dot);
  std::size_t least = std::max<std::size_t>(2, unknown.size() / 4) + 1;
  const Key* nearest = nullptr;
  std::vector<std::string_view> siblings;
  for (const Key& key : keys.all()) {
    if (key.list && !unknown.starts_with(key.table + ".")) continue;  // of another table of the list
    if (key.table == table) siblings.push_back(key.name);
    const bool comparable = unknown.size() <= 2 * key.name.size();
    std::size_t distance = comparable ? edit_distance(unknown, key.name) : unknown.size();
    if (last_part(unknown) == last_part(key.name)) distance = std::min<std::size_t>(distance, 2);
    if (distance >= least) continue;
    least = distance;
    nearest = &key;
  }
  if (nearest) return fmt::format("; did you mean {}?", nearest->name);
  return siblings.empty() ? "" : fmt::format("; allowed: {}", fmt::join(siblings, ", "));
}

// ---------------------------------------------------------------------------------------------------------------------
// Reading.

/// Gathers the values of all files and settings, then puts them into the keys' settings.
class Reader {
 public:
  explicit Reader(Keys& keys) : keys_(keys) {}

  void add_file(const NamedText& file);
  /// To be called behind the files, in the order of the settings; `count` counts them.
  void add_setting(const std::string& setting, std::size_t count);
  void assign();

  /// Some file is missing or unreadable: what is absent is no mistake then.
  void set_partial() { partial_ = true; }
  bool is_partial() const { return partial_; }

 private:
  void collect(const std::string& prefix, const toml::table& table, const Place& place);
  void add_value(const std::string& name, const toml::node& node, Place place);
  void add_tables(Key& list, const toml::array& tables, const Place& place);
  std::string put(Key& key, const toml::node& node) const;
  std::string put_numbers(const Key& key, const std::vector<double>& values, Numbers& target) const;

  Keys& keys_;
  std::vector<std::unique_ptr<toml::table>> texts_;  // own the nodes
  std::map<const Key*, const toml::node*> nodes_;
  std::size_t files_ = 0;
  bool partial_ = false;
};

void Reader::add_file(const NamedText& file) {
  Place place{.file = ++files_, .name = file.first};
  if (files_ == 1) {
    for (Key& key : keys_.all()) key.place = place;
  }
  try {
    texts_.push_back(std::make_unique<toml::table>(parse_toml(file.second, file.first)));
    collect("", *texts_.back(), place);
  } catch (const toml::parse_error& error) {
    place.line = error.source().begin.line;
    keys_.mistake(place, fmt::format("not TOML: {}", error.description()));
    set_partial();
  }
}

/// A setting's value is TOML; a key that takes text also takes it without quotes.
void Reader::add_setting(const std::string& setting, std::size_t count) {
  const Place place{.line = static_cast<unsigned>(count)};
  const auto equals = setting.find('=');
  if (equals == setting.npos || equals == 0) {
    keys_.mistake(place, fmt::format("{}: not of the form key=value", setting));
    return;
  }
  const auto trimmed = [](std::string_view text) {
    const auto begin = text.find_first_not_of(" \t");
    return begin == text.npos ? "" : std::string(text.substr(begin, text.find_last_not_of(" \t") + 1 - begin));
  };
  const std::string name = trimmed(setting.substr(0, equals));
  const std::string text = trimmed(setting.substr(equals + 1));

  const Key* key = keys_.find(name);
  const bool takes_text =
      key && (std::holds_alternative<std::string*>(key->target) || std::holds_alternative<Word>(key->target));
  auto table = std::make_unique<toml::table>();
  if (!takes_text || text.starts_with('"') || text.starts_with('\'')) {
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
    add_value(name, value, place);
  }
  texts_.push_back(std::move(table));
}

void Reader::collect(const std::string& prefix, const toml::table& table, const Place& place) {
  for (const auto& [name, node] : table) {
    const std::string full = prefix.empty() ? std::string(name.str()) : fmt::format("{}.{}", prefix, name.str());
    const toml::table* inner = node.as_table();
    const bool deep = std::ranges::count(full, '.') > 8;  // no key is: spare the stack
    if (inner && !keys_.find(full) && !deep) {
      collect(full, *inner, place);
    } else {
      add_value(full, node, place);
    }
  }
}

void Reader::add_value(const std::string& name, const toml::node& node, Place place) {
  const bool in_file = place.file > 0;
  if (in_file) place.line = node.source().begin.line;
  const auto mistake = [&](const std::string& what) {
    keys_.mistake(place, fmt::format("{}: {}", assignment_text(name, node_text(node)), what));
  };
  Key* key = keys_.find(name);
  if (in_file && name == "include") {
    if (!node.is_string()) mistake("not a string; allowed: a file");
  } else if (!key && keys_.is_table(name)) {
    mistake(fmt::format("not a table; allowed: [{}] with its keys", name));
  } else if (!key) {
    mistake("unknown key" + suggestion(keys_, name));
  } else if (key->is_list() && !in_file) {
    mistake(fmt::format("--set does not change a list; allowed: {}[1].key of its first table, and so on", name));
  } else if (!key->given || !in_file) {
    key->given = true;
    key->place = place;
    nodes_[key] = &node;
    if (key->is_list() && is_list_of_tables(node)) add_tables(*key, *node.as_array(), place);
  }
}

void Reader::add_tables(Key& list, const toml::array& tables, const Place& place) {
  constexpr std::size_t most = List::most_tables;
  if (tables.size() > most) {
    keys_.mistake(place, fmt::format("{}: {} tables; allowed: at most {}", list.name, tables.size(), most));
    return;
  }
  std::vector<Place> places(tables.size(), place);
  for (std::size_t k = 0; k < tables.size(); ++k) places[k].line = tables[k].source().begin.line;
  keys_.resize(list, places);
  for (std::size_t k = 0; k < tables.size(); ++k)
    collect(fmt::format("{}[{}]", list.name, k + 1), *tables[k].as_table(), place);
}

/// What is wrong with a number; nothing if all is well.
std::string range_problem(const Key& key, double x) {
  if (!std::isfinite(x)) return "not a finite number";
  return key.about.range.contains(x) ? "" : "out of range";
}

/// Fills a vector. Returns what is wrong with the values; nothing if all is well.
std::string Reader::put_numbers(const Key& key, const std::vector<double>& values, Numbers& target) const {
  if (keys_.dimension_is_usable() && values.size() != static_cast<std::size_t>(keys_.dimension()))
    return fmt::format("has {} numbers, but the dimension is {}", values.size(), keys_.dimension());
  for (std::size_t k = 0; k < std::min(values.size(), target.size()); ++k) {
    if (const std::string problem = range_problem(key, values[k]); !problem.empty()) return problem;
    target[k] = values[k];
  }
  return "";
}

/// Puts a TOML value into the key's setting. Returns what is wrong with it; nothing if all is well.
std::string Reader::put(Key& key, const toml::node& node) const {
  const std::string wrong_type = fmt::format("not {}", type_text(key));
  return std::visit(
      [&]<class T>(const T& target) -> std::string {
        if constexpr (std::is_same_v<T, bool*>) {
          if (!node.is_boolean()) return wrong_type;
          *target = node.as_boolean()->get();
          return "";
        } else if constexpr (std::is_same_v<T, double*>) {
          const std::optional<double> value = number(node);
          if (!value) return wrong_type;
          *target = *value;
          return range_problem(key, *value);
        } else if constexpr (std::is_same_v<T, int*>) {
          if (!node.is_integer()) return wrong_type;
          const std::int64_t value = node.as_integer()->get();
          if (!std::in_range<int>(value) || !key.about.range.contains(static_cast<double>(value)))
            return "out of range";
          *target = static_cast<int>(value);
          return "";
        } else if constexpr (std::is_same_v<T, Numbers*>) {
          const auto values = numbers(node);
          return values ? put_numbers(key, *values, *target) : wrong_type;
        } else if constexpr (std::is_same_v<T, std::vector<double>*>) {
          const auto values = numbers(node);
          if (!values) return wrong_type;
          for (const double value : *values)
            if (const std::string problem = range_problem(key, value); !problem.empty()) return problem;
          *target = *values;
          return "";
        } else if constexpr (std::is_same_v<T, std::vector<Numbers>*>) {
          if (!node.is_array()) return wrong_type;
          std::vector<Numbers> points;
          for (const toml::node& part : *node.as_array()) {
            const auto values = numbers(part);
            if (!values) return wrong_type;
            const std::string problem = put_numbers(key, *values, points.emplace_back());
            if (!problem.empty()) return fmt::format("point {}: {}", points.size(), problem);
          }
          *target = std::move(points);
          return "";
        } else if constexpr (std::is_same_v<T, std::string*>) {
          if (!node.is_string()) return wrong_type;
          *target = node.as_string()->get();
          return text_problem(*target);
        } else if constexpr (std::is_same_v<T, Word>) {
          if (!node.is_string()) return wrong_type;
          const auto found = std::ranges::find(target.words, std::string_view(node.as_string()->get()));
          if (found == target.words.end()) return "unknown word";
          target.set(static_cast<std::size_t>(found - target.words.begin()));
          return "";
        } else {
          return is_list_of_tables(node) ? "" : wrong_type;
        }
      },
      key.target);
}

void Reader::assign() {
  for (Key& key : keys_.all()) {  // conditions and lists come before the keys that depend on them
    if (key.list && !key.list->usable) continue;
    const Key* other = key.condition.key;
    const bool applies =
        !other || (other->usable && std::ranges::count(key.condition.words, std::get<Word>(other->target).get()) > 0);
    if (!key.given) {
      key.usable = applies && !key.about.required;
      if (applies && key.about.required && !partial_)
        keys_.mistake(key.place, fmt::format("{}: required key is missing; allowed: {}", key.name, allowed_text(key)));
      continue;
    }
    const toml::node& node = *nodes_.at(&key);
    const auto mistake = [&](const std::string& what) {
      keys_.mistake(key.place, fmt::format("{}: {}", assignment_text(key.name, node_text(node)), what));
    };
    if (!applies && other->usable) {
      mistake(fmt::format("a key of {}, but {}{} is {}", condition_text(key), key.list ? "" : "this case's ",
                          other->name, keys_.value_text(*other)));
      continue;
    }
    const std::string problem = put(key, node);
    if (!problem.empty()) mistake(fmt::format("{}; allowed: {}", problem, allowed_text(key)));
    key.usable = applies && problem.empty();
  }
}

/// A file's text, or the reason why it cannot be read.
constexpr std::size_t largest_case = 1 << 20;  // [bytes]

std::optional<std::string> read_text(const fs::path& path, std::string& reason, std::size_t largest = largest_case) {
  std::error_code error;
  const auto size = fs::is_regular_file(path, error) ? fs::file_size(path, error) : largest;
  std::string text(std::min<std::size_t>(largest, error ? largest : size) + 1, '\0');
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

std::string text_problem(std::string_view text) {
  constexpr std::string_view no_characters[] = {"\uFFFE", "\uFFFF"};
  if (text.empty()) return "empty";
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  const auto is_in_text = [&](std::string_view part) { return text.find(part) != text.npos; };
  if (std::ranges::any_of(text, is_control) || std::ranges::any_of(no_characters, is_in_text))
    return "has a control character";
  const std::string quoted = in_quotes(text);
  if (quoted.size() > 4096) return "longer than 4096 bytes";
  try {
    if (toml::parse(fmt::format("text = {}", quoted))["text"].value<std::string>() == text) return "";
  } catch (const toml::parse_error&) {
  }
  return "not UTF-8";
}

std::string path_problem(std::string_view path) {
  const auto dollar = path.find('$');
  const bool is_variable = dollar != path.npos && dollar + 1 < path.size() &&
                           (path[dollar + 1] == '{' || path[dollar + 1] == '_' ||
                            std::isalpha(static_cast<unsigned char>(path[dollar + 1])));
  if (!path.starts_with('~') && !is_variable) return "";
  return "a case is no shell, ~ and $ stay as they are; allowed: the path in full, or from the shell --set "
         "output.directory=\"$HOME/...\"";
}

std::vector<NamedText> load_files(const std::string& path, Keys& keys) {
  std::vector<NamedText> files;
  const auto fail = [&](const Place& place, const std::string& text) {
    Reader reader(keys);
    reader.set_partial();
    for (const NamedText& file : files) reader.add_file(file);
    reader.assign();
    keys.mistake(place, text);
    keys.throw_mistakes();
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
    std::optional<std::string> text;
    if (!key.empty() && fs::exists(next, error) && !fs::is_regular_file(next, error) &&
        !fs::is_directory(next, error)) {
      reason = "is no regular file";  // a pipe or a terminal may have no end
    } else {
      text = read_text(next, reason);
    }
    if (!text) fail(place, fmt::format("{}cannot read {}: {}", key, next.string(), reason));
    files.emplace_back(next.string(), *text);
    try {
      const toml::table table = parse_toml(*text, next.string());
      const toml::node* include = table.get("include");
      if (!include || !include->is_string()) return files;
      const std::string& name = include->as_string()->get();
      place = {.file = files.size(), .line = include->source().begin.line, .name = next.string()};
      key = fmt::format("include = {}: ", in_quotes(name));
      if (const std::string problem = path_problem(name); !problem.empty()) fail(place, key + problem);
      next = next.parent_path() / name;
    } catch (const toml::parse_error&) {
      return files;  // read_files says what is wrong
    }
  }
}

void load_named_files(std::vector<NamedText>& files, std::string_view list, std::string_view key,
                      const std::function<bool(std::string_view)>& counts, std::size_t largest) {
  std::vector<NamedText> tables;
  for (const auto& [name, text] : files) {
    try {
      const toml::table table = parse_toml(text, name);
      const toml::array* entries = table.at_path(list).as_array();
      for (std::size_t k = 0; entries && k < entries->size(); ++k) {
        const toml::table* entry = entries->get(k)->as_table();
        const toml::node* value = entry ? entry->get(key) : nullptr;
        if (!value || !value->is_string()) continue;
        const fs::path path = path_of_named(name, value->as_string()->get());
        std::error_code error;
        std::string reason;
        if (!counts(path.string()) || !fs::is_regular_file(path, error)) continue;
        if (std::ranges::find(tables, path.string(), &NamedText::first) != tables.end()) continue;
        if (auto content = read_text(path, reason, largest)) tables.emplace_back(path.string(), std::move(*content));
      }
    } catch (const toml::parse_error&) {
      continue;  // read_files says what is wrong
    }
  }
  files.insert(files.end(), std::make_move_iterator(tables.begin()), std::make_move_iterator(tables.end()));
}

std::string path_of_named(const std::string& naming_file, const std::string& name) {
  return (fs::path(naming_file).parent_path() / name).string();
}

bool read_files(Keys& keys, const std::vector<NamedText>& files, const std::vector<std::string>& settings) {
  Reader reader(keys);
  for (const NamedText& file : files) reader.add_file(file);
  for (std::size_t k = 0; k < settings.size(); ++k) reader.add_setting(settings[k], k);
  reader.assign();
  return !reader.is_partial();
}

// ---------------------------------------------------------------------------------------------------------------------
// Writing.

namespace {

/// The tables of the keys outside lists, in the order of their first keys; the top of the file is the first. Several
/// modules may have keys in one table, but a text opens it once.
std::vector<std::string> tables_of(const Keys& keys) {
  std::vector<std::string> tables{""};
  for (const Key& key : keys.all())
    if (!key.list && std::ranges::find(tables, key.table) == tables.end()) tables.push_back(key.table);
  return tables;
}

std::string only_text(const Key& key) { return key.condition.key ? fmt::format("{} only", condition_text(key)) : ""; }

}  // namespace

std::string resolved_text(const Keys& keys) {
  std::string text, table;
  const auto write = [&](const Key& key) {
    if (!key.usable || key.is_list()) return;  // without a mistake, what applies is usable
    if (key.table != table)
      text += key.list ? fmt::format("\n[[{}]]\n", key.list->name) : fmt::format("\n[{}]\n", key.table);
    table = key.table;
    constexpr std::size_t longest = 1000;  // lines that can be read back
    std::string value = keys.value_text(key);
    if (value.starts_with('[') && value.size() > longest) value = keys.value_text(key, ",\n  ");
    text += fmt::format("{} = {}\n", key.local_name(), value);
  };
  for (const std::string& own : tables_of(keys))
    for (const Key& key : keys.all())
      if (!key.list && key.table == own) write(key);
  for (const Key& list : keys.all())
    for (const Key& key : keys.all())
      if (list.is_list() && key.list == &list) write(key);
  return text;
}

std::string describe(Keys& keys) {
  std::string text = fmt::format(
      "Keys of a case file (TOML), each with what is allowed and its default.\n"
      "include = \"FILE\" at the top of a case file {}.\n",
      include_doc);
  const auto write = [&](const Key& key, std::string_view name, std::string_view only) {
    text += fmt::format("  {:<29} {}: {}; {}{}{}\n  {:<29} {}\n", name, type_text(key), allowed_text(key),
                        keys.default_text(key), only.empty() ? "" : "; ", only, "", key.doc);
  };
  for (const std::string& table : tables_of(keys)) {
    std::vector<const Key*> own;
    for (const Key& key : keys.all())
      if (key.table == table && !key.is_list()) own.push_back(&key);
    if (own.empty()) continue;
    const std::string only = only_text(*own[0]);
    const bool common = std::ranges::all_of(own, [&](const Key* key) { return only_text(*key) == only; });
    if (!table.empty())
      text += fmt::format("\n[{}]{}{}\n", table, common && !only.empty() ? "  " : "", common ? only : "");
    for (const Key* key : own) write(*key, key->name, common ? "" : only_text(*key));
  }
  for (std::size_t k = 0, count = keys.all().size(); k < count; ++k) {
    Key& list = keys.all()[k];
    if (!list.is_list()) continue;
    const std::string only = only_text(list);
    text +=
        fmt::format("\n[[{}]]{}{}\n  any number of tables: {}\n", list.name, only.empty() ? "" : "  ", only, list.doc);
    keys.resize(list, std::vector<Place>(1));
    for (const Key& key : keys.all())
      if (key.list == &list) write(key, key.local_name(), only_text(key));
  }
  return text;
}

}  // namespace impinge
