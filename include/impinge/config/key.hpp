#pragma once
// The keys of a case file. Modules declare them; each key is bound to the setting that it fills.

#include <array>
#include <cstddef>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include "impinge/core/vector.hpp"

namespace impinge {

/// A vector in a case file, one number per dimension.
using Numbers = std::array<double, 3>;

/// Its first components.
template <int Dim>
Vector<Dim> vector_of(const Numbers& x) {
  Vector<Dim> result;
  for (int k = 0; k < Dim; ++k) result[k] = x[static_cast<std::size_t>(k)];
  return result;
}

/// The finite numbers that a key may take.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool with_low = false;
  bool with_high = false;

  bool contains(double x) const;
  std::string text() const;
};
constexpr Range any_number{};
constexpr Range positive{.low = 0.0};
constexpr Range not_negative{.low = 0.0, .with_low = true};
constexpr Range from_to(double low, double high) { return {low, high, true, true}; }
constexpr Range above_to(double low, double high) { return {low, high, false, true}; }

/// The shortest text that reads back to the same double, and that TOML takes for a float.
std::string number_text(double x);
/// The text as a TOML basic string.
std::string in_quotes(std::string_view text);

/// The word of a value of an enumeration.
template <class Enum>
constexpr std::string_view word_of(Enum value) {
  return words(value)[static_cast<std::size_t>(value)];
}

/// A value as TOML. The words of an enumeration are given by words(Enum), in the order of its values.
template <class T>
std::string value_text(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    return in_quotes(word_of(value));
  } else if constexpr (std::is_same_v<T, std::string>) {
    return in_quotes(value);
  } else if constexpr (std::is_same_v<T, double>) {
    return number_text(value);
  } else if constexpr (std::is_same_v<T, bool>) {
    return value ? "true" : "false";
  } else {
    return std::to_string(value);
  }
}

/// Where a value was given. Orders the mistakes: the command line, the case file, then the files that it includes.
struct Place {
  static constexpr unsigned whole_file = std::numeric_limits<unsigned>::max();

  std::size_t file = 0;        ///< 0: the command line
  unsigned line = whole_file;  ///< or the number of the setting
  std::string name = "--set";

  std::string text() const;
  friend bool operator<(const Place& a, const Place& b) {
    return std::pair(a.file, a.line) < std::pair(b.file, b.line);
  }
};

/// What a declaration says of its key, besides its doc line.
struct About {
  std::string_view unit{};  ///< empty: dimensionless
  Range range{};            ///< of each number
  bool required = false;
  bool fixed = false;      ///< a restart cannot change it
  std::string fallback{};  ///< how the default is derived; empty: the setting's initial value is the default
};

class Keys;

/// A setting that takes one of several words.
struct Word {
  std::span<const std::string_view> words;
  std::function<std::size_t()> get;
  std::function<void(std::size_t)> set;
};

/// A list of tables: what a new element is, and which keys it has.
struct List {
  static constexpr std::size_t most_tables = 10'000;

  std::function<std::size_t()> size;
  std::function<void(std::size_t)> resize;
  std::function<void(Keys&, std::size_t)> declare;
};

using Target =
    std::variant<double*, int*, bool*, std::string*, Numbers*, std::vector<double>*, std::vector<Numbers>*, Word, List>;

struct Key {
  /// The key applies only where another key has one of these words.
  struct Condition {
    const Key* key = nullptr;  ///< null: it always applies
    std::vector<std::size_t> words;
  };

  std::string name;   ///< in full: "time.end"; "fluid[2].velocity" in the second table of a list
  std::string table;  ///< "time"; "fluid[2]"; empty at the top of a file
  Target target;
  std::string_view doc;
  About about;
  Condition condition;
  const Key* list = nullptr;  ///< whose tables have this key; null: it is in no list

  // What was read.
  bool given = false;
  bool usable = false;  ///< applies, and has an allowed value
  Place place;          ///< where it was given, or where it is missing

  /// The name inside its table.
  std::string_view local_name() const { return std::string_view(name).substr(table.empty() ? 0 : table.size() + 1); }
  bool is_list() const { return std::holds_alternative<List>(target); }
};

/// "a number", "a word", ...
std::string_view type_text(const Key& key);
/// What the key may be, with its unit: "> 0 (m)"; "\"jet\", \"tank\", \"periodic_box\"".
std::string allowed_text(const Key& key);
/// The condition's key and words: geometry "jet".
std::string condition_text(const Key& key);

/// All keys of a case, what its files gave for them, and the mistakes found. Settings are named by reference: each must
/// have been declared, and stay where it is.
class Keys {
 public:
  /// Vectors have one number per `dimension`: the setting of a key that is declared before the first vector.
  explicit Keys(const int& dimension) : dimension_(&dimension) {}
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;

  /// Declares a key. T is double, int, bool, std::string, Numbers, a vector of double or Numbers, or an enumeration.
  template <class T>
  void add(std::string_view name, T& target, std::string_view doc, About about = {}) {
    if constexpr (std::is_enum_v<T>) {
      static constexpr auto all = words(T{});
      insert(name, &target,
             Word{all, [&] { return static_cast<std::size_t>(target); }, [&](auto k) { target = static_cast<T>(k); }},
             doc, std::move(about));
    } else {
      insert(name, &target, &target, doc, std::move(about));
    }
  }

  /// Declares a list of tables, [[name]] in a case file. `declare(keys, element)` declares the keys of one table, which
  /// holds no list itself. The default is an empty list.
  template <class Element, class Declare>
  void list(std::string_view name, std::vector<Element>& elements, std::string_view doc, About about, Declare declare) {
    insert(name, &elements,
           List{[&] { return elements.size(); }, [&](std::size_t n) { elements.assign(n, {}); },
                [&elements, declare](Keys& keys, std::size_t k) { declare(keys, elements[k]); }},
           doc, std::move(about));
  }

  /// The keys that `declare()` declares apply only where `target` is one of `values`.
  template <class Enum, class Declare>
  void only_where(const Enum& target, const std::vector<Enum>& values, Declare declare) {
    condition_ = {.key = &of(target), .words = {}};
    for (const Enum value : values) condition_.words.push_back(static_cast<std::size_t>(value));
    declare();
    condition_ = {};
  }

  /// True if a file or a --set gave it.
  template <class T>
  bool given(const T& target) const {
    return of(target).given;
  }
  /// True if all these settings apply and hold allowed values, given or default.
  template <class... T>
  bool usable(const T&... targets) const {
    return (of(targets).usable && ...);
  }
  /// Where it was given; the case file's name if it was not.
  template <class T>
  std::string place(const T& target) const {
    return of(target).place.text();
  }
  /// Notes what is wrong with an allowed value: "file:line: key = value: `what`".
  template <class T>
  void mistake(const T& target, std::string_view what) {
    mistake(of(target), what);
  }
  /// The key of a setting.
  template <class T>
  Key& of(const T& target) {
    return *by_target_.at(&target);
  }
  template <class T>
  const Key& of(const T& target) const {
    return *by_target_.at(&target);
  }

  // For whoever reads or writes whole case files.

  /// Every key, those of lists behind the others.
  std::deque<Key>& all() { return keys_; }
  const std::deque<Key>& all() const { return keys_; }
  Key* find(std::string_view name);
  bool is_table(std::string_view name) const;
  /// Gives a list its tables, which begin at `places`, and declares their keys. Once for each list.
  void resize(Key& list, const std::vector<Place>& places);
  /// The setting's value as TOML; `separator` stands between the items of an array.
  std::string value_text(const Key& key, std::string_view separator = ", ") const;
  /// "required"; "default 0.25"; "default 0.8 x time.end".
  std::string default_text(const Key& key) const;
  int dimension() const { return *dimension_; }
  const Key& dimension_key() const { return of(*dimension_); }
  bool dimension_is_usable() const { return usable(*dimension_); }

  /// True if no mistake has been found so far.
  bool is_sound() const { return mistakes_.empty(); }

  void mistake(const Key& key, std::string_view what);
  void mistake(const Place& place, std::string_view text);
  /// Notes defaults that are out of range: extreme values of other keys can lead to them.
  void check_defaults();
  /// Throws InputError with every mistake so far, in the order of the files and their lines; returns if there is none.
  void throw_mistakes();

 private:
  void insert(std::string_view name, const void* address, Target target, std::string_view doc, About about);

  const int* dimension_;
  std::deque<Key> keys_;  // grows at its end: pointers to keys stay valid
  std::map<std::string, Key*, std::less<>> by_name_;
  std::unordered_map<const void*, Key*> by_target_;
  std::vector<std::pair<Place, std::string>> mistakes_;

  // Of the keys being declared.
  const Key* list_ = nullptr;
  std::string element_;  // "fluid[2]"
  Place element_place_;
  Key::Condition condition_;
};

/// "key = value"; a long array is cut.
std::string assignment_text(std::string_view name, std::string value);

}  // namespace impinge
