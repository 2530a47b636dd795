#pragma once
// Names in the headers of tables.

#include <algorithm>
#include <string>

namespace impinge {

/// The name of a wall or an outlet as a part of a column's: it has neither commas nor quotes then.
inline std::string in_column(std::string name) {
  std::ranges::replace_if(
      name, [](char c) { return c == ',' || c == '"'; }, '_');
  return name;
}

}  // namespace impinge
