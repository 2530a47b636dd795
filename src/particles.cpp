#include "impinge/particles.hpp"

namespace impinge {

template <int Dim>
void Particles<Dim>::resize(int size) {
  const auto n = static_cast<std::size_t>(size);
  position.resize(n);
  velocity.resize(n);
  pressure.resize(n);
  pressure_impulse.resize(n);
  number_density.resize(n);
  id.resize(n);
  type.resize(n);
  free_surface.resize(n);
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
