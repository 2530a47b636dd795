#include "impinge/geometry/outline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

namespace impinge {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double coincident = 1e-9;    // distance below which points are one, in sizes of the outline
constexpr double angle_error = 1e-12;  // [rad]
constexpr double share_error = 1e-12;  // of a length
constexpr double area_error = 1e-15;   // of a product of lengths

Vector<2> turned_right(const Vector<2>& a) { return {{a[1], -a[0]}}; }
double angle_of(const Vector<2>& a) { return std::atan2(a[1], a[0]); }
Vector<2> direction(double angle) { return {{std::cos(angle), std::sin(angle)}}; }

OutlineEdge segment(const Vector<2>& begin, const Vector<2>& end) { return {.begin = begin, .end = end}; }

/// Angle from the arc's begin to a point's direction, in the arc's sense, in [0, 2 pi) [rad].
double angle_along(const OutlineEdge& arc, const Vector<2>& point) {
  const Vector<2> first = arc.begin - arc.center, second = point - arc.center;
  const double angle = std::atan2(cross(first, second), dot(first, second)) * (arc.sweep > 0.0 ? 1.0 : -1.0);
  return angle < 0.0 ? angle + 2.0 * pi : angle;
}

/// True for a point in a direction from the centre that the arc covers.
bool covers(const OutlineEdge& arc, const Vector<2>& point) {
  const double angle = angle_along(arc, point);
  return angle <= std::abs(arc.sweep) + angle_error || angle >= 2.0 * pi - angle_error;
}

/// Angles of the arc where its tangent is along an axis: odd multiples of pi/2 (`vertical` = false: where y is
/// extreme), even ones (true), in the order of the arc [rad].
std::vector<double> extreme_angles(const OutlineEdge& arc, bool vertical) {
  const double first = angle_of(arc.begin - arc.center), last = first + arc.sweep;
  const double offset = vertical ? 0.0 : 0.5 * pi;
  std::vector<double> angles;
  for (double k = std::ceil((std::min(first, last) - offset) / pi); offset + k * pi < std::max(first, last); k += 1.0)
    angles.push_back(offset + k * pi);
  if (arc.sweep < 0.0) std::ranges::reverse(angles);
  return angles;
}

/// How often a ray from the point along x crosses the edge. A point of the edge at the ray's height counts as below it.
int ray_crossings(const OutlineEdge& edge, const Vector<2>& point) {
  const auto passes = [&](double from, double to) { return (from > point[1]) != (to > point[1]); };
  if (edge.straight()) {
    if (!passes(edge.begin[1], edge.end[1])) return 0;
    const bool left = cross(edge.end - edge.begin, point - edge.begin) > 0.0;
    return left == (edge.end[1] > edge.begin[1]) ? 1 : 0;
  }
  const double height = point[1] - edge.center[1];
  const double half_chord = std::sqrt(std::max(edge.radius * edge.radius - height * height, 0.0));
  const double first = angle_of(edge.begin - edge.center);
  double angle = first, y = edge.begin[1];
  int crossings = 0;
  const auto go_to = [&](double next_angle, double next_y) {
    const double side = std::cos(0.5 * (angle + next_angle)) > 0.0 ? 1.0 : -1.0;
    if (passes(y, next_y) && point[0] < edge.center[0] + side * half_chord) ++crossings;
    angle = next_angle;
    y = next_y;
  };
  for (const double extreme : extreme_angles(edge, false))
    go_to(extreme, edge.center[1] + (std::sin(extreme) > 0.0 ? edge.radius : -edge.radius));
  go_to(first + edge.sweep, edge.end[1]);
  return crossings;
}

/// Share of the segment from a to b before its first point on the edge.
std::optional<double> share_before(const Vector<2>& a, const Vector<2>& b, const OutlineEdge& edge) {
  const Vector<2> along = b - a;
  const double square = dot(along, along);
  if (square == 0.0) return std::nullopt;
  if (!edge.straight()) {
    const Vector<2> offset = a - edge.center;
    const double half = dot(along, offset);
    const double constant = dot(offset, offset) - edge.radius * edge.radius;
    const double discriminant = half * half - square * constant;
    if (discriminant < 0.0) return std::nullopt;
    const double q = -(half + std::copysign(std::sqrt(discriminant), half));
    std::array<double, 2> shares{q / square, q == 0.0 ? 0.0 : constant / q};
    std::ranges::sort(shares);
    for (const double share : shares)
      if (share > -share_error && share < 1.0 + share_error && covers(edge, a + share * along))
        return std::clamp(share, 0.0, 1.0);
    return std::nullopt;
  }
  // Signed areas within their rounding errors count as 0, so that no segment slips through between two edges.
  const Vector<2> to_begin = edge.begin - a, to_end = edge.end - a, way = edge.end - edge.begin;
  const double reach = norm(to_begin) + norm(to_end) + norm(along);
  const auto apart = [&](double one, double two, double length) {
    const double rounding = area_error * reach * length;
    return std::min(one, two) > rounding || std::max(one, two) < -rounding;
  };
  const double begin_side = cross(along, to_begin), end_side = cross(along, to_end);
  const double a_side = cross(way, a - edge.begin), b_side = cross(way, b - edge.begin);
  if (apart(begin_side, end_side, norm(along)) || apart(a_side, b_side, norm(way))) return std::nullopt;
  const bool parallel = std::max(std::abs(a_side), std::abs(b_side)) <= area_error * reach * norm(way);
  const double share =
      parallel ? std::min(dot(along, to_begin), dot(along, to_end)) / square : a_side / (a_side - b_side);
  // Of almost parallel lines the sides tell little.
  const double clamped = std::clamp(share, 0.0, 1.0);
  const Vector<2> point = a + clamped * along;
  if (norm(edge.nearest(point) - point) > share_error * reach) return std::nullopt;
  return clamped;
}

/// A point that two edges have in common.
std::optional<Vector<2>> common_point(const OutlineEdge& first, const OutlineEdge& second) {
  for (const auto& [line, other] : {std::pair{&first, &second}, std::pair{&second, &first}}) {
    if (!line->straight()) continue;
    const auto share = share_before(line->begin, line->end, *other);
    return share ? std::optional(line->at(*share)) : std::nullopt;
  }
  const Vector<2> between = second.center - first.center;
  const double square = dot(between, between);
  if (square == 0.0) return std::nullopt;
  const double along = 0.5 * (1.0 + (first.radius * first.radius - second.radius * second.radius) / square);
  const double across_square = first.radius * first.radius / square - along * along;
  if (across_square < 0.0) return std::nullopt;
  for (const double across : {std::sqrt(across_square), -std::sqrt(across_square)}) {
    const Vector<2> point = first.center + along * between + across * turned_right(between);
    if (covers(first, point) && covers(second, point)) return point;
  }
  return std::nullopt;
}

/// Calls use(share of the first, share of the second) for the ends of each connection of two edges that may be the
/// shortest, here or on a piece of their way.
template <class Use>
void for_connections(const OutlineEdge& first, const OutlineEdge& second, Use&& use) {
  for (const double end : {0.0, 1.0}) use(end, second.nearest_share(first.at(end)));
  for (const double end : {0.0, 1.0}) use(first.nearest_share(second.at(end)), end);
  // Between the ends it is perpendicular to both: on the line from an arc's centre to the segment or to the other
  // centre; of parallel segments anywhere.
  if (!first.straight() && second.straight()) {
    const double foot = second.nearest_share(first.center);
    use(first.nearest_share(second.at(foot)), foot);
  } else if (first.straight() && !second.straight()) {
    const double foot = first.nearest_share(second.center);
    use(foot, second.nearest_share(first.at(foot)));
  } else if (first.straight()) {
    const double middle = 0.5 * (first.nearest_share(second.begin) + first.nearest_share(second.end));
    use(middle, second.nearest_share(first.at(middle)));
  } else {
    const Vector<2> between = second.center - first.center;
    if (norm(between) == 0.0) return;
    const Vector<2> reach = first.radius / norm(between) * between;
    for (const Vector<2>& point : {first.center + reach, first.center - reach}) {
      const double begin = first.nearest_share(point);
      use(begin, second.nearest_share(first.at(begin)));
    }
  }
}

/// The shortest connection of two edges.
Gap gap_between(const OutlineEdge& first, const OutlineEdge& second) {
  if (const auto point = common_point(first, second)) return {0.0, *point, *point};
  Gap gap;
  for_connections(first, second, [&](double one, double two) {
    const Vector<2> begin = first.at(one), end = second.at(two);
    const double width = norm(end - begin);
    if (width < gap.width) gap = {width, begin, end};
  });
  return gap;
}

/// The edges of an outline, long arcs in pieces: no piece comes near itself again.
class Pieces {
 public:
  explicit Pieces(const Outline& outline) : closed_(outline.closed()) {
    constexpr double longest = 0.5 * pi;  // of an arc [rad]
    for (const OutlineEdge& edge : outline.edges()) {
      const int count = std::max(1, static_cast<int>(std::ceil(std::abs(edge.sweep) / longest - angle_error)));
      for (int k = 0; k < count; ++k) {
        OutlineEdge piece = edge;
        piece.begin = edge.at(static_cast<double>(k) / count);
        piece.end = edge.at((k + 1.0) / count);
        piece.sweep = edge.sweep / count;
        edges_.push_back(piece);
        discs_.push_back({piece.at(0.5), 0.5 * piece.length()});
      }
    }
  }

  const std::vector<OutlineEdge>& edges() const { return edges_; }

  /// At most the distance of a piece to another's [m].
  double least_distance(std::size_t k, const Pieces& others, std::size_t other) const {
    const Disc &one = discs_[k], &two = others.discs_[other];
    return norm(one.center - two.center) - one.radius - two.radius;
  }

  /// Calls use(point) for the points at a small distance [m] along the outline from a share of a piece.
  template <class Use>
  void for_steps(std::size_t k, double share, double distance, Use&& use) const {
    const std::size_t n = edges_.size();
    const double step = distance / edges_[k].length();
    if (share > share_error) {
      use(edges_[k].at(share - step));
    } else if (closed_ || k > 0) {
      const OutlineEdge& before = edges_[(k + n - 1) % n];
      use(before.at(1.0 - distance / before.length()));
    }
    if (share < 1.0 - share_error) {
      use(edges_[k].at(share + step));
    } else if (closed_ || k + 1 < n) {
      const OutlineEdge& after = edges_[(k + 1) % n];
      use(after.at(distance / after.length()));
    }
  }

 private:
  struct Disc {
    Vector<2> center;
    double radius;
  };

  bool closed_;
  std::vector<OutlineEdge> edges_;
  std::vector<Disc> discs_;  // around them
};

/// True if no small step of either end along its outline makes a connection shorter. Each end: piece, share.
bool is_throat(const Pieces& first, std::pair<std::size_t, double> one, const Pieces& second,
               std::pair<std::size_t, double> two, double width) {
  constexpr double small = 0.01, rounding = 1e-9;  // of the width
  bool result = true;
  const auto step_from = [&](const Pieces& pieces, const auto& end, const OutlineEdge& other) {
    pieces.for_steps(end.first, end.second, small * width, [&](const Vector<2>& point) {
      if (norm(other.nearest(point) - point) < (1.0 - rounding) * width) result = false;
    });
  };
  step_from(first, one, second.edges()[two.first]);
  if (result) step_from(second, two, first.edges()[one.first]);
  return result;
}

Box<2> bounds_of(std::span<const Vector<2>> points) {
  Box<2> box{points.front(), points.front()};
  for (const Vector<2>& point : points) {
    for (int k = 0; k < 2; ++k) {
      box.low[k] = std::min(box.low[k], point[k]);
      box.high[k] = std::max(box.high[k], point[k]);
    }
  }
  return box;
}

double size_of(const Box<2>& box) { return norm(box.high - box.low); }

std::string text(const Vector<2>& point) { return fmt::format("({}, {})", point[0], point[1]); }

std::vector<OutlineEdge> join(const std::vector<Vector<2>>& points, bool closed) {
  std::vector<OutlineEdge> edges;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) edges.push_back(segment(points[k], points[k + 1]));
  if (closed) edges.push_back(segment(points.back(), points.front()));
  return edges;
}

/// Appends what is wrong with the corners of an outline; true if nothing is.
bool check_corners(const std::vector<Vector<2>>& points, bool closed, std::vector<std::string>& mistakes) {
  constexpr int most_crossings = 5;  // more would hide the other mistakes of a case
  const char* name = closed ? "polygon" : "polyline";
  const std::size_t least = closed ? 3 : 2;
  if (points.size() < least) {
    mistakes.push_back(fmt::format("a {} needs at least {} points, but it has {}", name, least, points.size()));
    return false;
  }
  const std::size_t before = mistakes.size();
  const double margin = coincident * size_of(bounds_of(points));
  const auto same = [&](const Vector<2>& one, const Vector<2>& two) { return norm(one - two) <= margin; };
  for (std::size_t k = 0; k + 1 < points.size(); ++k)
    if (same(points[k], points[k + 1]))
      mistakes.push_back(
          fmt::format("points {} and {} of the {} are the same, {}", k + 1, k + 2, name, text(points[k])));
  if (points.size() > 2 && same(points.front(), points.back())) {
    mistakes.push_back(
        closed ? fmt::format("the last point of the polygon repeats the first, {}; leave it out", text(points[0]))
               : fmt::format("the last point of the polyline is the first, {}; a closed line is a polygon",
                             text(points[0])));
  }
  if (mistakes.size() > before) return false;

  if (closed) {
    const auto farthest = std::ranges::max(points, {}, [&](const Vector<2>& p) { return norm(p - points[0]); });
    const Vector<2> line = 1.0 / norm(farthest - points[0]) * (farthest - points[0]);
    if (std::ranges::all_of(points,
                            [&](const Vector<2>& p) { return !(std::abs(cross(line, p - points[0])) > margin); })) {
      mistakes.push_back("the points of the polygon lie on one line: it has no area");
      return false;
    }
  }

  const std::vector<OutlineEdge> edges = join(points, closed);
  int crossings = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = i + 1; j < edges.size(); ++j) {
      const OutlineEdge &one = edges[i], &two = edges[j];
      const auto off = [&](const OutlineEdge& edge, const Vector<2>& point) {
        return norm(edge.nearest(point) - point) > margin;
      };
      const bool follows = j == i + 1, precedes = closed && i == 0 && j + 1 == edges.size();
      // Neighbours have one point in common; they must not run back over each other.
      const bool apart = follows    ? off(one, two.end) && off(two, one.begin)
                         : precedes ? off(one, two.begin) && off(two, one.end)
                                    : gap_between(one, two).width > margin;
      if (apart) continue;
      if (++crossings > most_crossings) return false;
      mistakes.push_back(fmt::format("the {} meets itself: edge {} from {} to {} and edge {} from {} to {}", name,
                                     i + 1, text(one.begin), text(one.end), j + 1, text(two.begin), text(two.end)));
    }
  }
  return mistakes.size() == before;
}

/// Drops the corners that lie on the line between the corners beside them.
std::vector<Vector<2>> without_straight_corners(const std::vector<Vector<2>>& points, bool closed) {
  const double margin = coincident * size_of(bounds_of(points));
  const std::size_t n = points.size();
  const auto bends = [&](const Vector<2>& last, std::size_t k) {
    const Vector<2> line = points[(k + 1) % n] - last;
    return std::abs(cross(line, points[k] - last)) > margin * norm(line);
  };
  std::size_t first = 0;
  while (closed && first + 1 < n && !bends(points[(first + n - 1) % n], first)) ++first;
  std::vector<Vector<2>> corners{points[first]};
  for (std::size_t k = first + 1; k < first + n; ++k)
    if ((!closed && k + 1 == n) || bends(corners.back(), k % n)) corners.push_back(points[k % n]);
  return corners;
}

double area_of(const std::vector<OutlineEdge>& edges) {
  const Vector<2> origin = edges.front().begin;  // near the shape, so that little cancels
  double area = 0.0;
  for (const OutlineEdge& edge : edges) {
    area += 0.5 * cross(edge.begin - origin, edge.end - origin);
    if (!edge.straight()) area += 0.5 * edge.radius * edge.radius * (edge.sweep - std::sin(edge.sweep));
  }
  return area;
}

void check_radius(double radius, std::vector<std::string>& mistakes) {
  if (!(radius > 0.0)) mistakes.push_back(fmt::format("the radius must be positive, but it is {}", radius));
}

}  // namespace

double OutlineEdge::length() const { return straight() ? norm(end - begin) : radius * std::abs(sweep); }

Vector<2> OutlineEdge::at(double share) const {
  if (share <= 0.0) return begin;
  if (share >= 1.0) return end;
  if (straight()) return begin + share * (end - begin);
  return center + radius * direction(angle_of(begin - center) + share * sweep);
}

Vector<2> OutlineEdge::normal(double share) const {
  if (straight()) return 1.0 / length() * turned_right(end - begin);
  return (sweep > 0.0 ? 1.0 : -1.0) / radius * (at(share) - center);
}

double OutlineEdge::nearest_share(const Vector<2>& point) const {
  if (straight()) {
    const Vector<2> along = end - begin;
    return std::clamp(dot(along, point - begin) / dot(along, along), 0.0, 1.0);
  }
  const double angle = angle_along(*this, point), whole = std::abs(sweep);
  if (angle <= whole) return angle / whole;
  return angle - whole < 2.0 * pi - angle ? 1.0 : 0.0;
}

Outline::Outline(std::vector<OutlineEdge> edges, bool closed) : edges_(std::move(edges)), closed_(closed) {
  std::vector<Vector<2>> points;
  for (const OutlineEdge& edge : edges_) {
    points.push_back(edge.begin);
    points.push_back(edge.end);
    if (edge.straight()) continue;
    for (const bool vertical : {false, true})
      for (const double angle : extreme_angles(edge, vertical))
        points.push_back(edge.center + edge.radius * direction(angle));
  }
  bounds_ = bounds_of(points);
  if (closed_) area_ = area_of(edges_);
}

double Outline::length() const {
  double sum = 0.0;
  for (const OutlineEdge& edge : edges_) sum += edge.length();
  return sum;
}

NearestPoint Outline::nearest(const Vector<2>& point) const {
  NearestPoint nearest;
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    const Vector<2> on_edge = edges_[k].nearest(point);
    const double distance = norm(on_edge - point);
    if (distance < nearest.distance) nearest = {on_edge, k, distance};
  }
  return nearest;
}

bool Outline::encloses(const Vector<2>& point) const {
  if (!closed_) return false;
  int crossings = 0;
  for (const OutlineEdge& edge : edges_) crossings += ray_crossings(edge, point);
  return crossings % 2 == 1;
}

double Outline::distance(const Vector<2>& point) const {
  const double distance = nearest(point).distance;
  return encloses(point) ? -distance : distance;
}

Vector<2> Outline::normal(const Vector<2>& point) const {
  const NearestPoint found = nearest(point);
  const double margin = coincident * size_of(bounds_);
  if (found.distance > margin) return (encloses(point) ? -1.0 : 1.0) / found.distance * (point - found.point);
  // On the outline; at a corner both edges count.
  Vector<2> sum;
  for (const OutlineEdge& edge : edges_) {
    const double share = edge.nearest_share(point);
    if (norm(edge.at(share) - found.point) <= margin) sum += edge.normal(share);
  }
  const double length = norm(sum);
  return length > 0.0 ? 1.0 / length * sum : edges_[found.edge].normal(edges_[found.edge].nearest_share(point));
}

std::optional<Hit> Outline::first_hit(const Vector<2>& from, const Vector<2>& to) const {
  std::optional<Hit> first;
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    const auto share = share_before(from, to, edges_[k]);
    if (share && (!first || *share < first->share)) first = Hit{from + *share * (to - from), k, *share};
  }
  return first;
}

std::optional<Outline> make_box(const Vector<2>& low, const Vector<2>& high, std::vector<std::string>& mistakes) {
  const std::size_t before = mistakes.size();
  for (int k = 0; k < 2; ++k)
    if (!(low[k] < high[k]))
      mistakes.push_back(
          fmt::format("the box has no {}: it reaches from {} to {}", k == 0 ? "width" : "height", low[k], high[k]));
  if (mistakes.size() > before) return std::nullopt;
  return Outline(join({low, {{high[0], low[1]}}, high, {{low[0], high[1]}}}, true), true);
}

std::optional<Outline> make_circle(const Vector<2>& center, double radius, std::vector<std::string>& mistakes) {
  const std::size_t before = mistakes.size();
  check_radius(radius, mistakes);
  if (mistakes.size() > before) return std::nullopt;
  const Vector<2> begin = center + Vector<2>{{radius, 0.0}};
  return Outline({{begin, begin, center, radius, 2.0 * pi}}, true);
}

std::optional<Outline> make_arc(const Vector<2>& center, double radius, double from, double to,
                                std::vector<std::string>& mistakes) {
  const std::size_t before = mistakes.size();
  check_radius(radius, mistakes);
  if (!(std::abs(to - from) > 0.0 && std::abs(to - from) < 360.0))
    mistakes.push_back(
        fmt::format("the arc from {} to {} degrees must be more than 0 and less than 360 degrees long", from, to));
  if (mistakes.size() > before) return std::nullopt;
  const Vector<2> start{{radius, 0.0}};
  return Outline(
      {{center + rotation(from) * start, center + rotation(to) * start, center, radius, (to - from) * pi / 180.0}},
      false);
}

std::optional<Outline> make_polygon(std::vector<Vector<2>> points, std::vector<std::string>& mistakes) {
  if (!check_corners(points, true, mistakes)) return std::nullopt;
  if (area_of(join(points, true)) < 0.0) std::reverse(points.begin() + 1, points.end());
  return Outline(join(without_straight_corners(points, true), true), true);
}

std::optional<Outline> make_polyline(std::vector<Vector<2>> points, std::vector<std::string>& mistakes) {
  if (!check_corners(points, false, mistakes)) return std::nullopt;
  return Outline(join(without_straight_corners(points, false), false), false);
}

Outline transformed(const Outline& outline, const Transform<2>& transform) {
  std::vector<OutlineEdge> edges = outline.edges();
  for (OutlineEdge& edge : edges) {
    edge.begin = transform(edge.begin);
    edge.end = transform(edge.end);
    edge.center = transform(edge.center);
    edge.radius *= transform.scale;
  }
  return Outline(std::move(edges), outline.closed());
}

Gap narrowest_gap(const Outline& first, const Outline& second) {
  Gap narrowest;
  for (const OutlineEdge& one : first.edges()) {
    for (const OutlineEdge& two : second.edges()) {
      const Gap gap = gap_between(one, two);
      if (gap.width < narrowest.width) narrowest = gap;
    }
  }
  return narrowest;
}

std::optional<Gap> narrowest_throat(const Outline& first, const Outline& second, double least,
                                    const std::function<bool(const Gap&)>& counts) {
  const Pieces of_first(first), of_second(second);
  const auto &ones = of_first.edges(), &twos = of_second.edges();
  Gap narrowest;
  for (std::size_t i = 0; i < ones.size(); ++i) {
    for (std::size_t j = &first == &second ? i + 1 : 0; j < twos.size(); ++j) {
      if (of_first.least_distance(i, of_second, j) >= narrowest.width) continue;
      for_connections(ones[i], twos[j], [&](double one, double two) {
        const Gap gap{.width = 0.0, .begin = ones[i].at(one), .end = twos[j].at(two)};
        const double width = norm(gap.end - gap.begin);
        if (!(width > least && width < narrowest.width)) return;
        if (!is_throat(of_first, {i, one}, of_second, {j, two}, width)) return;
        if (const Gap found{width, gap.begin, gap.end}; counts(found)) narrowest = found;
      });
    }
  }
  if (std::isinf(narrowest.width)) return std::nullopt;
  return narrowest;
}

}  // namespace impinge
