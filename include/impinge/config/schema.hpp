#pragma once
// The keys of a case file as a JSON schema, for editors.

#include <string>

#include "impinge/config/key.hpp"

namespace impinge {

/// A JSON schema (draft 7) that a case file fulfils if each value by itself has its type and range, each key is known
/// and applies, and none is missing. In a file that includes another, none is missing. Each key has its doc line, unit,
/// range and default as a description, which editors show. Gives each list one table.
std::string schema(Keys& keys);

}  // namespace impinge
