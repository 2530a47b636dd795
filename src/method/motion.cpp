#include "impinge/method/motion.hpp"

#include <algorithm>

#include "impinge/method/operators.hpp"

namespace impinge {
template <int Dim>
void accelerate(const MotionRule& rule, const BodyForce<Dim>& force, const DampingZones<Dim>& damping,
                std::span<const Vector<Dim>> viscous, State<Dim>& state) {
  Particles<Dim>& particles = state.particles;
  std::vector<Vector<Dim>> change(state.owned());
  for (std::size_t i = 0; i < change.size(); ++i)
    change[i] = rule.dt * force.at(particles.position[i] + rule.after * particles.velocity[i]);
  if (!damping.empty())
    for (std::size_t i = 0; i < change.size(); ++i)
      change[i] += damping.velocity_change(particles.position[i], particles.velocity[i], rule.dt);
  for (std::size_t i = 0; i < viscous.size(); ++i) change[i] += viscous[i];
  for (std::size_t i = 0; i < change.size(); ++i) {
    if (!state.moves(i)) continue;
    particles.velocity[i] += change[i];
    particles.position[i] -= rule.after * change[i];
  }
}

template <int Dim>
void collide(const CollisionSettings& settings, double spacing, double dt, State<Dim>& state) {
  if (settings.distance == 0.0) return;
  Particles<Dim>& particles = state.particles;
  state.refresh_positions();
  state.refresh_velocities();
  const double distance = settings.distance * spacing;
  double fastest = 0.0;  // of those that this rank sees
  for (const Vector<Dim>& velocity : particles.velocity) fastest = std::max(fastest, norm(velocity));
  std::vector<Vector<Dim>> change(state.owned());
  for (std::size_t i = 0; i < change.size(); ++i)
    if (state.moves(i))
      change[i] = collision<Dim>(state.near(), particles.position, particles.velocity, particles.type,
                                 state.wall_normal, dt, distance, settings.restitution, fastest, static_cast<int>(i));
  for (std::size_t i = 0; i < change.size(); ++i) particles.velocity[i] += change[i];
}

template <int Dim>
void advance(double dt, std::vector<Inlet<Dim>>& inlets, Particles<Dim>& particles) {
  for (Inlet<Dim>& inlet : inlets)
    if (inlet.blows) inlet.last_row += inlet.speed * dt;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
    if (particles.type[i] == ParticleType::fluid || particles.type[i] == ParticleType::inlet)
      particles.position[i] += dt * particles.velocity[i];
}

#define IMPINGE_INSTANTIATE(Dim)                                                               \
  template void accelerate(const MotionRule&, const BodyForce<Dim>&, const DampingZones<Dim>&, \
                           std::span<const Vector<Dim>>, State<Dim>&);                         \
  template void collide(const CollisionSettings&, double, double, State<Dim>&);                \
  template void advance(double, std::vector<Inlet<Dim>>&, Particles<Dim>&);
IMPINGE_INSTANTIATE(2)
IMPINGE_INSTANTIATE(3)
#undef IMPINGE_INSTANTIATE

}  // namespace impinge
