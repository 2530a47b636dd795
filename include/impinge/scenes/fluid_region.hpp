#pragma once
// Regions that are full of fluid at the start: [[fluid.region]] of a case file.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "impinge/config/key.hpp"
#include "impinge/geometry/shape.hpp"
#include "impinge/geometry/transform.hpp"
#include "impinge/particles/particles.hpp"
#include "impinge/scenes/box_lattice.hpp"
#include "impinge/scenes/shape_settings.hpp"

namespace impinge {

/// One table of [[fluid.region]]. Spin and gradient leave the point `about` of the shape as it is.
struct FluidRegion : ShapeSettings {
  std::string name;
  Numbers velocity{};            ///< at `about`, after `translate` [m/s]
  double spin = 0.0;             ///< solid rotation, in two dimensions, counter-clockwise [rad/s]
  std::vector<double> gradient;  ///< of the velocity, row by row, du_i/dx_j [1/s]; empty: none
};

/// Declares [[fluid.region]].
void declare_fluid(Keys& keys, std::vector<FluidRegion>& regions);

/// Sets names and centres that are not given. `dimension`: of space.
void derive_fluid(const Keys& keys, int dimension, std::vector<FluidRegion>& regions);

/// Notes shapes that do not exist in the dimension or have no inside, names that are used twice, regions that overlap
/// by more than a quarter of the spacing, and regions outside `room`, where the scene has fluid [m]. `spacing`: dp [m].
/// The keys of `dimension` and `spacing` are usable.
void check_fluid(Keys& keys, int dimension, double spacing, const Box<3>& room,
                 const std::vector<FluidRegion>& regions);

/// True where the region's numbers make a shape in this dimension.
bool has_shape(const FluidRegion& region, int dimension);

/// A region in its place, with its particles: the points of a lattice in the region's own frame.
template <int Dim>
class PlacedRegion {
 public:
  /// The region must have passed check_fluid. `spacing`: dp [m].
  PlacedRegion(const FluidRegion& region, double spacing);

  bool contains(const Vector<Dim>& point, double depth = 0.0) const { return distance(point) < -depth; }
  /// The smallest axis-aligned box around it, or a larger one where it is turned [m].
  Box<Dim> bounds() const;
  /// [m^2] in two dimensions, [m^3] in three.
  double volume() const { return shape_->volume(); }
  /// Particles in it.
  std::int64_t count() const;
  /// Velocity of the fluid at the start [m/s].
  Vector<Dim> velocity(const Vector<Dim>& point) const;

  /// Lattice points, those outside the region among them.
  std::int64_t points() const { return lattice_.count(); }
  /// The place of a lattice point, inside the region or not; `offset`: from the point along the lattice's axes [m].
  Vector<Dim> place(std::int64_t k, const Vector<Dim>& offset = {}) const {
    return placement_(lattice_.point(k) + offset);
  }
  /// Distance to the region's surface, negative inside [m].
  double distance(const Vector<Dim>& point) const { return shape_->distance(placement_.origin_of(point)); }
  /// The place of a lattice point; false outside the region.
  bool point(std::int64_t k, Vector<Dim>& position) const;

 private:
  std::shared_ptr<const Shape<Dim>> shape_;  // scaled
  Transform<Dim> placement_;                 // turns and moves it
  BoxLattice<Dim> lattice_;
  Vector<Dim> centre_;  // of the velocity's rotation and gradient [m]
  Vector<Dim> velocity_;
  Matrix<Dim> gradient_;  // [1/s]
};

/// Appends this rank's share of the particles of all regions, numbered from `first_id` on by their lattice points;
/// those that `keep` says no to are left out.
template <int Dim>
void fill_regions(const std::vector<PlacedRegion<Dim>>& regions, std::int64_t first_id, int rank, int ranks,
                  const std::function<bool(const Vector<Dim>&)>& keep, Particles<Dim>& particles);

/// Lattice points of all regions: as many ids.
template <int Dim>
std::int64_t count_points(const std::vector<PlacedRegion<Dim>>& regions);

template <int Dim>
std::vector<PlacedRegion<Dim>> placed(const std::vector<FluidRegion>& regions, double spacing) {
  std::vector<PlacedRegion<Dim>> result;
  for (const FluidRegion& region : regions) result.emplace_back(region, spacing);
  return result;
}

}  // namespace impinge
