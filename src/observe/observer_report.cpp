#include "impinge/observe/observer_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <span>

namespace impinge {

std::vector<std::string> observer_lines(const ObserverSettings& settings, int dimension) {
  const auto text = [&](const Numbers& x) {
    return fmt::format("({:.6g})", fmt::join(std::span(x).first(static_cast<std::size_t>(dimension)), ", "));
  };
  std::vector<std::string> lines;
  for (const ProbeSettings& probe : settings.probes) {
    std::string line = fmt::format("probe       {}: at {} m", probe.name, text(probe.position));
    if (probe.wall != "none") line += fmt::format(", rides on {}", probe.wall);
    if (probe.diameter > 0.0) line += fmt::format(", a face of {:.6g} m", probe.diameter);
    if (probe.diameter > 0.0 && probe.wall == "none") line += fmt::format(" that looks along {}", text(probe.normal));
    lines.push_back(line);
  }
  for (const GaugeSettings& gauge : settings.gauges)
    lines.push_back(fmt::format("gauge       {}: from {} m on {:.6g} m along {}", gauge.name, text(gauge.point),
                                gauge.length, text(gauge.direction)));
  for (const SectionSettings& section : settings.sections)
    lines.push_back(fmt::format("section     {}: from {} to {} m{}", section.name, text(section.begin),
                                text(section.end),
                                dimension == 3 ? fmt::format(", side {} m", text(section.side)) : ""));
  return lines;
}

}  // namespace impinge
