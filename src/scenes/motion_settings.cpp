#include "impinge/scenes/motion_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "impinge/boundaries/prescribed_motion.hpp"
#include "impinge/scenes/check_names.hpp"
#include "impinge/scenes/shape_settings.hpp"

namespace impinge {
namespace {

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const auto begin = text.find_first_not_of(blanks);
  return begin == text.npos ? "" : text.substr(begin, text.find_last_not_of(blanks) + 1 - begin);
}

std::optional<double> number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

/// Takes lines "t, x, y" or "t, x, y, angle", in three dimensions with z; a first line of words is a header, # begins a
/// comment. Returns what is wrong with the text; nothing if all is well.
std::string take_table(std::string_view text, int dimension, MotionEntry& motion) {
  const auto least = static_cast<std::size_t>(dimension) + 1;
  std::size_t columns = 0;
  bool first = true;
  for (int line = 1; !text.empty(); ++line) {
    const auto end = text.find('\n');
    std::string_view rest = trimmed(text.substr(0, end));
    text = end == text.npos ? "" : text.substr(end + 1);
    if (rest.empty() || rest.starts_with('#')) continue;
    std::vector<std::string_view> cells;
    for (auto comma = rest.find(','); comma != rest.npos; comma = rest.find(',')) {
      cells.push_back(trimmed(rest.substr(0, comma)));
      rest.remove_prefix(comma + 1);
    }
    cells.push_back(trimmed(rest));
    if (std::exchange(first, false) && std::ranges::none_of(cells, [](auto cell) { return number(cell).has_value(); }))
      continue;
    if (columns == 0) columns = cells.size();
    if (cells.size() != columns || columns < least || columns > least + 1)
      return fmt::format("line {} has {} number(s); allowed: t [s], {}, angle [deg], or all but the last in all lines",
                         line, cells.size(), dimension == 2 ? "x [m], y [m]" : "x [m], y [m], z [m]");
    std::vector<double> values;
    for (const std::string_view cell : cells) {
      const auto value = number(cell);
      if (!value) return fmt::format("line {} has {} in the place of a number", line, in_quotes(cell));
      values.push_back(*value);
    }
    motion.times.push_back(values[0]);
    motion.positions.push_back({values[1], values[2], dimension == 3 ? values[3] : 0.0});
    if (columns > least) motion.angles.push_back(values.back());
  }
  return motion.times.empty() ? "has no line of numbers" : "";
}

bool has_sound_table(const MotionEntry& motion) {
  const std::size_t count = motion.times.size();
  const auto fits = [&](const auto& values) { return values.empty() || values.size() == count; };
  return count >= 2 && fits(motion.positions) && fits(motion.angles) &&
         std::ranges::adjacent_find(motion.times, std::greater_equal{}) == motion.times.end();
}

void check_table(Keys& keys, const MotionEntry& motion) {
  const std::size_t count = motion.times.size();
  if (count == 0 && keys.given(motion.file)) return;  // its text is told
  if (count < 2) {
    keys.mistake(motion.type, fmt::format("the table has {} time(s); allowed: a file, or at least two times with "
                                          "positions, angles or both",
                                          count));
    return;
  }
  if (!motion.positions.empty() && motion.positions.size() != count)
    keys.mistake(motion.positions,
                 fmt::format("{} positions, but {} times; allowed: one for each time", motion.positions.size(), count));
  if (!motion.angles.empty() && motion.angles.size() != count)
    keys.mistake(motion.angles,
                 fmt::format("{} angles, but {} times; allowed: one for each time", motion.angles.size(), count));
  const auto fall = std::ranges::adjacent_find(motion.times, std::greater_equal{});
  if (fall != motion.times.end())
    keys.mistake(motion.times, fmt::format("the times do not rise: {} after {}; allowed: > {} (s)",
                                           number_text(*(fall + 1)), number_text(*fall), number_text(*fall)));
}

}  // namespace

void declare_motions(Keys& keys, std::vector<MotionEntry>& motions) {
  keys.list("motion", motions, "a prescribed motion that walls name", {.fixed = true}, [](Keys& inner, MotionEntry& m) {
    inner.add("name", m.name, "name of the motion", {.fallback = "motion_<number>"});
    inner.add("type", m.type, "how it goes in time", {.required = true});
    inner.add("center", m.center, "point that the walls turn about; it moves with them", {.unit = "m"});
    inner.add("axis", m.axis, "3D: direction of the line through center that the walls turn about, of any length");
    inner.add("start", m.start, "before, the walls stand where they are then", {.unit = "s"});
    inner.add("end", m.end, "after, the walls stand where they are then", {.unit = "s", .fallback = "never"});
    inner.only_where(m.type, {MotionType::constant}, [&] {
      inner.add("velocity", m.velocity, "of the centre", {.unit = "m/s"});
      inner.add("spin", m.spin, "counter-clockwise", {.unit = "rad/s"});
    });
    inner.only_where(m.type, {MotionType::harmonic}, [&] {
      inner.add("amplitude", m.amplitude, "of the displacement", {.unit = "m"});
      inner.add("angle", m.angle, "amplitude of the angle, counter-clockwise", {.unit = "deg"});
      inner.add("frequency", m.frequency, "both go as sin(2 pi frequency t + phase), t since the start",
                {.unit = "Hz", .range = positive, .required = true});
      inner.add("phase", m.phase, "phase at the start", {.unit = "deg"});
      inner.add("ramp", m.ramp, "time in which both rise smoothly from 0", {.unit = "s", .range = not_negative});
    });
    inner.only_where(m.type, {MotionType::table}, [&] {
      inner.add("file", m.file,
                "a .csv file in the place of the other keys, relative to the case file: t, x, y and, if it is "
                "wanted, the angle",
                {.fallback = "none"});
      inner.add("times", m.times, "since the start; a spline joins them, at rest at the first and at the last",
                {.unit = "s"});
      inner.add("positions", m.positions, "displacements at the times", {.unit = "m"});
      inner.add("angles", m.angles, "angles at the times, counter-clockwise", {.unit = "deg"});
    });
  });
}

void take_motion_tables(Keys& keys, int dimension, const std::vector<NamedText>& tables,
                        std::vector<MotionEntry>& motions) {
  for (MotionEntry& motion : motions) {
    Key& key = keys.of(motion.file);
    if (key.given && key.usable) {
      const std::string path = path_of_named(key.place.name, motion.file);
      const auto found = std::ranges::find(tables, path, &NamedText::first);
      if (const std::string problem = path_problem(motion.file); !problem.empty()) {
        keys.mistake(key, problem);
      } else if (!motion.file.ends_with(".csv")) {
        keys.mistake(key, "has another ending; allowed: a .csv file");
      } else if (keys.given(motion.times) || keys.given(motion.positions) || keys.given(motion.angles)) {
        keys.mistake(key, "the table is given by times, positions or angles, too; allowed: one of the two");
      } else if (found == tables.end()) {
        keys.mistake(key, fmt::format("cannot read {}; allowed: a file of at most 1 MB that a case file names", path));
      } else if (const std::string wrong = take_table(found->second, dimension, motion); !wrong.empty()) {
        keys.mistake(key, wrong);
        motion.times.clear();
      }
    }
    key.usable = false;  // the numbers stand in the resolved case
  }
}

void derive_motions(const Keys& keys, std::vector<MotionEntry>& motions) {
  for (std::size_t k = 0; k < motions.size(); ++k)
    if (!keys.given(motions[k].name)) motions[k].name = fmt::format("motion_{}", k + 1);
}

void check_motions(Keys& keys, int dimension, const std::vector<MotionEntry>& motions) {
  check_names(keys, motions);
  for (const MotionEntry& motion : motions) {
    if (keys.usable(motion.name) && motion.name == no_motion)
      keys.mistake(motion.name, "the word of walls that do not move; allowed: any other name");
    if (keys.usable(motion.start, motion.end) && motion.end <= motion.start)
      keys.mistake(motion.end, fmt::format("ends before it starts; allowed: > {} (s)", number_text(motion.start)));
    if (dimension == 3 && keys.usable(motion.axis) && !(norm(vector_of<3>(motion.axis)) > 0.0))
      keys.mistake(motion.axis, "no direction; allowed: any vector but 0");
    if (keys.usable(motion.type, motion.times, motion.positions, motion.angles)) check_table(keys, motion);
  }
}

bool is_usable(const Keys& keys, const MotionEntry& motion) {
  if (!keys.usable(motion.type, motion.center, motion.axis, motion.start, motion.end)) return false;
  switch (motion.type) {
    case MotionType::constant:
      return keys.usable(motion.velocity, motion.spin);
    case MotionType::harmonic:
      return keys.usable(motion.amplitude, motion.angle, motion.frequency, motion.phase, motion.ramp);
    case MotionType::table:
      return keys.usable(motion.times, motion.positions, motion.angles);
  }
  return false;
}

template <int Dim>
std::optional<Motion<Dim>> motion_of(const MotionEntry& motion) {
  MotionFrame<Dim> frame{.center = vector_of<Dim>(motion.center), .start = motion.start, .end = motion.end};
  if constexpr (Dim == 3) frame.axis = 1.0 / norm(vector_of<3>(motion.axis)) * vector_of<3>(motion.axis);
  if (motion.type == MotionType::constant) return steady_motion(frame, vector_of<Dim>(motion.velocity), motion.spin);
  if (motion.type == MotionType::harmonic)
    return harmonic_motion<Dim>(frame, {.amplitude = vector_of<Dim>(motion.amplitude),
                                        .angle = radians(motion.angle),
                                        .frequency = motion.frequency,
                                        .phase = radians(motion.phase),
                                        .ramp = motion.ramp});
  if (!has_sound_table(motion)) return {};
  std::vector<MotionPoint<Dim>> points;
  for (std::size_t k = 0; k < motion.times.size(); ++k)
    points.push_back({.time = motion.times[k],
                      .shift = motion.positions.empty() ? Vector<Dim>{} : vector_of<Dim>(motion.positions[k]),
                      .angle = motion.angles.empty() ? 0.0 : radians(motion.angles[k])});
  return table_motion(frame, points);
}

template std::optional<Motion<2>> motion_of(const MotionEntry&);
template std::optional<Motion<3>> motion_of(const MotionEntry&);

std::vector<double> times_of(const MotionEntry& motion, double end, std::size_t most) {
  std::vector<double> times{0.0};
  const double first = std::max(motion.start, 0.0), last = std::min(motion.end, end);
  if (!(last > first)) return times;
  const auto add = [&](double from, double to, double count) {
    const double steps = std::clamp(std::ceil(count), 1.0, static_cast<double>(most));
    for (double k = 0.0; k <= steps; k += 1.0) times.push_back(from + k / steps * (to - from));
  };
  if (motion.type == MotionType::table) {
    const std::size_t pieces = std::max<std::size_t>(motion.times.size(), 2) - 1;
    const double of_piece = std::max(1.0, std::min(8.0, static_cast<double>(most) / static_cast<double>(pieces)));
    for (std::size_t k = 0; k + 1 < motion.times.size(); ++k)
      add(motion.start + motion.times[k], motion.start + motion.times[k + 1], of_piece);
    std::erase_if(times, [&](double time) { return time < 0.0 || time > last; });
    times.push_back(last);
  } else {
    const double turns = motion.type == MotionType::harmonic
                             ? motion.frequency * (last - first)
                             : std::abs(motion.spin) / (2.0 * std::numbers::pi) * (last - first);
    add(first, last, std::max(40.0 * turns, 100.0));
  }
  std::ranges::sort(times);
  const auto [again, stop] = std::ranges::unique(times);
  times.erase(again, stop);
  return times;
}

}  // namespace impinge
