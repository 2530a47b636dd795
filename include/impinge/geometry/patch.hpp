#pragma once
// A smooth piece of a surface in three dimensions: a polygon, or facets that stand for a curved surface.

#include <array>
#include <vector>

#include "impinge/core/vector.hpp"
#include "impinge/geometry/box_tree.hpp"

namespace impinge {

/// The corners of a facet, counter-clockwise as seen from the side that it faces.
using Facet = std::array<int, 3>;

/// The point of a facet that is nearest to another.
struct FacetPoint {
  Vector<3> point;              ///< [m]
  std::array<double, 3> share;  ///< point = sum of share and corner; not negative [-]
};
FacetPoint nearest_on_facet(const std::array<Vector<3>, 3>& corner, const Vector<3>& x);

/// Where a patch is nearest to a point x. Beyond its edges the patch goes on along the plane that touches it there.
struct PatchPoint {
  Vector<3> point;      ///< [m]
  Vector<3> normal;     ///< there; a unit vector [-]
  double height = 0.0;  ///< (x - point).normal [m]
  double beyond = 0.0;  ///< distance of the point from the patch's edges, 0 on the patch [m]
  Matrix<3> bending;    ///< slope of the normal along the patch: the principal curvatures, positive where it bulges
                        ///< to the side that it faces [1/m]
};

/// Facets that meet without a sharp edge. Those of a curved surface have its normals at their corners; the surface
/// between them is that of Phong tessellation (Boubekeur & Alexa 2008) with a share of one half, which is exact to
/// second order.
class Patch {
 public:
  /// The facets' corners are numbers of `points` [m].
  Patch(const std::vector<Vector<3>>& points, const std::vector<Facet>& facets);

  bool is_flat() const { return flat_; }
  /// Of a flat patch.
  const Vector<3>& normal() const { return normal_; }
  const Vector<3>& origin() const { return corner_.front(); }
  /// The largest curvature towards the side that it faces, or the other; not negative [1/m].
  double bulge(bool front) const { return front ? front_bulge_ : back_bulge_; }
  const BoxTree& tree() const { return tree_; }
  const std::vector<Vector<3>>& points() const { return corner_; }
  const std::vector<Facet>& facets() const { return facet_; }

  PatchPoint nearest(const Vector<3>& x) const;
  /// Distance to the facets; the limit if it is larger [m].
  double distance(const Vector<3>& x, double limit) const;

 private:
  struct Place {
    int facet = -1;
    FacetPoint at;
    double square = 0.0;
  };
  std::array<Vector<3>, 3> corners(int facet) const {
    const Facet& f = facet_[static_cast<std::size_t>(facet)];
    return {corner_[static_cast<std::size_t>(f[0])], corner_[static_cast<std::size_t>(f[1])],
            corner_[static_cast<std::size_t>(f[2])]};
  }
  void find_normals();
  Place nearest_facet(const Vector<3>& x, double square, int first = -1) const;

  std::vector<Vector<3>> corner_, corner_normal_;
  std::vector<Matrix<3>> corner_bending_;
  std::vector<Facet> facet_;
  BoxTree tree_;
  bool flat_ = true;
  Vector<3> normal_;
  double front_bulge_ = 0.0, back_bulge_ = 0.0;
};

}  // namespace impinge
