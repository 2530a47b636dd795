#pragma once
// The history of a run: one row per step.

#include <span>
#include <string>

#include "impinge/method/step_report.hpp"

namespace impinge {

/// A column of the history.
struct HistoryColumn {
  const char* name;     ///< in the file
  const char* unit;     ///< "": none
  const char* meaning;  ///< for the documentation
  std::string (*value)(const StepReport& report, double seconds);
};

/// All columns, in the order of the file.
std::span<const HistoryColumn> history_columns();

/// The names of all columns, separated by commas.
std::string history_header();

/// A step's row. `seconds`: wall-clock time of the step.
std::string history_row(const StepReport& report, double seconds);

/// Every column with its unit and meaning, as a text for the terminal.
std::string describe_history();

}  // namespace impinge
