#include "impinge/observe/observers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "impinge/core/errors.hpp"

namespace impinge {
namespace {

std::string header(const std::vector<std::string>& columns) {
  return fmt::format("step,t [s],{}", fmt::join(columns, ","));
}

std::string row(const StepReport& report, const std::string& values) {
  return fmt::format("{},{:.17g},{}", report.step, report.time, values);
}
std::string row(const StepReport& report, const std::vector<double>& values) {
  return row(report, fmt::format("{:.9g}", fmt::join(values, ",")));
}
std::string row(const StepReport& report, const std::vector<std::int64_t>& counts) {
  return row(report, fmt::format("{}", fmt::join(counts, ",")));
}

}  // namespace

template <int Dim>
Observers<Dim>::Observers(MPI_Comm comm, const ObserverSettings& settings, const MethodSettings& method,
                          const Scene<Dim>& scene, const Particles<Dim>& particles, const StepReport& report)
    : comm_(comm),
      sampling_(settings.sampling),
      probes_(settings.probes, scene, method.particles.spacing),
      gauges_(settings.gauges, scene, method),
      sections_(comm, settings.sections, scene, method.particles.spacing, particles, report.time),
      forces_(scene),
      outlets_(scene),
      last_time_(report.time),
      last_step_(report.step) {}

// Calls use(kind, part, measure) for every table that has columns; measure(what there is after a step) gives its row.
template <int Dim>
template <class Self, class Use>
void Observers<Dim>::for_tables(Self& self, Use&& use) {
  const auto add = [&](const char* kind, auto& part, auto measure) {
    if (!part.empty()) use(kind, part, measure);
  };
  MPI_Comm comm = self.comm_;
  add("probes", self.probes_,
      [&](const auto& now) { return self.probes_.measure(comm, now.particles, now.report.time); });
  add("gauges", self.gauges_,
      [&](const auto& now) { return self.gauges_.measure(comm, now.particles, now.surface_depth); });
  add("sections", self.sections_, [&](const auto& now) { return self.measure_sections(now.report); });
  add("forces", self.forces_,
      [&](const auto& now) { return self.forces_.measure(comm, now.particles, now.report.time); });
  add("outlets", self.outlets_, [&](const auto& now) { return self.outlets_.measure(now.outlets); });
}

template <int Dim>
std::vector<TableLine> Observers<Dim>::headers() const {
  std::vector<TableLine> lines;
  for_tables(*this, [&](const char* kind, auto& part, auto&) { lines.push_back({kind, header(part.columns())}); });
  return lines;
}

template <int Dim>
void Observers<Dim>::go_on(const std::string& last_row) {
  std::vector<double> numbers;
  std::istringstream cells(last_row);
  for (std::string cell; std::getline(cells, cell, ',');) numbers.push_back(std::strtod(cell.c_str(), nullptr));
  if (numbers.empty()) return;
  constexpr double most = 1e15;  // larger ones are not counted exactly
  const auto is_sound = [](double x) { return std::abs(x) < most; };
  if (numbers.size() != 2 + sections_.columns().size() || !std::ranges::all_of(numbers, is_sound))
    throw FileError(fmt::format("cannot continue the table of sections: its last row is {}", last_row));
  sections_.go_on(numbers[1], {numbers.begin() + 2, numbers.end()});
}

// At the first step that ends at or after a multiple of the interval.
template <int Dim>
bool Observers<Dim>::is_due(const StepReport& report) const {
  if (sampling_.steps > 0 && report.step % sampling_.steps == 0) return true;
  constexpr double rounding = 1e-9;
  const auto intervals = [&](double time) { return std::floor(time / sampling_.interval + rounding); };
  return sampling_.interval > 0.0 && intervals(report.time) > intervals(last_time_);
}

template <int Dim>
std::vector<double> Observers<Dim>::measure_sections(const StepReport& report) {
  last_step_ = report.step;
  return sections_.measure(report.time);
}

template <int Dim>
std::vector<TableLine> Observers<Dim>::observe(const Now& now) {
  if (!sections_.empty()) sections_.count(now.particles);
  const bool due = is_due(now.report);
  last_time_ = now.report.time;
  if (!due) return {};
  std::vector<TableLine> rows;
  for_tables(*this, [&](const char* kind, auto&, auto measure) {
    rows.push_back({kind, row(now.report, measure(now))});
  });
  return rows;
}

template <int Dim>
std::vector<TableLine> Observers<Dim>::rows_for_restart(const StepReport& report) {
  if (sections_.empty() || last_step_ == report.step) return {};
  return {{"sections", row(report, measure_sections(report))}};
}

template class Observers<2>;
template class Observers<3>;

}  // namespace impinge
