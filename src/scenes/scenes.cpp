#include "impinge/scenes/scenes.hpp"

#include "impinge/core/errors.hpp"

namespace impinge {

template <int Dim>
Scene<Dim> make_scene(const MethodSettings& method, const SceneSettings& scene) {
  if (scene.geometry == SceneType::tank) return make_tank<Dim>(method, scene.tank, scene.regions);
  if (scene.geometry == SceneType::periodic_box) return make_periodic_box<Dim>(method, scene.periodic_box);
  if (scene.geometry == SceneType::scene) return make_open_scene<Dim>(method, scene);
  if constexpr (Dim == 2) {
    return make_jet(method, scene.jet, scene.plate);
  } else {
    throw InputError({"geometry = \"jet\" exists in two dimensions only"});
  }
}

template Scene<2> make_scene(const MethodSettings&, const SceneSettings&);
template Scene<3> make_scene(const MethodSettings&, const SceneSettings&);

}  // namespace impinge
