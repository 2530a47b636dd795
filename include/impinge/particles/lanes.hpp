#pragma once
// Several pairs of a particle at a time, in the lanes of the processor's vectors.

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "impinge/core/vector.hpp"
#include "impinge/particles/neighbours.hpp"

namespace impinge {

/// One number for each of eight pairs: GCC's and Clang's vectors, which every processor has in some way.
using Lanes [[gnu::vector_size(64)]] = double;
constexpr int lane_count = 8;

/// A number of each lane.
template <class Value>
[[gnu::always_inline]] inline Lanes by_lane(Value&& value) {
  return Lanes{value(0), value(1), value(2), value(3), value(4), value(5), value(6), value(7)};
}

/// Calls use(j, W_ij) for the pairs of particle i, several at a time: their indices and weights. The lanes that are
/// left at the row's end repeat its first pair with weight 0. `use` must be inlined for the sums to stay in registers.
template <class Use>
[[gnu::always_inline]] inline void for_lanes(const PairList& list, int i, Use&& use) {
  const int begin = list.begin(i), end = list.end(i);
  const int* const index = list.index.data();
  const double* const weight = list.weight.data();
  for (int k = begin; k < end; k += lane_count) {
    const int count = std::min(lane_count, end - k);
    std::array<int, lane_count> rest;
    std::array<double, lane_count> rest_weight{};
    if (count < lane_count) {
      rest.fill(index[begin]);
      std::copy_n(index + k, count, rest.begin());
      std::copy_n(weight + k, count, rest_weight.begin());
    }
    const int* const j = count < lane_count ? rest.data() : index + k;
    const double* const w = count < lane_count ? rest_weight.data() : weight + k;
    use(j, by_lane([w](int lane) { return w[lane]; }));
  }
}

/// The values of a field at some particles.
[[gnu::always_inline]] inline Lanes gathered(std::span<const double> field, const int* j) {
  return by_lane([&](int lane) { return field[static_cast<std::size_t>(j[lane])]; });
}
template <int Dim>
[[gnu::always_inline]] inline Vector<Dim, Lanes> gathered(std::span<const Vector<Dim>> field, const int* j) {
  Vector<Dim, Lanes> result;
  for (int k = 0; k < Dim; ++k)
    result[k] = by_lane([&](int lane) { return field[static_cast<std::size_t>(j[lane])][k]; });
  return result;
}

/// The same value in every lane.
template <int Dim>
[[gnu::always_inline]] inline Vector<Dim, Lanes> spread(const Vector<Dim>& value) {
  Vector<Dim, Lanes> result;
  for (int k = 0; k < Dim; ++k) result[k] = Lanes{} + value[k];
  return result;
}

[[gnu::always_inline]] inline Lanes square_root(const Lanes& square) {
  return by_lane([&](int lane) { return std::sqrt(square[lane]); });
}

/// The sum over the lanes.
[[gnu::always_inline]] inline double reduced(const Lanes& lanes) {
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}
template <int Dim>
[[gnu::always_inline]] inline Vector<Dim> reduced(const Vector<Dim, Lanes>& lanes) {
  Vector<Dim> result;
  for (int k = 0; k < Dim; ++k) result[k] = reduced(lanes[k]);
  return result;
}
template <int Dim>
[[gnu::always_inline]] inline Matrix<Dim> reduced(const Matrix<Dim, Lanes>& lanes) {
  Matrix<Dim> result;
  for (std::size_t k = 0; k < Dim; ++k) result.row[k] = reduced(lanes.row[k]);
  return result;
}

}  // namespace impinge
