#pragma once
// What a case observes, as texts.

#include <string>
#include <vector>

#include "impinge/observe/settings.hpp"

namespace impinge {

/// A line for each probe, gauge and section. `dimension`: of space.
std::vector<std::string> observer_lines(const ObserverSettings& settings, int dimension);

}  // namespace impinge
