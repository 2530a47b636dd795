#include "impinge/scenes/scene_report.hpp"

#include <fmt/format.h>

#include <optional>

#include "impinge/scenes/wet_space.hpp"

namespace impinge {
namespace {

constexpr double touching = 0.01;  // nearer walls have no gap [dp]
constexpr double least_gap = 2.0;  // that fluid can flow through [dp]

/// Two walls and the gap between them.
struct WallGap {
  std::size_t one, other;
  double width;  ///< [dp]
  Vector<2> middle;
};

/// The gaps between all pairs of walls at the start, where they are wet.
std::vector<WallGap> gaps_between(const std::vector<Wall>& walls, double spacing) {
  std::vector<WallGap> gaps;
  const WetSpace wet(walls, 0.0, spacing);
  std::vector<Outline> outlines;
  for (const Wall& wall : walls) outlines.push_back(outline_at(wall, 0.0));
  for (std::size_t b = 0; b < walls.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      const Gap gap = narrowest_gap(outlines[a], outlines[b]);
      const Vector<2> middle = 0.5 * (gap.begin + gap.end);
      if (gap.width > touching * spacing && wet.contains(middle)) gaps.push_back({a, b, gap.width / spacing, middle});
    }
  }
  return gaps;
}

std::string inlet_line(const InletEntry& entry, const MethodSettings& method) {
  const Inlet<2> inlet = inlet_of(entry, method.particles.spacing, method.kernel);
  std::string text = fmt::format("inlet       {}: {:.6g} m wide, {} rows of {} particles, ", entry.name, entry.width,
                                 inlet.rows, inlet.section.size());
  if (entry.speeds.empty()) {
    text += fmt::format("{:.6g} m/s", entry.speed);
  } else {
    text += fmt::format("{} speeds up to {:.6g} m/s", entry.speeds.size(), largest_speed(entry));
  }
  if (entry.start > 0.0) text += fmt::format(", from t = {:.6g} s", entry.start);
  if (entry.stop < InletEntry::never) text += fmt::format(", until t = {:.6g} s", entry.stop);
  return text;
}

template <int Dim>
std::string outlet_line(const OutletEntry& entry) {
  std::vector<std::string> mistakes;
  const auto shape = scaled_shape<Dim>(entry, mistakes);
  return fmt::format("outlet      {}: {:.6g} m^{}", entry.name, shape ? shape->volume() : 0.0, Dim);
}

}  // namespace

std::vector<std::string> scene_lines(const MethodSettings& method, const SceneSettings& settings) {
  std::vector<std::string> lines;
  const std::vector<Wall> walls = walls_of(settings.scene_walls, settings.motions);
  const std::vector<WallGap> gaps = gaps_between(walls, method.particles.spacing);
  for (std::size_t k = 0; k < walls.size(); ++k) {
    const Outline& outline = walls[k].outline;
    const std::size_t faces = outline.edges().size();
    std::string text = fmt::format("wall        {}: {:.6g} m long, ", walls[k].name, outline.length());
    if (outline.closed()) text += fmt::format("{:.6g} m^2 enclosed, ", outline.volume());
    text += fmt::format("{} face{}, wet {}", faces, faces == 1 ? "" : "s",
                        words(Wet{})[static_cast<std::size_t>(settings.scene_walls[k].wet)]);
    if (settings.scene_walls[k].motion != no_motion)
      text += fmt::format(", moves by {}", settings.scene_walls[k].motion);
    const WallGap* narrowest = nullptr;
    for (const WallGap& gap : gaps)
      if ((gap.one == k || gap.other == k) && (!narrowest || gap.width < narrowest->width)) narrowest = &gap;
    if (narrowest)
      text += fmt::format(", narrowest gap {:.3g} dp, to {}", narrowest->width,
                          walls[narrowest->one == k ? narrowest->other : narrowest->one].name);
    lines.push_back(text);
  }
  for (const InletEntry& entry : settings.inlets) lines.push_back(inlet_line(entry, method));
  for (const OutletEntry& entry : settings.outlets)
    lines.push_back(method.dimension == 2 ? outlet_line<2>(entry) : outlet_line<3>(entry));
  return lines;
}

std::vector<std::string> scene_warnings(const MethodSettings& method, const SceneSettings& settings) {
  std::vector<std::string> texts;
  const std::vector<Wall> walls = walls_of(settings.scene_walls, settings.motions);
  for (const WallGap& gap : gaps_between(walls, method.particles.spacing)) {
    if (gap.width >= least_gap) continue;
    texts.push_back(
        fmt::format("the gap between the walls \"{}\" and \"{}\" is {:.3g} dp wide at ({:.6g}, {:.6g}) m; fluid "
                    "needs {} dp to pass",
                    walls[gap.one].name, walls[gap.other].name, gap.width, gap.middle[0], gap.middle[1], least_gap));
  }
  return texts;
}

}  // namespace impinge
