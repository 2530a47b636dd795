#include <cmath>
#include <numbers>

#include "impinge/core/mpi.hpp"
#include "impinge/scenes/box_lattice.hpp"
#include "impinge/scenes/scenes.hpp"

namespace impinge {

template <int Dim>
Scene<Dim> make_periodic_box(const MethodSettings& method, const PeriodicBoxSettings& box) {
  BoxLattice<Dim> lattice{.spacing = method.particles.spacing};
  Scene<Dim> scene;
  scene.periodic.fill(true);
  for (int k = 0; k < Dim; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    scene.bounds.high[k] = box.size[axis];
    lattice.extent[axis] = std::lround(box.size[axis] / lattice.spacing);
  }
  scene.next_id = lattice.count();
  scene.fill = [=](int rank, int ranks, Particles<Dim>& particles) {
    for_share(lattice.count(), rank, ranks, [&](std::int64_t k) {
      const Vector<Dim> position = lattice.point(k);
      const double x = 2.0 * std::numbers::pi * position[0] / box.size[0];
      const double y = 2.0 * std::numbers::pi * position[1] / box.size[1];
      Vector<Dim> velocity;
      velocity[0] = (box.shear_speed - box.vortex_speed * std::cos(x)) * std::sin(y);
      velocity[1] = box.vortex_speed * box.size[1] / box.size[0] * std::sin(x) * std::cos(y);
      particles.append({position, velocity, 0.0, 0.0, k, ParticleType::fluid});
    });
  };
  return scene;
}

template Scene<2> make_periodic_box(const MethodSettings&, const PeriodicBoxSettings&);
template Scene<3> make_periodic_box(const MethodSettings&, const PeriodicBoxSettings&);

}  // namespace impinge
