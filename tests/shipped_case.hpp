#pragma once
// The cases of input/ for the tests.

#include <filesystem>

#include "impinge/cases/case.hpp"

namespace impinge {

/// A case file of input/, with settings as on the command line.
inline Case shipped_case(const std::string& file, const std::vector<std::string>& settings = {}) {
  const auto input = std::filesystem::path(__FILE__).parent_path() / "../input";
  return parse_case(load_case_files((input / file).string()), settings);
}

}  // namespace impinge
