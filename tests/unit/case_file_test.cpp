// The engine of case files, with keys of the tests' own: types, conditions, lists of tables, texts.

#include "impinge/config/case_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "impinge/config/schema.hpp"
#include "impinge/core/errors.hpp"

namespace impinge {
namespace {

using Texts = std::vector<std::string>;

enum class Form { circle, arc, outline };
constexpr auto words(Form) { return std::to_array<std::string_view>({"circle", "arc", "outline"}); }

struct Body {
  std::string name = "unnamed";
  Form form = Form::circle;
  Numbers velocity{};
  double radius = 0.0;
  std::vector<Numbers> points;
  double amplitude = 0.0;
};

/// Settings with keys of every type.
struct Settings {
  int dimension = 2;
  std::string title = "none";
  double length = 1.0;
  int count = 3;
  bool open = false;
  Numbers size{1.0, 2.0, 3.0};
  std::vector<double> weights;
  double late = 7.0;
  std::vector<Body> bodies;
  std::vector<Body> gates;
};

void declare_body(Keys& keys, Body& body) {
  keys.add("name", body.name, "what it is called");
  keys.add("form", body.form, "what it looks like", {.required = true});
  keys.add("velocity", body.velocity, "velocity", {.unit = "m/s"});
  keys.only_where(body.form, {Form::circle, Form::arc}, [&] {
    keys.add("radius", body.radius, "radius", {.unit = "m", .range = positive, .required = true});
  });
  keys.only_where(body.form, {Form::outline},
                  [&] { keys.add("points", body.points, "corners", {.unit = "m", .required = true}); });
  keys.add("motion.amplitude", body.amplitude, "stroke", {.unit = "m", .range = not_negative});
}

/// The settings of a text, with the keys that hold them.
struct Read {
  Settings s;
  Keys keys{s.dimension};
  bool complete = false;

  explicit Read(const std::vector<NamedText>& files, const Texts& settings = {}) {
    declare();
    complete = read_files(keys, files, settings);
  }
  Read() { declare(); }

  void declare() {
    keys.add("dimension", s.dimension, "of space", {.range = from_to(2, 3)});
    keys.add("title", s.title, "any text");
    keys.add("box.length", s.length, "a length", {.unit = "m", .range = positive});
    keys.add("box.count", s.count, "a count");
    keys.add("box.open", s.open, "no lid");
    keys.add("box.size", s.size, "a vector", {.unit = "m", .range = not_negative, .fixed = true});
    keys.list("body", s.bodies, "what is in the box", {.fixed = true}, declare_body);
    keys.list("box.gate", s.gates, "what closes it", {}, declare_body);
    keys.add("other.weights", s.weights, "numbers", {.range = from_to(0, 1)});
    keys.add("box.late", s.late, "declared behind another table");
  }
  Texts mistakes() {
    try {
      keys.throw_mistakes();
    } catch (const InputError& error) {
      return error.mistakes();
    }
    return {};
  }
};

std::unique_ptr<Read> read(const std::string& text, const Texts& settings = {}) {
  return std::make_unique<Read>(std::vector<NamedText>{{"case.toml", text}}, settings);
}

Texts mistakes_in(const std::string& text, const Texts& settings = {}) { return read(text, settings)->mistakes(); }

const std::string two_bodies = R"(
[[body]]
form = "circle"
radius = 0.5
velocity = [1, -2]

[[body]]
name = "wedge"
form = "outline"
points = [[0, 0], [1, 0.5], [0.25, 1]]
motion = {amplitude = 0.1}
)";

// ---------------------------------------------------------------------------------------------------------------------
// Numbers.

/// An integer that no double has, and what any key of numbers makes of it.
TEST(CaseFile, AnIntegerThatNoDoubleHasIsTheNearest) {
  const std::vector<std::pair<std::string, double>> table{{"9007199254740993", 9007199254740992.0},
                                                          {"9007199254740995", 9007199254740996.0},
                                                          {"9223372036854775807", 9223372036854775808.0},
                                                          {"0x20000000000001", 9007199254740992.0}};
  for (const auto& [text, value] : table) {
    const auto found =
        read(fmt::format("box = {{length = {0}, size = [1, {0}]}}\n[[body]]\nform = \"outline\"\nvelocity = [{0}, "
                         "0]\npoints = [[0, {0}]]",
                         text));
    EXPECT_EQ(found->mistakes(), Texts{});
    EXPECT_EQ(found->s.length, value);
    EXPECT_EQ(found->s.size[1], value);
    EXPECT_EQ(found->s.bodies.at(0).velocity[0], value);
    EXPECT_EQ(found->s.bodies[0].points.at(0)[1], value);
    EXPECT_EQ(read("", {"box.length=" + text})->s.length, value);
    EXPECT_EQ(read(resolved_text(found->keys))->s.length, value);
  }
  EXPECT_EQ(mistakes_in("other.weights = [0, 9007199254740993]"),
            Texts{"case.toml:1: other.weights = [0, 9007199254740993]: out of range; allowed: each [0, 1]"});
}

TEST(CaseFile, AnIntegerKeyTakesWhatItCanHold) {
  EXPECT_EQ(read("box.count = 2147483647")->s.count, 2147483647);
  EXPECT_EQ(read("box.count = -2147483648")->s.count, -2147483647 - 1);
  for (const std::string text : {"2147483648", "-2147483649", "9007199254740993"})
    EXPECT_EQ(mistakes_in("box.count = " + text),
              Texts{"case.toml:1: box.count = " + text + ": out of range; allowed: any finite number"});
}

TEST(CaseFile, ReadsArraysOfAnyLength) {
  EXPECT_EQ(read("other.weights = [0, 0.5, 1]")->s.weights, (std::vector<double>{0.0, 0.5, 1.0}));
  EXPECT_EQ(read("other.weights = []")->s.weights, std::vector<double>{});
  EXPECT_EQ(mistakes_in("other.weights = [0, \"half\"]"),
            Texts{"case.toml:1: other.weights = [0, \"half\"]: not an array of numbers; allowed: each [0, 1]"});
  EXPECT_EQ(mistakes_in("other.weights = [0, nan]"),
            Texts{"case.toml:1: other.weights = [0, nan]: not a finite number; allowed: each [0, 1]"});
}

// ---------------------------------------------------------------------------------------------------------------------
// Lists of tables.

TEST(CaseFile, ReadsAListOfTables) {
  const auto found = read(two_bodies);
  EXPECT_EQ(found->mistakes(), Texts{});
  ASSERT_EQ(found->s.bodies.size(), 2u);
  const Body &circle = found->s.bodies[0], &wedge = found->s.bodies[1];
  EXPECT_EQ(circle.name, "unnamed");
  EXPECT_EQ(circle.form, Form::circle);
  EXPECT_EQ(circle.radius, 0.5);
  EXPECT_EQ(circle.velocity[1], -2.0);
  EXPECT_EQ(wedge.name, "wedge");
  EXPECT_EQ(wedge.amplitude, 0.1);
  ASSERT_EQ(wedge.points.size(), 3u);
  EXPECT_EQ(wedge.points[1], (Numbers{1.0, 0.5, 0.0}));
  EXPECT_TRUE(found->keys.given(wedge.name));
  EXPECT_FALSE(found->keys.given(circle.name));
  EXPECT_TRUE(found->keys.usable(circle.name, circle.radius, wedge.points, found->s.bodies));
  EXPECT_FALSE(found->keys.usable(wedge.radius));
  EXPECT_EQ(found->keys.place(wedge.name), "case.toml:8");
}

TEST(CaseFile, AListMayBeEmptyOrInOneLine) {
  EXPECT_TRUE(read("")->s.bodies.empty());
  EXPECT_TRUE(read("body = []")->s.bodies.empty());
  const auto found = read("body = [{form = \"circle\", radius = 1}, {form = \"arc\", radius = 2}]");
  EXPECT_EQ(found->mistakes(), Texts{});
  EXPECT_EQ(found->s.bodies.at(1).radius, 2.0);
}

TEST(CaseFile, AListMayStandInATable) {
  const auto found = read("[box]\nlength = 2\n[[box.gate]]\nform = \"circle\"\nradius = 3\n[[box.gate]]\nform = 1");
  EXPECT_EQ(found->s.gates.at(0).radius, 3.0);
  EXPECT_EQ(found->mistakes(), (Texts{"case.toml:7: box.gate[2].form = 1: not a word; allowed: \"circle\", \"arc\", "
                                      "\"outline\""}));
}

TEST(CaseFile, FindsTheMistakesInEachTableOfAList) {
  EXPECT_EQ(
      mistakes_in(R"([[body]]
form = "circle"
radius = -1
velocty = [0, 0]
[[body]]
radius = 1
[[body]]
form = "outline"
radius = 1
points = [[0, 0], [1, 0, 0]]
motion.amplitud = 1
[[body]]
form = "arc"
velocity = [0, "fast"]
[[body]]
name = ""
form = "ellipse"
box = {length = 1}
)"),
      (Texts{"case.toml:3: body[1].radius = -1: out of range; allowed: > 0 (m)",
             "case.toml:4: body[1].velocty = [0, 0]: unknown key; did you mean body[1].velocity?",
             "case.toml:5: body[2].form: required key is missing; allowed: \"circle\", \"arc\", \"outline\"",
             "case.toml:9: body[3].radius = 1: a key of form \"circle\", \"arc\", but body[3].form is \"outline\"",
             "case.toml:10: body[3].points = [[0, 0], [1, 0, 0]]: point 2: has 3 numbers, but the dimension is "
             "2; allowed: points of one number per dimension, each any finite number (m)",
             "case.toml:11: body[3].motion.amplitud = 1: unknown key; did you mean body[3].motion.amplitude?",
             "case.toml:12: body[4].radius: required key is missing; allowed: > 0 (m)",
             "case.toml:14: body[4].velocity = [0, \"fast\"]: not an array of numbers; allowed: one per "
             "dimension, each any finite number (m/s)",
             "case.toml:16: body[5].name = \"\": empty; allowed: UTF-8 without control characters, not empty",
             "case.toml:17: body[5].form = \"ellipse\": unknown word; allowed: \"circle\", \"arc\", \"outline\"",
             "case.toml:18: body[5].box.length = 1: unknown key; did you mean box.length?"}));
}

TEST(CaseFile, FindsWhatIsNoListOfTables) {
  const std::string allowed = ": not a list of tables; allowed: [[body]] with its keys";
  EXPECT_EQ(mistakes_in("[body]\nform = \"circle\""), Texts{"case.toml:1: body = {...}" + allowed});
  EXPECT_EQ(mistakes_in("body = 3"), Texts{"case.toml:1: body = 3" + allowed});
  EXPECT_EQ(mistakes_in("body = [{}, 1]"), Texts{"case.toml:1: body = [{...}, 1]" + allowed});
  EXPECT_EQ(mistakes_in("[[bodi]]\nform = \"circle\""),
            Texts{"case.toml:1: bodi = [{...}]: unknown key; did you mean body?"});
  EXPECT_EQ(mistakes_in("[[box]]\nlength = 1"),
            Texts{"case.toml:1: box = [{...}]: not a table; allowed: [box] with its "
                  "keys"});
}

TEST(CaseFile, AListHasSoManyTablesAtMost) {
  std::string text = "body = [";
  for (int k = 0; k < 10001; ++k) text += "{},\n";
  EXPECT_EQ(mistakes_in(text + "]"), Texts{"case.toml:1: body: 10001 tables; allowed: at most 10000"});
}

TEST(CaseFile, ALongArrayIsCutInMessages) {
  std::string text = "other.weights = [";
  for (int k = 0; k < 500; ++k) text += "0,\n";
  const Texts found = mistakes_in(text + "2]");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT(found[0].size(), 600u);
  EXPECT_TRUE(found[0].ends_with("0, ...]: out of range; allowed: each [0, 1]")) << found[0];
}

TEST(CaseFile, AListComesWholeFromOneFile) {
  const auto first = [](const std::string& text) {
    return std::make_unique<Read>(std::vector<NamedText>{{"case.toml", text}, {"base.toml", two_bodies}});
  };
  const auto found = first("[[body]]\nform = \"circle\"\nradius = 9");
  ASSERT_EQ(found->s.bodies.size(), 1u);
  EXPECT_EQ(found->s.bodies[0].radius, 9.0);
  EXPECT_EQ(found->s.bodies[0].velocity[0], 0.0);
  EXPECT_TRUE(first("body = []")->s.bodies.empty());
}

TEST(CaseFile, SettingsChangeTheKeysOfAListsTables) {
  const auto found = read(two_bodies, {"body[1].radius=2", "body[2].name=plate", "body[2].motion={amplitude=0.3}"});
  EXPECT_EQ(found->mistakes(), Texts{});
  EXPECT_EQ(found->s.bodies[0].radius, 2.0);
  EXPECT_EQ(found->s.bodies[1].name, "plate");
  EXPECT_EQ(found->s.bodies[1].amplitude, 0.3);
  EXPECT_EQ(mistakes_in(two_bodies, {"body=[]", "body[3].name=x", "body[1].radius=-2"}),
            (Texts{"--set: body = []: --set does not change a list; allowed: body[1].key of its first table, and so on",
                   "--set: body[3].name = \"x\": unknown key; [[body]] has 2 table(s)",
                   "--set: body[1].radius = -2: out of range; allowed: > 0 (m)"}));
}

TEST(CaseFile, ModulesNoteMistakesInTheTablesOfAList) {
  const auto found = read(two_bodies);
  found->keys.mistake(found->s.bodies[1].points, "crosses itself");
  found->keys.mistake(found->s.bodies, "too many");
  found->keys.mistake(found->s.bodies[0].name, "used twice");
  EXPECT_EQ(
      found->mistakes(),
      (Texts{"case.toml:2: body = [{...}, {...}]: too many", "case.toml:2: body[1].name = \"unnamed\": used twice",
             "case.toml:10: body[2].points = [[0.0, 0.0], [1.0, 0.5], [0.25, 1.0]]: crosses itself"}));
}

TEST(CaseFile, TheTablesOfAFixedListAreFixed) {
  const auto found = read(two_bodies + "[[box.gate]]\nform = \"arc\"\nradius = 1\n");
  for (const Key& key : found->keys.all())
    EXPECT_EQ(key.about.fixed, key.name.starts_with("body") || key.name == "box.size") << key.name;
}

// ---------------------------------------------------------------------------------------------------------------------
// Texts.

TEST(CaseFile, TheResolvedTextWritesListsBehindTheTables) {
  const auto found = read(two_bodies);
  EXPECT_EQ(resolved_text(found->keys), R"(dimension = 2
title = "none"

[box]
length = 1.0
count = 3
open = false
size = [1.0, 2.0]
late = 7.0

[other]
weights = []

[[body]]
name = "unnamed"
form = "circle"
velocity = [1.0, -2.0]
radius = 0.5
motion.amplitude = 0.0

[[body]]
name = "wedge"
form = "outline"
velocity = [0.0, 0.0]
points = [[0.0, 0.0], [1.0, 0.5], [0.25, 1.0]]
motion.amplitude = 0.1
)");
}

TEST(CaseFile, TheResolvedTextReadsBack) {
  std::string polygon = "[[box.gate]]\nform = \"outline\"\npoints = [\n";
  for (int k = 0; k < 1000; ++k) polygon += fmt::format("[{}, {}],\n", 1.0 / (k + 3), k / 7.0);
  const auto found = read("dimension = 2\nother.weights = [0.1, 0.30000000000000004]\n" + polygon + "]\n" + two_bodies);
  EXPECT_EQ(found->mistakes(), Texts{});
  const std::string text = resolved_text(found->keys);
  const auto again = read(text);
  EXPECT_EQ(again->mistakes(), Texts{});
  EXPECT_EQ(resolved_text(again->keys), text);
  EXPECT_EQ(again->s.weights, found->s.weights);
  EXPECT_EQ(again->s.gates.at(0).points, found->s.gates.at(0).points);
  EXPECT_EQ(again->s.bodies.at(1).points, found->s.bodies.at(1).points);
}

TEST(CaseFile, DescribesTheKeysOfAListOnce) {
  Read none;
  const std::string text = describe(none.keys);
  EXPECT_TRUE(text.ends_with(R"(
[[body]]
  any number of tables: what is in the box
  name                          a string: UTF-8 without control characters, not empty; default "unnamed"
                                what it is called
  form                          a word: "circle", "arc", "outline"; required
                                what it looks like
  velocity                      an array of numbers: one per dimension, each any finite number (m/s); default [0.0, 0.0]
                                velocity
  radius                        a number: > 0 (m); required; form "circle", "arc" only
                                radius
  points                        an array of points: points of one number per dimension, each any finite number (m); required; form "outline" only
                                corners
  motion.amplitude              a number: >= 0 (m); default 0.0
                                stroke

[[box.gate]]
  any number of tables: what closes it
  name                          a string: UTF-8 without control characters, not empty; default "unnamed"
                                what it is called
  form                          a word: "circle", "arc", "outline"; required
                                what it looks like
  velocity                      an array of numbers: one per dimension, each any finite number (m/s); default [0.0, 0.0]
                                velocity
  radius                        a number: > 0 (m); required; form "circle", "arc" only
                                radius
  points                        an array of points: points of one number per dimension, each any finite number (m); required; form "outline" only
                                corners
  motion.amplitude              a number: >= 0 (m); default 0.0
                                stroke
)")) << text;
  EXPECT_EQ(text.find("[box]"), text.rfind("[box]"));
}

/// The whole agreement with the reader is tested by tests/system/schema_test.py, with the keys of a case.
TEST(CaseFile, TheSchemaHasListsDottedNamesAndConditions) {
  using Json = nlohmann::json;
  Read none;
  const Json schema = Json::parse(impinge::schema(none.keys));
  const Json &top = schema["properties"], &box = top["box"]["properties"], &gate = box["gate"]["items"];
  EXPECT_EQ(schema["additionalProperties"], false);
  EXPECT_EQ(top["box"]["additionalProperties"], false);
  EXPECT_EQ(box["length"]["exclusiveMinimum"], 0.0);
  EXPECT_EQ(box["length"]["description"], "a length\n\na number: > 0 (m). Default 1.0.");
  EXPECT_EQ(box["late"]["default"], 7.0);
  EXPECT_EQ(top["other"]["properties"]["weights"]["items"],
            Json::parse(R"({"type": "number", "minimum": 0, "maximum": 1})"));
  EXPECT_EQ(gate["properties"]["motion"]["properties"]["amplitude"]["minimum"], 0.0);
  EXPECT_EQ(gate["properties"]["points"]["description"],
            "corners\n\nan array of points: points of one number per dimension, each any finite number (m). Required. "
            "Only with form \"outline\".");
  EXPECT_EQ(gate["then"]["allOf"], Json::parse(R"([
    {"if": {"properties": {"form": {"enum": ["outline"]}}, "required": ["form"]}, "then": {"properties": {"radius": false}}},
    {"if": {"properties": {"form": {"enum": ["circle", "arc"]}}, "required": ["form"]}, "then": {"properties": {"points": false}}},
    {"if": {"properties": {"form": {"enum": ["circle", "arc"]}}, "required": ["form"]}, "then": {"required": ["radius"]}},
    {"if": {"properties": {"form": {"enum": ["outline"]}}, "required": ["form"]}, "then": {"required": ["points"]}},
    {"required": ["form"]}])"));
}

TEST(CaseFile, AKeyIsDeclaredOnce) {
  Read none;
  double again = 0.0;
  EXPECT_THROW(none.keys.add("box.length", again, "once more"), std::logic_error);
  EXPECT_THROW(none.keys.add("box.width", none.s.length, "once more"), std::logic_error);
}

}  // namespace
}  // namespace impinge
