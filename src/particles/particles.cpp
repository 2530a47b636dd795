#include "impinge/particles/particles.hpp"

#include <tuple>

namespace impinge {
namespace {

/// All arrays of some particles.
template <class Particles>
auto fields(Particles& p) {
  return std::tie(p.position, p.velocity, p.pressure, p.pressure_impulse, p.number_density, p.id, p.type,
                  p.free_surface);
}

}  // namespace

template <int Dim>
void Particles<Dim>::resize(int size) {
  std::apply([&](auto&... field) { (field.resize(static_cast<std::size_t>(size)), ...); }, fields(*this));
}

template <int Dim>
void Particles<Dim>::copy_owned(const Particles& other) {
  owned = other.owned;
  const auto copy = [&](auto& to, const auto& from) { to.assign(from.begin(), from.begin() + owned); };
  std::apply([&](auto&... to) { std::apply([&](const auto&... from) { (copy(to, from), ...); }, fields(other)); },
             fields(*this));
}

template <int Dim>
void Particles<Dim>::reorder(std::span<const int> order) {
  const auto reorder_field = [&](auto& field) {
    auto sorted = field;
    for (std::size_t k = 0; k < order.size(); ++k) sorted[k] = field[static_cast<std::size_t>(order[k])];
    field.swap(sorted);
  };
  std::apply([&](auto&... field) { (reorder_field(field), ...); }, fields(*this));
}

template <int Dim>
void Particles<Dim>::append(const ParticleRecord<Dim>& record) {
  resize(owned + 1);
  set_record(owned++, record);
}

template <int Dim>
ParticleRecord<Dim> Particles<Dim>::record(int i) const {
  const auto k = static_cast<std::size_t>(i);
  return {position[k], velocity[k], pressure[k], pressure_impulse[k], id[k], type[k]};
}

template <int Dim>
void Particles<Dim>::set_record(int i, const ParticleRecord<Dim>& record) {
  const auto k = static_cast<std::size_t>(i);
  position[k] = record.position;
  velocity[k] = record.velocity;
  pressure[k] = record.pressure;
  pressure_impulse[k] = record.pressure_impulse;
  id[k] = record.id;
  type[k] = record.type;
}

template struct Particles<2>;
template struct Particles<3>;

}  // namespace impinge
