#include "impinge/method/operators.hpp"

#include <algorithm>
#include <cmath>

#include "impinge/method/surface.hpp"
#include "impinge/particles/lanes.hpp"

namespace impinge {
namespace {

// Calls use(j, W_ij) for the pairs of particle i.
template <class Use>
void for_pairs(const PairList& list, int i, Use&& use) {
  for (int k = list.begin(i); k < list.end(i); ++k)
    use(static_cast<std::size_t>(list.index[static_cast<std::size_t>(k)]), list.weight[static_cast<std::size_t>(k)]);
}

constexpr double least_determinant = 0.15;
constexpr double least_surface_determinant = 0.3;
constexpr double surface_point_weight = 0.5;

template <int Dim>
Matrix<Dim> or_identity(const Matrix<Dim>& correction) {
  return correction == Matrix<Dim>{} ? Matrix<Dim>::identity() : correction;
}

/// Where the neighbours stand from a particle at `centre` [m].
template <int Dim>
[[gnu::always_inline]] inline Vector<Dim, Lanes> offsets(std::span<const Vector<Dim>> position, const int* j,
                                                         const Vector<Dim>& centre) {
  return gathered(position, j) - spread(centre);
}

// Of a pair's force: along the pair, but along the normal of a wall, which is smooth.
template <int Dim>
Vector<Dim> push_direction(const Vector<Dim>& offset, ParticleType type, std::span<const Vector<Dim>> wall_normal,
                           std::size_t j) {
  return type == ParticleType::wall ? dot(offset, wall_normal[j]) * wall_normal[j] : offset;
}

}  // namespace

void number_density(const PairList& near, std::span<double> density) {
  for (int i = 0; i < near.rows(); ++i) {
    Lanes sum{};
    for_lanes(
        near, i, [&](const int*, const Lanes& weight) __attribute__((always_inline)) { sum += weight; });
    density[static_cast<std::size_t>(i)] = reduced(sum);
  }
}

template <int Dim>
double packing(const PairList& near, std::span<const Vector<Dim>> position, KernelType kernel, double radius,
               int first_scaled, int i) {
  const Vector<Dim> centre = position[static_cast<std::size_t>(i)];
  return with_kernel(kernel, [&]<class Kernel>(Kernel) {
    double sum = 0.0;
    for_pairs(near, i, [&](std::size_t j, double weight) {
      if (static_cast<int>(j) < first_scaled) {
        sum += packing_weight<Dim, Kernel>(weight);
      } else if (const double own = Kernel::weight(norm(position[j] - centre), radius); own > 0.0) {
        sum += weight / own * packing_weight<Dim, Kernel>(own);
      }
    });
    return sum;
  });
}

template <int Dim>
Vector<Dim> asymmetry(const PairList& near, std::span<const Vector<Dim>> position, double n0, int i) {
  const Vector<Dim>& centre = position[static_cast<std::size_t>(i)];
  Vector<Dim, Lanes> sum;
  for_lanes(
      near, i, [&](const int* j, const Lanes& weight) __attribute__((always_inline)) {
        const Vector<Dim, Lanes> offset = offsets(position, j, centre);
        sum -= weight / square_root(dot(offset, offset)) * offset;
      });
  return Dim / n0 * reduced(sum);
}

template <int Dim>
Matrix<Dim> moment_correction(const PairList& near, std::span<const Vector<Dim>> position, double n0, int i) {
  const Vector<Dim>& centre = position[static_cast<std::size_t>(i)];
  Matrix<Dim, Lanes> sum;
  for_lanes(
      near, i, [&](const int* j, const Lanes& weight) __attribute__((always_inline)) {
        const Vector<Dim, Lanes> offset = offsets(position, j, centre);
        sum.add_product(weight / dot(offset, offset) * offset, offset);
      });
  const Matrix<Dim> moment = Dim / n0 * reduced(sum);
  const double size = determinant(moment);
  return size < least_determinant ? Matrix<Dim>{} : 1.0 / size * adjugate(moment);
}

template <int Dim>
double divergence(const PairList& near, std::span<const Vector<Dim>> position, std::span<const Vector<Dim>> velocity,
                  double n0, int i) {
  const auto self = static_cast<std::size_t>(i);
  const Vector<Dim> centre = position[self];
  const Vector<Dim> own = velocity[self];
  double sum = 0.0;
  for_pairs(near, i, [&](std::size_t j, double weight) {
    const Vector<Dim> offset = position[j] - centre;
    sum += dot(velocity[j] - own, offset) * weight / dot(offset, offset);
  });
  return Dim / n0 * sum;
}

template <int Dim>
Matrix<Dim> velocity_gradient(const PairList& near, std::span<const Vector<Dim>> position,
                              std::span<const Vector<Dim>> velocity, std::span<const Vector<Dim>> wall_normal,
                              const Matrix<Dim>& correction, double n0, int i) {
  const auto self = static_cast<std::size_t>(i);
  const Vector<Dim>& centre = position[self];
  const Vector<Dim, Lanes> own = spread(velocity[self]);
  Matrix<Dim, Lanes> sum;
  const auto add_pairs = [&](auto&& counted) {
    for_lanes(
        near, i, [&](const int* j, const Lanes& weight) __attribute__((always_inline)) {
          const Vector<Dim, Lanes> offset = offsets(position, j, centre);
          sum.add_product(counted(j, gathered(velocity, j) - own), weight / dot(offset, offset) * offset);
        });
  };
  if (wall_normal.empty()) {
    add_pairs([](const int*, const Vector<Dim, Lanes>& relative) { return relative; });
  } else {
    add_pairs([&](const int* j, Vector<Dim, Lanes> relative) {
      const Vector<Dim, Lanes> normal = spread(wall_normal[self]) + gathered(wall_normal, j);
      const Lanes square = dot(normal, normal), share = dot(relative, normal) / square;
      for (int k = 0; k < Dim; ++k) relative[k] = square > 0.0 ? share * normal[k] : relative[k];
      return relative;
    });
  }
  Matrix<Dim> slope = Dim / n0 * reduced(sum);
  const Matrix<Dim> applied = or_identity(correction);
  for (Vector<Dim>& row : slope.row) row = applied * row;  // which is symmetric
  return slope;
}

template <int Dim>
Matrix<Dim> gradient_to_images_left(const PairList& near, std::span<const Vector<Dim>> position,
                                    std::span<const Vector<Dim>> velocity, const Matrix<Dim>& correction, double n0,
                                    std::size_t first_image, int i) {
  const auto self = static_cast<std::size_t>(i);
  Matrix<Dim> slope;
  for_pairs(near, i, [&](std::size_t j, double weight) {
    if (j < first_image) return;
    const Vector<Dim> offset = position[j] - position[self], relative = velocity[j] - velocity[self];
    if (dot(relative, offset) > 0.0)
      slope.add_product(Dim / n0 * relative, weight / dot(offset, offset) * (correction * offset));
  });
  return slope;
}

template <int Dim>
Vector<Dim> corrected_gradient(const PairList& near, std::span<const Vector<Dim>> position,
                               std::span<const double> pressure, double base, const Matrix<Dim>& correction, double n0,
                               int i) {
  const Vector<Dim>& centre = position[static_cast<std::size_t>(i)];
  Vector<Dim, Lanes> sum;
  for_lanes(
      near, i, [&](const int* j, const Lanes& weight) __attribute__((always_inline)) {
        const Vector<Dim, Lanes> offset = offsets(position, j, centre);
        sum += (gathered(pressure, j) - base) * weight / dot(offset, offset) * offset;
      });
  return Dim / n0 * (or_identity(correction) * reduced(sum));
}

template <int Dim>
Vector<Dim> repulsion(const PairList& near, std::span<const Vector<Dim>> position, std::span<const ParticleType> type,
                      double distance, double spacing, int i) {
  const Vector<Dim> centre = position[static_cast<std::size_t>(i)];
  Vector<Dim> push;
  for_pairs(near, i, [&](std::size_t j, double) {
    if (type[j] != ParticleType::fluid) return;
    const Vector<Dim> offset = centre - position[j];
    const double r = norm(offset);
    const double overlap = distance - r / spacing;
    if (overlap > 0.0 && r > 0.0) push += overlap / r * offset;
  });
  return push;
}

template <int Dim>
Vector<Dim> limited_change(const PairList& near, std::span<const Vector<Dim>> velocity,
                           std::span<const ParticleType> type, const Vector<Dim>& change, int i) {
  const double size = norm(change);
  if (size == 0.0) return change;
  const Vector<Dim> own = velocity[static_cast<std::size_t>(i)];
  double most = 0.0;
  for_pairs(near, i, [&](std::size_t j, double) {
    if (type[j] == ParticleType::wall || type[j] == ParticleType::ghost) return;
    most = std::max(most, dot(velocity[j] - own, change) / size);
  });
  return most < size ? most / size * change : change;
}

template <int Dim>
Vector<Dim> off_mean(const PairList& near, std::span<const Vector<Dim>> change, std::span<const ParticleType> type,
                     double n0, int i) {
  const Vector<Dim> own = change[static_cast<std::size_t>(i)];
  Vector<Dim> sum;
  for_pairs(near, i, [&](std::size_t j, double weight) {
    if (j < change.size() && type[j] == ParticleType::fluid) sum += weight * (own - change[j]);
  });
  return 1.0 / n0 * sum;
}

template <int Dim>
Vector<Dim> off_linear(const PairList& near, std::span<const Vector<Dim>> position,
                       std::span<const Vector<Dim>> velocity, std::span<const Matrix<Dim>> gradient, double n0, int i) {
  const auto self = static_cast<std::size_t>(i);
  if (gradient[self] == Matrix<Dim>{}) return {};
  const Vector<Dim> centre = position[self];
  const Vector<Dim> own = velocity[self];
  Vector<Dim> differences, offset_sum;
  Matrix<Dim> products;  // of the gradients' columns with the offsets' components
  for_pairs(near, i, [&](std::size_t j, double weight) {
    if (j >= gradient.size() || gradient[j] == Matrix<Dim>{}) return;
    const Vector<Dim> offset = weight * (position[j] - centre);
    differences += weight * (velocity[j] - own);
    offset_sum += offset;
    for (std::size_t k = 0; k < Dim; ++k)
      for (int l = 0; l < Dim; ++l) products.row[k][l] += gradient[j].row[k][l] * offset[l];
  });
  Vector<Dim> linear = gradient[self] * offset_sum;
  for (int k = 0; k < Dim; ++k)
    for (int l = 0; l < Dim; ++l) linear[k] += products.row[static_cast<std::size_t>(k)][l];
  return 1.0 / n0 * (differences - 0.5 * linear);
}

template <int Dim>
std::optional<Vector<Dim>> surface_gradient(const PairList& near, std::span<const Vector<Dim>> position,
                                            std::span<const double> pressure, const Vector<Dim>& normal, double depth,
                                            double curvature, double n0, int i) {
  const Vector<Dim> centre = position[static_cast<std::size_t>(i)];
  const double own = pressure[static_cast<std::size_t>(i)];
  Vector<Dim> sum = -surface_point_weight * (own / depth + 0.5 * curvature * depth) * normal;
  Matrix<Dim> moment;
  moment.add_product(surface_point_weight * normal, normal);
  for_pairs(near, i, [&](std::size_t j, double weight) {
    const Vector<Dim> offset = position[j] - centre;
    const Vector<Dim> weighted = Dim / n0 * weight / dot(offset, offset) * offset;
    const double height = dot(offset, normal);
    sum += (pressure[j] - own - 0.5 * curvature * height * height) * weighted;
    moment.add_product(weighted, offset);
  });
  const double size = determinant(moment);
  if (size < least_surface_determinant) return std::nullopt;
  return 1.0 / size * (adjugate(moment) * sum);
}

double least_pressure(const PairList& near, std::span<const double> pressure, int i) {
  double least = pressure[static_cast<std::size_t>(i)];
  for_pairs(near, i, [&](std::size_t j, double) { least = std::min(least, pressure[j]); });
  return least;
}

double mean_inside(const PairList& near, std::span<const double> value, std::span<const std::uint8_t> free_surface,
                   double own_weight, int i) {
  double weights = own_weight;
  double sum = own_weight * value[static_cast<std::size_t>(i)];
  for_pairs(near, i, [&](std::size_t j, double weight) {
    if (free_surface[j]) return;
    weights += weight;
    sum += weight * value[j];
  });
  return sum / weights;
}

double weighted_mean(const PairList& near, std::span<const double> value, int i) {
  double weights = 0.0;
  double sum = 0.0;
  for_pairs(near, i, [&](std::size_t j, double weight) {
    weights += weight;
    sum += weight * value[j];
  });
  return weights > 0.0 ? sum / weights : 0.0;
}

template <int Dim>
Vector<Dim> pressure_gradient(const PairList& near, std::span<const Vector<Dim>> position,
                              std::span<const double> pressure, std::span<const ParticleType> type,
                              std::span<const Vector<Dim>> wall_normal, double n0, int i) {
  const auto self = static_cast<std::size_t>(i);
  const Vector<Dim> centre = position[self];
  const double own = pressure[self];
  Vector<Dim> sum;
  for_pairs(near, i, [&](std::size_t j, double weight) {
    if (type[j] == ParticleType::ghost) return;
    const Vector<Dim> offset = position[j] - centre;
    sum += (pressure[j] + own) * weight / dot(offset, offset) * push_direction<Dim>(offset, type[j], wall_normal, j);
  });
  return Dim / n0 * sum;
}

template <int Dim>
Vector<Dim> velocity_laplacian(const PairRow& far, std::span<const Vector<Dim>> velocity, double factor, int i) {
  const Vector<Dim> own = velocity[static_cast<std::size_t>(i)];
  Vector<Dim> sum;
  for (std::size_t k = 0; k < far.index.size(); ++k)
    sum += far.weight[k] * (velocity[static_cast<std::size_t>(far.index[k])] - own);
  return factor * sum;
}

template <int Dim>
ViscousSums<Dim> viscous_sums(const PairRow& far, std::span<const Vector<Dim>> position,
                              std::span<const Vector<Dim>> velocity, int i) {
  const auto self = static_cast<std::size_t>(i);
  ViscousSums<Dim> sums;
  for (std::size_t k = 0; k < far.index.size(); ++k) {
    const auto j = static_cast<std::size_t>(far.index[k]);
    const Vector<Dim> offset = position[j] - position[self];
    sums.differences += far.weight[k] * (velocity[j] - velocity[self]);
    sums.offsets += far.weight[k] * offset;
    sums.spread += far.weight[k] * dot(offset, offset);
  }
  return sums;
}

template <int Dim>
Vector<Dim> collision(const PairList& near, std::span<const Vector<Dim>> position,
                      std::span<const Vector<Dim>> velocity, std::span<const ParticleType> type,
                      std::span<const Vector<Dim>> wall_normal, double dt, double distance, double restitution,
                      double fastest, int i) {
  const auto self = static_cast<std::size_t>(i);
  const Vector<Dim>& centre = position[self];
  const Vector<Dim>& own = velocity[self];
  const double within = distance + 2.0 * dt * fastest;
  Vector<Dim> change;
  for_pairs(near, i, [&](std::size_t j, double) {
    const Vector<Dim> offset = position[j] - centre;
    if (dot(offset, offset) > within * within || type[j] == ParticleType::ghost) return;
    const Vector<Dim> relative = own - velocity[j];
    const Vector<Dim> next = offset - dt * relative;
    const Vector<Dim> direction = push_direction<Dim>(offset, type[j], wall_normal, j);
    const double approach = dot(relative, direction);
    if (approach <= 0.0 || dot(next, next) >= distance * distance) return;
    const double share = type[j] == ParticleType::fluid ? 0.5 : 1.0;
    change -= share * (1.0 + restitution) * approach / dot(direction, direction) * direction;
  });
  return change;
}

#define IMPINGE_INSTANTIATE(Dim)                                                                                       \
  template double packing<Dim>(const PairList&, std::span<const Vector<Dim>>, KernelType, double, int, int);           \
  template Vector<Dim> asymmetry<Dim>(const PairList&, std::span<const Vector<Dim>>, double, int);                     \
  template Matrix<Dim> moment_correction<Dim>(const PairList&, std::span<const Vector<Dim>>, double, int);             \
  template double divergence<Dim>(const PairList&, std::span<const Vector<Dim>>, std::span<const Vector<Dim>>, double, \
                                  int);                                                                                \
  template Matrix<Dim> gradient_to_images_left<Dim>(const PairList&, std::span<const Vector<Dim>>,                     \
                                                    std::span<const Vector<Dim>>, const Matrix<Dim>&, double,          \
                                                    std::size_t, int);                                                 \
  template Matrix<Dim> velocity_gradient<Dim>(const PairList&, std::span<const Vector<Dim>>,                           \
                                              std::span<const Vector<Dim>>, std::span<const Vector<Dim>>,              \
                                              const Matrix<Dim>&, double, int);                                        \
  template std::optional<Vector<Dim>> surface_gradient<Dim>(const PairList&, std::span<const Vector<Dim>>,             \
                                                            std::span<const double>, const Vector<Dim>&, double,       \
                                                            double, double, int);                                      \
  template Vector<Dim> corrected_gradient<Dim>(const PairList&, std::span<const Vector<Dim>>, std::span<const double>, \
                                               double, const Matrix<Dim>&, double, int);                               \
  template Vector<Dim> repulsion<Dim>(const PairList&, std::span<const Vector<Dim>>, std::span<const ParticleType>,    \
                                      double, double, int);                                                            \
  template Vector<Dim> off_mean<Dim>(const PairList&, std::span<const Vector<Dim>>, std::span<const ParticleType>,     \
                                     double, int);                                                                     \
  template Vector<Dim> limited_change<Dim>(const PairList&, std::span<const Vector<Dim>>,                              \
                                           std::span<const ParticleType>, const Vector<Dim>&, int);                    \
  template Vector<Dim> off_linear<Dim>(const PairList&, std::span<const Vector<Dim>>, std::span<const Vector<Dim>>,    \
                                       std::span<const Matrix<Dim>>, double, int);                                     \
  template Vector<Dim> pressure_gradient<Dim>(const PairList&, std::span<const Vector<Dim>>, std::span<const double>,  \
                                              std::span<const ParticleType>, std::span<const Vector<Dim>>, double,     \
                                              int);                                                                    \
  template ViscousSums<Dim> viscous_sums<Dim>(const PairRow&, std::span<const Vector<Dim>>,                            \
                                              std::span<const Vector<Dim>>, int);                                      \
  template Vector<Dim> velocity_laplacian<Dim>(const PairRow&, std::span<const Vector<Dim>>, double, int);             \
  template Vector<Dim> collision<Dim>(const PairList&, std::span<const Vector<Dim>>, std::span<const Vector<Dim>>,     \
                                      std::span<const ParticleType>, std::span<const Vector<Dim>>, double, double,     \
                                      double, double, int);
IMPINGE_INSTANTIATE(2)
IMPINGE_INSTANTIATE(3)
#undef IMPINGE_INSTANTIATE

}  // namespace impinge
