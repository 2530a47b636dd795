#include "impinge/observe/fluid_value.hpp"

#include <cmath>

#include "impinge/particles/kernel.hpp"

namespace impinge {
namespace {

// Places in the sums.
constexpr std::size_t near = 0, weight = 1, first = 2;
template <int Dim>
constexpr std::size_t second = first + Dim;
template <int Dim>
constexpr std::size_t quantity(int q) {
  return second<Dim> + Dim * Dim + static_cast<std::size_t>(q) * (Dim + 1);
}

template <int Dim>
double& component(FluidValue<Dim>& value, int q) {
  return q == 0 ? value.pressure : value.velocity.component[static_cast<std::size_t>(q - 1)];
}

}  // namespace

template <int Dim>
void FluidFit<Dim>::add(const Vector<Dim>& offset, const FluidValue<Dim>& value) {
  const double r = norm(offset);
  const double w = NonSingularKernel::weight(r, radius);
  if (w == 0.0) return;
  if (r < in_fluid) sums[near] += 1.0;
  sums[weight] += w;
  for (int k = 0; k < Dim; ++k) {
    sums[first + static_cast<std::size_t>(k)] += w * offset[k];
    for (int l = 0; l < Dim; ++l)
      sums[second<Dim> + static_cast<std::size_t>(k * Dim + l)] += w * offset[k] * offset[l];
  }
  for (int q = 0; q <= Dim; ++q) {
    const double x = q == 0 ? value.pressure : value.velocity[q - 1];
    sums[quantity<Dim>(q)] += w * x;
    for (int k = 0; k < Dim; ++k) sums[quantity<Dim>(q) + 1 + static_cast<std::size_t>(k)] += w * x * offset[k];
  }
}

template <int Dim>
std::optional<FluidValue<Dim>> FluidFit<Dim>::value() const {
  const double w = sums[weight];
  if (w == 0.0) return {};
  Vector<Dim> mean;  // offset
  for (int k = 0; k < Dim; ++k) mean[k] = sums[first + static_cast<std::size_t>(k)] / w;
  Matrix<Dim> spread;  // covariance of the offsets
  for (int k = 0; k < Dim; ++k)
    for (int l = 0; l < Dim; ++l)
      spread.row[static_cast<std::size_t>(k)][l] =
          sums[second<Dim> + static_cast<std::size_t>(k * Dim + l)] / w - mean[k] * mean[l];
  // About the least variance of the particles along any direction; a row of particles has none across it.
  constexpr double least_variance = 0.03;  // [dp^2]
  const double whole = determinant(spread);
  const bool linear = sums[near] > 0.0 && whole > least_variance * std::pow(trace(spread) / (Dim - 1), Dim - 1);
  const Vector<Dim> step = linear ? 1.0 / whole * (adjugate(spread) * mean) : Vector<Dim>{};
  FluidValue<Dim> result;
  for (int q = 0; q <= Dim; ++q) {
    const double mean_value = sums[quantity<Dim>(q)] / w;
    double& x = component(result, q);
    x = mean_value;
    for (int k = 0; k < Dim; ++k)
      x -= step[k] * (sums[quantity<Dim>(q) + 1 + static_cast<std::size_t>(k)] / w - mean_value * mean[k]);
  }
  return result;
}

template class FluidFit<2>;
template class FluidFit<3>;

}  // namespace impinge
