// The command line: what is ours, what is PETSc's, what is wrong.

#include "impinge/programs/command_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "impinge/cases/case.hpp"
#include "impinge/cases/new_cases.hpp"
#include "impinge/observe/history.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

std::string mistake_in(const Words& arguments) {
  try {
    parse_command_line(arguments);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CommandLine, TakesACaseAndSettings) {
  const CommandLine line =
      parse_command_line({"--set", "time.dt=1e-4", "case.toml", "--set=fluid.gravity=[0, -9.81]", "--check"});
  EXPECT_EQ(line.case_path, "case.toml");
  EXPECT_EQ(line.settings, (Words{"time.dt=1e-4", "fluid.gravity=[0, -9.81]"}));
  EXPECT_TRUE(line.check);
  EXPECT_TRUE(line.petsc_arguments.empty());
  EXPECT_TRUE(line.text.empty());
  EXPECT_FALSE(parse_command_line({"case.toml"}).check);
}

TEST(CommandLine, TakesANumberOfRanksToPlanFor) {
  EXPECT_EQ(parse_command_line({"case.toml"}).plan_ranks, 0);
  EXPECT_EQ(parse_command_line({"case.toml", "--plan", "10000"}).plan_ranks, 10000);
  EXPECT_EQ(parse_command_line({"--plan=1", "case.toml"}).plan_ranks, 1);
  for (const char* ranks : {"0", "-5", "1.5", "1e3", "many", "1000001", ""})
    EXPECT_NE(mistake_in({"case.toml", "--plan", ranks}).find("--plan"), std::string::npos) << ranks;
  EXPECT_NE(mistake_in({"case.toml", "--plan"}).find("--plan"), std::string::npos);
  EXPECT_NE(mistake_in({"case.toml", "--plan", "4", "--check"}).find("--check"), std::string::npos);
}

TEST(CommandLine, TakesADirectoryToGoOnIn) {
  const CommandLine line = parse_command_line({"--restart", "out/x", "--set", "time.end=9", "-log_view"});
  EXPECT_EQ(line.restart_directory, "out/x");
  EXPECT_EQ(line.case_path, "");
  EXPECT_EQ(line.settings, Words{"time.end=9"});
  for (const Words& more : {Words{"case.toml"}, Words{"--check"}, Words{"--plan", "2"}}) {
    Words words{"--restart", "out"};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_NE(mistake_in(words).find("--restart"), std::string::npos) << more.front();
  }
  EXPECT_NE(mistake_in({"--restart"}).find("--restart"), std::string::npos);
}

TEST(CommandLine, SplitsOffPetscOptionsInOrder) {
  const CommandLine line = parse_command_line({"-ppe_ksp_monitor", "case.toml", "-ppe_ksp_rtol", "1e-8", "-log_view",
                                               "--set", "time.end=1", "-ppe_shift", "-1.5", "-ppe_pc_type", "gamg"});
  EXPECT_EQ(line.case_path, "case.toml");
  EXPECT_EQ(line.settings, Words{"time.end=1"});
  EXPECT_EQ(line.petsc_arguments, (Words{"-ppe_ksp_monitor", "-ppe_ksp_rtol", "1e-8", "-log_view", "-ppe_shift", "-1.5",
                                         "-ppe_pc_type", "gamg"}));
}

TEST(CommandLine, HelpNamesOptionsAndExitCodes) {
  for (const Words& arguments :
       {Words{"--help"}, Words{"-h"}, Words{"-log_view", "-h"}, Words{"case.toml", "--help"}}) {
    const std::string text = parse_command_line(arguments).text;
    for (const char* part : {"--set", "--check", "--plan RANKS", "--describe", "--schema", "--new jet|", "--version",
                             "CASE.toml", "-ppe_ksp_type cg", "-ppe_pc_type two_level|hypre|gamg", "-ppe_ksp_monitor",
                             "-log_view", "2 wrong input", "--restart DIR", "4 ended by a signal"}) {
      EXPECT_NE(text.find(part), text.npos) << part;
    }
  }
}

TEST(CommandLine, PrintsVersionAndKeys) {
  EXPECT_EQ(parse_command_line({"--version"}).text, "impinge " IMPINGE_VERSION "\n");
  EXPECT_EQ(parse_command_line({"--describe"}).text, describe_keys() + "\n" + describe_history());
  EXPECT_EQ(parse_command_line({"--schema"}).text, schema_of_keys());
}

TEST(CommandLine, PrintsCasesToStartFrom) {
  std::set<std::string> offered;
  for (const NewCase& one : new_cases()) {
    const std::string name(one.name), text = parse_command_line({"--new", name}).text;
    EXPECT_TRUE(text.ends_with(one.text)) << name;
    EXPECT_TRUE(text.starts_with("# ") || text.starts_with("#:schema /")) << name;
    EXPECT_EQ(parse_case({{name + ".toml", text}}).name, name);
    offered.insert(std::string(one.text));
  }
  for (const char* name : {"jet", "dam-break", "sloshing"})
    EXPECT_EQ(std::ranges::count(new_cases(), name, &NewCase::name), 1);
  // Every shipped case that needs no other file, but for those that are there to be compared.
  std::set<std::string> shipped, compared;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(__FILE__).parent_path() / "../../input")) {
    if (entry.path().extension() != ".toml" || entry.path().parent_path().filename() == "common") continue;
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    const auto has = [&](const char* key) { return text.str().find(key) != std::string::npos; };
    if (has("\ninclude = ") || has("\nfile = ")) continue;
    (fs::exists(entry.path().parent_path() / "compare.py") ? compared : shipped).insert(text.str());
  }
  for (const std::string& text : shipped) EXPECT_TRUE(offered.contains(text)) << text;
  for (const std::string& text : offered) EXPECT_TRUE(shipped.contains(text) || compared.contains(text)) << text;
  const std::string mistake = mistake_in({"--new", "tsunami"});
  EXPECT_TRUE(mistake.starts_with("command line: --new: tsunami not in {jet,dam-break,sloshing,")) << mistake;
  EXPECT_NE(mistake_in({"--new"}), "");
}

TEST(CommandLine, FindsMistakes) {
  EXPECT_EQ(mistake_in({}), "command line: the case file is missing; see impinge --help");
  EXPECT_EQ(
      mistake_in({"-log_view", "case"}),
      "command line: the case file is missing (case is taken for the value of a PETSc option); see impinge --help");
  EXPECT_NE(mistake_in({"case.toml", "other.toml"}).find("other.toml"), std::string::npos);
  EXPECT_NE(mistake_in({"case.toml", "--chekc"}).find("--chekc"), std::string::npos);
  EXPECT_NE(mistake_in({"case.toml", "--set"}).find("--set"), std::string::npos);
}

}  // namespace
}  // namespace impinge
