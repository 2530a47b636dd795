#include "impinge/method/smoothing.hpp"

#include <algorithm>

#include "impinge/method/density.hpp"
#include "impinge/method/operators.hpp"

namespace impinge {

constexpr double largest_share = 0.5;  // of what is off the linear field, in a step

template <int Dim>
std::vector<Matrix<Dim>> velocity_gradients(double n0, State<Dim>& state) {
  Particles<Dim>& particles = state.particles;
  state.refresh_velocities();
  std::vector<Matrix<Dim>> gradient(state.role.size());
  for (std::size_t i = 0; i < state.owned(); ++i)
    if (state.moves(i) && !is_spray(particles, n0, i) && state.correction[i] != Matrix<Dim>{})
      gradient[i] = velocity_gradient<Dim>(state.near(), particles.position, particles.velocity, state.wall_normal,
                                           state.correction[i], n0, static_cast<int>(i));
  state.decomposition.halo().refresh(gradient, particles.owned);
  return gradient;
}

template <int Dim>
std::vector<Vector<Dim>> smoothing_of(const SmoothingSettings& smoothing, double speed, double dt, double spacing,
                                      double n0, std::span<const Matrix<Dim>> gradient, const State<Dim>& state) {
  const Particles<Dim>& particles = state.particles;
  std::vector<Vector<Dim>> change(state.owned());
  const double share = std::min(smoothing.rate * speed * dt / spacing, largest_share);
  if (share == 0.0) return change;
  for (std::size_t i = 0; i < change.size(); ++i)
    change[i] = share * off_linear<Dim>(state.near(), particles.position, particles.velocity, gradient, n0,
                                        static_cast<int>(i));
  return change;
}

#define IMPINGE_INSTANTIATE(Dim)                                                                           \
  template std::vector<Matrix<Dim>> velocity_gradients(double, State<Dim>&);                               \
  template std::vector<Vector<Dim>> smoothing_of(const SmoothingSettings&, double, double, double, double, \
                                                 std::span<const Matrix<Dim>>, const State<Dim>&);
IMPINGE_INSTANTIATE(2)
IMPINGE_INSTANTIATE(3)
#undef IMPINGE_INSTANTIATE

}  // namespace impinge
