#include "impinge/observe/history.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

namespace impinge {
namespace {

std::string count(std::int64_t value) { return fmt::format("{}", value); }
std::string exact(double value) { return fmt::format("{:.17g}", value); }
std::string rounded(double value) { return fmt::format("{:.9g}", value); }

constexpr HistoryColumn columns[] = {
    {"step", "", "number of the step", [](const StepReport& r, double) { return count(r.step); }},
    {"t", "s", "time at its end", [](const StepReport& r, double) { return exact(r.time); }},
    {"dt", "s", "time step", [](const StepReport& r, double) { return exact(r.dt); }},
    {"limit", "", "what bounded dt: case (time.dt), CFL, force, growth, retry, or target (a time of output)",
     [](const StepReport& r, double) { return std::string(step_limit_names[static_cast<std::size_t>(r.limit)]); }},
    {"particles", "", "particles of every type", [](const StepReport& r, double) { return count(r.particles); }},
    {"fluid", "", "fluid particles", [](const StepReport& r, double) { return count(r.fluid); }},
    {"in", "", "fluid particles at the start and through the inlet since",
     [](const StepReport& r, double) { return count(r.in); }},
    {"out", "", "fluid particles that left through the outlets",
     [](const StepReport& r, double) { return count(r.out); }},
    {"lost", "", "fluid particles that left the bounds elsewhere and were removed",
     [](const StepReport& r, double) { return count(r.lost); }},
    {"kinetic_energy", "J; 2D: J/m", "of the fluid",
     [](const StepReport& r, double) { return rounded(r.kinetic_energy); }},
    {"max_speed", "m/s", "largest speed of the fluid",
     [](const StepReport& r, double) { return rounded(r.max_speed); }},
    {"max_pressure", "Pa", "largest pressure", [](const StepReport& r, double) { return rounded(r.max_pressure); }},
    {"plate_force", "N; 2D: N/m", "pressure force on plate or floor",
     [](const StepReport& r, double) { return rounded(r.floor_force); }},
    {"iterations", "", "iterations of the pressure solver",
     [](const StepReport& r, double) { return count(r.pressure.iterations); }},
    {"residual", "", "relative residual of the pressure equation",
     [](const StepReport& r, double) { return fmt::format("{:.3e}", r.pressure.residual); }},
    {"cold_solves", "", "pressure solves that were repeated from zero",
     [](const StepReport& r, double) { return count(r.cold_solves); }},
    {"halvings", "", "how often the step was repeated with half its dt",
     [](const StepReport& r, double) { return count(r.halvings); }},
    {"seconds", "s", "wall-clock time of the step",
     [](const StepReport&, double seconds) { return fmt::format("{:.4f}", seconds); }},
};

}  // namespace

std::span<const HistoryColumn> history_columns() { return columns; }

std::string history_header() {
  std::vector<std::string> names;
  for (const HistoryColumn& column : columns) names.emplace_back(column.name);
  return fmt::format("{}", fmt::join(names, ","));
}

std::string history_row(const StepReport& report, double seconds) {
  std::vector<std::string> values;
  for (const HistoryColumn& column : columns) values.push_back(column.value(report, seconds));
  return fmt::format("{}", fmt::join(values, ","));
}

std::string describe_history() {
  std::string text = "Columns of the history, <case>_history.csv: a row per step.\n";
  for (const HistoryColumn& column : columns) {
    const std::string unit = *column.unit ? fmt::format(" [{}]", column.unit) : "";
    text += fmt::format("  {:<29} {}{}\n", column.name, column.meaning, unit);
  }
  return text;
}

}  // namespace impinge
