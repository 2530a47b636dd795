#include "impinge/boundaries/wall_lines.hpp"

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

WallFaces<2>::WallFaces(const std::vector<Face<2>>& planes, const std::vector<Wall<2>>& walls, double reach,
                        double spacing)
    : reach_(reach), spacing_(spacing) {
  for (const Face<2>& plane : planes) {
    planes_.push_back(count());
    faces_.emplace_back();
    faces_.back().point = plane.point;
    faces_.back().normal = plane.normal;
  }
  for (const Wall<2>& wall : walls) add_wall(wall);
  find_sectors();
  rest_ = faces_;
  rest_vertices_ = vertices_;
  move_to(0.0, 0.0);
  move_to(0.0, 0.0);  // nothing has moved yet
}

void WallFaces<2>::add_wall(const Wall<2>& wall) {
  const int motion = motions_.add(wall.motion);
  for (const OutlineEdge& whole : wall.surface->edges()) {
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
        face.is_open = !wall.surface->closed() && wall.wet_front != wall.wet_back;
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
      if (wall.wet_front) add(true);
      if (wall.wet_back) add(false);
      if (wall.wet_front && wall.wet_back) {
        const int last = count() - 1;
        faces_[static_cast<std::size_t>(last)].partner = last - 1;
        faces_[static_cast<std::size_t>(last - 1)].partner = last;
      }
    }
  }
}

int WallFaces<2>::add_vertex(const Vector<2>& place, int motion) {
  for (std::size_t v = 0; v < vertices_.size(); ++v)
    if (vertex_motion_[v] == motion && norm(vertices_[v].place - place) < coincident * spacing_)
      return static_cast<int>(v);
  vertices_.push_back({.place = place, .sectors = {}});
  vertex_motion_.push_back(motion);
  return static_cast<int>(vertices_.size()) - 1;
}

// From an end into the face.
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

void WallFaces<2>::move_to(double time, double velocity_time) {
  motions_.move_to(time, velocity_time);
  if (any_moves()) {
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      if (faces_[f].motion < 0) continue;
      const Pose<2>& pose = motions_.pose(faces_[f].motion);
      faces_[f].point = pose.of_position(rest_[f].point);
      faces_[f].normal = pose.of_direction(rest_[f].normal);
      faces_[f].center = pose.of_position(rest_[f].center);
    }
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
      if (vertex_motion_[v] < 0) continue;
      const Pose<2>& pose = motions_.pose(vertex_motion_[v]);
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

const Motion<2>* WallFaces<2>::common_motion() const {
  const bool is_common =
      !motions_.empty() && std::ranges::all_of(faces_, [](const FaceData& face) { return face.motion == 0; });
  return is_common ? motions_.motion(0).get() : nullptr;
}

double WallFaces<2>::largest_speed(double time) const {
  std::vector<Pose<2>> pose;
  for (int m = 0; m < motions_.count(); ++m) pose.push_back((*motions_.motion(m))(time));
  const auto speed_at = [](const Pose<2>& at, const Vector<2>& rest) {
    return norm(at.velocity_at(at.of_position(rest)));
  };
  double largest = 0.0;
  for (std::size_t v = 0; v < rest_vertices_.size(); ++v)
    if (vertex_motion_[v] >= 0)
      largest = std::max(largest, speed_at(pose[static_cast<std::size_t>(vertex_motion_[v])], rest_vertices_[v].place));
  for (const FaceData& face : rest_) {
    if (face.motion < 0 || face.radius == 0.0) continue;
    const Pose<2>& of_face = pose[static_cast<std::size_t>(face.motion)];
    double rate = 0.0;
    for (const Vector<2>& row : of_face.spin.row) rate = std::max(rate, norm(row));
    largest = std::max(largest, speed_at(of_face, face.center) + rate * face.radius);
  }
  return largest;
}

// Lists the faces of each cell: those that reach into the cell, made larger by twice the reach.
void WallFaces<2>::arrange() {
  cell_.clear();
  extent_.fill(0);
  std::vector<Box<2>> box;
  Box<2> whole;
  double margin = 2.0 * reach_;
  for (std::size_t f = planes_.size(); f < faces_.size(); ++f) {
    const FaceData& face = faces_[f];
    Box<2> around;
    if (face.radius > 0.0) {
      around = {face.center, face.center};
      for (int k = 0; k < 2; ++k) {
        around.low[k] -= face.radius;
        around.high[k] += face.radius;
      }
    } else {
      const Vector<2>&a = vertex(static_cast<int>(f), 0).place, &b = vertex(static_cast<int>(f), 1).place;
      for (int k = 0; k < 2; ++k) {
        around.low[k] = std::min(a[k], b[k]);
        around.high[k] = std::max(a[k], b[k]);
      }
    }
    for (int k = 0; k < 2; ++k) {
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
  for (int k = 0; k < 2; ++k) edge_ = std::max(edge_, (whole.high[k] - whole.low[k]) / most_cells);
  std::size_t cells = 1;
  for (int k = 0; k < 2; ++k) {
    extent_[static_cast<std::size_t>(k)] = static_cast<int>((whole.high[k] - whole.low[k]) / edge_) + 1;
    cells *= static_cast<std::size_t>(extent_[static_cast<std::size_t>(k)]);
  }
  cell_.assign(cells, planes_);
  for (std::size_t b = 0; b < box.size(); ++b) {
    const int face = static_cast<int>(b + planes_.size());
    std::array<int, 2> first, last, at_cell;
    for (std::size_t k = 0; k < 2; ++k) {
      first[k] = static_cast<int>((box[b].low[static_cast<int>(k)] - low_[static_cast<int>(k)]) / edge_);
      last[k] = std::min(extent_[k] - 1,
                         static_cast<int>((box[b].high[static_cast<int>(k)] - low_[static_cast<int>(k)]) / edge_));
    }
    at_cell = first;
    while (true) {
      Vector<2> middle;
      std::size_t cell = 0;
      for (std::size_t k = 0; k < 2; ++k) {
        middle[static_cast<int>(k)] = low_[static_cast<int>(k)] + (at_cell[k] + 0.5) * edge_;
        cell = cell * static_cast<std::size_t>(extent_[k]) + static_cast<std::size_t>(at_cell[k]);
      }
      if (distance(face, middle) < margin + 0.5 * std::sqrt(2) * edge_) cell_[cell].push_back(face);
      std::size_t k = 2;
      while (k > 0 && ++at_cell[k - 1] > last[k - 1]) {
        at_cell[k - 1] = first[k - 1];
        --k;
      }
      if (k == 0) break;
    }
  }
}

std::span<const int> WallFaces<2>::around(const Vector<2>& x) const {
  if (cell_.empty()) return planes_;
  std::size_t cell = 0;
  for (int k = 0; k < 2; ++k) {
    const double place = (x[k] - low_[k]) / edge_;
    if (!(place >= 0.0 && place < extent_[static_cast<std::size_t>(k)])) return planes_;
    cell = cell * static_cast<std::size_t>(extent_[static_cast<std::size_t>(k)]) + static_cast<std::size_t>(place);
  }
  return cell_[cell];
}

// A body that stands on another, a plate that ends at one.
void WallFaces<2>::cover_vertices() {
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    Vertex& here = vertices_[v];
    const auto is_other = [&](int f) {
      return std::ranges::find(at(f).vertex, static_cast<int>(v)) == at(f).vertex.end();
    };
    here.is_covered = std::ranges::any_of(
        around(here.place), [&](int f) { return is_other(f) && distance(f, here.place) < fade * spacing_; });
  }
}

double WallFaces<2>::height(int face, const Vector<2>& x) const {
  const FaceData& data = at(face);
  if (data.radius > 0.0) return data.bulge * (norm(x - data.center) - data.radius);
  return dot(x - data.point, data.normal);
}

bool WallFaces<2>::covers(const FaceData& face, const Vector<2>& x) const {
  if (face.vertex[0] < 0) return true;
  const Vector<2> begin = vertices_[static_cast<std::size_t>(face.vertex[0])].place - face.center;
  return angle_between(begin, x - face.center, face.sweep > 0.0 ? 1.0 : -1.0) <= std::abs(face.sweep);
}

double WallFaces<2>::distance(int face, const Vector<2>& x) const {
  const FaceData& data = at(face);
  if (data.vertex[0] < 0) return std::abs(height(face, x));
  const Vector<2>&a = vertex(face, 0).place, &b = vertex(face, 1).place;
  if (data.radius > 0.0) {
    if (covers(data, x)) return std::abs(height(face, x));
    return std::min(norm(x - a), norm(x - b));
  }
  const Vector<2> way = b - a;
  const double share = std::clamp(dot(x - a, way) / dot(way, way), 0.0, 1.0);
  return norm(x - a - share * way);
}

const WallFaces<2>::Sector* WallFaces<2>::sector_of(const Vertex& vertex, int face) const {
  for (const Sector& sector : vertex.sectors)
    if (sector.face == face) return &sector;
  return nullptr;
}

bool WallFaces<2>::fades(int face, int end) const {
  const Vertex& here = vertex(face, end);
  return !here.is_covered && sector_of(here, face)->fades;
}

bool WallFaces<2>::is_behind(int face, const Vector<2>& x) const {
  return at(face).is_open && height(face, x) <= 0.0 && distance(face, x) < reach_;
}

void WallFaces<2>::append_near(const Vector<2>& x, std::vector<NearFace>& near) const {
  for (const int f : around(x)) {
    const double apart = distance(f, x);
    if (apart < 2.0 * reach_) near.push_back({f, apart, height(f, x)});
  }
}

// A path that meets a face is as long as the distances of its ends, or longer.
bool WallFaces<2>::may_meet(const NearFace& one, const NearFace& other, double length, bool) const {
  return one.distance + other.distance < length + 2.0 * fade * spacing_;
}

bool WallFaces<2>::has_tests(const Vector<2>& x, std::span<const NearFace> faces) const {
  if (vertices_.empty() && cell_.empty()) return false;
  constexpr std::size_t most = 2;  // faces that need no tests
  std::array<int, most> near{};
  std::size_t found = 0;
  for (const NearFace& face : faces) {
    const int f = face.face;
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
bool WallFaces<2>::crosses(int face, const Vector<2>& from, const Vector<2>& to, double since, double until) const {
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
}

// What is left of a line up to a share of it, beside the faces and vertices that it begins or ends at.
double WallFaces<2>::leg_factor(const Vector<2>& from, const Vector<2>& to, double since, double until,
                                std::span<const int> near, std::span<const int> skipped,
                                std::span<const int> skipped_vertices) const {
  const Vector<2> way = to - from;
  const double length = norm(way);
  if (length == 0.0) return 1.0;
  const Vector<2> end_point = from + until * way;
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
}

double WallFaces<2>::line_factor(const Vector<2>& from, const Vector<2>& to, std::span<const int> faces) const {
  return leg_factor(from, to, 0.0, 1.0, faces, {}, {});
}

bool WallFaces<2>::find_foot(int face, const Vector<2>& x, Foot<2>& foot) const {
  const FaceData& data = at(face);
  const Vector<2> radial = 1.0 / norm(x - data.center) * (x - data.center);
  foot = {data.center + data.radius * radial, data.bulge * radial, height(face, x), {}};
  return foot.height > 0.0 && distance(face, x) < reach_;
}

Meeting<2> WallFaces<2>::meeting(int face, const Vector<2>& one, const Foot<2>& foot, const Vector<2>& two,
                                 const Foot<2>& other_foot) const {
  const FaceData& data = at(face);
  const double height = foot.height, other_height = other_foot.height;
  const Vector<2> between = 1.0 / (height + other_height) * (other_height * one + height * two);
  const Vector<2> radial = 1.0 / norm(between - data.center) * (between - data.center);
  const Face<2> plane{data.center + data.radius * radial, data.bulge * radial};
  const double first = norm(one - plane.point), second = norm(two - plane.point);
  const double cosine = (height + other_height) / norm(reflection_at(plane).of_position(two) - one);
  const double share = (first + second) / (first + second + 2.0 * data.bulge / data.radius * first * second / cosine);
  const Vector<2> along{{-radial[1], radial[0]}};
  Matrix<2> bending;
  bending.add_product(data.bulge / data.radius * along, along);
  return {plane, bending, share};
}

double WallFaces<2>::path_factor(const Vector<2>& from, const Vector<2>& image, const MirrorPath& path,
                                 const Face<2>& plane, std::span<const int> faces) const {
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
    factor *= leg_factor(begin, end, since, share, faces, skipped, {passed.data(), n_passed});
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
  return factor * leg_factor(begin, end, since, 1.0, faces, skipped, {passed.data(), n_passed});
}

// The first face that a way meets from its wet side, or a line from either side.
bool WallFaces<2>::first_hit(const Vector<2>& from, const Vector<2>& to, int skipped, int& face, double& share) const {
  face = -1;
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
  return face >= 0;
}

void WallFaces<2>::confine(const Vector<2>& from, Vector<2>& to, Vector<2>& velocity) const {
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
  Vector<2> begin = from;
  for (int motion = -1; motion < motions_.count(); ++motion) {
    int other = -1;
    double other_share = 0.0;
    const Vector<2> start = motions_.moved_along(motion, from);
    if (!first_hit(start, to, -1, other, other_share) || at(other).motion != motion) continue;
    if (face >= 0 && other_share >= share) continue;
    face = other;
    share = other_share;
    begin = start;
  }
  for (int bounce = 0; face >= 0; ++bounce) {
    const Vector<2> hit = begin + share * (to - begin);
    const FaceData& data = at(face);
    Vector<2> normal = data.radius > 0.0 ? data.bulge / norm(hit - data.center) * (hit - data.center) : data.normal;
    if (data.is_open && dot(to - hit, normal) > 0.0) normal *= -1.0;  // from behind
    const Vector<2> wall_velocity = this->velocity(face, hit);
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

}  // namespace impinge
