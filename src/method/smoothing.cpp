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
  for (std::size_t i = 0; i < state.owned(); ++i) {
    const Matrix<Dim>& correction = state.correction[i];
    if (!state.moves(i) || is_spray(particles, n0, i) || correction == Matrix<Dim>{}) continue;
    gradient[i] = velocity_gradient<Dim>(state.near(), particles.position, particles.velocity, state.wall_normal,
                                         correction, n0, static_cast<int>(i));
    if (!particles.free_surface[i]) continue;
    const Matrix<Dim> left = gradient_to_images_left<Dim>(state.near(), particles.position, particles.velocity,
                                                          correction, n0, gradient.size(), static_cast<int>(i));
    for (std::size_t k = 0; k < Dim; ++k) gradient[i].row[k] -= left.row[k];
  }
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
