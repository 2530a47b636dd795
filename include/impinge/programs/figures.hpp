#pragma once
// Figures, drawn by the Python program impinge-plot.

#include <string>
#include <vector>

namespace impinge {

/// Runs `impinge-plot`, which stands beside this program, as a process outside of MPI and waits for its end. False
/// where it, Python or a package is missing, which the process has told. Throws FileError where it fails otherwise. Not
/// collective.
bool draw(const std::vector<std::string>& arguments);

}  // namespace impinge
