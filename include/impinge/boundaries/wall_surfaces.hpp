#pragma once
// The walls of a scene in three dimensions.

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "impinge/boundaries/face.hpp"
#include "impinge/boundaries/wall.hpp"
#include "impinge/boundaries/wall_motions.hpp"
#include "impinge/core/vector.hpp"

namespace impinge {

/// Planes that have no end, then the faces of walls: the patches of their surfaces, each side that is wet.
///
/// Where a line passes a sharp edge, one particle's image ends and another's begins. At edges that the fluid stands
/// around by more than 180 degrees both fade, by 1/2 + s/(2 d), with s the line's distance from the edge, negative
/// where it misses what it aims at or is blocked, and d a quarter of a spacing.
template <>
class WallFaces<3> {
 public:
  WallFaces() = default;

  /// `reach`: largest radius of a sum over neighbours [m]; `spacing`: dp [m].
  WallFaces(const std::vector<Face<3>>& planes, const std::vector<Wall<3>>& walls, double reach, double spacing);

  /// Moves the walls to where they are at a time [s]. Their velocity is that at another time.
  void move_to(double time, double velocity_time);
  /// The motion that all walls share; none where they are at rest or move apart.
  const Motion<3>* common_motion() const;
  /// No point of a wall is faster at a time [s] [m/s].
  double largest_speed(double time) const;
  bool any_moves() const { return !motions_.empty(); }

  int count() const { return static_cast<int>(faces_.size()); }
  bool is_flat(int face) const { return !at(face).patch || at(face).patch->is_flat(); }
  /// True for the two sides of a plate.
  bool is_partner(int face, int other) const { return at(face).partner == other; }
  bool has_ends(int face) const { return at(face).patch != nullptr; }
  bool has_curves() const { return has_curves_; }
  bool has_lines() const { return std::ranges::any_of(faces_, &FaceData::is_open); }
  bool slips(int face) const { return at(face).slip; }

  /// The faces that may be nearer to a position than twice the reach.
  std::span<const int> around(const Vector<3>& x) const;

  /// Distance of a position to a face or its continuation, positive on its wet side [m].
  double height(int face, const Vector<3>& x) const;
  /// Distance to the face itself, not negative; beyond twice the reach that or more [m].
  double distance(int face, const Vector<3>& x) const;
  /// Where a curved face is nearest to a position before it, nearer than the reach; false where it is not.
  bool find_foot(int face, const Vector<3>& x, Foot<3>& foot) const;
  /// Where the path from one position to another by a curved face meets it.
  Meeting<3> meeting(int, const Vector<3>& one, const Foot<3>& foot, const Vector<3>& two,
                     const Foot<3>& other_foot) const;
  /// True where a point of a face has not gone over its end.
  bool holds(int face, const Vector<3>& point) const;
  /// The plane of a flat face.
  Face<3> plane(int face) const { return at(face).plane; }

  /// Velocity and acceleration of the wall's material at a position [m/s], [m/s^2].
  Vector<3> velocity(int face, const Vector<3>& x) const { return motions_.velocity(at(face).motion, x); }
  Vector<3> acceleration(int face, const Vector<3>& x) const { return motions_.acceleration(at(face).motion, x); }
  /// Omega x a velocity, with the wall's rate of turning [m/s^2].
  Vector<3> turning(int face, const Vector<3>& velocity) const { return motions_.turning(at(face).motion, velocity); }
  bool moves(int face) const { return at(face).motion >= 0; }

  /// True for a position on the dry side of an open surface that is wet on one side, nearer than the reach.
  bool is_behind(int face, const Vector<3>& x) const;
  /// Appends the faces nearer to a position than twice the reach.
  void append_near(const Vector<3>& x, std::vector<NearFace>& near) const;
  /// True if a path between two particles near a face, straight or reflected elsewhere, may meet the face or pass
  /// its ends; `length`: of the path [m].
  bool may_meet(const NearFace& one, const NearFace& other, double length, bool is_straight) const;
  /// False where every line to a neighbour and to an image of one is free.
  bool has_tests(const Vector<3>& x, std::span<const NearFace> near) const;
  /// What faces leave of the straight line between two positions: 1 if it is free, 0 if not [-].
  double line_factor(const Vector<3>& from, const Vector<3>& to, std::span<const int> faces) const;
  /// Likewise of a line that is reflected at the faces of a path; `image`: where it ends if it is unfolded.
  /// `plane`: of a path over a curved face, which touches it.
  double path_factor(const Vector<3>& from, const Vector<3>& image, const MirrorPath& path, const Face<3>& plane,
                     std::span<const int> faces) const;

  /// The way of a particle from where it was before the walls moved to where it shall be: reflected at every face that
  /// it meets, and its velocity with it.
  void confine(const Vector<3>& from, Vector<3>& to, Vector<3>& velocity) const;

 private:
  struct FaceData {
    std::shared_ptr<const Patch> patch{};  ///< of walls, where their pose is the identity
    double side = 1.0;                     ///< 1: its front, -1: its back
    Face<3> plane;                         ///< of flat faces, as they stand
    int wall = -1;
    int partner = -1;  ///< the face on the other side of a plate
    int motion = -1;
    bool slip = false;
    bool is_open = false;  ///< of a surface wet on one side: there may be fluid on the dry side
  };
  struct EdgeData {
    Vector<3> begin, end;
    int face;
    int other;                ///< face on the edge's other side; -1: none
    bool fades;               ///< the fluid stands around it by more than 180 degrees
    bool is_right_angle;      ///< between flat faces, in the fluid
    bool is_covered = false;  ///< by another wall, so that nothing passes there
  };
  struct Cell {
    std::vector<int> faces, edges;
  };
  /// A line beside an edge.
  struct Passing {
    double apart;     ///< [m]
    double share;     ///< of the line before it
    Vector<3> place;  ///< on the edge
  };
  /// Points of edges that a line passes.
  class PassedEdges;

  const FaceData& at(int face) const { return faces_[static_cast<std::size_t>(face)]; }
  void add_wall(const Wall<3>& wall, int number);
  void arrange();
  void cover_edges();
  const Cell* cell_at(const Vector<3>& x) const;
  std::int64_t key(const std::array<std::int64_t, 3>& cell) const;
  /// The largest curvature of a face towards its wet side [1/m].
  double bulge(int face) const { return at(face).patch->bulge(at(face).side > 0.0); }
  PatchPoint nearest(int face, const Vector<3>& x) const;
  double beyond(int face, const Vector<3>& x) const;
  static Passing passing(const Vector<3>& from, const Vector<3>& to, const EdgeData& edge);
  double free_share(int face, const Vector<3>& from, const Vector<3>& to, double since, double until) const;
  double leg_factor(const Vector<3>& from, const Vector<3>& to, double since, double until, std::span<const int> near,
                    std::array<int, 2> skipped, const PassedEdges& passed) const;
  bool first_hit(const Vector<3>& from, const Vector<3>& to, int skipped, int& face, double& share) const;

  std::vector<FaceData> faces_;
  std::vector<EdgeData> rest_edges_, edges_;  // in the rest pose; as they stand
  std::vector<Box<3>> body_;                  // around the walls of each motion, in the rest pose
  WallMotions<3> motions_;
  double reach_ = 0.0;
  double spacing_ = 0.0;
  bool has_curves_ = false;
  std::vector<int> planes_;
  std::unordered_map<std::int64_t, Cell> cells_;  // those near walls
};

}  // namespace impinge
