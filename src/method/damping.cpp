#include "impinge/method/damping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace impinge {

void declare_damping(Keys& keys, std::vector<DampingSettings>& zones) {
  keys.list(
      "damping", zones, "a box in which waves are damped: du/dt = -rate u", {}, [](Keys& inner, DampingSettings& zone) {
        inner.add("name", zone.name, "name of the zone", {.fallback = "damping_<number>"});
        inner.add("low", zone.low, "corner with the smallest coordinates", {.unit = "m", .required = true});
        inner.add("high", zone.high, "corner with the largest coordinates", {.unit = "m", .required = true});
        inner.add("strength", zone.strength, "largest rate; some 3 times the waves' angular frequency",
                  {.unit = "1/s", .range = positive, .required = true});
        inner.add("direction", zone.direction,
                  "in which the rate rises across the box, from 0 to the strength, as the square of the way; 0: it "
                  "is the same everywhere");
      });
}

void derive_damping(const Keys& keys, std::vector<DampingSettings>& zones) {
  for (std::size_t k = 0; k < zones.size(); ++k)
    if (!keys.given(zones[k].name)) zones[k].name = fmt::format("damping_{}", k + 1);
}

void check_damping(Keys& keys, int dimension, const std::vector<DampingSettings>& zones) {
  for (std::size_t b = 0; b < zones.size(); ++b) {
    const DampingSettings& zone = zones[b];
    const auto earlier = std::ranges::find(zones, zone.name, &DampingSettings::name);
    if (keys.usable(zone.name) && earlier < zones.begin() + static_cast<std::ptrdiff_t>(b))
      keys.mistake(zone.name, fmt::format("the name is used twice, first at {}; allowed: a name of its own",
                                          keys.place(earlier->name)));
    if (!keys.usable(zone.low, zone.high)) continue;
    for (std::size_t k = 0; k < static_cast<std::size_t>(dimension); ++k) {
      if (zone.low[k] < zone.high[k]) continue;
      keys.mistake(zone.high, fmt::format("not above the low corner along every axis; allowed: above {} (m) along {}",
                                          number_text(zone.low[k]), "xyz"[k]));
      break;
    }
  }
}

template <int Dim>
DampingZones<Dim>::DampingZones(const std::vector<DampingSettings>& settings) {
  for (const DampingSettings& one : settings) {
    Zone zone{.box = {}, .strength = one.strength, .direction = {}, .begin = 0.0, .length = 0.0};
    for (int k = 0; k < Dim; ++k) {
      zone.box.low[k] = one.low[static_cast<std::size_t>(k)];
      zone.box.high[k] = one.high[static_cast<std::size_t>(k)];
      zone.direction[k] = one.direction[static_cast<std::size_t>(k)];
    }
    if (const double size = norm(zone.direction); size > 0.0) zone.direction *= 1.0 / size;
    // The corners that are first and last along the direction.
    for (int k = 0; k < Dim; ++k) {
      const double slope = zone.direction[k];
      zone.begin += slope * (slope > 0.0 ? zone.box.low[k] : zone.box.high[k]);
      zone.length += std::abs(slope) * (zone.box.high[k] - zone.box.low[k]);
    }
    zones_.push_back(zone);
  }
}

template <int Dim>
double DampingZones<Dim>::rate(const Vector<Dim>& position) const {
  double sum = 0.0;
  for (const Zone& zone : zones_) {
    if (!zone.box.contains(position)) continue;
    const double share = zone.length > 0.0 ? (dot(position, zone.direction) - zone.begin) / zone.length : 1.0;
    sum += zone.strength * share * share;
  }
  return sum;
}

template <int Dim>
Vector<Dim> DampingZones<Dim>::velocity_change(const Vector<Dim>& position, const Vector<Dim>& velocity,
                                               double dt) const {
  return std::expm1(-rate(position) * dt) * velocity;
}

template class DampingZones<2>;
template class DampingZones<3>;

}  // namespace impinge
