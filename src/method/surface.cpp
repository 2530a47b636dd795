#include "impinge/method/surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace impinge {
namespace {

constexpr double table_step = 0.02;  // [dp]
constexpr double rough = 0.8;        // mean of the normals' sum at which a surface counts as rough
constexpr double flat = 0.95;        // likewise as flat
constexpr double still = 0.05;       // disordered motion that counts as none [fall speeds]
constexpr double agitated = 0.2;     // likewise that counts as wholly disordered
constexpr double own_weight = 5.0;   // of a surface particle in its own normal; a neighbour next to it has 0.8

// The sums of term(W, d_g, depth) over the lattice points beyond a flat surface that a particle misses, at least_depth
// and from step to step. Lengths in dp.
template <int Dim, class Term>
std::vector<double> missing(KernelType type, double effective_radius, const Term& term) {
  const int reach = static_cast<int>(std::ceil(effective_radius));
  std::vector<double> sums;
  for (double depth = SurfaceClosure<Dim>::least_depth; depth < effective_radius + table_step; depth += table_step) {
    double sum = 0.0;
    for (int x = -reach; x <= reach; ++x) {
      for (int z = Dim == 2 ? 0 : -reach; z <= (Dim == 2 ? 0 : reach); ++z) {
        for (double beyond = 0.5; depth + beyond < effective_radius; beyond += 1.0) {
          const double r = std::hypot(x, z, depth + beyond);
          const double weight =
              with_kernel(type, [&](auto kernel) { return decltype(kernel)::weight(r, effective_radius); });
          if (weight > 0.0) sum += term(weight, beyond, depth);
        }
      }
    }
    sums.push_back(sum);
  }
  return sums;
}

}  // namespace

template <int Dim>
SurfaceClosure<Dim>::SurfaceClosure(KernelType type, double laplacian_radius, double packing_radius)
    : weight_(missing<Dim>(type, laplacian_radius,
                           [](double weight, double beyond, double depth) { return (1.0 + beyond / depth) * weight; })),
      curvature_(missing<Dim>(
          type, laplacian_radius,
          [](double weight, double beyond, double depth) { return 0.5 * beyond * (beyond + depth) * weight; })),
      packing_(missing<Dim>(type, packing_radius, [&](double weight, double, double) {
        return with_kernel(type, [&](auto kernel) { return packing_weight<Dim, decltype(kernel)>(weight); });
      })) {}

template <int Dim>
double SurfaceClosure<Dim>::at_depth(const std::vector<double>& table, double depth) {
  const double place = (std::max(depth, least_depth) - least_depth) / table_step;
  if (!(place < static_cast<double>(table.size() - 1))) return 0.0;
  const auto below = static_cast<std::size_t>(place);
  const double upper = place - static_cast<double>(below);
  return (1.0 - upper) * table[below] + upper * table[below + 1];
}

template <int Dim>
double surface_depth(std::span<const int> around, std::span<const Vector<Dim>> position,
                     std::span<const Vector<Dim>> asymmetry, std::span<const std::uint8_t> free_surface,
                     std::span<const double> layer, double spacing, int i) {
  const auto self = static_cast<std::size_t>(i);
  if (free_surface[self]) return layer[self];
  double weights = 0.0;
  double depths = 0.0;
  for (const int neighbour : around) {
    const auto j = static_cast<std::size_t>(neighbour);
    if (!free_surface[j]) continue;
    const double size = norm(asymmetry[j]);
    const Vector<Dim> offset = 1.0 / spacing * (position[j] - position[self]);
    const double square = dot(offset, offset);
    if (size == 0.0 || square == 0.0) continue;
    const double weight = 1.0 / (square * square * square);
    weights += weight;
    depths += weight * (dot(offset, asymmetry[j]) / size + layer[j]);
  }
  if (weights == 0.0) return std::numeric_limits<double>::infinity();
  return std::max(depths / weights, SurfaceClosure<Dim>::usual_depth);
}

template <int Dim>
double surface_flatness(const PairList& near, std::span<const Vector<Dim>> asymmetry,
                        std::span<const std::uint8_t> free_surface, int i) {
  Vector<Dim> sum;
  int count = 0;
  const auto add = [&](std::size_t j) {
    if (!free_surface[j]) return;
    const double size = norm(asymmetry[j]);
    if (size == 0.0) return;
    sum += 1.0 / size * asymmetry[j];
    ++count;
  };
  add(static_cast<std::size_t>(i));
  for (int k = near.begin(i); k < near.end(i); ++k)
    add(static_cast<std::size_t>(near.index[static_cast<std::size_t>(k)]));
  if (free_surface[static_cast<std::size_t>(i)] && count < 2) return 0.0;
  if (count == 0) return 1.0;
  return std::clamp((norm(sum) / count - rough) / (flat - rough), 0.0, 1.0);
}

bool is_beside_surface(const PairList& near, std::span<const std::uint8_t> free_surface, int i) {
  for (int k = near.begin(i); k < near.end(i); ++k)
    if (free_surface[static_cast<std::size_t>(near.index[static_cast<std::size_t>(k)])]) return true;
  return false;
}

template <int Dim>
double disorder(const PairList& near, std::span<const Vector<Dim>> position, std::span<const Vector<Dim>> velocity,
                const Matrix<Dim>& slope, double fall_speed, int i) {
  const auto self = static_cast<std::size_t>(i);
  double most = 0.0;
  for (int k = near.begin(i); k < near.end(i); ++k) {
    const auto j = static_cast<std::size_t>(near.index[static_cast<std::size_t>(k)]);
    const Vector<Dim> rest = velocity[j] - velocity[self] - slope * (position[j] - position[self]);
    most = std::max(most, dot(rest, rest));
  }
  return std::clamp((std::sqrt(most) / fall_speed - still) / (agitated - still), 0.0, 1.0);
}

template <int Dim>
Vector<Dim> surface_normal(const PairList& near, std::span<const Vector<Dim>> asymmetry,
                           std::span<const std::uint8_t> free_surface, int i) {
  const auto self = static_cast<std::size_t>(i);
  Vector<Dim> sum;
  if (free_surface[self]) sum += own_weight * asymmetry[self];
  for (int k = near.begin(i); k < near.end(i); ++k) {
    const auto j = static_cast<std::size_t>(near.index[static_cast<std::size_t>(k)]);
    if (free_surface[j]) sum += near.weight[static_cast<std::size_t>(k)] * asymmetry[j];
  }
  const double size = norm(sum);
  return size > 0.0 ? 1.0 / size * sum : sum;
}

template class SurfaceClosure<2>;
template class SurfaceClosure<3>;
template double surface_depth<2>(std::span<const int>, std::span<const Vector<2>>, std::span<const Vector<2>>,
                                 std::span<const std::uint8_t>, std::span<const double>, double, int);
template double surface_flatness<2>(const PairList&, std::span<const Vector<2>>, std::span<const std::uint8_t>, int);
template double surface_flatness<3>(const PairList&, std::span<const Vector<3>>, std::span<const std::uint8_t>, int);
template double disorder<2>(const PairList&, std::span<const Vector<2>>, std::span<const Vector<2>>, const Matrix<2>&,
                            double, int);
template double disorder<3>(const PairList&, std::span<const Vector<3>>, std::span<const Vector<3>>, const Matrix<3>&,
                            double, int);
template Vector<2> surface_normal<2>(const PairList&, std::span<const Vector<2>>, std::span<const std::uint8_t>, int);
template Vector<3> surface_normal<3>(const PairList&, std::span<const Vector<3>>, std::span<const std::uint8_t>, int);
template double surface_depth<3>(std::span<const int>, std::span<const Vector<3>>, std::span<const Vector<3>>,
                                 std::span<const std::uint8_t>, std::span<const double>, double, int);

}  // namespace impinge
