#include "impinge/config/schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "impinge/config/case_file.hpp"

namespace impinge {
namespace {

using Json = nlohmann::ordered_json;

/// The name of a key in the schema of its table of a list, or of the whole file.
std::string_view name_in_schema(const Key& key) { return key.list ? key.local_name() : std::string_view(key.name); }

/// The schema of a value, by its dotted name, inside the schema of a table.
Json& at(Json& table, std::string_view name) {
  const auto dot = name.find('.');
  Json& part = table["properties"][std::string(name.substr(0, dot))];
  return dot == name.npos ? part : at(part, name.substr(dot + 1));
}

/// Lets the schema of a table demand a value.
void require(Json& table, std::string_view name) {
  const auto dot = name.find('.');
  const std::string part(name.substr(0, dot));
  Json& required = table["required"];
  if (std::ranges::find(required, Json(part)) == required.end()) required.push_back(part);
  if (dot != name.npos) require(table["properties"][part], name.substr(dot + 1));
}

/// Lets each schema that has properties demand a table with no others.
void close(Json& schema) {
  if (schema.contains("properties")) {
    schema["type"] = "object";
    schema["additionalProperties"] = false;
    for (Json& part : schema["properties"]) close(part);
  }
  if (schema.contains("items")) close(schema["items"]);
}

Json number_schema(std::string_view type, const Range& range) {
  Json schema{{"type", type}};
  if (std::isfinite(range.low)) schema[range.with_low ? "minimum" : "exclusiveMinimum"] = range.low;
  if (std::isfinite(range.high)) schema[range.with_high ? "maximum" : "exclusiveMaximum"] = range.high;
  return schema;
}

Json array_schema(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }

Json value_schema(const Key& key) {
  const Range& range = key.about.range;
  return std::visit(
      [&]<class T>(const T& target) -> Json {
        if constexpr (std::is_same_v<T, double*>) {
          return number_schema("number", range);
        } else if constexpr (std::is_same_v<T, int*>) {
          return number_schema("integer", range);
        } else if constexpr (std::is_same_v<T, bool*>) {
          return {{"type", "boolean"}};
        } else if constexpr (std::is_same_v<T, std::string*>) {
          return {
              {"type", "string"}, {"minLength", 1}, {"not", {{"pattern", "[\\u0000-\\u001f\\u007f\\ufffe\\uffff]"}}}};
        } else if constexpr (std::is_same_v<T, Word>) {
          return {{"type", "string"}, {"enum", target.words}};
        } else if constexpr (std::is_same_v<T, List>) {
          Json schema = array_schema(Json::object());
          schema["maxItems"] = List::most_tables;
          return schema;
        } else if constexpr (std::is_same_v<T, std::vector<Numbers>*>) {
          return array_schema(array_schema(number_schema("number", range)));
        } else {
          return array_schema(number_schema("number", range));
        }
      },
      key.target);
}

/// What an editor shows of a key.
std::string description(const Keys& keys, const Key& key) {
  std::string text(key.doc);
  if (!key.is_list()) {
    std::string fallback = keys.default_text(key);
    fallback[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(fallback[0])));
    text += fmt::format("\n\n{}: {}. {}.", type_text(key), allowed_text(key), fallback);
  }
  if (key.condition.key) text += fmt::format(" Only with {}.", condition_text(key));
  return text;
}

/// Fulfilled by a table that has one of the words. In a list's table, a key that is not given has its default; in a
/// file, an included one may have it.
Json has_word(const Key& key, const std::vector<std::size_t>& words) {
  const auto& word = std::get<Word>(key.target);
  Json schema;
  for (const std::size_t k : words) at(schema, name_in_schema(key))["enum"].push_back(word.words[k]);
  if (key.about.required || !key.list || std::ranges::count(words, word.get()) == 0)
    require(schema, name_in_schema(key));
  return schema;
}

std::vector<std::size_t> other_words(const Key::Condition& condition) {
  std::vector<std::size_t> others;
  for (std::size_t k = 0; k < std::get<Word>(condition.key->target).words.size(); ++k)
    if (std::ranges::count(condition.words, k) == 0) others.push_back(k);
  return others;
}

/// Rules for the keys of a list's table, or for those outside lists if `list` is null: which are missing, and which do
/// not apply.
struct Rules {
  Json missing = Json::array(), foreign = Json::array();

  Rules(const Keys& keys, const Key* list) {
    Json always;
    std::vector<Key::Condition> done;
    const auto same_as = [](const Key::Condition& one) {
      return [&one](const Key::Condition& other) { return one.key == other.key && one.words == other.words; };
    };
    for (const Key& key : keys.all()) {
      if (key.list != list) continue;
      if (!key.condition.key) {
        if (key.about.required) require(always, name_in_schema(key));
        continue;
      }
      if (std::ranges::any_of(done, same_as(key.condition))) continue;
      done.push_back(key.condition);
      Json needed, refused;
      for (const Key& sibling : keys.all()) {
        if (sibling.list != list || !same_as(key.condition)(sibling.condition)) continue;
        if (sibling.about.required) require(needed, name_in_schema(sibling));
        at(refused, name_in_schema(sibling)) = false;
      }
      if (!needed.is_null())
        missing.push_back({{"if", has_word(*key.condition.key, key.condition.words)}, {"then", needed}});
      foreign.push_back({{"if", has_word(*key.condition.key, other_words(key.condition))}, {"then", refused}});
    }
    if (!always.is_null()) missing.push_back(always);
  }
};

/// Fulfilled by a file whose vectors have so many numbers.
Json vectors_have(const Keys& keys, int dimension) {
  const Json length{{"minItems", dimension}, {"maxItems", dimension}};
  Json schema;
  for (const Key& key : keys.all()) {
    Json& table = key.list ? at(schema, key.list->name)["items"] : schema;
    if (std::holds_alternative<Numbers*>(key.target)) at(table, name_in_schema(key)) = length;
    if (std::holds_alternative<std::vector<Numbers>*>(key.target)) at(table, name_in_schema(key))["items"] = length;
  }
  return schema;
}

}  // namespace

std::string schema(Keys& keys) {
  for (std::size_t k = 0, count = keys.all().size(); k < count; ++k)
    if (Key& key = keys.all()[k]; key.is_list()) keys.resize(key, std::vector<Place>(1));

  Json file{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "Case file of Impinge"}};
  file["properties"]["include"] = {{"type", "string"}, {"description", fmt::format("FILE: {}.", include_doc)}};
  for (const Key& key : keys.all()) {
    Json& own = at(key.list ? at(file, key.list->name)["items"] : file, name_in_schema(key));
    own = value_schema(key);
    own["description"] = description(keys, key);
    if (!key.about.required && key.about.fallback.empty() && !key.is_list())
      own["default"] = Json::parse(keys.value_text(key));
  }
  close(file);

  // Taplo offers no keys where a schema has rules of its own beside its properties; it does not look into "then".
  const auto add_rules = [](Json& schema, Json rules) {
    if (rules.empty()) return;
    schema["if"] = true;
    schema["then"]["allOf"] = std::move(rules);
  };
  for (const Key& key : keys.all()) {
    if (!key.is_list()) continue;
    Rules rules(keys, &key);
    rules.foreign.insert(rules.foreign.end(), rules.missing.begin(), rules.missing.end());
    add_rules(at(file, key.name)["items"], std::move(rules.foreign));
  }
  Rules rules(keys, nullptr);
  const Json included{{"required", {"include"}}};
  rules.foreign.push_back({{"if", {{"not", included}}}, {"then", {{"allOf", std::move(rules.missing)}}}});
  const std::string& name = keys.dimension_key().name;
  for (const int dimension : {2, 3}) {
    Json given{{"properties", {{name, {{"const", dimension}}}}}, {"required", {name}}};
    if (dimension == keys.dimension())
      given = {{"anyOf", {given, {{"not", {{"anyOf", {included, {{"required", {name}}}}}}}}}}};
    rules.foreign.push_back({{"if", std::move(given)}, {"then", vectors_have(keys, dimension)}});
  }
  add_rules(file, std::move(rules.foreign));
  return file.dump(1) + "\n";
}

}  // namespace impinge
