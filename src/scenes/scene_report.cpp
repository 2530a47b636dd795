#include "impinge/scenes/scene_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "impinge/scenes/wall_gaps.hpp"

namespace impinge {
namespace {

constexpr double least_gap = 2.0;  // that fluid can flow through [dp]

/// Times at which the walls are looked at: where all motions are told by few [s].
std::vector<double> times_of_all(const std::vector<MotionEntry>& motions, double end) {
  constexpr std::size_t most = 400;
  std::vector<double> times{0.0};
  for (const MotionEntry& motion : motions)
    for (const double time : times_of(motion, end, most)) times.push_back(time);
  std::ranges::sort(times);
  const auto [again, stop] = std::ranges::unique(times);
  times.erase(again, stop);
  return times;
}

/// "at (1, 0.5) m", and the time if it is not the start.
std::string place_text(const WallGap& gap) {
  constexpr double rounding = 1e-12;
  Vector<2> place = gap.place;
  for (int k = 0; k < 2; ++k)
    if (std::abs(place[k]) < rounding * norm(gap.place)) place[k] = 0.0;
  return fmt::format("at ({:.5g}, {:.5g}) m{}", place[0], place[1],
                     gap.time > 0.0 ? fmt::format(" at t = {:.4g} s", gap.time) : "");
}

/// Faces, and pieces in line with each other that they are made of.
std::string faces_text(const WallEntry& entry, const Outline& outline) {
  const std::size_t faces = outline.edges().size(), corners = entry.points.size();
  std::size_t pieces = faces;
  if (entry.shape == ShapeType::polygon) pieces = corners;
  if (entry.shape == ShapeType::polyline) pieces = corners - 1;
  return fmt::format("{} face{}{}", faces, faces == 1 ? "" : "s",
                     pieces > faces ? fmt::format(" of {} pieces", pieces) : "");
}

std::string moved_by(const WallEntry& entry) {
  return entry.motion == no_motion ? "" : fmt::format(", moves by {}", entry.motion);
}

std::string wall_line(const WallEntry& entry, const Wall<2>& wall) {
  std::string text = fmt::format("wall        {}: {:.6g} m long, ", wall.name, wall.surface->length());
  if (wall.surface->closed()) text += fmt::format("{:.6g} m^2 enclosed, ", wall.surface->volume());
  text += fmt::format("{}, wet {}", faces_text(entry, *wall.surface), word_of(entry.wet));
  return text + moved_by(entry);
}

std::string wall_line(const WallEntry& entry, const Wall<3>& wall) {
  const Mesh& mesh = *wall.surface;
  std::size_t facets = 0, flat = 0;
  for (const auto& patch : mesh.patches()) {
    facets += patch->facets().size();
    flat += patch->is_flat() ? 1 : 0;
  }
  std::string text = fmt::format("wall        {}: {:.6g} m^2, ", wall.name, mesh.area());
  if (mesh.closed()) text += fmt::format("{:.6g} m^3 enclosed, ", mesh.volume());
  return text + fmt::format("{} facets, {} flat and {} curved faces, wet {}{}", facets, flat,
                            mesh.patches().size() - flat, word_of(entry.wet), moved_by(entry));
}

/// The narrowest gap of a wall; nothing if it has none.
std::string gap_text(std::size_t wall, const std::vector<WallGap>& gaps, const std::vector<Wall<2>>& walls) {
  const WallGap* narrowest = nullptr;
  for (const WallGap& gap : gaps)
    if ((gap.one == wall || gap.other == wall) && (!narrowest || gap.width < narrowest->width)) narrowest = &gap;
  if (!narrowest) return "";
  const std::size_t other = narrowest->one == wall ? narrowest->other : narrowest->one;
  return fmt::format(", narrowest gap {:.3g} dp, to {}, {}", narrowest->width,
                     other == wall ? "itself" : walls[other].name, place_text(*narrowest));
}

std::string gap_warning(const WallGap& gap, const std::vector<Wall<2>>& walls) {
  const std::string between = gap.one == gap.other ? fmt::format("within the wall \"{}\"", walls[gap.one].name)
                                                   : fmt::format("between the walls \"{}\" and \"{}\"",
                                                                 walls[gap.one].name, walls[gap.other].name);
  return fmt::format("the gap {} is {:.3g} dp wide {}; fluid needs {} dp to pass", between, gap.width, place_text(gap),
                     least_gap);
}

/// Between which numbers a value stays; nothing if it does not change.
class Range {
 public:
  void add(double value) {
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
  }
  std::string text(const char* name, const char* unit) const {
    constexpr double rounding = 1e-12;
    if (!(high_ - low_ > rounding)) return "";
    return fmt::format(", {} from {:.3g} to {:.3g} {}", name, low_, high_, unit);
  }

 private:
  double low_ = 0.0, high_ = 0.0;
};

template <int Dim>
std::string motion_line(const MotionEntry& entry, const std::vector<WallEntry>& walls, double end) {
  constexpr std::size_t most = 4000;
  constexpr double degrees = 180.0 / std::numbers::pi;
  const auto motion = motion_of<Dim>(entry);
  const Vector<Dim> center = vector_of<Dim>(entry.center);
  std::array<Range, Dim> way;
  Range turn;
  double angle = 0.0;
  // A direction across the axis, and what it turns to after a quarter.
  Vector<Dim> across, quarter;
  if constexpr (Dim == 2) {
    across = {{1.0, 0.0}};
    quarter = turned_left(across);
  } else {
    const Vector<3> axis = 1.0 / norm(vector_of<3>(entry.axis)) * vector_of<3>(entry.axis);
    across = std::abs(axis[0]) < 0.9 ? Vector<3>{{1.0, 0.0, 0.0}} : Vector<3>{{0.0, 1.0, 0.0}};
    quarter = cross(axis, across);
    across = cross(quarter, axis);
  }
  for (const double time : times_of(entry, end, most)) {
    const Pose<Dim> pose = (*motion)(time);
    const Vector<Dim> shift = pose.of_position(center) - center, along = pose.of_direction(across);
    const double now = std::atan2(dot(along, quarter), dot(along, across));
    angle += std::remainder(now - angle, 2.0 * std::numbers::pi);  // over full turns, too
    for (int k = 0; k < Dim; ++k) way[static_cast<std::size_t>(k)].add(shift[k]);
    turn.add(degrees * angle);
  }
  std::string text = fmt::format("motion      {}: {}, t = {:.6g} to {:.6g} s", entry.name, word_of(entry.type),
                                 entry.start, std::min(entry.end, end));
  for (std::size_t k = 0; k < Dim; ++k) text += way[k].text(std::array{"x", "y", "z"}[k], "m");
  text += turn.text("angle", "deg");
  std::vector<std::string> moved;
  for (const WallEntry& wall : walls)
    if (wall.motion == entry.name) moved.push_back(wall.name);
  return text + (moved.empty() ? ", moves no wall" : fmt::format(", moves {}", fmt::join(moved, ", ")));
}

std::string inlet_line(const InletEntry& entry, const MethodSettings& method) {
  std::string size = fmt::format("{:.6g} m wide", entry.width);
  if (entry.section == InletSection::circle) size = fmt::format("round, radius {:.6g} m", entry.radius);
  if (entry.section == InletSection::annulus)
    size = fmt::format("a ring, radii {:.6g} and {:.6g} m", entry.inner_radius, entry.radius);
  if (entry.section == InletSection::rectangle) size = fmt::format("{:.6g} m x {:.6g} m", entry.width, entry.height);
  const auto [rows, of_row] = [&] {
    const auto counts = [](const auto& inlet) { return std::pair(inlet.rows, inlet.section.size()); };
    return method.dimension == 2 ? counts(inlet_of<2>(entry, method.particles.spacing, method.kernel))
                                 : counts(inlet_of<3>(entry, method.particles.spacing, method.kernel));
  }();
  std::string text = fmt::format("inlet       {}: {}, {} rows of {} particles, ", entry.name, size, rows, of_row);
  if (entry.speeds.empty()) {
    text += fmt::format("{:.6g} m/s", entry.speed);
  } else {
    text += fmt::format("{} speeds up to {:.6g} m/s", entry.speeds.size(), std::ranges::max(entry.speeds));
  }
  if (!entry.profile.empty())
    text += fmt::format(" times a profile up to {:.6g}, mean {:.6g}", std::ranges::max(entry.profile),
                        mean_of_profile(entry));
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

SceneReport report_scene(const MethodSettings& method, const SceneSettings& settings) {
  SceneReport report;
  const double end = method.time.end;
  if (method.dimension == 2) {
    const std::vector<Wall<2>> walls = walls_of<2>(settings.scene_walls, settings.motions);
    const std::vector<WallGap> gaps = wall_gaps(walls, times_of_all(settings.motions, end), method.particles.spacing);
    for (std::size_t k = 0; k < walls.size(); ++k)
      report.lines.push_back(wall_line(settings.scene_walls[k], walls[k]) + gap_text(k, gaps, walls));
    for (const WallGap& gap : gaps)
      if (gap.width < least_gap) report.warnings.push_back(gap_warning(gap, walls));
  } else {
    const std::vector<Wall<3>> walls = walls_of<3>(settings.scene_walls, settings.motions);
    for (std::size_t k = 0; k < walls.size(); ++k) {
      report.lines.push_back(wall_line(settings.scene_walls[k], walls[k]));
      for (const std::string& what : settings.scene_walls[k].mesh_warnings)
        report.warnings.push_back(fmt::format("the wall \"{}\": {}", walls[k].name, what));
    }
  }
  for (const MotionEntry& entry : settings.motions)
    report.lines.push_back(method.dimension == 2 ? motion_line<2>(entry, settings.scene_walls, end)
                                                 : motion_line<3>(entry, settings.scene_walls, end));
  for (const InletEntry& entry : settings.inlets) report.lines.push_back(inlet_line(entry, method));
  for (const OutletEntry& entry : settings.outlets)
    report.lines.push_back(method.dimension == 2 ? outlet_line<2>(entry) : outlet_line<3>(entry));
  return report;
}

}  // namespace impinge
