#pragma once
// The table of the particle fields. A new field is a member of Particles (and of ParticleRecord where it travels) and a
// row here; memory, exchange, snapshots, checkpoints and the time series follow.

#include <tuple>

#include "impinge/particles/particles.hpp"

namespace impinge {

/// A field of the particles, with values of type T.
template <int Dim, class T>
struct Field {
  using Value = T;

  const char* name;                        ///< in files
  const char* unit;                        ///< in files; "1": none
  std::vector<T> Particles<Dim>::*values;  ///< its array
  T ParticleRecord<Dim>::*record;          ///< where it travels with its particle; nullptr: it stays
  bool is_saved;                           ///< snapshots and checkpoints hold it
  bool is_in_series;                       ///< the time series shows it
};

/// All fields, in the order of the files.
template <int Dim>
inline constexpr auto particle_fields = [] {
  using P = Particles<Dim>;
  using R = ParticleRecord<Dim>;
  return std::tuple{
      // name, unit, array, in the record, saved, in the series
      Field<Dim, Vector<Dim>>{"position", "m", &P::position, &R::position, true, true},
      Field<Dim, Vector<Dim>>{"velocity", "m/s", &P::velocity, &R::velocity, true, true},
      Field<Dim, double>{"pressure", "Pa", &P::pressure, &R::pressure, true, true},
      Field<Dim, double>{"pressure_impulse", "Pa s", &P::pressure_impulse, &R::pressure_impulse, true, false},
      Field<Dim, double>{"number_density", "1", &P::number_density, nullptr, true, true},
      Field<Dim, ParticleType>{"type", "1", &P::type, &R::type, true, true},
      Field<Dim, std::uint8_t>{"free_surface", "1", &P::free_surface, nullptr, true, true},
      Field<Dim, std::int64_t>{"id", "1", &P::id, &R::id, true, true},
  };
}();

/// Calls use(field) for every field.
template <int Dim, class Use>
constexpr void for_fields(Use&& use) {
  std::apply([&](const auto&... field) { (use(field), ...); }, particle_fields<Dim>);
}

/// Memory of a particle's fields [bytes].
template <int Dim>
inline constexpr std::size_t field_bytes = [] {
  std::size_t sum = 0;
  for_fields<Dim>([&]<class T>(const Field<Dim, T>&) { sum += sizeof(T); });
  return sum;
}();

}  // namespace impinge
