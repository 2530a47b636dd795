#pragma once
// Zero pressure where the free surface is: half a spacing outside the centres of the surface particles; docs/method.md
// (16).

#include <cstdint>
#include <span>
#include <vector>

#include "impinge/core/vector.hpp"
#include "impinge/particles/kernel.hpp"
#include "impinge/particles/neighbours.hpp"

namespace impinge {

/// What a particle misses beyond a flat free surface, of the lattice that would go on there. Of the Laplacian: a
/// pressure that is zero at the surface and curved by S along its normal is -p_i d_g/d_i + S/2 d_g (d_g + d_i) at a
/// lattice point at the height d_g above it. The missing pairs are the flux -p_i sum W (1 + d_g/d_i), a weight on the
/// diagonal, and S sum W d_g (d_g + d_i)/2, which is known. Of the packing: the sum over the points.
template <int Dim>
class SurfaceClosure {
 public:
  /// Depth of a surface particle below the surface on the lattice, and the least that there is [dp].
  static constexpr double usual_depth = 0.5, least_depth = 0.3;

  /// Radii of Laplacian and packing [dp].
  SurfaceClosure(KernelType type, double laplacian_radius, double packing_radius);

  /// The weight [-] at a depth [dp], interpolated in a table; 0 where nothing is missing.
  double weight(double depth) const { return at_depth(weight_, depth); }
  /// The flux that is known over the curvature S of the pressure [dp^2].
  double flux_of_curvature(double depth) const { return at_depth(curvature_, depth); }
  /// Likewise the packing [-].
  double packing(double depth) const { return at_depth(packing_, depth); }

 private:
  static double at_depth(const std::vector<double>& table, double depth);

  std::vector<double> weight_, curvature_, packing_;  // at least_depth, one step deeper, ...
};

/// Depth of particle i below the free surface [dp]: that of `layer` for a surface particle. For others, at least
/// usual_depth, its distance to the planes at these depths outside the surface particles around, their normals along
/// the asymmetries; the mean with weights 1/r_ij^6, so that around a bend the nearest count; infinite without any.
/// `spacing`: dp [m]. Reads positions, asymmetries, surface marks and depths of owned particles, halo and images.
template <int Dim>
double surface_depth(std::span<const int> around, std::span<const Vector<Dim>> position,
                     std::span<const Vector<Dim>> asymmetry, std::span<const std::uint8_t> free_surface,
                     std::span<const double> layer, double spacing, int i);

/// Flatness of the free surface at particle i [0, 1], from the unit normals n_j (along the asymmetries) of the surface
/// particles among it and its neighbours: 0 up to |sum n_j| = 0.8 of their number, 1 from 0.95 on, linear between; 1
/// without any, 0 for a surface particle alone.
template <int Dim>
double surface_flatness(const PairList& near, std::span<const Vector<Dim>> asymmetry,
                        std::span<const std::uint8_t> free_surface, int i);

/// True where a surface particle is in the row of particle i.
bool is_beside_surface(const PairList& near, std::span<const std::uint8_t> free_surface, int i);

/// Disorder of the motion around particle i [0, 1]: 0 where no neighbour's velocity is off the linear field around the
/// particle by more than 0.05 fall speeds, 1 from 0.2 on, linear between. `slope`: of the velocity [1/s]; `fall_speed`
/// [m/s].
template <int Dim>
double disorder(const PairList& near, std::span<const Vector<Dim>> position, std::span<const Vector<Dim>> velocity,
                const Matrix<Dim>& slope, double fall_speed, int i);

/// Unit normal of the free surface at particle i, out of the fluid, from the asymmetries of the surface particles among
/// it and its neighbours, weighted; zero without any.
template <int Dim>
Vector<Dim> surface_normal(const PairList& near, std::span<const Vector<Dim>> asymmetry,
                           std::span<const std::uint8_t> free_surface, int i);

}  // namespace impinge
