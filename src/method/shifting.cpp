#include "impinge/method/shifting.hpp"

#include "impinge/method/density.hpp"
#include "impinge/method/operators.hpp"
#include "impinge/method/surface.hpp"

namespace impinge {

constexpr double largest_shift = 0.1;  // of a step [dp]

template <int Dim>
Shift<Dim> shift_of(const ShiftingSettings& shifting, double speed, double dt, double spacing, double n0,
                    std::span<const Matrix<Dim>> gradient, const State<Dim>& state) {
  const Particles<Dim>& particles = state.particles;
  Shift<Dim> shift{std::vector<Vector<Dim>>(state.owned()), std::vector<Vector<Dim>>(state.owned())};
  const double scale = shifting.coefficient * speed * dt;
  if (scale == 0.0) return shift;
  const double largest = largest_shift * spacing;
  std::vector<Vector<Dim>> change_by_push(state.owned());
  for (int i = 0; i < particles.owned; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (!state.moves(self) || is_spray(particles, n0, self)) continue;
    const Vector<Dim> normal = surface_normal<Dim>(state.near(), state.asymmetry, particles.free_surface, i);
    Vector<Dim> drift = scale * state.asymmetry[self], push;
    if (normal != Vector<Dim>{}) {
      drift -= dot(drift, normal) * normal;
      push =
          scale * repulsion<Dim>(state.near(), particles.position, particles.type, shifting.least_distance, spacing, i);
    }
    const double length = norm(drift + push), share = length > largest ? largest / length : 1.0;
    shift.displacement[self] = share * (drift + push);
    if (!shifting.correct_velocity) continue;
    const auto change_by = [&](const Vector<Dim>& way) {
      return limited_change<Dim>(state.near(), particles.velocity, particles.type, share * (gradient[self] * way), i);
    };
    shift.velocity_change[self] = change_by(drift);
    change_by_push[self] = change_by(push);
  }
  if (!shifting.correct_velocity || shifting.least_distance == 0.0) return shift;
  change_by_push.resize(state.role.size());
  state.decomposition.halo().refresh(change_by_push, particles.owned);
  for (int i = 0; i < particles.owned; ++i)
    if (const auto self = static_cast<std::size_t>(i); state.moves(self))
      shift.velocity_change[self] += off_mean<Dim>(state.near(), change_by_push, particles.type, n0, i);
  return shift;
}

template Shift<2> shift_of(const ShiftingSettings&, double, double, double, double, std::span<const Matrix<2>>,
                           const State<2>&);
template Shift<3> shift_of(const ShiftingSettings&, double, double, double, double, std::span<const Matrix<3>>,
                           const State<3>&);

}  // namespace impinge
