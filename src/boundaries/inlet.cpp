#include "impinge/boundaries/inlet.hpp"

#include <algorithm>

namespace impinge {

template <int Dim>
BoundaryFlow pass_open_boundaries(std::vector<Inlet<Dim>>& inlets, const std::vector<Outlet<Dim>>& outlets,
                                  std::int64_t& next_id, Particles<Dim>& particles,
                                  const std::function<bool(const Vector<Dim>&)>& owns) {
  BoundaryFlow flow;
  int kept = 0;
  for (int i = 0; i < particles.owned; ++i) {
    ParticleRecord<Dim> record = particles.record(i);
    const auto has_entered = [&](const Inlet<Dim>& inlet) { return inlet.distance_past(record.position) > 0.0; };
    if (record.type == ParticleType::inlet && std::ranges::any_of(inlets, has_entered)) {
      record.type = ParticleType::fluid;
      ++flow.entered;
    }
    const auto has_left = [&](const Outlet<Dim>& outlet) { return outlet.has_passed(record.position); };
    if (record.type == ParticleType::fluid && std::ranges::any_of(outlets, has_left)) {
      ++flow.left;
      continue;
    }
    particles.set_record(kept++, record);
  }
  particles.owned = kept;
  particles.resize(kept);

  for (Inlet<Dim>& inlet : inlets) {
    while (inlet.last_row - inlet.spacing >= -inlet.rows * inlet.spacing) {
      inlet.last_row -= inlet.spacing;
      for (std::size_t k = 0; k < inlet.section.size(); ++k) {
        const Vector<Dim> position = inlet.at(inlet.last_row, inlet.section[k]);
        if (owns(position))
          particles.append(
              {position, inlet.velocity(), 0.0, 0.0, next_id + static_cast<std::int64_t>(k), ParticleType::inlet});
      }
      next_id += static_cast<std::int64_t>(inlet.section.size());
    }
  }
  return flow;
}

template BoundaryFlow pass_open_boundaries(std::vector<Inlet<2>>&, const std::vector<Outlet<2>>&, std::int64_t&,
                                           Particles<2>&, const std::function<bool(const Vector<2>&)>&);
template BoundaryFlow pass_open_boundaries(std::vector<Inlet<3>>&, const std::vector<Outlet<3>>&, std::int64_t&,
                                           Particles<3>&, const std::function<bool(const Vector<3>&)>&);

}  // namespace impinge
