#pragma once
// What is wrong with the cases that the tests write.

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "impinge/cases/case.hpp"
#include "impinge/core/errors.hpp"

namespace impinge {

/// Appends a case and the mistakes in it to the file that IMPINGE_NOTED_CASES names, if it is set. There
/// tests/system/schema_test.py compares them with the schema of case files.
inline void note_case(const std::vector<NamedText>& files, const std::vector<std::string>& mistakes) {
  const char* path = std::getenv("IMPINGE_NOTED_CASES");
  if (!path) return;
  nlohmann::json texts = nlohmann::json::array();
  for (const auto& [name, text] : files) texts.push_back(text);
  const nlohmann::json line{{"files", texts}, {"mistakes", mistakes}};
  std::ofstream(path, std::ios::app) << line.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) << '\n';
}

/// The mistakes in a case; none if it is sound.
inline std::vector<std::string> case_mistakes(const std::vector<NamedText>& files,
                                              const std::vector<std::string>& settings = {}) {
  std::vector<std::string> mistakes;
  try {
    parse_case(files, settings);
  } catch (const InputError& error) {
    mistakes = error.mistakes();
  }
  if (settings.empty()) note_case(files, mistakes);
  return mistakes;
}

}  // namespace impinge
