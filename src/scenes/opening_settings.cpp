#include "impinge/scenes/opening_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "impinge/core/table.hpp"
#include "impinge/scenes/check_names.hpp"

namespace impinge {
namespace {

constexpr double most_of_row = 1e6;  // particles

bool has_allowed_width(const InletEntry& inlet, double spacing) {
  return inlet.width >= (1.0 - 1e-9) * spacing && inlet.width <= most_of_row * spacing;
}

double area_of(const InletEntry& inlet) {
  if (inlet.section == InletSection::rectangle) return inlet.width * inlet.height;
  const double hole = inlet.section == InletSection::annulus ? inlet.inner_radius : 0.0;
  return std::numbers::pi * (inlet.radius * inlet.radius - hole * hole);
}

bool is_round(const InletEntry& inlet) {
  return inlet.section == InletSection::circle || inlet.section == InletSection::annulus;
}

/// What is wrong with the section's size; nothing if all is well.
std::string size_problem(const InletEntry& inlet, int dimension, double spacing) {
  if (dimension == 2) {
    if (has_allowed_width(inlet, spacing)) return "";
    return fmt::format("{} particle wide; allowed: [{}, {:.6g}] (m)",
                       inlet.width < spacing ? "less than a" : "more than a million", number_text(spacing),
                       most_of_row * spacing);
  }
  const double count = area_of(inlet) / (spacing * spacing);
  if (inlet.section == InletSection::annulus && inlet.inner_radius >= inlet.radius)
    return fmt::format("not wider than its inner radius; allowed: > {} (m)", number_text(inlet.inner_radius));
  if (!(count <= most_of_row)) return fmt::format("makes some {:.2g} particles of a row; allowed: at most 1e6", count);
  const double narrow = inlet.section == InletSection::rectangle ? std::min(inlet.width, inlet.height)
                        : inlet.section == InletSection::annulus ? inlet.radius - inlet.inner_radius
                                                                 : 2.0 * inlet.radius;
  if (narrow < (1.0 - 1e-9) * spacing)
    return fmt::format("less than a particle wide, {:.4g} m; allowed: >= {} (m)", narrow, number_text(spacing));
  return "";
}

/// Pushes the places next to a rim apart from each other and from their images beyond it: a wall may stand there.
/// `apart`: their mean distance.
void smooth_rims(double radius, double inner_radius, double apart, std::vector<Vector<2>>& places) {
  constexpr int passes = 40;
  constexpr double layer = 1.5, reach = 1.6, way = 0.12, nearest = 0.3;  // places that move, and how [apart]
  const double least = inner_radius > 0.0 ? inner_radius + nearest * apart : 0.0;
  const auto is_near_rim = [&](const Vector<2>& place, double range) {
    const double r = norm(place);
    return radius - r < range * apart || (inner_radius > 0.0 && r - inner_radius < range * apart);
  };
  std::vector<std::size_t> moving, all;
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (is_near_rim(places[k], layer)) moving.push_back(k);
    if (is_near_rim(places[k], layer + 2.0 * reach)) all.push_back(k);
  }
  const auto cell_of = [&](const Vector<2>& place) {
    const auto cell = [&](double x) { return static_cast<int>(std::floor(x / (reach * apart))); };
    return std::pair(cell(place[0]), cell(place[1]));
  };
  for (int pass = 0; pass < passes; ++pass) {
    std::map<std::pair<int, int>, std::vector<Vector<2>>> others;
    for (const std::size_t k : all) {
      const double r = norm(places[k]);
      const auto add = [&](double factor) { others[cell_of(factor * places[k])].push_back(factor * places[k]); };
      add(1.0);
      if (r > 0.0 && radius - r < reach * apart) add((2.0 * radius - r) / r);
      if (inner_radius > 0.0 && r - inner_radius < reach * apart) add((2.0 * inner_radius - r) / r);
    }
    std::vector<Vector<2>> next = places;
    for (const std::size_t k : moving) {
      const auto [column, row] = cell_of(places[k]);
      for (int a = column - 1; a <= column + 1; ++a) {
        for (int b = row - 1; b <= row + 1; ++b) {
          for (const Vector<2>& other : others[{a, b}]) {
            const Vector<2> offset = places[k] - other;
            const double distance = norm(offset) / apart;
            if (distance > 0.0 && distance < reach) next[k] += way * (1.0 - distance / reach) / distance * offset;
          }
        }
      }
      const double r = norm(next[k]);
      if (const double kept = std::clamp(r, least, radius - nearest * apart); kept != r) next[k] *= kept / r;
    }
    places = next;
  }
}

/// Places that fill a ring evenly: a spiral by the golden angle (Vogel, Math. Biosci. 44, 1979). To push those far from
/// the rims apart, too, would make rings of more and of less density.
std::vector<std::array<double, 2>> places_in_ring(double radius, double inner_radius, std::size_t count) {
  const double square = inner_radius * inner_radius, area = radius * radius - square;
  std::vector<Vector<2>> places;
  for (std::size_t k = 0; k < count; ++k) {
    const double r = std::sqrt(square + area * (static_cast<double>(k) + 0.5) / static_cast<double>(count));
    const double angle = 2.0 * std::numbers::pi * std::fmod(std::numbers::phi * static_cast<double>(k), 1.0);
    places.push_back({{r * std::cos(angle), r * std::sin(angle)}});
  }
  smooth_rims(radius, inner_radius, std::sqrt(std::numbers::pi * area / static_cast<double>(count)), places);
  std::vector<std::array<double, 2>> result;
  for (const Vector<2>& place : places) result.push_back(place.component);
  return result;
}

/// Two unit vectors normal to a direction and each other; the first is along `wish` as far as it can be.
std::array<Vector<3>, 2> across(const Vector<3>& direction, const Vector<3>& wish) {
  Vector<3> first = wish - dot(wish, direction) * direction;
  if (!(norm(first) > 1e-9 * norm(wish))) {
    Vector<3> axis;
    int least = 0;
    for (int k = 1; k < 3; ++k)
      if (std::abs(direction[k]) < std::abs(direction[least])) least = k;
    axis[least] = 1.0;
    first = axis - dot(axis, direction) * direction;
  }
  first *= 1.0 / norm(first);
  return {first, cross(direction, first)};
}

/// Where a profile begins and ends: distances from the axis, or along the width from the middle [m].
std::pair<double, double> reach_of_profile(const InletEntry& inlet) {
  if (is_round(inlet)) return {inlet.section == InletSection::annulus ? inlet.inner_radius : 0.0, inlet.radius};
  return {-0.5 * inlet.width, 0.5 * inlet.width};
}

double profile_at(const InletEntry& inlet, double place) {
  const auto [before, after, share] = place_in(inlet.profile_at, place);
  return std::lerp(inlet.profile[before], inlet.profile[after], share);
}

/// The area between two places, of a round section over 2 pi, of another one per length of the other side.
double area_between(const InletEntry& inlet, double low, double high) {
  return is_round(inlet) ? 0.5 * (high * high - low * low) : high - low;
}

/// The mean of the profile between two places, exact: piece by piece by Simpson's rule.
double mean_of_profile(const InletEntry& inlet, double low, double high) {
  std::vector<double> ends{low};
  for (const double place : inlet.profile_at)
    if (place > low && place < high) ends.push_back(place);
  ends.push_back(high);
  const auto flow = [&](double place) { return profile_at(inlet, place) * (is_round(inlet) ? place : 1.0); };
  double sum = 0.0;
  for (std::size_t k = 1; k < ends.size(); ++k) {
    const double begin = ends[k - 1], end = ends[k];
    sum += (end - begin) / 6.0 * (flow(begin) + 4.0 * flow(0.5 * (begin + end)) + flow(end));
  }
  return sum / area_between(inlet, low, high);
}

/// Direction, section and distance of the rows.
void lay_section(const InletEntry& entry, double spacing, Inlet<2>& inlet) {
  const Vector<2> direction = vector_of<2>(entry.direction);
  inlet.direction = 1.0 / norm(direction) * direction;
  inlet.across = {Vector<2>{{-inlet.direction[1], inlet.direction[0]}}};
  inlet.corner = vector_of<2>(entry.center) - 0.5 * entry.width * inlet.across[0];
  const auto count = static_cast<int>(std::clamp(std::round(entry.width / spacing), 1.0, most_of_row));
  const double apart = entry.width / count;
  for (int k = 0; k < count; ++k) inlet.section.push_back({(k + 0.5) * apart});
  inlet.spacing = spacing * spacing / apart;
}

void lay_section(const InletEntry& entry, double spacing, Inlet<3>& inlet) {
  const Vector<3> direction = vector_of<3>(entry.direction);
  inlet.direction = 1.0 / norm(direction) * direction;
  inlet.across = across(inlet.direction, vector_of<3>(entry.across));
  inlet.corner = vector_of<3>(entry.center);
  if (entry.section == InletSection::rectangle) {
    inlet.corner -= 0.5 * entry.width * inlet.across[0] + 0.5 * entry.height * inlet.across[1];
    const double columns = std::max(1.0, std::round(entry.width / spacing));
    const double rows = std::max(1.0, std::round(entry.height / spacing));
    for (double b = 0.5; b < rows; b += 1.0)
      for (double a = 0.5; a < columns; a += 1.0)
        inlet.section.push_back({a * entry.width / columns, b * entry.height / rows});
  } else {
    inlet.radius = entry.radius;
    inlet.inner_radius = entry.section == InletSection::annulus ? entry.inner_radius : 0.0;
    const double count = std::max(1.0, std::round(area_of(entry) / (spacing * spacing)));
    inlet.section = places_in_ring(inlet.radius, inlet.inner_radius, static_cast<std::size_t>(count));
  }
  inlet.spacing = spacing * spacing * spacing * static_cast<double>(inlet.section.size()) / area_of(entry);
}

/// Notes numbers of a table that do not rise.
void check_rise(Keys& keys, const std::vector<double>& numbers, const char* what, const char* unit) {
  const auto fall = std::ranges::adjacent_find(numbers, std::greater_equal{});
  if (fall != numbers.end())
    keys.mistake(numbers, fmt::format("the {} do not rise: {} after {}; allowed: > {} ({})", what,
                                      number_text(*(fall + 1)), number_text(*fall), number_text(*fall), unit));
}

/// As many rows as a kernel reaches, in their places if the inlet blows.
template <int Dim>
void set_rows(double spacing, const KernelSettings& kernel, Inlet<Dim>& inlet) {
  inlet.rows = static_cast<int>(std::ceil(kernel.largest() * spacing / inlet.spacing)) + 1;
  inlet.last_row = inlet.blows ? -(inlet.rows - 0.5) * inlet.spacing : inlet.no_row();
}

void check_speeds(Keys& keys, const InletEntry& inlet) {
  if (!keys.usable(inlet.speed, inlet.times, inlet.speeds)) return;
  if (inlet.times.empty() && inlet.speeds.empty()) {
    if (inlet.speed == 0.0) keys.mistake(inlet.speed, "nothing enters; allowed: > 0 (m/s), or times with speeds");
    return;
  }
  if (inlet.speed != 0.0)
    keys.mistake(inlet.speed, "the speed is given by times and speeds, too; allowed: one of the two");
  if (inlet.times.size() != inlet.speeds.size())
    keys.mistake(inlet.speeds, fmt::format("{} speeds, but {} times; allowed: one for each time", inlet.speeds.size(),
                                           inlet.times.size()));
  check_rise(keys, inlet.times, "times", "s");
}

/// True where the numbers that a section needs have allowed values.
bool has_size(const Keys& keys, const InletEntry& inlet) {
  switch (inlet.section) {
    case InletSection::line:
      return keys.usable(inlet.width);
    case InletSection::rectangle:
      return keys.usable(inlet.width, inlet.height, inlet.across);
    case InletSection::circle:
      return keys.usable(inlet.radius);
    case InletSection::annulus:
      return keys.usable(inlet.radius, inlet.inner_radius);
  }
  return false;
}

void check_profile(Keys& keys, const InletEntry& inlet) {
  if (!keys.usable(inlet.profile_at, inlet.profile)) return;
  check_rise(keys, inlet.profile_at, "places", "m");
  if (inlet.profile_at.size() != inlet.profile.size())
    keys.mistake(inlet.profile, fmt::format("{} factors, but {} places; allowed: one for each place",
                                            inlet.profile.size(), inlet.profile_at.size()));
  else if (!inlet.profile.empty() && has_size(keys, inlet) && mean_of_profile(inlet) == 0.0)
    keys.mistake(inlet.profile, "nothing enters; allowed: factors > 0 within the section");
}

bool has_length(const Numbers& direction, int dimension) {
  return dimension == 2 ? norm(vector_of<2>(direction)) > 0.0 : norm(vector_of<3>(direction)) > 0.0;
}

/// True where particles of an inlet's rows stand in the block of another.
bool has_particles_in(const Inlet<3>& block, const Inlet<3>& inlet) {
  for (int row = 0; row < inlet.rows; ++row)
    for (std::size_t k = 0; k < inlet.section.size(); ++k)
      if (block.distance_from_block(inlet.in_row(-(row + 0.5) * inlet.spacing, k, 0)) <= 0.0) return true;
  return false;
}

/// Notes inlets in space of which one's rows stand in the other's block.
void check_overlaps(Keys& keys, double spacing, const KernelSettings& kernel, const std::vector<InletEntry>& inlets) {
  for (std::size_t b = 0; b < inlets.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      if (!is_usable(keys, 3, spacing, inlets[a]) || !is_usable(keys, 3, spacing, inlets[b])) continue;
      const Inlet<3> one = inlet_of<3>(inlets[a], spacing, kernel), other = inlet_of<3>(inlets[b], spacing, kernel);
      if (has_particles_in(one, other) || has_particles_in(other, one))
        keys.mistake(inlets[b].center, fmt::format("its rows overlap those of the inlet \"{}\", given at {}",
                                                   inlets[a].name, keys.place(inlets[a].center)));
    }
  }
}

}  // namespace

void declare_openings(Keys& keys, std::vector<InletEntry>& inlets, std::vector<OutletEntry>& outlets) {
  keys.list("inlet", inlets, "where fluid enters", {.fixed = true}, [](Keys& inner, InletEntry& inlet) {
    inner.add("name", inlet.name, "name of the inlet", {.fallback = "inlet_<number>"});
    inner.add("section", inlet.section, "what the inlet's plane has of fluid: in 2D a line, in 3D one of the others",
              {.fallback = "line"});
    inner.add("center", inlet.center, "middle of the section", {.unit = "m", .required = true});
    inner.add("direction", inlet.direction, "of the flow, normal to the section, of any length", {.required = true});
    inner.only_where(inlet.section, {InletSection::line, InletSection::rectangle}, [&] {
      inner.add("width", inlet.width, "length of the line, or of a side of the rectangle",
                {.unit = "m", .range = positive, .required = true});
    });
    inner.only_where(inlet.section, {InletSection::rectangle}, [&] {
      inner.add("height", inlet.height, "of the other side", {.unit = "m", .range = positive, .required = true});
      inner.add("across", inlet.across, "direction of the width, of any length", {.required = true});
    });
    inner.only_where(inlet.section, {InletSection::circle, InletSection::annulus}, [&] {
      inner.add("radius", inlet.radius, "outer radius", {.unit = "m", .range = positive, .required = true});
    });
    inner.only_where(inlet.section, {InletSection::annulus}, [&] {
      inner.add("inner_radius", inlet.inner_radius, "inner radius", {.unit = "m", .range = positive, .required = true});
    });
    inner.add("speed", inlet.speed, "speed of the flow", {.unit = "m/s", .range = not_negative});
    inner.add("times", inlet.times, "times of the speeds", {.unit = "s"});
    inner.add("speeds", inlet.speeds, "in the place of speed: linear between the times, constant before and after",
              {.unit = "m/s", .range = not_negative});
    inner.add(
        "profile_at", inlet.profile_at,
        "places of the profile: distances from the axis of a circle or an annulus; along the width, from the middle",
        {.unit = "m"});
    inner.add("profile", inlet.profile,
              "the speed is multiplied by this: linear between the places, constant before and after",
              {.range = not_negative, .fallback = "uniform"});
    inner.add("start", inlet.start, "time from which it blows", {.unit = "s"});
    inner.add("stop", inlet.stop, "time until which it blows", {.unit = "s", .fallback = "never"});
  });
  keys.list("outlet", outlets, "a region that swallows fluid", {.fixed = true}, [](Keys& inner, OutletEntry& outlet) {
    inner.add("name", outlet.name, "name of the outlet", {.fallback = "outlet_<number>"});
    declare_shape(inner, outlet, ShapeKind::closed);
  });
}

void derive_openings(const Keys& keys, int dimension, std::vector<InletEntry>& inlets,
                     std::vector<OutletEntry>& outlets) {
  for (std::size_t k = 0; k < inlets.size(); ++k)
    if (!keys.given(inlets[k].name)) inlets[k].name = fmt::format("inlet_{}", k + 1);
  for (std::size_t k = 0; k < outlets.size(); ++k) {
    if (!keys.given(outlets[k].name)) outlets[k].name = fmt::format("outlet_{}", k + 1);
    derive_shape(keys, dimension, outlets[k]);
  }
}

void check_inlets(Keys& keys, int dimension, double spacing, const KernelSettings& kernel,
                  const std::vector<InletEntry>& inlets) {
  check_names(keys, inlets);
  for (const InletEntry& inlet : inlets) {
    check_speeds(keys, inlet);
    check_profile(keys, inlet);
    if (keys.usable(inlet.direction) && !has_length(inlet.direction, dimension))
      keys.mistake(inlet.direction, "no direction; allowed: any vector but 0");
    if (keys.usable(inlet.section) && (inlet.section == InletSection::line) != (dimension == 2)) {
      keys.mistake(inlet.section, dimension == 2
                                      ? "has three dimensions; allowed: \"line\""
                                      : "a line has two dimensions; allowed: \"circle\", \"annulus\", \"rectangle\"");
    } else if (has_size(keys, inlet)) {
      const bool is_low = inlet.section == InletSection::rectangle && inlet.height < inlet.width;
      if (const std::string problem = size_problem(inlet, dimension, spacing); !problem.empty())
        keys.mistake(is_round(inlet) ? inlet.radius : is_low ? inlet.height : inlet.width, problem);
    }
    if (inlet.section == InletSection::rectangle && keys.usable(inlet.across, inlet.direction)) {
      const Vector<3> direction = vector_of<3>(inlet.direction), wish = vector_of<3>(inlet.across);
      if (!(norm(cross(direction, wish)) > 1e-6 * norm(direction) * norm(wish)))
        keys.mistake(inlet.across, "along the flow, or 0; allowed: any other direction");
    }
    if (keys.usable(inlet.start, inlet.stop) && inlet.stop <= inlet.start)
      keys.mistake(inlet.stop, fmt::format("stops before it starts; allowed: > {} (s)", number_text(inlet.start)));
  }
  if (!keys.usable(kernel.radius, kernel.laplacian_radius)) return;
  if (dimension == 3) return check_overlaps(keys, spacing, kernel, inlets);
  const auto block = [&](const InletEntry& entry) {
    const double margin = 0.25 * spacing;  // inlets may stand side by side
    const Inlet<2> inlet = inlet_of<2>(entry, spacing, kernel);
    return way_of(inlet, entry.width, -inlet.rows * inlet.spacing + margin, -margin, margin);
  };
  for (std::size_t b = 0; b < inlets.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      if (!is_usable(keys, 2, spacing, inlets[a]) || !is_usable(keys, 2, spacing, inlets[b])) continue;
      const Outline one = block(inlets[a]), other = block(inlets[b]);
      const auto begin = [](const Outline& outline) { return outline.edges().front().begin; };
      if (narrowest_gap(one, other).width > 0.0 && !one.contains(begin(other)) && !other.contains(begin(one))) continue;
      keys.mistake(inlets[b].center, fmt::format("its rows overlap those of the inlet \"{}\", given at {}",
                                                 inlets[a].name, keys.place(inlets[a].center)));
    }
  }
}

void check_outlets(Keys& keys, int dimension, const std::vector<OutletEntry>& outlets) {
  check_names(keys, outlets);
  for (const OutletEntry& outlet : outlets) {
    check_shape(keys, dimension, ShapeKind::closed, outlet);
    if (!is_usable(keys, outlet)) continue;
    std::vector<std::string> mistakes;
    if (dimension == 2) scaled_shape<2>(outlet, mistakes);
    if (dimension == 3) scaled_shape<3>(outlet, mistakes);
    for (const std::string& what : mistakes) keys.mistake(outlet.shape, what);
  }
}

bool is_usable(const Keys& keys, int dimension, double spacing, const InletEntry& inlet) {
  return keys.usable(inlet.center, inlet.direction, inlet.section, inlet.start, inlet.stop) &&
         (inlet.section == InletSection::line) == (dimension == 2) && has_size(keys, inlet) &&
         has_length(inlet.direction, dimension) && size_problem(inlet, dimension, spacing).empty();
}

double largest_speed(const InletEntry& inlet) {
  const double speed = inlet.speeds.empty() ? inlet.speed : std::ranges::max(inlet.speeds);
  return inlet.profile.empty() ? speed : speed * std::ranges::max(inlet.profile);
}

double mean_of_profile(const InletEntry& inlet) {
  if (inlet.profile.empty()) return 1.0;
  const auto [low, high] = reach_of_profile(inlet);
  return mean_of_profile(inlet, low, high);
}

template <int Dim>
Inlet<Dim> inlet_of(const InletEntry& entry, double spacing, const KernelSettings& kernel) {
  Inlet<Dim> inlet;
  inlet.name = entry.name;
  lay_section(entry, spacing, inlet);
  for (std::size_t k = 0; k < std::min(entry.times.size(), entry.speeds.size()); ++k)
    inlet.speeds.push_back({entry.times[k], entry.speeds[k]});
  inlet.speed = entry.speed;
  if (entry.start > 0.0) inlet.start = entry.start;
  if (entry.stop < InletEntry::never) inlet.stop = entry.stop;
  inlet.blows = inlet.blows_at(0.0);
  inlet.speed = inlet.speed_at(0.0);
  set_rows(spacing, kernel, inlet);
  return inlet;
}

template Inlet<2> inlet_of(const InletEntry&, double, const KernelSettings&);
template Inlet<3> inlet_of(const InletEntry&, double, const KernelSettings&);

template <int Dim>
std::vector<Inlet<Dim>> parts_of(const InletEntry& entry, double spacing, const KernelSettings& kernel) {
  const Inlet<Dim> whole = inlet_of<Dim>(entry, spacing, kernel);
  if (entry.profile.empty()) return {whole};
  const auto [begin, end] = reach_of_profile(entry);
  const auto count = static_cast<int>(std::clamp(std::round((end - begin) / spacing), 1.0, most_of_row));
  std::vector<Inlet<Dim>> parts;
  for (int k = 0; k < count; ++k) {
    const double low = begin + (end - begin) * k / count, high = begin + (end - begin) * (k + 1) / count;
    Inlet<Dim> part = whole;
    std::erase_if(part.section, [&](const auto& place) {
      const double at = is_round(entry) ? std::hypot(place[0], place.back()) : place[0] + begin;
      return at < low || at >= high;
    });
    const double factor = mean_of_profile(entry, low, high);
    if (part.section.empty() || factor == 0.0) continue;
    part.speed *= factor;
    for (SpeedEntry& at_time : part.speeds) at_time.speed *= factor;
    if (is_round(entry)) {
      part.radius = high;
      part.inner_radius = low;
    }
    part.spacing *= static_cast<double>(part.section.size()) / static_cast<double>(whole.section.size()) *
                    area_between(entry, begin, end) / area_between(entry, low, high);
    set_rows(spacing, kernel, part);
    parts.push_back(std::move(part));
  }
  return parts;
}

template std::vector<Inlet<2>> parts_of(const InletEntry&, double, const KernelSettings&);
template std::vector<Inlet<3>> parts_of(const InletEntry&, double, const KernelSettings&);

Outline way_of(const Inlet<2>& inlet, double width, double from, double to, double margin) {
  std::vector<std::string> mistakes;
  return make_polygon({inlet.at(from, {margin}), inlet.at(from, {width - margin}), inlet.at(to, {width - margin}),
                       inlet.at(to, {margin})},
                      mistakes)
      .value();
}

template <int Dim>
std::optional<Outlet<Dim>> outlet_of(const OutletEntry& entry) {
  std::vector<std::string> mistakes;
  const auto shape = scaled_shape<Dim>(entry, mistakes);
  if (!shape) return {};
  Outlet<Dim> outlet;
  outlet.name = entry.name;
  outlet.region = [shape, bounds = shape->bounds(), placement = placement_of<Dim>(entry)](const Vector<Dim>& position) {
    const Vector<Dim> place = placement.origin_of(position);
    return bounds.contains(place) && shape->contains(place);
  };
  return outlet;
}

template std::optional<Outlet<2>> outlet_of(const OutletEntry&);
template std::optional<Outlet<3>> outlet_of(const OutletEntry&);

}  // namespace impinge
