// Case files: every kind of mistake with its message, the order of precedence, the resolved text, the shipped cases.

#include "impinge/cases/case.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "case_mistakes.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;
using Texts = std::vector<std::string>;
using namespace std::string_literals;

const NamedText jet_base{"base.toml", R"(geometry = "jet"
particles.spacing = 0.02
time = {end = 5.0, dt = 8e-4}
jet = {width = 0.4, speed = 1.0, angle = 60.0}
)"};

const NamedText tank_base{"base.toml", R"(geometry = "tank"
particles.spacing = 0.01
time = {end = 2.0, dt = 1e-3}
tank = {size = [0.2, 0.3], fluid_height = 0.2}
fluid.gravity = [0.0, -9.81]
)"};

const NamedText box_base{"base.toml", R"(geometry = "periodic_box"
particles.spacing = 0.0025
time = {end = 0.25, dt = 5e-4}
periodic_box = {size = [0.1, 0.1], shear_speed = 0.05}
fluid.viscosity = 1e-3
)"};

/// The case `text` with a sound case as its defaults.
Case parse(const std::string& text, const NamedText& base = jet_base, const Texts& settings = {}) {
  return parse_case({{"case.toml", text}, base}, settings);
}

template <class Action>
Texts mistakes(Action action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.mistakes();
  }
  return {};
}

Texts mistakes_in(const std::string& text, const NamedText& base = jet_base, const Texts& settings = {}) {
  return case_mistakes({{"case.toml", text}, base}, settings);
}

/// An empty directory for one test.
class CaseFiles : public testing::Test {
 protected:
  CaseFiles() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    directory_ = fs::temp_directory_path() / ("impinge_" + std::string(info->name()) + std::to_string(getpid()));
    fs::create_directories(directory_);
  }
  ~CaseFiles() override { fs::remove_all(directory_); }

  std::string write(const std::string& name, const std::string& text) const {
    fs::create_directories((directory_ / name).parent_path());
    std::ofstream(directory_ / name) << text;
    return path(name);
  }
  std::string path(const std::string& name) const { return (directory_ / name).string(); }

  fs::path directory_;
};

TEST(Case, TakesDefaultsFromTheOtherKeys) {
  const Case config = parse("");
  EXPECT_EQ(config.name, "case");
  EXPECT_EQ(config.output.directory, "output/case");
  EXPECT_EQ(config.average_start, 4.0);
  EXPECT_EQ(config.time.max_speed, 20.0);
  EXPECT_EQ(config.pressure.gamma, 0.01);
  EXPECT_EQ(parse("name = \"other\"").output.directory, "output/other");
  EXPECT_NEAR(parse("", tank_base).time.max_speed, 20.0 * std::sqrt(2.0 * 9.81 * 0.2), 1e-12);
  EXPECT_EQ(parse("", box_base).time.max_speed, 1.0);
}

/// The lines of a resolved text, each with its table: "time.dt = 0.001".
std::vector<std::string> resolved_lines(const Case& config) {
  std::vector<std::string> lines;
  std::istringstream text(config.resolved_text);
  std::string table;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with('[')) table = line.substr(1, line.size() - 2) + ".";
    if (line.find(" = ") != line.npos) lines.push_back(table + line);
  }
  return lines;
}

const char* const scheme_keys[] = {
    "fluid.corrected_viscosity",   "kernel.radius",           "kernel.laplacian_radius",
    "pressure.density_rate",       "pressure.packing",        "pressure.corrected_divergence",
    "pressure.corrected_gradient", "pressure.clamp_negative", "walls.model",
    "free_surface.zero_outside",   "shifting.coefficient",    "shifting.least_distance",
    "shifting.correct_velocity",   "smoothing.rate",          "collision.distance",
    "time.mean_velocity"};

std::string scheme_value(const std::string& scheme, const std::string& key) {
  for (const std::string& line : resolved_lines(parse("scheme = \"" + scheme + "\"")))
    if (line.starts_with(key + " = ")) return line.substr(key.size() + 3);
  return "no value";
}

TEST(Case, TheSchemeSetsDefaults) {
  const auto check = [](const Case& c, bool consistent) {
    EXPECT_EQ(c.walls.model, consistent ? WallModel::mirror : WallModel::particles);
    EXPECT_EQ(c.fluid.corrected_viscosity, consistent);
    EXPECT_EQ(c.kernel.radius, consistent ? 2.6 : 2.1);
    EXPECT_EQ(c.kernel.laplacian_radius, !consistent ? 4.01 : c.dimension == 3 ? 2.1 : 2.6);
    EXPECT_EQ(c.pressure.density_rate, consistent ? 0.1 : 0.0);
    EXPECT_EQ(c.pressure.packing, consistent);
    EXPECT_EQ(c.pressure.corrected_divergence, consistent);
    EXPECT_EQ(c.pressure.corrected_gradient, consistent);
    EXPECT_EQ(c.pressure.clamp_negative, !consistent);
    EXPECT_EQ(c.free_surface.zero_outside, consistent);
    EXPECT_EQ(c.shifting.coefficient, !consistent ? 0.0 : c.dimension == 3 ? 3.0 : 1.0);
    EXPECT_EQ(c.shifting.least_distance, consistent ? 0.9 : 0.0);
    EXPECT_EQ(c.shifting.correct_velocity, consistent);
    EXPECT_EQ(c.smoothing.rate, consistent ? 0.2 : 0.0);
    EXPECT_EQ(c.collision.distance, consistent ? 0.5 : 0.8);
    EXPECT_EQ(c.time.mean_velocity, consistent);
  };
  check(parse(""), true);
  check(parse("scheme = \"consistent\""), true);
  check(parse("scheme = \"paper\""), false);
  check(parse("", jet_base, {"scheme=paper"}), false);
  // Nothing else.
  const auto consistent = resolved_lines(parse("")), paper = resolved_lines(parse("scheme = \"paper\""));
  ASSERT_EQ(consistent.size(), paper.size());
  std::size_t different = 0;
  for (std::size_t k = 0; k < paper.size(); ++k) different += paper[k] != consistent[k];
  EXPECT_EQ(different, 1 + std::size(scheme_keys));
}

TEST(Case, IntervalsMakeAtMostAMillionFiles) {
  for (const std::string key : {"output.interval", "checkpoint.interval"}) {
    EXPECT_EQ(mistakes_in(key + " = 4e-6"),
              Texts{"case.toml:1: " + key +
                    " = 4e-06: more than a million files until time.end; allowed: 0 or from 5e-06 on (s)"});
    EXPECT_EQ(mistakes_in(key + " = 5e-6"), Texts{});
    EXPECT_EQ(mistakes_in(key + " = -1").size(), 1u);
  }
}

TEST(Case, NamesAreThoseThatFilesSeriesAndRestartsCanHave) {
  for (const std::string& name : {"a"s, "kühl"s, "水"s, "A&B <1>"s, "a b"s, "-"s, "...x"s, std::string(200, 'n')})
    EXPECT_EQ(parse("name = '" + name + "'").name, name);
  const std::string rule =
      ", but file names are made of it; allowed: 1 to 200 bytes of UTF-8 without /, :, control characters and spaces "
      "at "
      "its ends";
  for (const auto& [name, problem] : std::vector<std::pair<std::string, std::string>>{{"a/b", "has a '/'"},
                                                                                      {"a:b", "has a ':'"},
                                                                                      {" a", "has a space at an end"},
                                                                                      {"a ", "has a space at an end"},
                                                                                      {".", "is a directory"},
                                                                                      {"..", "is a directory"}})
    EXPECT_EQ(mistakes_in("name = '" + name + "'"), Texts{"case.toml:1: name = \"" + name + "\": " + problem + rule});
  EXPECT_EQ(mistakes_in("name = \"a\\nb\"").size(), 1u);
  EXPECT_EQ(mistakes_in("name = \"a\\uFFFFb\"").size(), 1u);
  // The default, from the case file's own name.
  EXPECT_EQ(mistakes([] {
              parse_case({{"caf\xE9.toml", jet_base.second}});
            }),
            Texts{"caf\xE9.toml: name = \"caf\xE9\": not UTF-8" + rule});
  EXPECT_EQ(mistakes([] {
              parse_case({{"a:b.toml", jet_base.second}});
            }),
            Texts{"a:b.toml: name = \"a:b\": has a ':'" + rule});
  EXPECT_EQ(parse_case({{"caf\xE9.toml", jet_base.second + "name = 'x'"}}).name, "x");
  // On the command line.
  EXPECT_EQ(mistakes_in("", jet_base, {"name=caf\xE9"}).size(), 1u);
}

TEST(Case, PathsAreUtf8WithoutWordsOfAShell) {
  const std::string shell =
      ": a case is no shell, ~ and $ stay as they are; allowed: the path in full, or from the shell --set "
      "output.directory=\"$HOME/...\"";
  for (const std::string path : {"~/out", "~", "$SCRATCH/out", "/a/${USER}", "$_"}) {
    EXPECT_EQ(mistakes_in("output.directory = '" + path + "'"),
              Texts{"case.toml:1: output.directory = \"" + path + "\"" + shell});
    EXPECT_EQ(mistakes_in("", jet_base, {"output.directory=" + path}),
              Texts{"--set: output.directory = \"" + path + "\"" + shell});
    EXPECT_EQ(mistakes([&] {
                parse_restart({"x_00000007.checkpoint", parse("").resolved_text}, {}, path);
              }),
              Texts{"--restart \"" + path + "\"" + shell});
  }
  for (const std::string path : {"a~b/$", "5$/~", "/tmp/ü/a:b"})
    EXPECT_EQ(parse("output.directory = '" + path + "'").output.directory, path);
  EXPECT_EQ(mistakes_in("", jet_base, {"output.directory=/tmp/caf\xE9"}).size(), 1u);
  EXPECT_EQ(mistakes_in("name = '$HOME'"), Texts{"case.toml: output.directory = \"output/$HOME\"" + shell});
}

TEST(Case, AGivenGammaTakesThePlaceOfTheDensityRate) {
  EXPECT_EQ(parse("pressure.gamma = 0.02").pressure.density_rate, 0.0);
  const Case both = parse("pressure = {gamma = 0.02, density_rate = 0.3}");
  EXPECT_EQ(both.pressure.density_rate, 0.3);
  EXPECT_EQ(both.pressure.gamma, 0.02);
}

TEST(Case, MirrorsAreAtLeastAKernelApart) {
  EXPECT_EQ(
      mistakes_in("tank.size = [0.04, 0.3]\nkernel.radius = 4.5", tank_base),
      Texts{"case.toml:1: tank.size = [0.04, 0.3]: mirrors nearer to each other than the kernel reaches; allowed: "
            ">= 0.045 (m)"});
  EXPECT_EQ(parse("tank.size = [0.04, 0.3]", tank_base).tank.size[0], 0.04);
  EXPECT_EQ(parse("tank.size = [0.04, 0.3]\nscheme = \"paper\"", tank_base).tank.size[0], 0.04);
}

TEST(Case, GivenKeysWinOverTheScheme) {
  for (const std::string scheme : {"consistent", "paper"}) {
    const std::string other = scheme == "paper" ? "consistent" : "paper";
    const auto usual = resolved_lines(parse("scheme = \"" + scheme + "\""));
    for (const std::string key : scheme_keys) {
      const std::string setting = key + " = " + scheme_value(other, key);
      for (const std::string& text :
           {setting + "\nscheme = \"" + scheme + "\"", "scheme = \"" + scheme + "\"\n" + setting}) {
        const auto lines = resolved_lines(parse(text));
        ASSERT_EQ(lines.size(), usual.size());
        for (std::size_t k = 0; k < lines.size(); ++k) {
          const bool is_it = lines[k].starts_with(key + " = ");
          EXPECT_EQ(lines[k], is_it ? setting : usual[k]);
          EXPECT_EQ(lines[k] != usual[k], is_it);
        }
      }
    }
  }
  EXPECT_EQ(parse("walls.model = \"particles\"").walls.model, WallModel::particles);
}

TEST(Case, DescribeNamesTheDefaultsOfBothSchemes) {
  const std::string text = describe_keys();
  for (const std::string key : scheme_keys) {
    const std::string fallback =
        "; default " + scheme_value("consistent", key) + "; paper: " + scheme_value("paper", key);
    const auto line = text.find("  " + key + " ");
    ASSERT_NE(line, text.npos) << key;
    EXPECT_NE(text.substr(line, text.find('\n', line) - line).find(fallback), text.npos) << key << fallback;
  }
}

TEST(Case, FindsMistakesInTheSchemesKeys) {
  EXPECT_EQ(mistakes_in("scheme = \"best\""),
            Texts{"case.toml:1: scheme = \"best\": unknown word; allowed: \"consistent\", \"paper\""});
  EXPECT_EQ(mistakes_in("walls.model = \"bricks\""),
            Texts{"case.toml:1: walls.model = \"bricks\": unknown word; allowed: \"mirror\", \"particles\""});
  EXPECT_EQ(mistakes_in("pressure.density_rate = 5.1"),
            Texts{"case.toml:1: pressure.density_rate = 5.1: out of range; allowed: [0, 5] (u/dp)"});
  EXPECT_EQ(mistakes_in("shifting.coefficient = -1"),
            Texts{"case.toml:1: shifting.coefficient = -1: out of range; allowed: [0, 10] (dp)"});
  EXPECT_EQ(mistakes_in("smoothing.rate = 2.1"),
            Texts{"case.toml:1: smoothing.rate = 2.1: out of range; allowed: [0, 2] (u/dp)"});
  EXPECT_EQ(mistakes_in("shifting.least_distance = 1.1"),
            Texts{"case.toml:1: shifting.least_distance = 1.1: out of range; allowed: [0, 1] (dp)"});
  EXPECT_EQ(mistakes_in("collision.distance = 1.1"),
            Texts{"case.toml:1: collision.distance = 1.1: out of range; allowed: [0, 1] (dp)"});
  EXPECT_EQ(mistakes_in("fluid.smagorinsky = 0.6"),
            Texts{"case.toml:1: fluid.smagorinsky = 0.6: out of range; allowed: [0, 0.5] (dp)"});
  EXPECT_EQ(mistakes_in("fluid.smagorinsky = 0.1\nfluid.corrected_viscosity = false"),
            Texts{"case.toml:1: fluid.smagorinsky = 0.1: needs fluid.corrected_viscosity = true; allowed: 0 (dp)"});
  for (const std::string key :
       {"fluid.corrected_viscosity", "pressure.packing", "pressure.corrected_divergence", "pressure.corrected_gradient",
        "free_surface.zero_outside", "shifting.correct_velocity", "time.mean_velocity"})
    EXPECT_EQ(mistakes_in(key + " = 1"), Texts{"case.toml:1: " + key + " = 1: not a boolean; allowed: true, false"});
}

TEST(Case, AFluidAtRestHasASpeedLimitToo) {
  EXPECT_DOUBLE_EQ(parse("fluid.gravity = [0, 0]", tank_base).time.max_speed, 20.0 * 0.01 / 1e-3);
  EXPECT_DOUBLE_EQ(parse("periodic_box.shear_speed = 0", box_base).time.max_speed, 20.0 * 0.0025 / 5e-4);
}

TEST(Case, ThePlateReachesBeyondTheAnalyticWallPressureInWholeSpacings) {
  const Case at60 = parse("");  // Cp = .01 at -1.2864 H and 3.2126 H
  EXPECT_NEAR(at60.plate.begin, -1.02, 1e-12);
  EXPECT_NEAR(at60.plate.end, 1.70, 1e-12);
  const Case at90 = parse("jet.angle = 90");  // Cp = .01 at -+2.4039 H
  EXPECT_NEAR(at90.plate.begin, -1.48, 1e-12);
  EXPECT_NEAR(at90.plate.end, 1.70, 1e-12);
  const Case given = parse("plate.begin = -0.5");
  EXPECT_EQ(given.plate.begin, -0.5);
  EXPECT_NEAR(given.plate.end, 1.70, 1e-12);
}

TEST(Case, FindsWrongTypes) {
  EXPECT_EQ(mistakes_in("jet.width = \"wide\""),
            Texts{"case.toml:1: jet.width = \"wide\": not a number; allowed: > 0 (m)"});
  EXPECT_EQ(mistakes_in("\ndimension = 2.0"), Texts{"case.toml:2: dimension = 2.0: not an integer; allowed: [2, 3]"});
  EXPECT_EQ(mistakes_in("pressure.clamp_negative = 1"),
            Texts{"case.toml:1: pressure.clamp_negative = 1: not a boolean; allowed: true, false"});
  EXPECT_EQ(mistakes_in("name = 7"),
            Texts{"case.toml:1: name = 7: not a string; allowed: UTF-8 without control characters, not empty"});
  EXPECT_EQ(mistakes_in("jet.start = true"),
            Texts{"case.toml:1: jet.start = true: not a word; allowed: \"impact\", \"steady\""});
  EXPECT_EQ(mistakes_in("jet.width = {value = 1}"),
            Texts{"case.toml:1: jet.width = {...}: not a number; allowed: > 0 (m)"});
  EXPECT_EQ(mistakes_in("kernel = 3"), Texts{"case.toml:1: kernel = 3: not a table; allowed: [kernel] with its keys"});
  EXPECT_EQ(mistakes_in("[[kernel]]\nradius = 2.1").size(), 1u);
}

TEST(Case, FindsNumbersOutOfRange) {
  EXPECT_EQ(mistakes_in("particles.spacing = -0.01"),
            Texts{"case.toml:1: particles.spacing = -0.01: out of range; allowed: > 0 (m)"});
  EXPECT_EQ(mistakes_in("particles.spacing = 0"),
            Texts{"case.toml:1: particles.spacing = 0: out of range; allowed: > 0 (m)"});
  EXPECT_EQ(mistakes_in("particles.spacing = nan"),
            Texts{"case.toml:1: particles.spacing = nan: not a finite number; allowed: > 0 (m)"});
  EXPECT_EQ(mistakes_in("particles.spacing = inf"),
            Texts{"case.toml:1: particles.spacing = inf: not a finite number; allowed: > 0 (m)"});
  EXPECT_EQ(mistakes_in("pressure.gamma = 1.5"),
            Texts{"case.toml:1: pressure.gamma = 1.5: out of range; allowed: [0, 1]"});
  EXPECT_EQ(mistakes_in("pressure.tolerance = 1e-5"),
            Texts{"case.toml:1: pressure.tolerance = 1e-05: out of range; allowed: (0, 1e-06]"});
  EXPECT_EQ(mistakes_in("jet.angle = 91"), Texts{"case.toml:1: jet.angle = 91: out of range; allowed: [1, 90] (deg)"});
  EXPECT_EQ(mistakes_in("jet.angle = 0"), Texts{"case.toml:1: jet.angle = 0: out of range; allowed: [1, 90] (deg)"});
  EXPECT_EQ(mistakes_in("dimension = 4"), Texts{"case.toml:1: dimension = 4: out of range; allowed: [2, 3]"});
  EXPECT_EQ(mistakes_in("kernel.laplacian_radius = 6.5"),
            Texts{"case.toml:1: kernel.laplacian_radius = 6.5: out of range; allowed: (1, 6] (dp)"});
}

TEST(Case, AnEndThatNoDoubleHasIsTheNearest) {
  const Case config = parse("time.end = 9007199254740993");
  EXPECT_EQ(config.time.end, 9007199254740992.0);
  EXPECT_NE(config.resolved_text.find("\nend = 9007199254740992.0\n"), std::string::npos) << config.resolved_text;
}

TEST(Case, FindsUnknownWordsAndEmptyStrings) {
  EXPECT_EQ(mistakes_in("kernel.type = \"cubic\""),
            Texts{"case.toml:1: kernel.type = \"cubic\": unknown word; allowed: \"non_singular\", \"singular\""});
  EXPECT_EQ(
      mistakes_in("geometry = \"pipe\""),
      Texts{"case.toml:1: geometry = \"pipe\": unknown word; allowed: \"jet\", \"tank\", \"periodic_box\", \"scene\""});
  EXPECT_EQ(mistakes_in("output.directory = \"\""),
            Texts{"case.toml:1: output.directory = \"\": empty; allowed: UTF-8 without control characters, not empty"});
  EXPECT_EQ(mistakes_in("name = \"a/b\"").size(), 1u);
}

TEST(Case, FindsWrongVectors) {
  EXPECT_EQ(mistakes_in("fluid.gravity = [0, 0, -9.81]"),
            Texts{"case.toml:1: fluid.gravity = [0, 0, -9.81]: has 3 numbers, but the dimension is 2; allowed: one per "
                  "dimension, each any finite number (m/s^2)"});
  EXPECT_EQ(mistakes_in("fluid.gravity = -9.81"),
            Texts{"case.toml:1: fluid.gravity = -9.81: not an array of numbers; allowed: one per dimension, each any "
                  "finite number (m/s^2)"});
  EXPECT_EQ(mistakes_in("fluid.gravity = [0, \"g\"]").size(), 1u);
  EXPECT_EQ(mistakes_in("tank.size = [0.2, -0.3]", tank_base),
            Texts{"case.toml:1: tank.size = [0.2, -0.3]: out of range; allowed: one per dimension, each > 0 (m)"});
}

TEST(Case, FindsUnknownKeysAndNamesTheNearest) {
  EXPECT_EQ(mistakes_in("[particles]\nspacin = 0.01"),
            Texts{"case.toml:2: particles.spacin = 0.01: unknown key; did you mean particles.spacing?"});
  EXPECT_EQ(mistakes_in("dt = 1e-3"), Texts{"case.toml:1: dt = 0.001: unknown key; did you mean time.dt?"});
  EXPECT_EQ(mistakes_in("[partcles]\nspacing = 1"),
            Texts{"case.toml:2: partcles.spacing = 1: unknown key; did you mean particles.spacing?"});
  EXPECT_EQ(mistakes_in("time.steps_in_all = 1"),
            Texts{"case.toml:1: time.steps_in_all = 1: unknown key; allowed: time.end, time.dt, time.cfl, "
                  "time.mean_velocity, time.max_speed"});
  EXPECT_EQ(mistakes_in("turbulence.closure = \"k-epsilon\""),
            Texts{"case.toml:1: turbulence.closure = \"k-epsilon\": unknown key"});
}

TEST(Case, FindsKeysOfAnotherGeometry) {
  EXPECT_EQ(
      mistakes_in("[tank]\nfluid_height = 0.1"),
      Texts{"case.toml:2: tank.fluid_height = 0.1: a key of geometry \"tank\", but this case's geometry is \"jet\""});
  EXPECT_EQ(mistakes_in("plate.end = 1.0", tank_base),
            Texts{"case.toml:1: plate.end = 1.0: a key of geometry \"jet\", but this case's geometry is \"tank\""});
}

TEST(Case, FindsMissingKeys) {
  EXPECT_EQ(mistakes([] {
              parse_case({{"case.toml", "geometry = \"jet\""}});
            }),
            (Texts{"case.toml: particles.spacing: required key is missing; allowed: > 0 (m)",
                   "case.toml: time.end: required key is missing; allowed: > 0 (s)",
                   "case.toml: time.dt: required key is missing; allowed: > 0 (s)",
                   "case.toml: jet.width: required key is missing; allowed: > 0 (m)",
                   "case.toml: jet.speed: required key is missing; allowed: > 0 (m/s)",
                   "case.toml: jet.angle: required key is missing; allowed: [1, 90] (deg)"}));
  EXPECT_EQ(mistakes([] {
              parse_case({{"case.toml", ""}});
            }).front(),
            "case.toml: geometry: required key is missing; allowed: \"jet\", \"tank\", \"periodic_box\", \"scene\"");
}

TEST(Case, FindsWhatIsNotToml) {
  const Texts found = mistakes_in("name = \"x\"\n[time\nend = 1");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].starts_with("case.toml:2: not TOML: ")) << found[0];
  EXPECT_TRUE(mistakes_in("time.dt = 1\ntime.dt = 2").at(0).starts_with("case.toml:2: not TOML: "));
}

struct Malformed {
  std::string text;
  std::string message;  // the first mistake begins with this
};

void expect_refused(const std::vector<Malformed>& table, const NamedText& base) {
  for (const auto& [text, message] : table) {
    const Texts found = mistakes_in(text, base);
    ASSERT_FALSE(found.empty()) << text.substr(0, 100);
    EXPECT_TRUE(found[0].starts_with("case.toml:" + message)) << found[0].substr(0, 200);
  }
}

TEST(Case, RefusesMalformedTomlWithItsLine) {
  const std::vector<Malformed> table{
      {"time.dt", "1: not TOML: "},
      {"time.dt =", "1: not TOML: "},
      {"= 1", "1: not TOML: "},
      {"time.dt = 1 2", "1: not TOML: "},
      {"time.dt = 1 time.end = 2", "1: not TOML: "},
      {"\n\nname = \"open", "3: not TOML: "},
      {"name = 'open", "1: not TOML: "},
      {"name = \"\"\"open\n\n", "2: not TOML: "},
      {"name = \"\\q\"", "1: not TOML: "},
      {"name = \"\\uD800\"", "1: not TOML: "},
      {"name = \"a\nb\"", "1: not TOML: "},
      {"name = bare", "1: not TOML: "},
      {"[time", "1: not TOML: "},
      {"[time]]", "1: not TOML: "},
      {"[]", "1: not TOML: "},
      {"time = {dt = 1", "1: not TOML: "},
      {"tank.size = [0.2, 0.3", "1: not TOML: "},
      {"tank.size = [0.2 0.3]", "1: not TOML: "},
      // Twice.
      {"name = \"a\"\nname = \"b\"", "2: not TOML: "},
      {"[time]\ndt = 1\n[time]\nend = 1", "3: not TOML: "},
      {"time = {dt = 1}\ntime.end = 1", "2: not TOML: "},
      {"time = 1\ntime.end = 1", "2: not TOML: "},
      {"[time]\n[[time]]", "2: not TOML: "},
      // Numbers.
      {"time.dt = 1.", "1: not TOML: "},
      {"time.dt = .5", "1: not TOML: "},
      {"time.dt = 1e", "1: not TOML: "},
      {"time.dt = 0x", "1: not TOML: "},
      {"time.dt = 1__0", "1: not TOML: "},
      {"dimension = 02", "1: not TOML: "},
      {"dimension = 9223372036854775808", "1: not TOML: "},
      {"dimension = -9223372036854775809", "1: not TOML: "},
      // What is no text.
      {std::string("name = \"a\0b\"", 12), "1: not TOML: "},
      {std::string("\x7f"
                   "ELF\x02\x01\x01\0\0\0\0",
                   11),
       "1: not TOML: "},
      {std::string("\x89HDF\r\n\x1a\n", 8), "1: not TOML: "},
      {"name = \"\xff\xfe\"", "1: not TOML: "},
      {"# \xc3(\n", "1: not TOML: "},
      {"name = \"\x01\"", "1: not TOML: "},
      {"time.dt = 0.1\u0366", "1: not TOML: "},
      {"time.dt = 0.1\u1234", "1: not TOML: "},
      {"tank.size = [0.2, 0.\ufffd]", "1: not TOML: "},
      // Nested without end.
      {"name = " + std::string(1000, '['), "1: not TOML: "},
      {"\n" + std::string(10000, 'a') + " = 1", "2: not TOML: a line of more than 8192 characters"},
  };
  expect_refused(table, jet_base);
}

TEST(Case, RefusesValuesThatNoRunCouldUse) {
  const std::vector<Malformed> jet{
      {"dimension = -2", "1: dimension = -2: out of range; allowed: [2, 3]"},
      {"dimension = 9223372036854775807", "1: dimension = 9223372036854775807: out of range; allowed: [2, 3]"},
      {"dimension = \"2\"", "1: dimension = \"2\": not an integer; allowed: [2, 3]"},
      {"time.end = -1", "1: time.end = -1: out of range; allowed: > 0 (s)"},
      {"time.end = -inf", "1: time.end = -inf: not a finite number; allowed: > 0 (s)"},
      {"time.dt = 1e999", "1: not TOML: "},
      {"time.dt = -0.0", "1: time.dt = -0.0: out of range; allowed: > 0 (s)"},
      {"time.dt = 1979-05-27", "1: time.dt = 1979-05-27: not a number; allowed: > 0 (s)"},
      {"time.dt = 07:32:00", "1: time.dt = 07:32:00: not a number; allowed: > 0 (s)"},
      {"time.dt = []", "1: time.dt = []: not a number; allowed: > 0 (s)"},
      {"time.dt.s = 1", "1: time.dt = {...}: not a number; allowed: > 0 (s)"},
      {"[[time.dt]]", "1: time.dt = [{...}]: not a number; allowed: > 0 (s)"},
      {"time.max_speed = nan", "1: time.max_speed = nan: not a finite number; allowed: > 0 (m/s)"},
      {"output.interval = -0.1", "1: output.interval = -0.1: out of range; allowed: >= 0 (s)"},
      {"parallel.imbalance = 0", "1: parallel.imbalance = 0: out of range; allowed: [1, 100]"},
      {"fluid.gravity = [0, nan]",
       "1: fluid.gravity = [0, nan]: not a finite number; allowed: one per dimension, each"},
      {"fluid.gravity = []", "1: fluid.gravity = []: has 0 numbers, but the dimension is 2; allowed: "},
      {"fluid.gravity = [[0, 1], 2]", "1: fluid.gravity = [[0, 1], 2]: not an array of numbers; allowed: "},
      {"pressure.clamp_negative = \"false\"", "1: pressure.clamp_negative = \"false\": not a boolean; allowed: true"},
      // Too shallow for the inlet to stand anywhere near.
      {"jet.angle = 0.01", "1: jet.angle = 0.01: out of range; allowed: [1, 90] (deg)"},
      // Text.
      {"größe = 1", "1: not TOML: "},
      {"\"größe\" = 1", "1: größe = 1: unknown key"},
      {"kernel.type = \"sïngular\"", "1: kernel.type = \"sïngular\": unknown word; allowed: \"non_singular\""},
      {"name = \"a\\u0000b\"",
       "1: name = \"a\\u0000b\": has a control character; allowed: UTF-8 without control characters, not empty"},
      {"output.directory = \"a\\u0000b\"", "1: output.directory = \"a\\u0000b\": has a control character; allowed: "},
      {"name = \"" + std::string(201, 'a') + "\"", "1: name = \"aaa"},
      {"output.directory = \"" + std::string(4096, 'a') + "\"", "1: output.directory = \"aaa"},
      {std::string(8000, 'a') + " = 1", "1: aaa"},
      {"\"\" = 1", "1:  = 1: unknown key"},
      // What keys say together.
      {"scheme = \"paper\"\nwalls.model = \"mirror\"\njet.start = \"steady\"\nplate.begin = 0.1",
       "4: plate.begin = 0.1: "},
      {"free_surface = {surface_density = 0.9, interior_density = 0.8}",
       "1: free_surface.surface_density = 0.9: larger than the interior's density; allowed: [0, 0.8] (n0)"},
  };
  expect_refused(jet, jet_base);
  const std::vector<Malformed> tank{
      {"tank.size = [0.2]", "1: tank.size = [0.2]: has 1 numbers, but the dimension is 2; allowed: one per dimension"},
      {"tank.size = [1e308, 1e308]", "1: tank.size = [1e+308, 1e+308]: 1e+308 m is inf particle spacings; allowed: "},
  };
  expect_refused(tank, tank_base);
  EXPECT_EQ(mistakes_in("dimension = 3", tank_base).front(),
            "base.toml:4: tank.size = [0.2, 0.3]: has 2 numbers, but the dimension is 3; allowed: one per dimension, "
            "each > 0 (m)");
  EXPECT_EQ(mistakes_in("fluid.viscosity = 1e300"),
            Texts{"base.toml:3: time.dt = 0.0008: above the viscous limit 0.2 dp^2/nu; allowed: (0, 8e-305] (s)"});
}

TEST(Case, TablesNestedAsDeepAsALineAllowsAreUnknownKeys) {
  std::string key = "a";
  for (int depth = 1; depth < 4000; ++depth) key += ".a";
  const Texts found = mistakes_in("[" + key + "]\n" + key + " = 1");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0], "case.toml:1: a.a.a.a.a.a.a.a.a.a = {...}: unknown key");
}

TEST(Case, DefaultsThatOverflowAreMistakes) {
  EXPECT_EQ(mistakes_in("jet.speed = 1e308"),
            Texts{"case.toml: time.max_speed = inf: such a default follows from the other keys; allowed: > 0 (m/s)"});
  EXPECT_EQ(mistakes_in("periodic_box.shear_speed = 1e308", box_base),
            Texts{"case.toml: time.max_speed = inf: such a default follows from the other keys; allowed: > 0 (m/s)"});
  EXPECT_EQ(mistakes_in("periodic_box.vortex_speed = 1e308", box_base),
            Texts{"case.toml: time.max_speed = inf: such a default follows from the other keys; allowed: > 0 (m/s)"});
  EXPECT_EQ(parse("jet.speed = 1e308\ntime.max_speed = 1.5e308").time.max_speed, 1.5e308);
}

TEST(Case, GathersEveryMistakeInTheOrderOfTheLines) {
  const Texts found = mistakes_in(R"(name = ""
[particles]
spacing = -0.02
[jet]
widht = 0.4
angle = "steep"
[pressure]
gamma = 2
[output]
average_start = 9.0
)",
                                  {"base.toml", "geometry = \"jet\"\njet.width = 0.4\ntime.end = 5\nfluid.densty = 1"},
                                  {"time.cfl=-1"});
  EXPECT_EQ(found, (Texts{"--set: time.cfl = -1: out of range; allowed: (0, 1]",
                          "case.toml:1: name = \"\": empty; allowed: UTF-8 without control characters, not empty",
                          "case.toml:3: particles.spacing = -0.02: out of range; allowed: > 0 (m)",
                          "case.toml:5: jet.widht = 0.4: unknown key; did you mean jet.width?",
                          "case.toml:6: jet.angle = \"steep\": not a number; allowed: [1, 90] (deg)",
                          "case.toml:8: pressure.gamma = 2: out of range; allowed: [0, 1]",
                          "case.toml:10: output.average_start = 9.0: the average starts after the end; allowed: [0, "
                          "5.0) (s)",
                          "case.toml: time.dt: required key is missing; allowed: > 0 (s)",
                          "case.toml: jet.speed: required key is missing; allowed: > 0 (m/s)",
                          "base.toml:4: fluid.densty = 1: unknown key; did you mean fluid.density?"}));
}

TEST(Case, WhatHasTheMistakesInOneText) {
  const InputError error({"one", "two"});
  EXPECT_STREQ(error.what(), "one\ntwo");
}

TEST(Case, TheJetIsWholeParticlesWide) {
  EXPECT_EQ(mistakes_in("particles.spacing = 0.03"),
            Texts{"base.toml:4: jet.width = 0.4: 0.4 m is 13.3333333 particle spacings; allowed: integer multiples of "
                  "particles.spacing = 0.03 (m), the nearest are 0.39 and 0.42"});
  EXPECT_EQ(mistakes_in("particles.spacing = 0.1"),
            Texts{"base.toml:4: jet.width = 0.4: narrower than 5 particles; allowed: >= 0.5 (m)"});
  EXPECT_TRUE(mistakes_in("particles.spacing = 0.08").empty());
}

TEST(Case, TheJetIsPlane) {
  EXPECT_EQ(mistakes_in("dimension = 3"), Texts{"case.toml:1: dimension = 3: the jet has two dimensions; allowed: 2"});
}

TEST(Case, TheJetMustHitThePlate) {
  EXPECT_EQ(mistakes_in("[plate]\nbegin = 5.0\nend = 6.0"),
            Texts{"case.toml:2: plate.begin = 5.0: the jet misses the plate, which must reach beyond the stagnation "
                  "point x = 0 and from x = 0.0471747 m to 0.509055 m; allowed: < 0 (m)"});
  EXPECT_EQ(mistakes_in("plate.end = 0.5"),
            Texts{"case.toml:1: plate.end = 0.5: the jet misses the plate, which must reach beyond the stagnation "
                  "point x = 0 and from x = 0.0471747 m to 0.509055 m; allowed: >= 0.509055 (m)"});
  EXPECT_EQ(mistakes_in("plate = {begin = -0.1, end = 0.3}\njet.angle = 90"),  // meets it from -H/2 to H/2
            Texts{"case.toml:1: plate.begin = -0.1: the jet misses the plate, which must reach beyond the stagnation "
                  "point x = 0 and from x = -0.2 m to 0.2 m; allowed: <= -0.2 (m)"});
  EXPECT_TRUE(mistakes_in("plate = {begin = -0.01, end = 0.51}").empty());
}

TEST(Case, TheInletStandsAboveThePlate) {
  EXPECT_EQ(mistakes_in("jet.inlet_distance = 1.4"),
            Texts{"case.toml:1: jet.inlet_distance = 1.4: the inlet's lower corner is less than H above the plate; "
                  "allowed: >= 1.44338 (H)"});
  EXPECT_EQ(mistakes_in("jet.angle = 10").at(0).substr(0, 40), "case.toml: jet.inlet_distance = 3.5: the");
}

TEST(Case, TheAverageStartsBeforeTheEnd) {
  EXPECT_EQ(mistakes_in("output.average_start = 5"),
            Texts{"case.toml:1: output.average_start = 5.0: the average starts after the end; allowed: [0, 5.0) (s)"});
}

TEST(Case, SurfaceDensitiesAreOrdered) {
  EXPECT_EQ(mistakes_in("free_surface.surface_density = 0.98"),
            Texts{"case.toml:1: free_surface.surface_density = 0.98: larger than the interior's density; allowed: [0, "
                  "0.97] (n0)"});
}

TEST(Case, TheStepKeepsTheViscousLimit) {
  EXPECT_EQ(mistakes_in("time.dt = 2e-3", box_base),
            Texts{"case.toml:1: time.dt = 0.002: above the viscous limit 0.2 dp^2/nu; allowed: (0, 0.00125] (s)"});
}

TEST(Case, TanksAndBoxesAreWholeParticlesLarge) {
  EXPECT_EQ(
      mistakes_in("tank.size = [0.205, 0.3]", tank_base),
      Texts{"case.toml:1: tank.size = [0.205, 0.3]: 0.205 m is 20.5 particle spacings; allowed: integer multiples "
            "of particles.spacing = 0.01 (m), the nearest are 0.2 and 0.21"});
  EXPECT_EQ(
      mistakes_in("tank.fluid_height = 0.123", tank_base),
      Texts{"case.toml:1: tank.fluid_height = 0.123: 0.123 m is 12.3 particle spacings; allowed: integer multiples "
            "of particles.spacing = 0.01 (m), the nearest are 0.12 and 0.13"});
  EXPECT_EQ(mistakes_in("periodic_box.size = [0.1, 0.101]", box_base),
            Texts{"case.toml:1: periodic_box.size = [0.1, 0.101]: 0.101 m is 40.4 particle spacings; allowed: integer "
                  "multiples of particles.spacing = 0.0025 (m), the nearest are 0.1 and 0.1025"});
  // Each length by itself; the sizes that are named are allowed.
  const std::string odd = "particles.spacing = 0.0071\ntank.fluid_height = 0.0994\ntank.size = ";
  const Texts found = mistakes_in(odd + "[0.7, 0.401]", tank_base);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_TRUE(found[0].ends_with("the nearest are 0.6958 and 0.7029")) << found[0];
  EXPECT_TRUE(found[1].ends_with("the nearest are 0.3976 and 0.4047")) << found[1];
  EXPECT_EQ(mistakes_in(odd + "[0.7029, 0.3976]", tank_base), Texts{});
  EXPECT_TRUE(mistakes_in("tank.fluid_height = 1e-3", tank_base).at(0).ends_with("(m), the least is 0.01"));
  const std::string fine = "particles.spacing = 0.00012345678912\ntank.fluid_height = 0.012345678912\ntank.size = ";
  const std::string text = mistakes_in(fine + "[3.0, 0.12345678912]", tank_base).at(0);
  EXPECT_TRUE(text.ends_with("the nearest are 2.99999997562 and 3.00012343241")) << text;
  EXPECT_EQ(mistakes_in(fine + "[3.00012343241, 0.12345678912]", tank_base), Texts{});
}

TEST(Case, TheFluidStaysBelowTheWalls) {
  EXPECT_EQ(mistakes_in("tank.fluid_height = 0.31", tank_base),
            Texts{"case.toml:1: tank.fluid_height = 0.31: higher than the walls; allowed: (0, 0.3] (m)"});
}

TEST(Case, PeriodsAreThreeCellsLong) {
  EXPECT_EQ(mistakes_in("periodic_box.size = [0.1, 0.02]", box_base),
            Texts{"case.toml:1: periodic_box.size = [0.1, 0.02]: a period is shorter than three background cells; "
                  "allowed: >= 0.0225 (m)"});
  EXPECT_EQ(mistakes_in("periodic_box.size = [0.1, 0.025]\nkernel.laplacian_radius = 4", box_base),
            Texts{"case.toml:1: periodic_box.size = [0.1, 0.025]: a period is shorter than three background cells; "
                  "allowed: >= 0.03 (m)"});
}

TEST(Case, ParticlesCanBeCounted) {
  EXPECT_EQ(mistakes_in("particles.spacing = 1e-7"),
            Texts{"case.toml:1: particles.spacing = 1e-07: makes some 5.6e+13 particles; allowed: at most 2147483647"});
  EXPECT_EQ(mistakes_in("particles.spacing = 1e-7", tank_base).size(), 1u);
  EXPECT_EQ(mistakes_in("particles.spacing = 1e-7", box_base).front(),
            "case.toml:1: particles.spacing = 1e-07: makes some 1e+12 particles; allowed: at most 2147483647");
}

TEST(Case, EarlierFilesOverrideLaterOnesAndSettingsAll) {
  const std::vector<NamedText> files{{"case.toml", "pressure.gamma = 0.1\ntime.dt = 1e-4"},
                                     {"common.toml", "pressure.gamma = 0.2\ntime.cfl = 0.1\ntime.dt = 1e-5"},
                                     jet_base};
  const Case config = parse_case(files, {"time.dt=2e-4", "time.dt=3e-4"});
  EXPECT_EQ(config.pressure.gamma, 0.1);
  EXPECT_EQ(config.time.cfl, 0.1);
  EXPECT_EQ(config.time.dt, 3e-4);
  EXPECT_EQ(config.jet.width, 0.4);
  EXPECT_EQ(parse_case(files).time.dt, 1e-4);
}

TEST(Case, AnOverriddenValueIsNotChecked) {
  EXPECT_TRUE(mistakes_in("pressure.gamma = 7", jet_base, {"pressure.gamma=0.5"}).empty());
}

TEST(Case, SettingsAreTomlOrBareWords) {
  const Case config =
      parse("", jet_base,
            {"jet.start=steady", "kernel.type = \"singular\"", "fluid.gravity=[0, -9.81]", "output.directory=/tmp/x y",
             "name=12", "pressure.clamp_negative=true", "plate={begin=-1.0, end=2.0}"});
  EXPECT_EQ(config.jet.start, JetStart::steady);
  EXPECT_EQ(config.kernel.type, KernelType::singular);
  EXPECT_EQ(config.fluid.gravity[1], -9.81);
  EXPECT_EQ(config.output.directory, "/tmp/x y");
  EXPECT_EQ(config.name, "12");
  EXPECT_TRUE(config.pressure.clamp_negative);
  EXPECT_EQ(config.plate.end, 2.0);
}

TEST(Case, FindsMistakesInSettings) {
  EXPECT_EQ(mistakes_in("", jet_base, {"jet.start", "=1", "jet.start=steadi", "time.dt=fast", "tiem.dt=1", "time.dt="}),
            (Texts{"--set: jet.start: not of the form key=value", "--set: =1: not of the form key=value",
                   "--set: jet.start = \"steadi\": unknown word; allowed: \"impact\", \"steady\"",
                   "--set: tiem.dt = 1: unknown key; did you mean time.dt?",
                   "--set: time.dt = \"\": not a number; allowed: > 0 (s)"}));
  EXPECT_EQ(mistakes_in("", jet_base, {"time.dt=1\nfoo=2"}).size(), 1u);
}

/// The text holds every key; some members besides, bit by bit.
void expect_round_trip(const Case& config) {
  const Case again = parse_stored({"resolved.toml", config.resolved_text});
  EXPECT_EQ(again.resolved_text, config.resolved_text);
  EXPECT_EQ(again.particles.spacing, config.particles.spacing);
  EXPECT_EQ(again.time.max_speed, config.time.max_speed);
  EXPECT_EQ(again.plate.begin, config.plate.begin);
  EXPECT_EQ(again.plate.end, config.plate.end);
  EXPECT_EQ(again.fluid.gravity, config.fluid.gravity);
  EXPECT_EQ(again.tank.size, config.tank.size);
  EXPECT_EQ(again.name, config.name);
  EXPECT_EQ(again.output.directory, config.output.directory);
}

TEST(Case, TheResolvedTextReadsBackToTheSameCase) {
  expect_round_trip(parse(""));
  expect_round_trip(parse("fluid.gravity = [-0.0, -9.80665]", tank_base));
  expect_round_trip(parse("name = \"sh\\\"e\\\\ar \\u00e9\"\nkernel.radius = 2.1000000000000001", box_base));
  const double odd = 0.1 + 0.2;
  const Case config = parse("", jet_base, {"fluid.density=0.30000000000000004"});
  EXPECT_EQ(config.fluid.density, odd);
  EXPECT_EQ(parse_case({{"r", config.resolved_text}}).fluid.density, odd);
  EXPECT_TRUE(
      std::signbit(parse_case({{"r", parse("fluid.gravity = [-0.0, 0]", tank_base).resolved_text}}).fluid.gravity[0]));
}

TEST(Case, TheResolvedTextHasNoKeysOfOtherGeometries) {
  const std::string text = parse("", tank_base).resolved_text;
  EXPECT_EQ(text.find("[jet]"), text.npos);
  EXPECT_EQ(text.find("[periodic_box]"), text.npos);
  EXPECT_NE(text.find("[tank]\nsize = [0.2, 0.3]\nfluid_height = 0.2\n"), text.npos);
}

TEST(Case, DescribeListsEveryKey) {
  const std::string text = describe_keys();
  for (const NamedText& base : {jet_base, tank_base, box_base}) {
    for (const std::string& line : resolved_lines(parse("", base)))
      EXPECT_NE(text.find("  " + line.substr(0, line.find(" = ")) + " "), text.npos) << line;
  }
  EXPECT_NE(text.find("[1, 90] (deg); required"), text.npos);
  EXPECT_NE(text.find("default \"non_singular\""), text.npos);
  EXPECT_NE(text.find("include = "), text.npos);
}

TEST_F(CaseFiles, IncludedFilesAreDefaults) {
  write("common/all.toml", jet_base.second + "pressure.gamma = 0.3\n[collision]\ndistance = 0.3\nrestitution = 0.3");
  write("common/jet.toml", "include = \"all.toml\"\n[collision]\ndistance = 0.4\nrestitution = 0.4");
  const std::string path = write("case.toml", "include = \"common/jet.toml\"\ncollision.distance = 0.5");
  const std::vector<NamedText> files = load_case_files(path);
  ASSERT_EQ(files.size(), 3u);
  EXPECT_EQ(files[0].first, path);
  const Case config = parse_case(files);
  EXPECT_EQ(config.collision.distance, 0.5);
  EXPECT_EQ(config.collision.restitution, 0.4);
  EXPECT_EQ(config.pressure.gamma, 0.3);
}

TEST_F(CaseFiles, MissingFilesAreMistakes) {
  const std::string missing = path("nothing.toml");
  EXPECT_EQ(mistakes([&] { load_case_files(missing); }),
            Texts{missing + ": cannot read " + missing + ": No such file or directory"});
  EXPECT_EQ(mistakes([&] { load_case_files(directory_); }),
            Texts{directory_.string() + ": cannot read " + directory_.string() + ": is a directory"});
}

TEST_F(CaseFiles, FilesThatCannotBeReadAreMistakes) {
  const std::string file = path("case.toml");
  const std::string line = file + ":1: include = ";
  const auto include = [&](const std::string& name) {
    write("case.toml", "include = \"" + name + "\"");
    const Texts found = mistakes([&] { load_case_files(file); });
    return found.empty() ? "" : found[0];
  };
  EXPECT_EQ(include("."), line + "\".\": cannot read " + path(".") + ": is a directory");
  EXPECT_EQ(include(""), line + "\"\": cannot read " + path("") + ": is a directory");
  EXPECT_EQ(include("case.toml"), line + "\"case.toml\": the files include each other in a circle");
  EXPECT_EQ(include("./case.toml/"),
            line + "\"./case.toml/\": cannot read " + path("./case.toml/") + ": Not a directory");
  const std::string endless(5000, 'x');
  EXPECT_EQ(include(endless), line + '"' + endless + "\": cannot read " + path(endless) + ": File name too long");
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  for (const std::string& name : {std::string("/dev/zero"), path("pipe")}) {
    EXPECT_EQ(include(name), line + '"' + name + "\": cannot read " + name + ": is no regular file");
  }
  EXPECT_EQ(mistakes([] { load_case_files("/dev/zero"); }).at(0),
            "/dev/zero: cannot read /dev/zero: larger than 1048576 bytes");
  EXPECT_EQ(include("/proc/self/mem"), line + "\"/proc/self/mem\": cannot read /proc/self/mem: Input/output error");
  fs::create_symlink("loop", path("loop"));
  EXPECT_EQ(include("loop"), line + "\"loop\": cannot read " + path("loop") + ": Too many levels of symbolic links");
}

TEST_F(CaseFiles, AnEmptyFileLacksItsKeys) {
  const std::string file = write("case.toml", "");
  EXPECT_EQ(mistakes([&] { parse_case(load_case_files(file)); }).at(0),
            file + ": geometry: required key is missing; allowed: \"jet\", \"tank\", \"periodic_box\", \"scene\"");
}

TEST_F(CaseFiles, AMissingIncludeComesWithTheOtherMistakes) {
  const std::string file = write("case.toml", "time.dt = -1\ninclude = \"nothing.toml\"\nfoo.bar = 1");
  EXPECT_EQ(mistakes([&] { load_case_files(file); }), (Texts{file + ":1: time.dt = -1: out of range; allowed: > 0 (s)",
                                                             file + ":2: include = \"nothing.toml\": cannot read " +
                                                                 path("nothing.toml") + ": No such file or directory",
                                                             file + ":3: foo.bar = 1: unknown key"}));
}

TEST_F(CaseFiles, IncludesInACircleAreMistakes) {
  const std::string one = write("one.toml", "include = \"sub/two.toml\"");
  const std::string two = write("sub/two.toml", "\ninclude = \"../one.toml\"");
  EXPECT_EQ(mistakes([&] { load_case_files(one); }),
            Texts{two + ":2: include = \"../one.toml\": the files include each other in a circle"});
}

TEST_F(CaseFiles, IncludeIsAString) {
  const std::string file = write("case.toml", "include = 3\n" + jet_base.second);
  EXPECT_EQ(mistakes([&] { parse_case(load_case_files(file)); }),
            Texts{file + ":1: include = 3: not a string; allowed: a file"});
}

TEST_F(CaseFiles, FilesThatAreNotTomlAreLeftToParseCase) {
  const std::string file = write("case.toml", "time.dt = \n");
  EXPECT_TRUE(mistakes([&] { parse_case(load_case_files(file)); }).at(0).starts_with(file + ":1: not TOML: "));
}

TEST_F(CaseFiles, ChecksThatTheOutputDirectoryIsWritable) {
  Case config = parse("output.directory = '" + path("a/b") + "'");
  check_writable(config);
  EXPECT_TRUE(fs::is_directory(path("a/b")));
  EXPECT_TRUE(fs::is_empty(path("a/b")));
  const std::string file = write("file", "");
  for (const std::string& directory : {file, file + "/below"}) {
    config = parse("\noutput.directory = '" + directory + "'");
    const Texts found = mistakes([&] { check_writable(config); });
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0], "case.toml:2: output.directory = \"" + directory + "\": cannot write there: Not a directory");
  }
}

TEST(Case, ShippedCasesAreSound) {
  const fs::path input = fs::path(__FILE__).parent_path() / "../../input";
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(input)) {
    if (entry.path().extension() != ".toml" || entry.path().parent_path().filename() == "common") continue;
    const Texts found = mistakes([&] {
      const Case config = parse_case(load_case_files(entry.path()));
      EXPECT_EQ(config.name, entry.path().stem());
      expect_round_trip(config);
    });
    EXPECT_EQ(found, Texts{}) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 19);
}

TEST(Case, ThePapersCasesAreThoseOfItsTables) {
  const fs::path paper = fs::path(__FILE__).parent_path() / "../../input/paper";
  const auto check = [&](const std::string& name, double gamma, KernelType kernel) {
    for (const int angle : {30, 60}) {
      const Case c = parse_case(load_case_files(paper / ("jet" + std::to_string(angle) + "-" + name + ".toml")));
      EXPECT_EQ(c.scheme, Scheme::paper);
      EXPECT_EQ(c.walls.model, WallModel::particles);
      EXPECT_EQ(c.pressure.gamma, gamma);
      EXPECT_EQ(c.kernel.type, kernel);
      EXPECT_EQ(c.jet.angle, angle);
      EXPECT_NEAR(c.jet.width / c.particles.spacing, 80.0, 1e-9);
      EXPECT_EQ(c.time.dt, 2e-4);
    }
  };
  check("A1", 1.0, KernelType::non_singular);
  check("A2", 0.01, KernelType::non_singular);
  check("A2-printed", 0.99, KernelType::non_singular);
  check("A3", 0.0, KernelType::non_singular);
  check("B1", 0.01, KernelType::singular);
  check("B2", 0.01, KernelType::non_singular);
}

// ---------------------------------------------------------------------------------------------------------------------
// The case of a restart.

const NamedText stored{"x_00000007.checkpoint", parse("name = \"x\"").resolved_text};

TEST(RestartCase, TakesSettingsOverTheStoredCase) {
  const Case config = parse_restart(stored, {"time.end=7", "checkpoint.steps=3", "jet.speed=1.0"}, "a \"b\"");
  EXPECT_EQ(config.time.end, 7.0);
  EXPECT_EQ(config.checkpoint.steps, 3);
  EXPECT_EQ(config.output.directory, "a \"b\"");
  EXPECT_EQ(config.average_start, 4.0);  // of the stored case
  EXPECT_NE(config.resolved_text.find(R"(directory = "a \"b\"")"), std::string::npos) << config.resolved_text;
}

TEST(RestartCase, RefusesWhatARunCannotChange) {
  const auto mistakes_of = [](const Texts& settings) {
    return mistakes([&] { parse_restart(stored, settings, "out"); });
  };
  EXPECT_EQ(mistakes_of({"particles.spacing=0.01", "jet.speed=2", "output.directory=here"}),
            (Texts{"--set: particles.spacing = 0.01: a restart cannot change this key; allowed: 0.02",
                   "--set: jet.speed = 2.0: a restart cannot change this key; allowed: 1.0",
                   "--set: output.directory = \"here\": a restart cannot change this key; allowed: \"output/x\""}));
  for (const char* setting :
       {"name=y", "scheme=paper", "fluid.density=900", "kernel.radius=2.5", "walls.model=particles", "plate.end=3"})
    EXPECT_EQ(mistakes_of({setting}).size(), 1u) << setting;
  EXPECT_EQ(mistakes_of({"time.dt=-1"}), (Texts{"--set: time.dt = -1: out of range; allowed: > 0 (s)"}));
}

TEST(RestartCase, RefusesAForeignText) {
  EXPECT_THROW(parse_restart({"x_00000007.checkpoint", "geometry = 7"}, {}, "out"), FileError);
}

}  // namespace
}  // namespace impinge
