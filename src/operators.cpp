#include "impinge/operators.hpp"

#include <cmath>

namespace impinge {
namespace {

// Calls use(j, W_ij) for the pairs of particle i.
template <class Use>
void for_pairs(const PairList& list, int i, Use&& use) {
  for (int k = list.begin(i); k < list.end(i); ++k)
    use(static_cast<std::size_t>(list.index[static_cast<std::size_t>(k)]), list.weight[static_cast<std::size_t>(k)]);
}

// Of a pair's force: along the pair, but along the normal of a wall, which is smooth.
template <int Dim>
Vec<Dim> push_direction(const Vec<Dim>& offset, ParticleType type, const Vec<Dim>& wall_normal) {
  return type == ParticleType::wall ? dot(offset, wall_normal) * wall_normal : offset;
}

}  // namespace

void number_density(const PairList& near, std::span<double> density) {
  for (int i = 0; i < near.rows(); ++i) {
    double sum = 0.0;
    for_pairs(near, i, [&](std::size_t, double weight) { sum += weight; });
    density[static_cast<std::size_t>(i)] = sum;
  }
}

template <int Dim>
double asymmetry(const PairList& near, std::span<const Vec<Dim>> position, double n0, int i) {
  const Vec<Dim> centre = position[static_cast<std::size_t>(i)];
  Vec<Dim> sum;
  for_pairs(near, i, [&](std::size_t j, double weight) {
    const Vec<Dim> offset = centre - position[j];
    sum += weight / norm(offset) * offset;
  });
  return Dim / n0 * norm(sum);
}

template <int Dim>
double divergence(const PairList& near, std::span<const Vec<Dim>> position, std::span<const Vec<Dim>> velocity,
                  double n0, int i) {
  const auto self = static_cast<std::size_t>(i);
  const Vec<Dim> centre = position[self];
  const Vec<Dim> own = velocity[self];
  double sum = 0.0;
  for_pairs(near, i, [&](std::size_t j, double weight) {
    const Vec<Dim> offset = position[j] - centre;
    sum += dot(velocity[j] - own, offset) * weight / dot(offset, offset);
  });
  return Dim / n0 * sum;
}

template <int Dim>
Vec<Dim> pressure_gradient(const PairList& near, std::span<const Vec<Dim>> position, std::span<const double> pressure,
                           std::span<const ParticleType> type, std::span<const Vec<Dim>> wall_normal, double n0,
                           int i) {
  const auto self = static_cast<std::size_t>(i);
  const Vec<Dim> centre = position[self];
  const double own = pressure[self];
  Vec<Dim> sum;
  for_pairs(near, i, [&](std::size_t j, double weight) {
    if (type[j] == ParticleType::ghost) return;
    const Vec<Dim> offset = position[j] - centre;
    sum += (pressure[j] + own) * weight / dot(offset, offset) * push_direction<Dim>(offset, type[j], wall_normal[j]);
  });
  return Dim / n0 * sum;
}

template <int Dim>
Vec<Dim> velocity_laplacian(const PairList& far, std::span<const Vec<Dim>> velocity, double factor, int i) {
  const Vec<Dim> own = velocity[static_cast<std::size_t>(i)];
  Vec<Dim> sum;
  for_pairs(far, i, [&](std::size_t j, double weight) { sum += weight * (velocity[j] - own); });
  return factor * sum;
}

template <int Dim>
Vec<Dim> collision(const PairList& near, std::span<const Vec<Dim>> position, std::span<const Vec<Dim>> velocity,
                   std::span<const ParticleType> type, std::span<const Vec<Dim>> wall_normal, double dt,
                   double distance, double restitution, int i) {
  const auto self = static_cast<std::size_t>(i);
  const Vec<Dim> centre = position[self];
  const Vec<Dim> own = velocity[self];
  Vec<Dim> change;
  for_pairs(near, i, [&](std::size_t j, double) {
    if (type[j] == ParticleType::ghost) return;
    const Vec<Dim> offset = position[j] - centre;
    const Vec<Dim> relative = own - velocity[j];
    const Vec<Dim> next = offset - dt * relative;
    const Vec<Dim> direction = push_direction<Dim>(offset, type[j], wall_normal[j]);
    const double approach = dot(relative, direction);
    if (approach <= 0.0 || dot(next, next) >= distance * distance) return;
    const double share = type[j] == ParticleType::fluid ? 0.5 : 1.0;
    change -= share * (1.0 + restitution) * approach / dot(direction, direction) * direction;
  });
  return change;
}

#define IMPINGE_INSTANTIATE(Dim)                                                                                       \
  template double asymmetry<Dim>(const PairList&, std::span<const Vec<Dim>>, double, int);                             \
  template double divergence<Dim>(const PairList&, std::span<const Vec<Dim>>, std::span<const Vec<Dim>>, double, int); \
  template Vec<Dim> pressure_gradient<Dim>(const PairList&, std::span<const Vec<Dim>>, std::span<const double>,        \
                                           std::span<const ParticleType>, std::span<const Vec<Dim>>, double, int);     \
  template Vec<Dim> velocity_laplacian<Dim>(const PairList&, std::span<const Vec<Dim>>, double, int);                  \
  template Vec<Dim> collision<Dim>(const PairList&, std::span<const Vec<Dim>>, std::span<const Vec<Dim>>,              \
                                   std::span<const ParticleType>, std::span<const Vec<Dim>>, double, double, double,   \
                                   int);
IMPINGE_INSTANTIATE(2)
IMPINGE_INSTANTIATE(3)
#undef IMPINGE_INSTANTIATE

}  // namespace impinge
