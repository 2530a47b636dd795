#include "impinge/boundaries/wall_faces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace impinge {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double fade = 0.25;              // half the width over which lines by an edge fade [dp]
constexpr double least_radius = 3.0;       // of an arc that is not cut into segments [dp]
constexpr double segment_turn = pi / 9.0;  // of such an arc, at most
constexpr double coincident = 1e-6;        // distance of vertices that are one [dp]
constexpr double same_angle = 1e-6;        // [rad]
constexpr double least_gap = 1e-9;         // between a particle and a face after a reflection [dp]
constexpr double rounding = 1e-15;         // of a position, over its distance from the origin
constexpr double least_share = 1e-9;       // of a leg that begins at a face before it can meet another
constexpr int most_bounces = 8;            // of a particle in a step

/// Angle from one direction to another, counter-clockwise for sense = 1 and clockwise for -1, in [0, 2 pi) [rad].
double angle_between(const Vector<2>& from, const Vector<2>& to, double sense) {
  const double angle = sense * std::atan2(cross(from, to), dot(from, to));
  return angle < 0.0 ? angle + 2.0 * pi : angle;
}

/// How far a line passes a point on its left [m].
double passing_distance(const Vector<2>& from, const Vector<2>& way, double length, const Vector<2>& point) {
  return cross(way, point - from) / length;
}

double faded(double distance, double width) { return std::clamp(0.5 + 0.5 * distance / width, 0.0, 1.0); }

/// The segments that stand for a sharp arc; other edges as they are.
std::vector<OutlineEdge> cut_sharp_arc(const OutlineEdge& edge, double spacing) {
  if (edge.straight() || edge.radius >= least_radius * spacing) return {edge};
  const int count = std::max(1, static_cast<int>(std::ceil(std::abs(edge.sweep) / segment_turn - 1e-9)));
  std::vector<OutlineEdge> segments;
  for (int k = 0; k < count; ++k) {
    const Vector<2> begin = k == 0 ? edge.begin : segments.back().end;
    segments.push_back({.begin = begin, .end = k + 1 == count ? edge.end : edge.at((k + 1.0) / count)});
  }
  return segments;
}

}  // namespace

template <int Dim>
Reflection<Dim> reflection_at(const Face<Dim>& plane) {
  Reflection<Dim> result;
  for (int k = 0; k < Dim; ++k) result.linear.row[static_cast<std::size_t>(k)] -= 2.0 * plane.normal[k] * plane.normal;
  result.shift = 2.0 * dot(plane.point, plane.normal) * plane.normal;
  return result;
}

template <int Dim>
Reflection<Dim> product(const Reflection<Dim>& outer, const Reflection<Dim>& inner) {
  Reflection<Dim> result;
  for (int r = 0; r < Dim; ++r) {
    Vector<Dim>& row = result.linear.row[static_cast<std::size_t>(r)];
    row = {};
    for (int k = 0; k < Dim; ++k)
      row += outer.linear.row[static_cast<std::size_t>(r)][k] * inner.linear.row[static_cast<std::size_t>(k)];
  }
  result.shift = outer.linear * inner.shift + outer.shift;
  return result;
}

template <int Dim>
WallFaces<Dim>::WallFaces(const std::vector<Face<Dim>>& planes, const std::vector<Wall>& walls, double reach,
                          double spacing)
    : reach_(reach), spacing_(spacing) {
  for (const Face<Dim>& plane : planes) {
    planes_.push_back(count());
    faces_.emplace_back();
    faces_.back().point = plane.point;
    faces_.back().normal = plane.normal;
  }
  if constexpr (Dim == 2) {
    for (const Wall& wall : walls) add_wall(wall);
    find_sectors();
  }
  rest_ = faces_;
  rest_vertices_ = vertices_;
  pose_.resize(motions_.size());
  move_to(0.0, 0.0);
  old_pose_ = pose_;
}

template <>
void WallFaces<3>::add_wall(const Wall&) {}
template <>
void WallFaces<3>::find_sectors() {}

template <>
void WallFaces<2>::add_wall(const Wall& wall) {
  int motion = -1;
  if (wall.motion) {
    const auto found = std::ranges::find(motions_, wall.motion);
    motion = static_cast<int>(found - motions_.begin());
    if (found == motions_.end()) motions_.push_back(wall.motion);
  }
  for (const OutlineEdge& whole : wall.outline.edges()) {
    for (const OutlineEdge& edge : cut_sharp_arc(whole, spacing_)) {
      const bool closed_arc = !edge.straight() && std::abs(edge.sweep) > 2.0 * pi - same_angle;
      const int begin = closed_arc ? -1 : add_vertex(edge.begin, motion);
      const int end = closed_arc ? -1 : add_vertex(edge.end, motion);
      const auto add = [&](bool right) {
        FaceData face;
        face.point = right ? edge.end : edge.begin;
        face.vertex = right ? std::array{end, begin} : std::array{begin, end};
        face.motion = motion;
        face.slip = wall.slip;
        face.is_open = !wall.outline.closed() && wall.wet_right != wall.wet_left;
        if (edge.straight()) {
          const Vector<2> left = turned_left(edge.end - edge.begin);
          face.normal = (right ? -1.0 : 1.0) / norm(left) * left;
        } else {
          face.center = edge.center;
          face.radius = edge.radius;
          face.sweep = right ? -edge.sweep : edge.sweep;
          face.bulge = face.sweep < 0.0 ? 1.0 : -1.0;
        }
        faces_.push_back(face);
      };
      if (wall.wet_right) add(true);
      if (wall.wet_left) add(false);
      if (wall.wet_right && wall.wet_left) {
        const int last = count() - 1;
        faces_[static_cast<std::size_t>(last)].partner = last - 1;
        faces_[static_cast<std::size_t>(last - 1)].partner = last;
      }
    }
  }
}

template <int Dim>
int WallFaces<Dim>::add_vertex(const Vector<Dim>& place, int motion) {
  for (std::size_t v = 0; v < vertices_.size(); ++v)
    if (vertex_motion_[v] == motion && norm(vertices_[v].place - place) < coincident * spacing_)
      return static_cast<int>(v);
  vertices_.push_back({.place = place, .sectors = {}});
  vertex_motion_.push_back(motion);
  return static_cast<int>(vertices_.size()) - 1;
}

// From an end into the face.
template <>
Vector<2> WallFaces<2>::tangent(const FaceData& face, int end) const {
  const auto place = [&](int k) {
    return vertices_[static_cast<std::size_t>(face.vertex[static_cast<std::size_t>(k)])].place;
  };
  if (face.radius == 0.0) {
    const Vector<2> way = place(1 - end) - place(end);
    return 1.0 / norm(way) * way;
  }
  const Vector<2> radial = 1.0 / face.radius * (place(end) - face.center);
  const double sense = (face.sweep > 0.0 ? 1.0 : -1.0) * (end == 0 ? 1.0 : -1.0);
  return sense * turned_left(radial);
}

// Around a vertex, from each face over its wet side to the next face.
template <>
void WallFaces<2>::find_sectors() {
  struct End {
    int face;
    Vector<2> along;
    double sense;  // in which the wet side follows
  };
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    std::vector<End> ends;
    for (int f = 0; f < count(); ++f)
      for (int end = 0; end < 2; ++end)
        if (at(f).vertex[static_cast<std::size_t>(end)] == static_cast<int>(v))
          ends.push_back({f, tangent(at(f), end), end == 0 ? 1.0 : -1.0});
    for (const End& own : ends) {
      double angle = 2.0 * pi;
      for (const End& other : ends) {
        const double to_other = angle_between(own.along, other.along, own.sense);
        if (to_other > same_angle && to_other < 2.0 * pi - same_angle) angle = std::min(angle, to_other);
      }
      int neighbour = -1;
      bool bent = at(own.face).radius > 0.0;
      for (const End& other : ends) {
        const double to_other = angle_between(own.along, other.along, own.sense);
        const double off = std::abs(to_other - angle);
        if (other.face == own.face || other.sense == own.sense) continue;
        if (std::min(off, 2.0 * pi - off) > same_angle) continue;
        neighbour = other.face;
        bent |= at(other.face).radius > 0.0;
      }
      const double half = 0.5 * own.sense * angle;
      const Vector<2> bisector = std::cos(half) * own.along + std::sin(half) * turned_left(own.along);
      const bool fades = angle > pi + same_angle || (bent && angle > pi - same_angle);
      vertices_[v].sectors.push_back({own.face, own.sense, own.along, bisector, angle, neighbour, fades});
    }
  }
}

template <int Dim>
void WallFaces<Dim>::move_to(double time, double velocity_time) {
  old_pose_ = pose_;
  velocity_pose_.clear();
  for (std::size_t m = 0; m < motions_.size(); ++m) {
    pose_[m] = (*motions_[m])(time);
    velocity_pose_.push_back((*motions_[m])(velocity_time));
  }
  if (any_moves()) {
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      if (faces_[f].motion < 0) continue;
      const Pose<Dim>& pose = pose_[static_cast<std::size_t>(faces_[f].motion)];
      faces_[f].point = pose.of_position(rest_[f].point);
      faces_[f].normal = pose.of_direction(rest_[f].normal);
      faces_[f].center = pose.of_position(rest_[f].center);
    }
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
      if (vertex_motion_[v] < 0) continue;
      const Pose<Dim>& pose = pose_[static_cast<std::size_t>(vertex_motion_[v])];
      vertices_[v].place = pose.of_position(rest_vertices_[v].place);
      for (std::size_t s = 0; s < vertices_[v].sectors.size(); ++s) {
        vertices_[v].sectors[s].along = pose.of_direction(rest_vertices_[v].sectors[s].along);
        vertices_[v].sectors[s].bisector = pose.of_direction(rest_vertices_[v].sectors[s].bisector);
      }
    }
  }
  arrange();
  cover_vertices();
}

template <int Dim>
const Motion<Dim>* WallFaces<Dim>::common_motion() const {
  const bool is_common =
      !motions_.empty() && std::ranges::all_of(faces_, [](const FaceData& face) { return face.motion == 0; });
  return is_common ? motions_.front().get() : nullptr;
}

template <int Dim>
double WallFaces<Dim>::largest_speed(double time) const {
  std::vector<Pose<Dim>> pose;
  for (const auto& motion : motions_) pose.push_back((*motion)(time));
  const auto speed_at = [](const Pose<Dim>& at, const Vector<Dim>& rest) {
    return norm(at.velocity_at(at.of_position(rest)));
  };
  double largest = 0.0;
  for (std::size_t v = 0; v < rest_vertices_.size(); ++v)
    if (vertex_motion_[v] >= 0)
      largest = std::max(largest, speed_at(pose[static_cast<std::size_t>(vertex_motion_[v])], rest_vertices_[v].place));
  for (const FaceData& face : rest_) {
    if (face.motion < 0 || face.radius == 0.0) continue;
    const Pose<Dim>& of_face = pose[static_cast<std::size_t>(face.motion)];
    double rate = 0.0;
    for (const Vector<Dim>& row : of_face.spin.row) rate = std::max(rate, norm(row));
    largest = std::max(largest, speed_at(of_face, face.center) + rate * face.radius);
  }
  return largest;
}

// Lists the faces of each cell: those that reach into the cell, made larger by twice the reach.
template <int Dim>
void WallFaces<Dim>::arrange() {
  cell_.clear();
  extent_.fill(0);
  std::vector<Box<Dim>> box;
  Box<Dim> whole;
  double margin = 2.0 * reach_;
  for (std::size_t f = planes_.size(); f < faces_.size(); ++f) {
    const FaceData& face = faces_[f];
    Box<Dim> around;
    if (face.radius > 0.0) {
      around = {face.center, face.center};
      for (int k = 0; k < Dim; ++k) {
        around.low[k] -= face.radius;
        around.high[k] += face.radius;
      }
    } else {
      const Vector<Dim>&a = vertex(static_cast<int>(f), 0).place, &b = vertex(static_cast<int>(f), 1).place;
      for (int k = 0; k < Dim; ++k) {
        around.low[k] = std::min(a[k], b[k]);
        around.high[k] = std::max(a[k], b[k]);
      }
    }
    for (int k = 0; k < Dim; ++k) {
      around.low[k] -= margin;
      around.high[k] += margin;
      whole.low[k] = box.empty() ? around.low[k] : std::min(whole.low[k], around.low[k]);
      whole.high[k] = box.empty() ? around.high[k] : std::max(whole.high[k], around.high[k]);
    }
    box.push_back(around);
  }
  if (box.empty()) return;
  constexpr double most_cells = 400.0;  // along an axis
  low_ = whole.low;
  edge_ = reach_;
  for (int k = 0; k < Dim; ++k) edge_ = std::max(edge_, (whole.high[k] - whole.low[k]) / most_cells);
  std::size_t cells = 1;
  for (int k = 0; k < Dim; ++k) {
    extent_[static_cast<std::size_t>(k)] = static_cast<int>((whole.high[k] - whole.low[k]) / edge_) + 1;
    cells *= static_cast<std::size_t>(extent_[static_cast<std::size_t>(k)]);
  }
  cell_.assign(cells, planes_);
  for (std::size_t b = 0; b < box.size(); ++b) {
    const int face = static_cast<int>(b + planes_.size());
    std::array<int, Dim> first, last, at_cell;
    for (std::size_t k = 0; k < Dim; ++k) {
      first[k] = static_cast<int>((box[b].low[static_cast<int>(k)] - low_[static_cast<int>(k)]) / edge_);
      last[k] = std::min(extent_[k] - 1,
                         static_cast<int>((box[b].high[static_cast<int>(k)] - low_[static_cast<int>(k)]) / edge_));
    }
    at_cell = first;
    while (true) {
      Vector<Dim> middle;
      std::size_t cell = 0;
      for (std::size_t k = 0; k < Dim; ++k) {
        middle[static_cast<int>(k)] = low_[static_cast<int>(k)] + (at_cell[k] + 0.5) * edge_;
        cell = cell * static_cast<std::size_t>(extent_[k]) + static_cast<std::size_t>(at_cell[k]);
      }
      if (distance(face, middle) < margin + 0.5 * std::sqrt(Dim) * edge_) cell_[cell].push_back(face);
      std::size_t k = Dim;
      while (k > 0 && ++at_cell[k - 1] > last[k - 1]) {
        at_cell[k - 1] = first[k - 1];
        --k;
      }
      if (k == 0) break;
    }
  }
}

template <int Dim>
std::span<const int> WallFaces<Dim>::around(const Vector<Dim>& x) const {
  if (cell_.empty()) return planes_;
  std::size_t cell = 0;
  for (int k = 0; k < Dim; ++k) {
    const double place = (x[k] - low_[k]) / edge_;
    if (!(place >= 0.0 && place < extent_[static_cast<std::size_t>(k)])) return planes_;
    cell = cell * static_cast<std::size_t>(extent_[static_cast<std::size_t>(k)]) + static_cast<std::size_t>(place);
  }
  return cell_[cell];
}

// A body that stands on another, a plate that ends at one.
template <int Dim>
void WallFaces<Dim>::cover_vertices() {
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    Vertex& here = vertices_[v];
    const auto is_other = [&](int f) {
      return std::ranges::find(at(f).vertex, static_cast<int>(v)) == at(f).vertex.end();
    };
    here.is_covered = std::ranges::any_of(
        around(here.place), [&](int f) { return is_other(f) && distance(f, here.place) < fade * spacing_; });
  }
}

template <int Dim>
double WallFaces<Dim>::height(int face, const Vector<Dim>& x) const {
  const FaceData& data = at(face);
  if (data.radius > 0.0) return data.bulge * (norm(x - data.center) - data.radius);
  return dot(x - data.point, data.normal);
}

template <int Dim>
bool WallFaces<Dim>::covers(const FaceData& face, const Vector<Dim>& x) const {
  if constexpr (Dim == 2) {
    if (face.vertex[0] < 0) return true;
    const Vector<2> begin = vertices_[static_cast<std::size_t>(face.vertex[0])].place - face.center;
    return angle_between(begin, x - face.center, face.sweep > 0.0 ? 1.0 : -1.0) <= std::abs(face.sweep);
  } else {
    return true;
  }
}

template <int Dim>
double WallFaces<Dim>::distance(int face, const Vector<Dim>& x) const {
  const FaceData& data = at(face);
  if (data.vertex[0] < 0) return std::abs(height(face, x));
  const Vector<Dim>&a = vertex(face, 0).place, &b = vertex(face, 1).place;
  if (data.radius > 0.0) {
    if (covers(data, x)) return std::abs(height(face, x));
    return std::min(norm(x - a), norm(x - b));
  }
  const Vector<Dim> way = b - a;
  const double share = std::clamp(dot(x - a, way) / dot(way, way), 0.0, 1.0);
  return norm(x - a - share * way);
}

template <int Dim>
Vector<Dim> WallFaces<Dim>::velocity(int face, const Vector<Dim>& x) const {
  const int motion = at(face).motion;
  return motion < 0 ? Vector<Dim>{} : velocity_pose_[static_cast<std::size_t>(motion)].velocity_at(x);
}

template <int Dim>
Vector<Dim> WallFaces<Dim>::acceleration(int face, const Vector<Dim>& x) const {
  const int motion = at(face).motion;
  return motion < 0 ? Vector<Dim>{} : pose_[static_cast<std::size_t>(motion)].acceleration_at(x);
}

template <int Dim>
const typename WallFaces<Dim>::Sector* WallFaces<Dim>::sector_of(const Vertex& vertex, int face) const {
  for (const Sector& sector : vertex.sectors)
    if (sector.face == face) return &sector;
  return nullptr;
}

template <int Dim>
bool WallFaces<Dim>::fades(int face, int end) const {
  const Vertex& here = vertex(face, end);
  return !here.is_covered && sector_of(here, face)->fades;
}

template <int Dim>
bool WallFaces<Dim>::is_behind(int face, const Vector<Dim>& x) const {
  return at(face).is_open && height(face, x) <= 0.0 && distance(face, x) < reach_;
}

template <int Dim>
bool WallFaces<Dim>::has_tests(const Vector<Dim>& x) const {
  if (vertices_.empty() && cell_.empty()) return false;
  constexpr std::size_t most = 2;  // faces that need no tests
  std::array<int, most> near{};
  std::size_t found = 0;
  for (const int f : around(x)) {
    if (distance(f, x) >= 2.0 * reach_) continue;
    if (found == most || at(f).partner >= 0) return true;
    near[found++] = f;
    for (int end = 0; end < 2 && at(f).vertex[0] >= 0; ++end) {
      if (norm(vertex(f, end).place - x) >= 2.0 * reach_) continue;
      if (vertex(f, end).is_covered || sector_of(vertex(f, end), f)->neighbour < 0 || fades(f, end)) return true;
    }
  }
  if (found < most) return false;
  const FaceData &one = at(near[0]), &two = at(near[1]);
  if (one.radius > 0.0 || two.radius > 0.0 || std::abs(dot(one.normal, two.normal)) > same_angle) return true;
  const bool has_ends = one.vertex[0] >= 0 || two.vertex[0] >= 0;
  const bool joined =
      one.vertex[0] >= 0 && two.vertex[0] >= 0 && (one.vertex[0] == two.vertex[1] || one.vertex[1] == two.vertex[0]);
  return has_ends && !joined;
}

// True where the line meets the face before a share of its length. Where faces meet, it crosses one of them.
template <int Dim>
bool WallFaces<Dim>::crosses(int face, const Vector<Dim>& from, const Vector<Dim>& to, double since,
                             double until) const {
  if constexpr (Dim == 2) {
    const FaceData& data = at(face);
    const Vector<2> way = to - from;
    if (data.radius > 0.0) {
      const Vector<2> offset = from - data.center;
      const double square = dot(way, way), half = dot(way, offset);
      const double constant = dot(offset, offset) - data.radius * data.radius;
      const double discriminant = half * half - square * constant;
      if (discriminant <= 0.0 || square == 0.0) return false;
      const double root = std::sqrt(discriminant);
      int crossings = 0;
      for (const double share : {(-half - root) / square, (-half + root) / square})
        crossings += share > since && share < until && covers(data, from + share * way);
      return crossings == 1;
    }
    const double first = height(face, from), last = height(face, to);
    if ((first > 0.0) == (last > 0.0)) return false;
    const double share = first / (first - last);
    if (share < since || share >= until) return false;
    if (data.vertex[0] < 0) return true;
    const double begin = cross(way, vertex(face, 0).place - from), end = cross(way, vertex(face, 1).place - from);
    return first > 0.0 ? begin <= 0.0 && end > 0.0 : begin > 0.0 && end <= 0.0;
  } else {
    return false;
  }
}

// What is left of a line up to a share of it, beside the faces and vertices that it begins or ends at.
template <int Dim>
double WallFaces<Dim>::leg_factor(const Vector<Dim>& from, const Vector<Dim>& to, double since, double until,
                                  std::span<const int> skipped, std::span<const int> skipped_vertices) const {
  if constexpr (Dim == 2) {
    const Vector<2> way = to - from;
    const double length = norm(way);
    if (length == 0.0) return 1.0;
    const Vector<2> end_point = from + until * way;
    const std::span<const int> near = around(from);
    double factor = 1.0;
    constexpr std::size_t most = 8;
    std::array<int, most> faded_at;  // vertices
    std::size_t n_faded = 0;
    const auto contains = [](std::span<const int> list, int value) {
      return std::ranges::find(list, value) != list.end();
    };
    for (const int f : near) {
      for (int end = 0; end < 2 && at(f).vertex[0] >= 0; ++end) {
        const int number = at(f).vertex[static_cast<std::size_t>(end)];
        const Vertex& here = vertex(f, end);
        if (here.is_covered || contains(skipped_vertices, number) || contains({faded_at.data(), n_faded}, number))
          continue;
        const double past = dot(here.place - from, way) / (length * length);
        if (past <= 0.0 || past >= until || n_faded == most) continue;
        const double apart = std::abs(passing_distance(from, way, length, here.place));
        if (apart >= fade * spacing_) continue;
        for (const Sector& sector : here.sectors) {
          const auto is_inside = [&](const Vector<2>& x) {
            const double angle = angle_between(sector.along, x - here.place, sector.sense);
            return angle > 0.0 && angle < sector.angle;
          };
          if (sector.angle <= pi + same_angle || !is_inside(from) || !is_inside(end_point)) continue;
          const Vector<2> foot = from + past * way - here.place;
          factor *= faded(dot(foot, sector.bisector) > 0.0 ? apart : -apart, fade * spacing_);
          faded_at[n_faded++] = number;
          break;
        }
      }
    }
    if (factor == 0.0) return 0.0;
    for (const int f : near) {
      if (contains(skipped, f) || (at(f).partner >= 0 && contains(skipped, at(f).partner))) continue;
      const auto is_left_out = [&](int v) {
        return v >= 0 && (contains({faded_at.data(), n_faded}, v) || contains(skipped_vertices, v));
      };
      if (is_left_out(at(f).vertex[0]) || is_left_out(at(f).vertex[1])) continue;
      if (crosses(f, from, to, since, until)) return 0.0;
    }
    return factor;
  } else {
    return 1.0;
  }
}

template <int Dim>
double WallFaces<Dim>::line_factor(const Vector<Dim>& from, const Vector<Dim>& to) const {
  return leg_factor(from, to, 0.0, 1.0, {}, {});
}

template <int Dim>
Face<Dim> WallFaces<Dim>::tangent_plane(int face, const Vector<Dim>& x) const {
  const FaceData& data = at(face);
  const Vector<Dim> radial = 1.0 / norm(x - data.center) * (x - data.center);
  return {data.center + data.radius * radial, data.bulge * radial};
}

template <int Dim>
double WallFaces<Dim>::ray_share(int face, const Face<Dim>& plane, const Vector<Dim>& one, const Vector<Dim>& two,
                                 double length) const {
  const FaceData& data = at(face);
  const double first = norm(one - plane.point), second = norm(two - plane.point);
  const double cosine = (height(face, one) + height(face, two)) / length;
  return (first + second) / (first + second + 2.0 * data.bulge / data.radius * first * second / cosine);
}

template <int Dim>
double WallFaces<Dim>::path_factor(const Vector<Dim>& from, const Vector<Dim>& image, const MirrorPath& path,
                                   const Face<Dim>& plane) const {
  if constexpr (Dim == 2) {
    Vector<2> begin = from, end = image;
    double factor = 1.0, since = 0.0;
    double travelled = 0.0;              // from the path's begin to that of the leg
    std::array<int, 2> skipped{-1, -1};  // the faces that a leg begins and ends at
    std::array<int, 4> passed{};         // vertices that fade, of the faces that a leg begins and ends at
    std::size_t n_passed = 0;
    for (const int f : path.faces()) {
      const Face<2> mirror = is_flat(f) ? this->plane(f) : plane;
      const double first = mirror.distance(begin), last = mirror.distance(end);
      if (!(first > 0.0 && last < 0.0)) return 0.0;
      const Vector<2> way = end - begin;
      const double length = norm(way);
      const double share = first / (first - last);
      const std::size_t before = n_passed;
      bool is_inside = is_flat(f) || covers(at(f), mirror.point);
      for (int side = 0; side < 2 && has_ends(f); ++side) {
        const Vector<2>& place = vertex(f, side).place;
        if (!is_flat(f) && norm(place - mirror.point) > reach_) continue;
        // Inside the face, positive: the begin is on the line's right, the end on its left.
        const double left = passing_distance(begin, way, length, place);
        const double inside = side == 0 ? -left : left;
        // Beyond the path's ends a line may pass near to a vertex and be far from it where it is reflected.
        const double past = dot(place - begin, way) / length;
        if (fades(f, side) && past > -travelled && past < length) {
          factor *= faded(inside, fade * spacing_);
          if (std::abs(inside) >= fade * spacing_) continue;
          passed[n_passed++] = at(f).vertex[static_cast<std::size_t>(side)];
          is_inside = true;
        } else if (side == 0 ? inside < 0.0 : inside <= 0.0) {
          return 0.0;
        }
      }
      if (factor == 0.0 || !is_inside) return 0.0;
      skipped[1] = f;
      factor *= leg_factor(begin, end, since, share, skipped, {passed.data(), n_passed});
      if (factor == 0.0) return 0.0;
      begin = begin + share * way;
      travelled += share * length;
      end = reflection_at(mirror).of_position(end);
      skipped = {f, -1};
      std::copy(passed.begin() + static_cast<std::ptrdiff_t>(before),
                passed.begin() + static_cast<std::ptrdiff_t>(n_passed), passed.begin());
      n_passed -= before;
      since = least_share;
    }
    return factor * leg_factor(begin, end, since, 1.0, skipped, {passed.data(), n_passed});
  } else {
    return 1.0;
  }
}

// The first face that a way meets from its wet side, or a line from either side.
template <int Dim>
bool WallFaces<Dim>::first_hit(const Vector<Dim>& from, const Vector<Dim>& to, int skipped, int& face,
                               double& share) const {
  face = -1;
  if constexpr (Dim == 2) {
    const Vector<2> way = to - from;
    const double square = dot(way, way);
    for (const int f : around(from)) {
      const FaceData& data = at(f);
      if (f == skipped || (skipped >= 0 && data.partner == skipped)) continue;
      double here = 0.0;
      if (data.radius > 0.0) {
        const Vector<2> offset = from - data.center;
        const double half = dot(way, offset), constant = dot(offset, offset) - data.radius * data.radius;
        const double discriminant = half * half - square * constant;
        if (discriminant <= 0.0) continue;
        // Into the wall: through the circle's near side from outside, its far side from inside.
        here = (-half - data.bulge * std::sqrt(discriminant)) / square;
        if (!(here >= 0.0 && here <= 1.0) || !covers(data, from + here * way)) continue;
      } else {
        const double first = height(f, from), last = height(f, to);
        const bool is_met = (first >= 0.0 && last <= 0.0) || (data.is_open && first < 0.0 && last > 0.0);
        if (!is_met || !crosses(f, from, to, 0.0, 2.0)) continue;
        here = first / (first - last);
      }
      if (face >= 0 && here >= share) continue;
      face = f;
      share = here;
    }
  }
  return face >= 0;
}

template <int Dim>
void WallFaces<Dim>::confine(const Vector<Dim>& from, Vector<Dim>& to, Vector<Dim>& velocity) const {
  const double gap = std::max(least_gap * spacing_, rounding * norm(to));
  for (const int f : planes_) {
    const double depth = -height(f, to);
    if (!(depth >= 0.0)) continue;
    to += 2.0 * std::max(depth, 0.5 * (depth + gap)) * at(f).normal;
    if (depth > 0.0) velocity -= 2.0 * dot(velocity, at(f).normal) * at(f).normal;
  }
  if (cell_.empty()) return;
  // From where a particle would be had it moved with the wall that it meets.
  int face = -1;
  double share = 0.0;
  Vector<Dim> begin = from;
  const auto moved = [&](int motion) {
    if (motion < 0) return from;
    const Pose<Dim>&old = old_pose_[static_cast<std::size_t>(motion)], &now = pose_[static_cast<std::size_t>(motion)];
    Vector<Dim> at_rest;
    const Vector<Dim> offset = from - old.shift;
    for (int k = 0; k < Dim; ++k) at_rest += offset[k] * old.rotation.row[static_cast<std::size_t>(k)];
    return now.of_position(at_rest);
  };
  for (int motion = -1; motion < static_cast<int>(motions_.size()); ++motion) {
    int other = -1;
    double other_share = 0.0;
    const Vector<Dim> start = moved(motion);
    if (!first_hit(start, to, -1, other, other_share) || at(other).motion != motion) continue;
    if (face >= 0 && other_share >= share) continue;
    face = other;
    share = other_share;
    begin = start;
  }
  for (int bounce = 0; face >= 0; ++bounce) {
    const Vector<Dim> hit = begin + share * (to - begin);
    const FaceData& data = at(face);
    Vector<Dim> normal = data.radius > 0.0 ? data.bulge / norm(hit - data.center) * (hit - data.center) : data.normal;
    if (data.is_open && dot(to - hit, normal) > 0.0) normal *= -1.0;  // from behind
    const Vector<Dim> wall_velocity = this->velocity(face, hit);
    velocity -= 2.0 * dot(velocity - wall_velocity, normal) * normal;
    if (bounce == most_bounces) {
      to = hit + gap * normal;
      return;
    }
    const double depth = -dot(to - hit, normal);
    to += 2.0 * std::max(depth, 0.5 * (depth + gap)) * normal;
    begin = hit;
    const int skipped = face;
    first_hit(begin, to, skipped, face, share);
  }
}

template Reflection<2> reflection_at(const Face<2>&);
template Reflection<3> reflection_at(const Face<3>&);
template Reflection<2> product(const Reflection<2>&, const Reflection<2>&);
template Reflection<3> product(const Reflection<3>&, const Reflection<3>&);
template class WallFaces<2>;
template class WallFaces<3>;

}  // namespace impinge
