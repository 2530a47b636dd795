#include "impinge/particles/particles.hpp"

#include "impinge/particles/fields.hpp"

namespace impinge {
namespace {

/// The arrays of Particles are those of the table, and the members of ParticleRecord are those that travel.
template <int Dim>
constexpr bool table_is_complete() {
  std::size_t arrays = 0;
  std::size_t record = 0;
  for_fields<Dim>([&]<class T>(const Field<Dim, T>& field) {
    arrays += sizeof(std::vector<T>);
    if (field.record) record += sizeof(T);
  });
  const auto in_whole = [](std::size_t size, std::size_t unit) { return (size + unit - 1) / unit * unit; };
  return sizeof(Particles<Dim>) == in_whole(sizeof(int), alignof(Particles<Dim>)) + arrays &&
         sizeof(ParticleRecord<Dim>) == in_whole(record, alignof(ParticleRecord<Dim>));
}

static_assert(table_is_complete<2>() && table_is_complete<3>());

}  // namespace

template <int Dim>
void Particles<Dim>::resize(int size) {
  for_fields<Dim>([&](const auto& field) { (this->*field.values).resize(static_cast<std::size_t>(size)); });
}

template <int Dim>
void Particles<Dim>::copy_owned(const Particles& other) {
  owned = other.owned;
  for_fields<Dim>([&](const auto& field) {
    const auto& from = other.*field.values;
    (this->*field.values).assign(from.begin(), from.begin() + owned);
  });
}

template <int Dim>
void Particles<Dim>::reorder(std::span<const int> order) {
  for_fields<Dim>([&](const auto& field) {
    auto& values = this->*field.values;
    auto sorted = values;
    for (std::size_t k = 0; k < order.size(); ++k) sorted[k] = values[static_cast<std::size_t>(order[k])];
    values.swap(sorted);
  });
}

template <int Dim>
void Particles<Dim>::append(const ParticleRecord<Dim>& record) {
  resize(owned + 1);
  set_record(owned++, record);
}

template <int Dim>
ParticleRecord<Dim> Particles<Dim>::record(int i) const {
  ParticleRecord<Dim> record{};
  for_fields<Dim>([&](const auto& field) {
    if (field.record) record.*field.record = (this->*field.values)[static_cast<std::size_t>(i)];
  });
  return record;
}

template <int Dim>
void Particles<Dim>::set_record(int i, const ParticleRecord<Dim>& record) {
  for_fields<Dim>([&](const auto& field) {
    if (field.record) (this->*field.values)[static_cast<std::size_t>(i)] = record.*field.record;
  });
}

template struct Particles<2>;
template struct Particles<3>;

}  // namespace impinge
