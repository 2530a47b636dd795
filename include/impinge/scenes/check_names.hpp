#pragma once
// Names in a list of tables.

#include <fmt/format.h>

#include <vector>

#include "impinge/config/key.hpp"

namespace impinge {

/// Notes names that are used twice in a list.
template <class Entry>
void check_names(Keys& keys, const std::vector<Entry>& entries) {
  for (std::size_t b = 0; b < entries.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      if (entries[a].name != entries[b].name) continue;
      keys.mistake(entries[b].name, fmt::format("the name is used twice, first at {}", keys.place(entries[a].name)));
      break;
    }
  }
}

}  // namespace impinge
