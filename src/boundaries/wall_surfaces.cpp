#include "impinge/boundaries/wall_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace impinge {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double fade = 0.25;         // half the width over which lines by an edge fade [dp]
constexpr double same_angle = 1e-6;   // [rad]
constexpr double on_face = 1e-9;      // of a point, and between a particle and a flat face after a reflection [dp]
constexpr double on_curve = 1e-3;     // likewise at a curved one: its facets end at chords [dp]
constexpr double at_end = 1e-9;       // share of a leg that meets no wall but the one that it is reflected at
constexpr double beside = 0.25;       // a face goes on behind another at an inner edge [dp]
constexpr double rounding = 1e-15;    // of a position, over its distance from the origin
constexpr double least_depth = 0.25;  // of a line behind a curved face before it is blocked [dp]
constexpr double full_depth = 0.75;   // where it is fully [dp]
constexpr double gentle = 0.25;       // curvature of a face alone that blocks no line [1/dp]
constexpr int most_bounces = 8;       // of a particle in a step

double faded(double distance, double width) { return std::clamp(0.5 + 0.5 * distance / width, 0.0, 1.0); }

Box<3> grown(Box<3> box, double margin) {
  for (int k = 0; k < 3; ++k) {
    box.low[k] -= margin;
    box.high[k] += margin;
  }
  return box;
}

void include(Box<3>& box, const Box<3>& other) {
  for (int k = 0; k < 3; ++k) {
    box.low[k] = std::min(box.low[k], other.low[k]);
    box.high[k] = std::max(box.high[k], other.high[k]);
  }
}

/// Distance of a point from a segment [m].
double distance_to(const Vector<3>& begin, const Vector<3>& end, const Vector<3>& x) {
  const Vector<3> way = end - begin;
  const double share = std::clamp(dot(x - begin, way) / dot(way, way), 0.0, 1.0);
  return norm(x - begin - share * way);
}

}  // namespace

class WallFaces<3>::PassedEdges {
 public:
  void add(const Vector<3>& place) {
    if (count_ < place_.size()) place_[count_++] = place;
  }
  bool holds(const Vector<3>& place, double apart) const {
    return std::any_of(place_.begin(), place_.begin() + static_cast<std::ptrdiff_t>(count_),
                       [&](const Vector<3>& own) { return norm(own - place) < apart; });
  }
  /// True if one of the points is on a face.
  template <class Distance>
  bool any_on(Distance&& distance, double apart) const {
    return std::any_of(place_.begin(), place_.begin() + static_cast<std::ptrdiff_t>(count_),
                       [&](const Vector<3>& own) { return distance(own) < apart; });
  }
  /// Leaves those from a number on.
  void drop(std::size_t first) {
    std::copy(place_.begin() + static_cast<std::ptrdiff_t>(first), place_.begin() + static_cast<std::ptrdiff_t>(count_),
              place_.begin());
    count_ -= first;
  }
  std::size_t count() const { return count_; }

 private:
  std::array<Vector<3>, 8> place_;
  std::size_t count_ = 0;
};

WallFaces<3>::WallFaces(const std::vector<Face<3>>& planes, const std::vector<Wall<3>>& walls, double reach,
                        double spacing)
    : reach_(reach), spacing_(spacing) {
  for (const Face<3>& plane : planes) {
    planes_.push_back(count());
    faces_.push_back({.plane = plane});
  }
  for (std::size_t w = 0; w < walls.size(); ++w) add_wall(walls[w], static_cast<int>(w));
  edges_ = rest_edges_;
  motions_.move_to(0.0, 0.0);  // nothing has moved yet
  move_to(0.0, 0.0);
}

void WallFaces<3>::add_wall(const Wall<3>& wall, int number) {
  const int motion = motions_.add(wall.motion);
  const Mesh& mesh = *wall.surface;
  if (motion >= 0) {
    if (motion == static_cast<int>(body_.size())) body_.push_back(mesh.bounds());
    include(body_[static_cast<std::size_t>(motion)], mesh.bounds());
  }
  const int first = count();
  const bool both = wall.wet_front && wall.wet_back;
  const int sides = both ? 2 : 1;
  for (const auto& patch : mesh.patches()) {
    has_curves_ |= !patch->is_flat();
    for (const double side : {1.0, -1.0}) {
      if (!(side > 0.0 ? wall.wet_front : wall.wet_back)) continue;
      faces_.push_back({.patch = patch,
                        .side = side,
                        .plane = {patch->origin(), side * patch->normal()},
                        .wall = number,
                        .partner = both ? count() + (side > 0.0 ? 1 : -1) : -1,
                        .motion = motion,
                        .slip = wall.slip,
                        .is_open = !mesh.closed() && !both});
    }
  }
  for (const Mesh::Edge& edge : mesh.edges()) {
    for (int side = 0; side < sides; ++side) {
      const bool is_front = side == 0 && wall.wet_front;
      const double angle = edge.other < 0 || is_front ? edge.angle : 2.0 * pi - edge.angle;
      const int face = first + edge.patch * sides + side;
      const int other = edge.other < 0 ? -1 : first + edge.other * sides + side;
      const bool is_right_angle =
          other >= 0 && is_flat(face) && is_flat(other) && std::abs(angle - 0.5 * pi) < same_angle;
      rest_edges_.push_back({edge.begin, edge.end, face, other, angle > pi + same_angle, is_right_angle});
    }
  }
}

void WallFaces<3>::move_to(double time, double velocity_time) {
  motions_.move_to(time, velocity_time);
  for (FaceData& face : faces_)
    if (face.motion >= 0)
      face.plane = {motions_.in_place(face.motion, face.patch->origin()),
                    motions_.turned(face.motion, face.side * face.patch->normal())};
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const int motion = at(edges_[e].face).motion;
    if (motion < 0) continue;
    edges_[e].begin = motions_.in_place(motion, rest_edges_[e].begin);
    edges_[e].end = motions_.in_place(motion, rest_edges_[e].end);
  }
  arrange();
  cover_edges();
}

const Motion<3>* WallFaces<3>::common_motion() const {
  const bool is_common =
      !motions_.empty() && std::ranges::all_of(faces_, [](const FaceData& face) { return face.motion == 0; });
  return is_common ? motions_.motion(0).get() : nullptr;
}

// The speed of a rigid body is largest at a corner of a box around it.
double WallFaces<3>::largest_speed(double time) const {
  double largest = 0.0;
  for (int m = 0; m < motions_.count(); ++m) {
    const Pose<3> pose = (*motions_.motion(m))(time);
    for (int k = 0; k < 8; ++k)
      largest =
          std::max(largest, norm(pose.velocity_at(pose.of_position(body_[static_cast<std::size_t>(m)].corner(k)))));
  }
  return largest;
}

std::int64_t WallFaces<3>::key(const std::array<std::int64_t, 3>& cell) const {
  constexpr std::int64_t most = std::int64_t{1} << 20;
  return (cell[0] & (2 * most - 1)) | (cell[1] & (2 * most - 1)) << 21 | (cell[2] & (2 * most - 1)) << 42;
}

// Lists faces and edges of each cell: those that reach into it, made larger by twice the reach.
void WallFaces<3>::arrange() {
  cells_.clear();
  const double margin = 2.0 * reach_, half_diagonal = 0.5 * std::sqrt(3.0) * reach_;
  const auto for_cells = [&](const Box<3>& box, auto&& use) {
    std::array<std::int64_t, 3> first, last, cell;
    for (std::size_t k = 0; k < 3; ++k) {
      first[k] = static_cast<std::int64_t>(std::floor(box.low[static_cast<int>(k)] / reach_));
      last[k] = static_cast<std::int64_t>(std::floor(box.high[static_cast<int>(k)] / reach_));
    }
    for (cell[0] = first[0]; cell[0] <= last[0]; ++cell[0])
      for (cell[1] = first[1]; cell[1] <= last[1]; ++cell[1])
        for (cell[2] = first[2]; cell[2] <= last[2]; ++cell[2]) {
          Vector<3> middle;
          for (std::size_t k = 0; k < 3; ++k)
            middle[static_cast<int>(k)] = (static_cast<double>(cell[k]) + 0.5) * reach_;
          use(key(cell), middle);
        }
  };
  for (int f = static_cast<int>(planes_.size()); f < count(); ++f) {
    const FaceData& face = at(f);
    constexpr std::size_t parts = 64;
    for (const Box<3>& part : face.patch->tree().parts(parts)) {
      Box<3> box = part;
      if (face.motion >= 0) {
        const Vector<3> corner = motions_.in_place(face.motion, part.corner(0));
        box = {corner, corner};
        for (int k = 1; k < 8; ++k) {
          const Vector<3> next = motions_.in_place(face.motion, part.corner(k));
          include(box, {next, next});
        }
      }
      for_cells(grown(box, margin), [&](std::int64_t key, const Vector<3>& middle) {
        if (is_flat(f) && std::abs(face.plane.distance(middle)) > margin + half_diagonal) return;
        std::vector<int>& faces = cells_[key].faces;
        if (faces.empty()) faces = planes_;
        if (faces.empty() || faces.back() != f) faces.push_back(f);
      });
    }
  }
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const EdgeData& edge = edges_[e];
    Box<3> box{edge.begin, edge.begin};
    include(box, {edge.end, edge.end});
    for_cells(grown(box, margin), [&](std::int64_t key, const Vector<3>& middle) {
      if (distance_to(edge.begin, edge.end, middle) < margin + half_diagonal)
        cells_[key].edges.push_back(static_cast<int>(e));
    });
  }
}

const WallFaces<3>::Cell* WallFaces<3>::cell_at(const Vector<3>& x) const {
  if (cells_.empty()) return nullptr;
  std::array<std::int64_t, 3> cell;
  for (std::size_t k = 0; k < 3; ++k) cell[k] = static_cast<std::int64_t>(std::floor(x[static_cast<int>(k)] / reach_));
  const auto found = cells_.find(key(cell));
  return found == cells_.end() ? nullptr : &found->second;
}

std::span<const int> WallFaces<3>::around(const Vector<3>& x) const {
  const Cell* cell = cell_at(x);
  return cell ? std::span<const int>(cell->faces) : std::span<const int>(planes_);
}

// A body that stands on another, a plate that ends at one.
void WallFaces<3>::cover_edges() {
  for (EdgeData& edge : edges_) {
    const int own = at(edge.face).wall;
    const auto is_covered = [&](const Vector<3>& x) {
      return std::ranges::any_of(around(x),
                                 [&](int f) { return at(f).wall != own && distance(f, x) < fade * spacing_; });
    };
    edge.is_covered =
        is_covered(edge.begin) && is_covered(edge.end) && is_covered(edge.begin + 0.5 * (edge.end - edge.begin));
  }
}

PatchPoint WallFaces<3>::nearest(int face, const Vector<3>& x) const {
  const FaceData& data = at(face);
  PatchPoint point = data.patch->nearest(motions_.at_rest(data.motion, x));
  if (data.motion >= 0) {
    point.point = motions_.in_place(data.motion, point.point);
    point.normal = motions_.turned(data.motion, point.normal);
    // rotation bending rotation^T
    Matrix<3> turned;
    for (std::size_t k = 0; k < 3; ++k) {
      Vector<3> axis;
      axis[static_cast<int>(k)] = 1.0;
      turned.add_product(motions_.turned(data.motion, point.bending * axis), motions_.turned(data.motion, axis));
    }
    point.bending = turned;
  }
  if (data.side < 0.0) {
    point.normal *= -1.0;
    point.height *= -1.0;
    point.bending = -1.0 * point.bending;
  }
  return point;
}

double WallFaces<3>::beyond(int face, const Vector<3>& x) const {
  const FaceData& data = at(face);
  return data.patch ? data.patch->nearest(motions_.at_rest(data.motion, x)).beyond : 0.0;
}

bool WallFaces<3>::holds(int face, const Vector<3>& point) const {
  const Cell* cell = cell_at(point);
  const auto is_own = [&](int e) { return edges_[static_cast<std::size_t>(e)].face == face; };
  if (!is_flat(face) && cell && std::ranges::none_of(cell->edges, is_own)) {  // its ends are far
    const FaceData& data = at(face);
    const double margin = beside * spacing_;
    return data.patch->distance(motions_.at_rest(data.motion, point), margin) < margin;
  }
  return beyond(face, point) <= (is_flat(face) ? on_face : on_curve) * spacing_;
}

double WallFaces<3>::height(int face, const Vector<3>& x) const {
  return is_flat(face) ? at(face).plane.distance(x) : nearest(face, x).height;
}

double WallFaces<3>::distance(int face, const Vector<3>& x) const {
  const FaceData& data = at(face);
  if (!data.patch) return std::abs(data.plane.distance(x));
  const double limit = 2.0 * reach_;
  if (data.patch->is_flat() && std::abs(data.plane.distance(x)) >= limit) return limit;
  return data.patch->distance(motions_.at_rest(data.motion, x), limit);
}

bool WallFaces<3>::find_foot(int face, const Vector<3>& x, Foot<3>& foot) const {
  const PatchPoint point = nearest(face, x);
  foot = {point.point, point.normal, point.height, point.bending};
  return point.height > 0.0 && std::hypot(point.height, point.beyond) < reach_;
}

// The surface between two feet, as a quadric: q is nearest to (d_2 x_1 + d_1 x_2)/(d_1 + d_2).
Meeting<3> WallFaces<3>::meeting(int, const Vector<3>& one, const Foot<3>& foot, const Vector<3>& two,
                                 const Foot<3>& other_foot) const {
  const double whole = foot.height + other_foot.height;
  const double a = other_foot.height / whole, b = foot.height / whole;
  Vector<3> normal = a * foot.normal + b * other_foot.normal;
  normal *= 1.0 / norm(normal);
  const Vector<3> way = other_foot.point - foot.point;
  const double rise = 0.5 * a * b * dot(other_foot.normal - foot.normal, way);
  const Face<3> plane{a * foot.point + b * other_foot.point + rise * normal, normal};
  // The ray tube: k_1 in the plane of incidence, k_2 across.
  const Vector<3> path = two - one, along = path - dot(path, normal) * normal;
  const double first = norm(one - plane.point), second = norm(two - plane.point);
  const double height = plane.distance(one) + plane.distance(two), square = dot(along, along);
  const double cosine = height / std::sqrt(height * height + square);
  const auto curvature = [&](const Matrix<3>& m) {
    const double in_plane = square > 0.0 ? dot(along, m * along) / square : 0.5 * trace(m);
    return std::array{in_plane, trace(m) - in_plane};
  };
  const auto [one_in, one_across] = curvature(foot.bending);
  const auto [two_in, two_across] = curvature(other_foot.bending);
  const double tube = 2.0 * first * second / (first + second);
  const double spread =
      (1.0 + (a * one_in + b * two_in) * tube / cosine) * (1.0 + (a * one_across + b * two_across) * tube * cosine);
  Matrix<3> bending;
  for (std::size_t k = 0; k < 3; ++k) bending.row[k] = a * foot.bending.row[k] + b * other_foot.bending.row[k];
  return {plane, bending, spread > 0.0 ? 1.0 / spread : std::numeric_limits<double>::infinity()};
}

bool WallFaces<3>::is_behind(int face, const Vector<3>& x) const {
  if (!at(face).is_open || distance(face, x) >= reach_) return false;
  const PatchPoint point = nearest(face, x);
  return point.height <= 0.0 && point.beyond == 0.0;
}

void WallFaces<3>::append_near(const Vector<3>& x, std::vector<NearFace>& near) const {
  for (const int f : around(x)) {
    const double apart = distance(f, x);
    if (apart < 2.0 * reach_) near.push_back({f, apart, height(f, x)});
  }
}

// A path that meets a face is as long as the distances of its ends, or longer. A straight one between places before a
// face that bulges little does not meet it.
bool WallFaces<3>::may_meet(const NearFace& one, const NearFace& other, double length, bool is_straight) const {
  if (one.distance + other.distance >= length + 2.0 * fade * spacing_) return false;
  if (!is_straight || is_flat(one.face)) return true;
  return !(one.height > 0.0 && other.height > 0.0 && bulge(one.face) * spacing_ <= gentle);
}

bool WallFaces<3>::has_tests(const Vector<3>& x, std::span<const NearFace> faces) const {
  const Cell* cell = cell_at(x);
  if (!cell) return false;
  constexpr std::size_t most = 3;  // faces that need no tests
  std::array<int, most> near{};
  std::size_t found = 0;
  bool any_wall = false;
  for (const NearFace& face : faces) {
    const int f = face.face;
    if (found == most || at(f).partner >= 0) return true;
    if (!is_flat(f) && bulge(f) * spacing_ > gentle) return true;
    any_wall |= at(f).patch != nullptr;
    near[found++] = f;
  }
  if (!any_wall) return false;
  for (const int e : cell->edges) {
    const EdgeData& edge = edges_[static_cast<std::size_t>(e)];
    if (edge.is_right_angle && !edge.is_covered) continue;
    if (distance_to(edge.begin, edge.end, x) < 2.0 * reach_) return true;
  }
  for (std::size_t b = 1; b < found; ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      const bool joined = std::ranges::any_of(cell->edges, [&](int e) {
        const EdgeData& edge = edges_[static_cast<std::size_t>(e)];
        return edge.face == near[a] && edge.other == near[b] && edge.is_right_angle;
      });
      if (!joined) return true;
    }
  }
  return false;
}

WallFaces<3>::Passing WallFaces<3>::passing(const Vector<3>& from, const Vector<3>& to, const EdgeData& edge) {
  // Ericson, Real-Time Collision Detection, 2005, section 5.1.9.
  const Vector<3> line = to - from, way = edge.end - edge.begin, off = from - edge.begin;
  const double a = dot(line, line), e = dot(way, way), f = dot(way, off), c = dot(line, off), b = dot(line, way);
  const double denominator = a * e - b * b;
  double s = denominator > 1e-14 * a * e ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0.0;
  double t = (b * s + f) / e;
  if (t < 0.0 || t > 1.0) {
    t = std::clamp(t, 0.0, 1.0);
    s = std::clamp((b * t - c) / a, 0.0, 1.0);
  }
  const Vector<3> place = edge.begin + t * way;
  return {norm(from + s * line - place), s, place};
}

// What a face leaves of a line from one share of it to another.
double WallFaces<3>::free_share(int face, const Vector<3>& from, const Vector<3>& to, double since,
                                double until) const {
  const FaceData& data = at(face);
  if (is_flat(face)) {
    const double first = data.plane.distance(from), last = data.plane.distance(to);
    if ((first > 0.0) == (last > 0.0)) return 1.0;
    const double share = first / (first - last);
    if (share < since || share >= until) return 1.0;
    return holds(face, from + share * (to - from)) ? 0.0 : 1.0;
  }
  const Vector<3> end = from + until * (to - from);
  const double limit = 0.5 * norm(end - from) + on_curve * spacing_;  // for a face that it meets
  if (data.patch->distance(motions_.at_rest(data.motion, from + 0.5 * (end - from)), limit) >= limit) return 1.0;
  const double first = nearest(face, from).height, last = nearest(face, end).height;
  if ((first > 0.0) != (last > 0.0)) return holds(face, from + first / (first - last) * (end - from)) ? 0.0 : 1.0;
  if (first <= 0.0) return 1.0;
  const Vector<3> middle = from + first / (first + last) * (end - from);
  const PatchPoint point = nearest(face, middle);
  const double depth = -point.height / spacing_;
  if (depth < least_depth || depth > 2.0 * reach_ / spacing_ || point.beyond > 0.0) return 1.0;
  return std::clamp((full_depth - depth) / (full_depth - least_depth), 0.0, 1.0);
}

// What is left of a line from one share of it to another, beside the faces and edges that it begins or ends at.
double WallFaces<3>::leg_factor(const Vector<3>& from, const Vector<3>& to, double since, double until,
                                std::span<const int> near, std::array<int, 2> skipped,
                                const PassedEdges& passed) const {
  const double width = fade * spacing_, joined = on_curve * spacing_;
  if (from == to) return 1.0;
  bool passes = false;
  Passing least{.apart = width, .share = 0.0, .place = {}};
  const Cell* cell = near.empty() ? nullptr : cell_at(from);
  for (const int e : cell ? std::span<const int>(cell->edges) : std::span<const int>()) {
    const EdgeData& edge = edges_[static_cast<std::size_t>(e)];
    if (!edge.fades || edge.is_covered || std::ranges::find(near, edge.face) == near.end()) continue;
    const Passing here = passing(from, to, edge);
    if (here.apart >= least.apart || here.share <= 0.0 || here.share >= until || passed.holds(here.place, joined))
      continue;
    least = here;
    passes = true;
  }
  double factor = 1.0;
  bool is_blocked = false;
  for (const int f : near) {
    if (!at(f).patch || f == skipped[0] || f == skipped[1]) continue;
    if (at(f).partner >= 0 && (at(f).partner == skipped[0] || at(f).partner == skipped[1])) continue;
    const double left = free_share(f, from, to, since, until);
    if (left == 1.0) continue;
    const auto distance_from = [&](const Vector<3>& place) { return distance(f, place); };
    if (passed.any_on(distance_from, joined)) continue;
    if (passes && left == 0.0 && distance(f, least.place) < joined) {
      is_blocked = true;
      continue;
    }
    if (left == 0.0) return 0.0;
    factor *= left;
  }
  return passes ? factor * faded(is_blocked ? -least.apart : least.apart, width) : factor;
}

double WallFaces<3>::line_factor(const Vector<3>& from, const Vector<3>& to, std::span<const int> faces) const {
  return leg_factor(from, to, 0.0, 1.0, faces, {-1, -1}, {});
}

double WallFaces<3>::path_factor(const Vector<3>& from, const Vector<3>& image, const MirrorPath& path,
                                 const Face<3>& plane, std::span<const int> faces) const {
  const Cell* cell = cell_at(from);
  if (!cell) return 1.0;
  const double width = fade * spacing_;
  Vector<3> begin = from, end = image;
  double factor = 1.0, since = 0.0;
  std::array<int, 2> skipped{-1, -1};  // the faces that a leg begins and ends at
  PassedEdges passed;                  // of these faces
  for (const int f : path.faces()) {
    const Face<3> mirror = is_flat(f) ? this->plane(f) : plane;
    const double first = mirror.distance(begin), last = mirror.distance(end);
    if (!(first > 0.0 && last < 0.0)) return 0.0;
    const double share = first / (first - last);
    const Vector<3> hit = begin + share * (end - begin);
    const std::size_t before = passed.count();
    const bool is_on = holds(f, hit);
    double apart = width, nearest_end = std::numeric_limits<double>::infinity();
    bool ends_inside = false;  // the end nearest to the hit is one that does not fade
    for (const int e : cell->edges) {
      const EdgeData& edge = edges_[static_cast<std::size_t>(e)];
      if (edge.face != f) continue;
      const bool fades = edge.fades && !edge.is_covered;
      if (!is_on) {
        const double here = distance_to(edge.begin, edge.end, hit);
        if (here < nearest_end) {
          nearest_end = here;
          ends_inside = !fades;
        }
      }
      if (!fades) continue;
      const Passing here = passing(begin, end, edge);
      if (here.apart >= width || here.share <= 0.0 || here.share >= 1.0) continue;
      apart = std::min(apart, here.apart);
      passed.add(here.place);
    }
    if (!is_on && (apart >= width || ends_inside)) return 0.0;
    factor *= faded(is_on ? apart : -apart, width);
    skipped[1] = f;
    factor *= leg_factor(begin, end, since, (1.0 - at_end) * share, faces, skipped, passed);
    since = at_end;
    if (factor == 0.0) return 0.0;
    begin = hit;
    end = reflection_at(mirror).of_position(end);
    skipped = {f, -1};
    passed.drop(before);
  }
  return factor * leg_factor(begin, end, since, 1.0, faces, skipped, passed);
}

// The first face that a way meets from its wet side, or an open surface from either side.
bool WallFaces<3>::first_hit(const Vector<3>& from, const Vector<3>& to, int skipped, int& face, double& share) const {
  face = -1;
  const Cell* cell = cell_at(from);
  if (!cell) return false;
  for (const int f : cell->faces) {
    const FaceData& data = at(f);
    if (!data.patch || f == skipped || (skipped >= 0 && data.partner == skipped)) continue;
    if (!is_flat(f)) {
      const double way = norm(to - from) + beside * spacing_;
      if (data.patch->distance(motions_.at_rest(data.motion, to), way) >= way) continue;
    }
    const double first = height(f, from), last = height(f, to);
    const double slack = is_flat(f) ? 0.0 : 0.1 * spacing_;  // of a way that begins at a curved face
    const bool is_met = (first >= -slack && last <= 0.0) || (data.is_open && first < 0.0 && last > 0.0);
    if (!is_met) continue;
    const double here = first > 0.0 || last > 0.0 ? first / (first - last) : 0.0;
    const Vector<3> hit = from + here * (to - from);
    const double off = beyond(f, hit);
    if (off > beside * spacing_) continue;
    if (off > (is_flat(f) ? on_face : on_curve) * spacing_) {
      // Behind another face it goes on.
      double nearest_end = std::numeric_limits<double>::infinity();
      bool fades = false;
      for (const int e : cell->edges) {
        const EdgeData& edge = edges_[static_cast<std::size_t>(e)];
        if (edge.face != f) continue;
        const double apart = distance_to(edge.begin, edge.end, hit);
        if (apart >= nearest_end) continue;
        nearest_end = apart;
        fades = edge.fades;
      }
      if (fades) continue;
    }
    if (face >= 0 && here >= share) continue;
    face = f;
    share = here;
  }
  return face >= 0;
}

void WallFaces<3>::confine(const Vector<3>& from, Vector<3>& to, Vector<3>& velocity) const {
  const double gap = std::max(on_face * spacing_, rounding * norm(to));
  for (const int f : planes_) {
    const double depth = -height(f, to);
    if (!(depth >= 0.0)) continue;
    to += 2.0 * std::max(depth, 0.5 * (depth + gap)) * at(f).plane.normal;
    if (depth > 0.0) velocity -= 2.0 * dot(velocity, at(f).plane.normal) * at(f).plane.normal;
  }
  if (cells_.empty()) return;
  // From where a particle would be had it moved with the wall that it meets.
  int face = -1;
  double share = 0.0;
  Vector<3> begin = from;
  for (int motion = -1; motion < motions_.count(); ++motion) {
    int other = -1;
    double other_share = 0.0;
    const Vector<3> start = motions_.moved_along(motion, from);
    if (!first_hit(start, to, -1, other, other_share) || at(other).motion != motion) continue;
    if (face >= 0 && other_share >= share) continue;
    face = other;
    share = other_share;
    begin = start;
  }
  for (int bounce = 0; face >= 0; ++bounce) {
    const Vector<3> hit = begin + share * (to - begin);
    const FaceData& data = at(face);
    const bool is_flat_face = is_flat(face);
    const PatchPoint foot = is_flat_face ? PatchPoint{hit, data.plane.normal, 0.0, 0.0, {}} : nearest(face, to);
    Vector<3> normal = foot.normal;
    double depth = is_flat_face ? -dot(to - hit, normal) : -foot.height;
    if (data.is_open && depth < 0.0) {  // from behind
      normal *= -1.0;
      depth = -depth;
    }
    const Vector<3> wall_velocity = this->velocity(face, hit);
    velocity -= 2.0 * dot(velocity - wall_velocity, normal) * normal;
    if (bounce == most_bounces) {
      to = hit + gap * normal;
      return;
    }
    to += 2.0 * std::max(depth, 0.5 * (depth + gap)) * normal;
    begin = hit;
    const int skipped = face;
    first_hit(begin, to, skipped, face, share);
  }
}

}  // namespace impinge
