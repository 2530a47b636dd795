#include "impinge/method/surface_layer.hpp"

#include <algorithm>
#include <cmath>

#include "impinge/method/surface.hpp"

namespace impinge {
namespace {

constexpr double thickness = 1.5;  // of what counts as one layer [dp]
// Of its thickness: the tables of the closure begin at the least depth.
constexpr double most_stretch = 1.0 - SurfaceClosure<2>::least_depth / SurfaceClosure<2>::usual_depth;

}  // namespace

template <int Dim>
SurfaceLayer<Dim>::SurfaceLayer(double radius) : radius_(radius), whole_(0.0) {
  const int reach = static_cast<int>(std::ceil(radius));
  for (int x = -reach; x <= reach; ++x)
    for (int z = Dim == 2 ? 0 : -reach; z <= (Dim == 2 ? 0 : reach); ++z) whole_ += weight(std::hypot(x, z));
}

template <int Dim>
double SurfaceLayer<Dim>::weight(double distance) const {
  const double rest = std::max(1.0 - distance / radius_, 0.0);
  return std::pow(rest, 4) * (5.0 - 4.0 * rest);
}

template <int Dim>
template <class Use>
void SurfaceLayer<Dim>::for_layer(const View& view, int i, Use&& use) const {
  const auto self = static_cast<std::size_t>(i);
  const Vector<Dim> normal = 1.0 / norm(view.asymmetry[self]) * view.asymmetry[self];
  for (const int neighbour : view.near.row(i)) {
    const auto j = static_cast<std::size_t>(neighbour);
    const bool enters = j < view.type.size() && view.type[j] == ParticleType::inlet;
    if (!view.free_surface[j] && !enters) continue;
    const Vector<Dim> offset = 1.0 / view.spacing * (view.position[j] - view.position[self]);
    const double height = dot(offset, normal);
    if (std::abs(height) > 0.5 * thickness) continue;
    const Vector<Dim> along = offset - height * normal;
    use(j, weight(norm(along)), along);
  }
}

template <int Dim>
double SurfaceLayer<Dim>::depth(const View& view, int i) const {
  constexpr double usual = SurfaceClosure<Dim>::usual_depth;
  const auto self = static_cast<std::size_t>(i);
  const double size = norm(view.asymmetry[self]);
  if (size == 0.0) return usual;
  const Vector<Dim> normal = 1.0 / size * view.asymmetry[self];
  double weights = weight(0.0), turn = 0.0, squares = 0.0;
  for_layer(view, i, [&](std::size_t j, double w, const Vector<Dim>& along) {
    weights += w;
    const double other = norm(view.asymmetry[j]);
    if (!view.free_surface[j] || other == 0.0) return;
    turn += w * dot(1.0 / other * view.asymmetry[j] - normal, along);
    squares += w * dot(along, along);
  });
  const double bend = squares > 0.0 ? (Dim - 1) * turn / squares : 0.0;  // [1/dp]
  const double flatness = surface_flatness<Dim>(view.near, view.asymmetry, view.free_surface, i);
  const double stretch = std::clamp(weights / whole_ - 1.0 + 0.25 * bend, -most_stretch, most_stretch);
  return usual * (1.0 + std::pow(flatness, 3) * stretch);
}

template <int Dim>
double SurfaceLayer<Dim>::mean(const View& view, std::span<const double> depth, int i) const {
  const auto self = static_cast<std::size_t>(i);
  if (view.asymmetry[self] == Vector<Dim>{}) return depth[self];
  double weights = weight(0.0), sum = weights * depth[self];
  for_layer(view, i, [&](std::size_t j, double w, const Vector<Dim>&) {
    if (!view.free_surface[j]) return;
    weights += w;
    sum += w * depth[j];
  });
  return sum / weights;
}

template class SurfaceLayer<2>;
template class SurfaceLayer<3>;

}  // namespace impinge
