#pragma once
// What the walls leave of a region of fluid.

#include <cstdint>
#include <vector>

#include "impinge/scenes/fluid_region.hpp"
#include "impinge/scenes/wet_space.hpp"

namespace impinge {

/// Lattice points of a region between walls, as many as the volume between them holds: of the cells that a wall cuts,
/// those whose points stand deepest in the fluid. Points too near to a wall are moved away from it.
template <int Dim>
class RegionBetweenWalls {
 public:
  /// `spacing`: dp [m].
  RegionBetweenWalls(const PlacedRegion<Dim>& region, const WetSpace<Dim>& wet, double spacing);

  /// Of the region between the walls, to some parts in a thousand of the cells at its edges [m^2], [m^3].
  double volume() const;
  /// Particles.
  std::int64_t count() const { return count_; }
  /// The place of a lattice point; false where there is none.
  bool point(std::int64_t k, Vector<Dim>& position) const;
  /// True where the points beside the walls are no lattice.
  bool is_cut() const { return is_cut_; }

 private:
  struct Point {
    std::int64_t number;
    Vector<Dim> position;
  };
  bool is_near(const Vector<Dim>& position) const { return wet_.depth(position) < spacing_; }

  PlacedRegion<Dim> region_;
  WetSpace<Dim> wet_;
  double spacing_;
  std::vector<Point> near_;  // the points beside walls, by number
  std::int64_t count_ = 0;
  bool is_cut_ = false;
};

}  // namespace impinge
