#include "impinge/config/key.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "impinge/core/errors.hpp"

namespace impinge {

bool Range::contains(double x) const {
  return std::isfinite(x) && (with_low ? x >= low : x > low) && (with_high ? x <= high : x < high);
}

std::string Range::text() const {
  if (!std::isfinite(low)) return "any finite number";
  if (!std::isfinite(high)) return fmt::format("{} {}", with_low ? ">=" : ">", low);
  return fmt::format("{}{}, {}{}", with_low ? '[' : '(', low, high, with_high ? ']' : ')');
}

std::string number_text(double x) {
  std::string text = fmt::format("{}", x);
  if (std::isfinite(x) && text.find_first_of(".e") == text.npos) text += ".0";
  return text;
}

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

std::string Place::text() const { return file == 0 || line == whole_file ? name : fmt::format("{}:{}", name, line); }

std::string_view type_text(const Key& key) {
  constexpr auto texts =
      std::to_array<std::string_view>({"a number", "an integer", "a boolean", "a string", "an array of numbers",
                                       "an array of numbers", "an array of points", "a word", "a list of tables"});
  static_assert(texts.size() == std::variant_size_v<Target>);
  return texts[key.target.index()];
}

std::string allowed_text(const Key& key) {
  if (const auto* word = std::get_if<Word>(&key.target)) return fmt::format("\"{}\"", fmt::join(word->words, "\", \""));
  if (key.is_list()) return fmt::format("[[{}]] with its keys", key.name);
  if (std::holds_alternative<bool*>(key.target)) return "true, false";
  if (std::holds_alternative<std::string*>(key.target)) return "UTF-8 without control characters, not empty";
  const std::string_view each = std::holds_alternative<Numbers*>(key.target)               ? "one per dimension, each "
                                : std::holds_alternative<std::vector<double>*>(key.target) ? "each "
                                : std::holds_alternative<std::vector<Numbers>*>(key.target)
                                    ? "points of one number per "
                                      "dimension, each "
                                    : "";
  return fmt::format("{}{}{}", each, key.about.range.text(),
                     key.about.unit.empty() ? "" : fmt::format(" ({})", key.about.unit));
}

std::string condition_text(const Key& key) {
  const auto& all = std::get<Word>(key.condition.key->target).words;
  std::vector<std::string> texts;
  for (const std::size_t word : key.condition.words) texts.push_back(in_quotes(all[word]));
  const Key& other = *key.condition.key;
  return fmt::format("{} {}", key.list ? other.local_name() : other.name, fmt::join(texts, ", "));
}

std::string assignment_text(std::string_view name, std::string value) {
  constexpr std::size_t longest = 400;
  const auto comma = value.find(',', longest);
  if (value.starts_with('[') && comma != value.npos) value = value.substr(0, comma) + ", ...]";
  return fmt::format("{} = {}", name, value);
}

void Keys::insert(std::string_view name, const void* address, Target target, std::string_view doc, About about) {
  const auto dot = name.rfind('.');
  Key& key = keys_.emplace_back();
  key.table = list_ ? element_ : std::string(dot == name.npos ? "" : name.substr(0, dot));
  key.name = list_ ? fmt::format("{}.{}", element_, name) : std::string(name);
  key.target = std::move(target);
  key.doc = doc;
  key.about = std::move(about);
  key.condition = condition_;
  key.list = list_;
  if (list_) {
    key.about.fixed |= list_->about.fixed;
    key.place = element_place_;
  }
  if (!by_name_.emplace(key.name, &key).second || !by_target_.emplace(address, &key).second)
    throw std::logic_error(fmt::format("{} is declared twice", key.name));
}

void Keys::resize(Key& list, const std::vector<Place>& places) {
  const List& target = std::get<List>(list.target);
  target.resize(places.size());
  list_ = &list;
  for (std::size_t k = 0; k < places.size(); ++k) {
    element_ = fmt::format("{}[{}]", list.name, k + 1);
    element_place_ = places[k];
    target.declare(*this, k);
  }
  list_ = nullptr;
}

Key* Keys::find(std::string_view name) {
  const auto found = by_name_.find(name);
  return found == by_name_.end() ? nullptr : found->second;
}

bool Keys::is_table(std::string_view name) const {
  return !name.empty() && std::ranges::any_of(keys_, [&](const Key& key) { return key.table == name; });
}

std::string Keys::value_text(const Key& key, std::string_view separator) const {
  const auto point_text = [&](const Numbers& x) {
    std::vector<std::string> parts;
    for (int k = 0; k < *dimension_; ++k) parts.push_back(number_text(x[k]));
    return fmt::format("[{}]", fmt::join(parts, ", "));
  };
  const auto array_text = [&](const auto& values, const auto& text) {
    std::vector<std::string> parts;
    for (const auto& value : values) parts.push_back(text(value));
    return fmt::format("[{}]", fmt::join(parts, separator));
  };
  return std::visit(
      [&]<class T>(const T& target) -> std::string {
        if constexpr (std::is_same_v<T, Word>) {
          return in_quotes(target.words[target.get()]);
        } else if constexpr (std::is_same_v<T, List>) {
          return array_text(std::vector<std::string>(target.size(), "{...}"), [](const std::string& x) { return x; });
        } else if constexpr (std::is_same_v<T, Numbers*>) {
          return point_text(*target);
        } else if constexpr (std::is_same_v<T, std::vector<double>*>) {
          return array_text(*target, number_text);
        } else if constexpr (std::is_same_v<T, std::vector<Numbers>*>) {
          return array_text(*target, point_text);
        } else {
          return impinge::value_text(*target);
        }
      },
      key.target);
}

std::string Keys::default_text(const Key& key) const {
  if (key.about.required) return "required";
  return "default " + (key.about.fallback.empty() ? value_text(key) : key.about.fallback);
}

void Keys::mistake(const Place& place, std::string_view text) {
  mistakes_.emplace_back(place, fmt::format("{}: {}", place.text(), text));
}

void Keys::mistake(const Key& key, std::string_view what) {
  mistake(key.place, fmt::format("{}: {}", assignment_text(key.name, value_text(key)), what));
}

void Keys::check_defaults() {
  for (const Key& key : keys_) {
    const auto* number = std::get_if<double*>(&key.target);
    if (!number || key.given || !key.usable || key.about.range.contains(**number)) continue;
    mistake(key, fmt::format("such a default follows from the other keys; allowed: {}", allowed_text(key)));
  }
}

void Keys::throw_mistakes() {
  if (mistakes_.empty()) return;
  std::ranges::stable_sort(mistakes_, [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> texts;
  for (const auto& [place, text] : mistakes_) texts.push_back(text);
  throw InputError(std::move(texts));
}

}  // namespace impinge
