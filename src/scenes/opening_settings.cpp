#include "impinge/scenes/opening_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "impinge/scenes/check_names.hpp"

namespace impinge {
namespace {

constexpr double most_of_row = 1e6;  // particles

bool has_allowed_width(const InletEntry& inlet, double spacing) {
  return inlet.width >= (1.0 - 1e-9) * spacing && inlet.width <= most_of_row * spacing;
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
  const auto fall = std::ranges::adjacent_find(inlet.times, std::greater_equal{});
  if (fall != inlet.times.end())
    keys.mistake(inlet.times, fmt::format("the times do not rise: {} after {}; allowed: > {} (s)",
                                          number_text(*(fall + 1)), number_text(*fall), number_text(*fall)));
}

}  // namespace

void declare_openings(Keys& keys, std::vector<InletEntry>& inlets, std::vector<OutletEntry>& outlets) {
  keys.list("inlet", inlets, "where fluid enters, 2D", {.fixed = true}, [](Keys& inner, InletEntry& inlet) {
    inner.add("name", inlet.name, "name of the inlet", {.fallback = "inlet_<number>"});
    inner.add("center", inlet.center, "middle of the inlet's line", {.unit = "m", .required = true});
    inner.add("direction", inlet.direction, "of the flow, normal to the line, of any length", {.required = true});
    inner.add("width", inlet.width, "length of the line", {.unit = "m", .range = positive, .required = true});
    inner.add("speed", inlet.speed, "speed of the flow", {.unit = "m/s", .range = not_negative});
    inner.add("times", inlet.times, "times of the speeds", {.unit = "s"});
    inner.add("speeds", inlet.speeds, "in the place of speed: linear between the times, constant before and after",
              {.unit = "m/s", .range = not_negative});
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

void check_inlets(Keys& keys, double spacing, const KernelSettings& kernel, const std::vector<InletEntry>& inlets) {
  check_names(keys, inlets);
  for (const InletEntry& inlet : inlets) {
    check_speeds(keys, inlet);
    if (keys.usable(inlet.direction) && !(norm(vector_of<2>(inlet.direction)) > 0.0))
      keys.mistake(inlet.direction, "no direction; allowed: any vector but 0");
    if (keys.usable(inlet.width)) {
      if (!has_allowed_width(inlet, spacing))
        keys.mistake(inlet.width, fmt::format("{} particle wide; allowed: [{}, {:.6g}] (m)",
                                              inlet.width < spacing ? "less than a" : "more than a million",
                                              number_text(spacing), most_of_row * spacing));
    }
    if (keys.usable(inlet.start, inlet.stop) && inlet.stop <= inlet.start)
      keys.mistake(inlet.stop, fmt::format("stops before it starts; allowed: > {} (s)", number_text(inlet.start)));
  }
  if (!keys.usable(kernel.radius, kernel.laplacian_radius)) return;
  const auto block = [&](const InletEntry& entry) {
    const double margin = 0.25 * spacing;  // inlets may stand side by side
    const Inlet<2> inlet = inlet_of(entry, spacing, kernel);
    return way_of(inlet, entry.width, -inlet.rows * inlet.spacing + margin, -margin, margin);
  };
  for (std::size_t b = 0; b < inlets.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      if (!is_usable(keys, spacing, inlets[a]) || !is_usable(keys, spacing, inlets[b])) continue;
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

bool is_usable(const Keys& keys, double spacing, const InletEntry& inlet) {
  return keys.usable(inlet.center, inlet.direction, inlet.width, inlet.start, inlet.stop) &&
         norm(vector_of<2>(inlet.direction)) > 0.0 && has_allowed_width(inlet, spacing);
}

double largest_speed(const InletEntry& inlet) {
  return inlet.speeds.empty() ? inlet.speed : std::ranges::max(inlet.speeds);
}

Inlet<2> inlet_of(const InletEntry& entry, double spacing, const KernelSettings& kernel) {
  const Vector<2> direction = vector_of<2>(entry.direction);
  Inlet<2> inlet;
  inlet.name = entry.name;
  inlet.direction = 1.0 / norm(direction) * direction;
  inlet.across = {Vector<2>{{-inlet.direction[1], inlet.direction[0]}}};
  inlet.corner = vector_of<2>(entry.center) - 0.5 * entry.width * inlet.across[0];
  const auto count = static_cast<int>(std::clamp(std::round(entry.width / spacing), 1.0, most_of_row));
  const double apart = entry.width / count;
  for (int k = 0; k < count; ++k) inlet.section.push_back({(k + 0.5) * apart});
  inlet.spacing = spacing * spacing / apart;
  inlet.rows = static_cast<int>(std::ceil(kernel.largest() * spacing / inlet.spacing)) + 1;
  for (std::size_t k = 0; k < std::min(entry.times.size(), entry.speeds.size()); ++k)
    inlet.speeds.push_back({entry.times[k], entry.speeds[k]});
  inlet.speed = entry.speed;
  if (entry.start > 0.0) inlet.start = entry.start;
  if (entry.stop < InletEntry::never) inlet.stop = entry.stop;
  inlet.blows = inlet.blows_at(0.0);
  inlet.speed = inlet.speed_at(0.0);
  inlet.last_row = inlet.blows ? -(inlet.rows - 0.5) * inlet.spacing : inlet.no_row();
  return inlet;
}

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
  outlet.region = [shape, placement = placement_of<Dim>(entry)](const Vector<Dim>& position) {
    return shape->contains(placement.origin_of(position));
  };
  return outlet;
}

template std::optional<Outlet<2>> outlet_of(const OutletEntry&);
template std::optional<Outlet<3>> outlet_of(const OutletEntry&);

}  // namespace impinge
