#pragma once
// Surfaces in three dimensions, by facets.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "impinge/geometry/patch.hpp"
#include "impinge/geometry/shape.hpp"

namespace impinge {

/// Facets as a file or a maker of shapes gives them: corners are numbers of points [m].
struct Facets {
  std::vector<Vector<3>> points;
  std::vector<Facet> facets;
};

// Makers of shapes whose facets face outwards. The numbers must make a shape.

Facets box_facets(const Vector<3>& low, const Vector<3>& high);
Facets sphere_facets(const Vector<3>& center, double radius);
/// A cylinder or a cone, cut off or not, with its ends: from one point with its radius to another. One of the radii may
/// be 0.
Facets cone_facets(const Vector<3>& begin, const Vector<3>& end, double radius, double end_radius);
/// A flat polygon, seen counter-clockwise from the side that it faces; nothing, and what is wrong, if the points make
/// none.
std::optional<Facets> polygon_facets(const std::vector<Vector<3>>& points, std::vector<std::string>& mistakes);

/// Facets joined to a surface. A closed one faces out of what it encloses; an open one has no inside: its distance is
/// not negative, its volume 0.
class Mesh final : public Shape<3> {
 public:
  /// A sharp edge between patches.
  struct Edge {
    Vector<3> begin, end;  ///< [m]
    int patch;
    int other;     ///< the patch on its other side; -1: the surface ends
    double angle;  ///< between the two on the side that they face [rad]; 2 pi where the surface ends
  };

  double distance(const Vector<3>& point) const override;
  Vector<3> normal(const Vector<3>& point) const override;
  Box<3> bounds() const override { return tree_.bounds(); }
  double volume() const override { return closed_ ? volume_ : 0.0; }

  bool closed() const { return closed_; }
  double area() const { return area_; }
  const std::vector<std::shared_ptr<const Patch>>& patches() const { return patches_; }
  /// Every sharp edge once for each of its patches.
  const std::vector<Edge>& edges() const { return edges_; }

  /// The point of the facets that is nearest to another, and whether that is in front of the surface there.
  struct Nearest {
    Vector<3> point;  ///< [m]
    double distance;  ///< not negative [m]
    bool is_in_front;
    bool is_at_end;  ///< of an open surface
  };
  Nearest nearest(const Vector<3>& point) const;
  /// True if a line meets a facet.
  bool meets(const Vector<3>& from, const Vector<3>& to) const;

 private:
  friend std::optional<Mesh> make_mesh(const Facets&, std::vector<std::string>&, std::vector<std::string>&);
  std::array<Vector<3>, 3> corners(int facet) const;
  void join(const std::vector<std::array<int, 3>>& neighbours);

  std::vector<Vector<3>> points_, point_normal_;
  std::vector<char> at_end_;  // per point
  std::vector<Facet> facets_;
  std::vector<std::array<Vector<3>, 3>> edge_normal_;  // per facet, of the edge that begins at corner k
  std::vector<std::array<bool, 3>> edge_ends_;
  BoxTree tree_;
  std::vector<std::shared_ptr<const Patch>> patches_;
  std::vector<Edge> edges_;
  bool closed_ = true;
  double volume_ = 0.0, area_ = 0.0;
};

/// Joins facets to a surface: points that coincide are one, facets without area are left out, those of a closed surface
/// are turned outwards. Facets that meet at less than 20 degrees are one patch. Nothing, and what is wrong, if a facet
/// is there twice, an edge has more than two, two neighbours face opposite sides, or facets cross each other; facets
/// are named by their numbers from 1 on. `warnings`: what was left out.
std::optional<Mesh> make_mesh(const Facets& facets, std::vector<std::string>& mistakes,
                              std::vector<std::string>& warnings);

}  // namespace impinge
