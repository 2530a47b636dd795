#pragma once
// A cloud with its pairs, for the tests of what runs over them.

#include "cloud.hpp"
#include "impinge/method/operators.hpp"
#include "impinge/particles/kernel.hpp"
#include "impinge/particles/neighbours.hpp"

namespace impinge {

constexpr double near_radius = 2.1;
constexpr double far_radius = 4.01;
constexpr int reach = 2;

constexpr auto all_kernels = [] {
  std::array<KernelType, std::tuple_size_v<Kernels>> types{};
  for (std::size_t k = 0; k < types.size(); ++k) types[k] = KernelType{static_cast<int>(k)};
  return types;
}();

/// A cloud with its pairs.
template <int Dim>
struct Cloud {
  static constexpr std::array<int, Dim> extent() {
    std::array<int, Dim> points;
    points.fill(11);
    return points;
  }

  explicit Cloud(double jitter, KernelType kernel = KernelType::non_singular)
      : sums(lattice_sums<Dim>(kernel, near_radius)), far_sums(lattice_sums<Dim>(kernel, far_radius)) {
    Box<Dim> box;
    for (int k = 0; k < Dim; ++k) box.high[k] = extent()[static_cast<std::size_t>(k)];
    const auto cells = CellGrid<Dim>(box, {}, far_radius).refined(reach);
    particles = sorted(cells, make_cloud<Dim>(extent(), jitter), [](const auto&) { return true; });
    NeighbourSearch<Dim> search(cells, reach, kernel, near_radius, far_radius);
    search.search(particles);
    near = search.near();
    far = far_list(search);
  }

  /// The particle nearest to a point.
  int at(const Vector<Dim>& point) const {
    int nearest = 0;
    for (int i = 0; i < particles.owned; ++i)
      if (distance(i, point) < distance(nearest, point)) nearest = i;
    return nearest;
  }
  double distance(int i, const Vector<Dim>& point) const {
    return norm(particles.position[static_cast<std::size_t>(i)] - point);
  }

  PairRow far_row(int i) const {
    const auto begin = static_cast<std::size_t>(far.begin(i)), count = static_cast<std::size_t>(far.end(i)) - begin;
    return {{far.index.data() + begin, count}, {far.weight.data() + begin, count}};
  }

  int centre() const {
    Vector<Dim> middle;
    for (int k = 0; k < Dim; ++k) middle[k] = 5.5;
    return at(middle);
  }

  /// In the middle of the top, with the normal along the last axis.
  int on_surface() const {
    Vector<Dim> top;
    for (int k = 0; k < Dim; ++k) top[k] = k == Dim - 1 ? 10.5 : 5.5;
    return at(top);
  }

  Vector<Dim> asymmetry_of(int i) const { return asymmetry<Dim>(near, particles.position, sums.number_density, i); }

  /// The sum of pressure_gradient over all particles.
  Vector<Dim> gradient_sum() const {
    Vector<Dim> sum;
    for (int i = 0; i < particles.owned; ++i) sum += gradient(i);
    return sum;
  }
  Vector<Dim> gradient(int i) const {
    const std::vector<Vector<Dim>> no_wall(particles.type.size());
    return pressure_gradient<Dim>(near, particles.position, particles.pressure, particles.type, no_wall,
                                  sums.number_density, i);
  }

  LatticeSums sums, far_sums;
  Particles<Dim> particles;
  PairList near, far;
};

}  // namespace impinge
