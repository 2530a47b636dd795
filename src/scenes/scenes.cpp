#include "impinge/scenes/scenes.hpp"

#include "impinge/core/errors.hpp"

namespace impinge {

template <int Dim>
Scene<Dim> make_scene(const MethodSettings& method, const SceneSettings& scene) {
  if (scene.geometry == SceneType::tank) return make_tank<Dim>(method, scene.tank, scene.regions);
  if (scene.geometry == SceneType::periodic_box) return make_periodic_box<Dim>(method, scene.periodic_box);
  if (scene.geometry == SceneType::scene) return make_open_scene<Dim>(method, scene.domain, scene.regions);
  if constexpr (Dim == 2) {
    return make_jet(method, scene.jet, scene.plate);
  } else {
    throw InputError({"geometry = \"jet\" exists in two dimensions only"});
  }
}

template <int Dim>
Scene<Dim> make_open_scene(const MethodSettings& method, const DomainSettings& domain,
                           const std::vector<FluidRegion>& regions) {
  Scene<Dim> scene;
  for (int k = 0; k < Dim; ++k) {
    scene.bounds.low[k] = domain.low[static_cast<std::size_t>(k)];
    scene.bounds.high[k] = domain.high[static_cast<std::size_t>(k)];
  }
  const std::vector<PlacedRegion<Dim>> fluid = placed<Dim>(regions, method.particles.spacing);
  scene.next_id = count_points(fluid);
  scene.fill = [fluid, bounds = scene.bounds](int rank, int ranks, Particles<Dim>& particles) {
    const auto is_inside = [&](const Vector<Dim>& position) {
      for (int k = 0; k < Dim; ++k)
        if (position[k] < bounds.low[k] || position[k] >= bounds.high[k]) return false;
      return true;
    };
    fill_regions<Dim>(fluid, 0, rank, ranks, is_inside, particles);
  };
  return scene;
}

template Scene<2> make_open_scene(const MethodSettings&, const DomainSettings&, const std::vector<FluidRegion>&);
template Scene<3> make_open_scene(const MethodSettings&, const DomainSettings&, const std::vector<FluidRegion>&);
template Scene<2> make_scene(const MethodSettings&, const SceneSettings&);
template Scene<3> make_scene(const MethodSettings&, const SceneSettings&);

}  // namespace impinge
