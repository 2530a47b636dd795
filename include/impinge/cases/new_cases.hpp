#pragma once
// The cases that `impinge --new` offers to start from.

#include <span>
#include <string_view>

namespace impinge {

struct NewCase {
  std::string_view name;
  std::string_view text;  ///< of its file in input/
};

/// In the order in which they are offered.
std::span<const NewCase> new_cases();

}  // namespace impinge
