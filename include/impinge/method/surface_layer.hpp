#pragma once
// How deep below the free surface its particles are; docs/method.md (16b).

#include <cstdint>
#include <span>

#include "impinge/core/vector.hpp"
#include "impinge/particles/neighbours.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

/// The layer of particles at the free surface. On the lattice their centres are half a spacing deep. A layer keeps its
/// volume: where its particles stand closer along the surface, it is thicker. Without that, waves are too slow by an
/// error of first order, and lose energy.
template <int Dim>
class SurfaceLayer {
 public:
  /// What is read of owned particles, halo and images. Lengths in m.
  struct View {
    const PairList& near;
    std::span<const Vector<Dim>> position, asymmetry;
    std::span<const std::uint8_t> free_surface;
    std::span<const ParticleType> type;
    double spacing;
  };

  /// `radius`: of the weights along the surface [dp].
  explicit SurfaceLayer(double radius);

  /// Depth of a surface particle [dp], between 0.3 and 0.7: dp/2 (1 + f^3 (c - 1 + dp/4 div n)). c is the sum of
  /// weights along the surface over that of the lattice, f the flatness. div n, of the surface's normals, is there
  /// because in a bend the layer's middle is slower than its surface, by dp/2 times the curvature.
  double depth(const View& view, int i) const;

  /// Mean of the depths of a surface particle and those around it [dp].
  double mean(const View& view, std::span<const double> depth, int i) const;

 private:
  /// Calls use(j, weight, offset along the surface [dp]) for the particles of the layer around one of its own.
  template <class Use>
  void for_layer(const View& view, int i, Use&& use) const;
  double weight(double distance) const;

  double radius_, whole_;  // [dp]; sum of weights on the lattice
};

}  // namespace impinge
