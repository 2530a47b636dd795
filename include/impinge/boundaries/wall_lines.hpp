#pragma once
// The walls of a scene in two dimensions.

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "impinge/boundaries/face.hpp"
#include "impinge/boundaries/wall.hpp"
#include "impinge/boundaries/wall_motions.hpp"
#include "impinge/core/vector.hpp"

namespace impinge {

/// Planes that have no end, then the faces of walls: segments and arcs. A plate that is wet on both
/// sides has two faces. A line may touch a wall at its end only.
///
/// Where a line passes an edge, one particle's image ends and another's begins. Unless the two coincide, as in corners
/// of 180/n degrees, both fade: by 1/2 + s/(2 d), with s the edge's distance from the line and d a quarter of a
/// spacing.
template <>
class WallFaces<2> {
 public:
  WallFaces() = default;

  /// `reach`: largest radius of a sum over neighbours [m]; `spacing`: dp [m].
  WallFaces(const std::vector<Face<2>>& planes, const std::vector<Wall<2>>& walls, double reach, double spacing);

  /// Moves the walls to where they are at a time [s]. Their velocity is that at another time.
  void move_to(double time, double velocity_time);
  /// The motion that all walls share; none where they are at rest or move apart.
  const Motion<2>* common_motion() const;
  /// Of the walls' ends and the farthest points of their circles at a time [s] [m/s].
  double largest_speed(double time) const;
  bool any_moves() const { return !motions_.empty(); }

  int count() const { return static_cast<int>(faces_.size()); }
  bool is_flat(int face) const { return at(face).radius == 0.0; }
  /// True for the two sides of a plate.
  bool is_partner(int face, int other) const { return at(face).partner == other; }
  bool has_ends(int face) const { return at(face).vertex[0] >= 0; }
  bool has_curves() const {
    return std::ranges::any_of(faces_, [](const FaceData& face) { return face.radius > 0.0; });
  }
  bool has_lines() const { return std::ranges::any_of(faces_, &FaceData::is_open); }
  bool slips(int face) const { return at(face).slip; }

  /// The faces that may be nearer to a position than twice the reach.
  std::span<const int> around(const Vector<2>& x) const;

  /// Distance of a position to the plane or circle that a face is part of, positive on its wet side [m].
  double height(int face, const Vector<2>& x) const;
  /// Distance to the face itself, not negative [m].
  double distance(int face, const Vector<2>& x) const;
  /// Where an arc is nearest to a position before it, nearer than the reach; false where it is not.
  bool find_foot(int face, const Vector<2>& x, Foot<2>& foot) const;
  /// Where the path from one position to another by an arc meets it.
  Meeting<2> meeting(int face, const Vector<2>& one, const Foot<2>& foot, const Vector<2>& two,
                     const Foot<2>& other_foot) const;
  /// True where a point of an arc has not gone over its end.
  bool holds(int face, const Vector<2>& point) const { return covers(at(face), point); }
  /// The plane of a flat face.
  Face<2> plane(int face) const { return {at(face).point, at(face).normal}; }

  /// Velocity and acceleration of the wall's material at a position [m/s], [m/s^2].
  Vector<2> velocity(int face, const Vector<2>& x) const { return motions_.velocity(at(face).motion, x); }
  Vector<2> acceleration(int face, const Vector<2>& x) const { return motions_.acceleration(at(face).motion, x); }
  /// Omega x a velocity, with the wall's rate of turning [m/s^2].
  Vector<2> turning(int face, const Vector<2>& velocity) const { return motions_.turning(at(face).motion, velocity); }
  bool moves(int face) const { return at(face).motion >= 0; }

  /// True for a position on the dry side of a line that is wet on one side, nearer than the reach.
  bool is_behind(int face, const Vector<2>& x) const;
  /// Appends the faces nearer to a position than twice the reach.
  void append_near(const Vector<2>& x, std::vector<NearFace>& near) const;
  /// True if a path between two particles near a face, straight or reflected elsewhere, may meet the face or pass
  /// its ends; `length`: of the path [m].
  bool may_meet(const NearFace& one, const NearFace& other, double length, bool is_straight) const;
  /// False where every line to a neighbour and to an image of one is free.
  bool has_tests(const Vector<2>& x, std::span<const NearFace> near) const;
  /// What faces leave of the straight line between two positions: 1 if it is free, 0 if not [-].
  double line_factor(const Vector<2>& from, const Vector<2>& to, std::span<const int> faces) const;
  /// Likewise of a line that is reflected at the faces of a path; `image`: where it ends if it is unfolded.
  /// `plane`: of a path over an arc, which touches it.
  double path_factor(const Vector<2>& from, const Vector<2>& image, const MirrorPath& path, const Face<2>& plane,
                     std::span<const int> faces) const;

  /// The way of a particle from where it was before the walls moved to where it shall be: reflected at every face that
  /// it meets, and its velocity with it.
  void confine(const Vector<2>& from, Vector<2>& to, Vector<2>& velocity) const;

 private:
  struct FaceData {
    Vector<2> point;   ///< begin of a segment
    Vector<2> normal;  ///< into the fluid; of flat faces
    Vector<2> center;  ///< of an arc
    double radius = 0.0;
    double bulge = 0.0;                 ///< of an arc: 1 where its centre is on the dry side, else -1
    double sweep = 0.0;                 ///< of an arc from begin to end, counter-clockwise positive [rad]
    std::array<int, 2> vertex{-1, -1};  ///< begin, end: the fluid is on the left of the way; -1: no end
    int partner = -1;                   ///< the face on the other side of a plate
    int motion = -1;
    bool slip = false;
    bool is_open = false;  ///< of a line: there may be fluid on the dry side
  };
  /// The fluid beside an end of a face, from the face to the next one around the vertex.
  struct Sector {
    int face;
    double sense;        ///< in which it follows the face: 1 counter-clockwise
    Vector<2> along;     ///< from the vertex along the face
    Vector<2> bisector;  ///< of the sector
    double angle;        ///< of the sector [rad]
    int neighbour;       ///< the face on its other side; -1: none
    bool fades;          ///< lines by the vertex fade
  };
  struct Vertex {
    Vector<2> place;
    std::vector<Sector> sectors;
    bool is_covered = false;  ///< by another face, so that nothing passes there
  };

  const FaceData& at(int face) const { return faces_[static_cast<std::size_t>(face)]; }
  const Vertex& vertex(int face, int end) const {
    return vertices_[static_cast<std::size_t>(at(face).vertex[static_cast<std::size_t>(end)])];
  }
  void add_wall(const Wall<2>& wall);
  int add_vertex(const Vector<2>& place, int motion);
  void find_sectors();
  void cover_vertices();
  void arrange();
  Vector<2> tangent(const FaceData& face, int end) const;
  const Sector* sector_of(const Vertex& vertex, int face) const;
  bool fades(int face, int end) const;
  bool covers(const FaceData& face, const Vector<2>& x) const;
  bool crosses(int face, const Vector<2>& from, const Vector<2>& to, double since, double until) const;
  double leg_factor(const Vector<2>& from, const Vector<2>& to, double since, double until, std::span<const int> near,
                    std::span<const int> skipped, std::span<const int> skipped_vertices) const;
  bool first_hit(const Vector<2>& from, const Vector<2>& to, int skipped, int& face, double& share) const;

  std::vector<FaceData> rest_, faces_;  // in the rest pose; as they stand
  std::vector<Vertex> rest_vertices_, vertices_;
  std::vector<int> vertex_motion_;
  WallMotions<2> motions_;
  double reach_ = 0.0;
  double spacing_ = 0.0;
  // Cells of faces: a box around all that have ends.
  Vector<2> low_;
  double edge_ = 1.0;
  std::array<int, 2> extent_{};
  std::vector<std::vector<int>> cell_;
  std::vector<int> planes_;
};

}  // namespace impinge
