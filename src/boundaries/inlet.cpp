#include "impinge/boundaries/inlet.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "impinge/core/table.hpp"

namespace impinge {
namespace {

/// The inlet that an inlet particle belongs to: the blocks of several do not overlap.
template <int Dim>
const Inlet<Dim>& inlet_of(const std::vector<Inlet<Dim>>& inlets, const Vector<Dim>& position) {
  if (inlets.size() == 1) return inlets.front();
  return *std::ranges::min_element(inlets, {},
                                   [&](const Inlet<Dim>& inlet) { return inlet.distance_from_block(position); });
}

}  // namespace

template <int Dim>
double Inlet<Dim>::speed_at(double time) const {
  if (speeds.empty()) return speed;
  const auto [before, after, share] = place_in(speeds, time, &SpeedEntry::time);
  return std::lerp(speeds[before].speed, speeds[after].speed, share);
}

template <int Dim>
Vector<Dim> Inlet<Dim>::in_row(double distance, std::size_t k, std::int64_t first_id) const {
  if constexpr (Dim == 3) {
    if (radius > 0.0) {
      // A turn that has nothing to do with the spiral's: by the golden angle, particles would stand behind each other.
      const auto rows_before = static_cast<double>(first_id / static_cast<std::int64_t>(section.size()));
      const double angle = 2.0 * std::numbers::pi * std::fmod(std::numbers::sqrt2 * rows_before, 1.0);
      const double cosine = std::cos(angle), sine = std::sin(angle);
      const auto [x, y] = section[k];
      return at(distance, {cosine * x - sine * y, sine * x + cosine * y});
    }
  }
  return at(distance, section[k]);
}

template <int Dim>
double Inlet<Dim>::distance_from_block(const Vector<Dim>& position) const {
  const double past = distance_past(position);
  double distance = std::max({0.0, past, -rows * spacing - past});
  if (radius > 0.0) {
    const double apart = norm(position - corner - past * direction);
    return std::max({distance, apart - radius, inner_radius - apart});
  }
  for (std::size_t k = 0; k < across.size(); ++k) {
    const double place = dot(position - corner, across[k]);
    const auto [low, high] = std::ranges::minmax(section, {}, [k](const auto& x) { return x[k]; });
    distance = std::max({distance, low[k] - place - 0.5 * spacing, place - high[k] - 0.5 * spacing});
  }
  return distance;
}

template <int Dim>
void set_inlets(double time, std::vector<Inlet<Dim>>& inlets, Particles<Dim>& particles) {
  if (std::ranges::all_of(inlets, &Inlet<Dim>::is_steady)) return;
  for (Inlet<Dim>& inlet : inlets) {
    inlet.blows = inlet.blows_at(time);
    inlet.speed = inlet.speed_at(time);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
    if (particles.type[i] == ParticleType::inlet)
      particles.velocity[i] = inlet_of(inlets, particles.position[i]).velocity();
}

template <int Dim>
BoundaryFlow pass_open_boundaries(std::vector<Inlet<Dim>>& inlets, const std::vector<Outlet<Dim>>& outlets,
                                  std::int64_t& next_id, Particles<Dim>& particles,
                                  const std::function<bool(const Vector<Dim>&)>& owns) {
  BoundaryFlow flow{.left_by = std::vector<std::int64_t>(outlets.size())};
  int kept = 0;
  for (int i = 0; i < particles.owned; ++i) {
    ParticleRecord<Dim> record = particles.record(i);
    if (record.type == ParticleType::inlet) {
      const Inlet<Dim>& inlet = inlet_of(inlets, record.position);
      if (!inlet.blows) continue;
      if (inlet.distance_past(record.position) > 0.0) {
        record.type = ParticleType::fluid;
        ++flow.entered;
      }
    }
    if (record.type == ParticleType::fluid) {
      const auto has_left = [&](const Outlet<Dim>& outlet) { return outlet.has_passed(record.position); };
      const auto outlet = std::ranges::find_if(outlets, has_left);
      if (outlet != outlets.end()) {
        ++flow.left;
        ++flow.left_by[static_cast<std::size_t>(outlet - outlets.begin())];
        continue;
      }
    }
    particles.set_record(kept++, record);
  }
  particles.owned = kept;
  particles.resize(kept);

  for (Inlet<Dim>& inlet : inlets) {
    if (!inlet.blows) {
      inlet.last_row = inlet.no_row();
      continue;
    }
    while (inlet.last_row - inlet.spacing >= -inlet.rows * inlet.spacing) {
      inlet.last_row -= inlet.spacing;
      for (std::size_t k = 0; k < inlet.section.size(); ++k) {
        const Vector<Dim> position = inlet.in_row(inlet.last_row, k, next_id);
        if (owns(position))
          particles.append(
              {position, inlet.velocity(), 0.0, 0.0, next_id + static_cast<std::int64_t>(k), ParticleType::inlet});
      }
      next_id += static_cast<std::int64_t>(inlet.section.size());
    }
  }
  return flow;
}

#define IMPINGE_INSTANTIATE(Dim)                                                                                       \
  template struct Inlet<Dim>;                                                                                          \
  template void set_inlets(double, std::vector<Inlet<Dim>>&, Particles<Dim>&);                                         \
  template BoundaryFlow pass_open_boundaries(std::vector<Inlet<Dim>>&, const std::vector<Outlet<Dim>>&, std::int64_t&, \
                                             Particles<Dim>&, const std::function<bool(const Vector<Dim>&)>&);
IMPINGE_INSTANTIATE(2)
IMPINGE_INSTANTIATE(3)
#undef IMPINGE_INSTANTIATE

}  // namespace impinge
