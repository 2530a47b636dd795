#include "impinge/geometry/mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <unordered_map>

namespace impinge {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double smooth = pi / 9.0;     // facets that meet at less than this are one patch [rad]
constexpr double coincident = 1e-6;     // distance of points that are one, over the surface's size
constexpr double least_height = 1e-12;  // of a facet that has an area, over its longest side
constexpr std::size_t most_told = 3;    // mistakes of a kind

Vector<3> unit(const Vector<3>& a) {
  const double size = norm(a);
  return size > 0.0 ? 1.0 / size * a : a;
}

double angle_of(const Vector<3>& a, const Vector<3>& b) { return std::atan2(norm(cross(a, b)), dot(a, b)); }

Box<3> box_around(const std::array<Vector<3>, 3>& corner) {
  Box<3> box{corner[0], corner[0]};
  for (int k = 0; k < 3; ++k) {
    box.low[k] = std::min({corner[0][k], corner[1][k], corner[2][k]});
    box.high[k] = std::max({corner[0][k], corner[1][k], corner[2][k]});
  }
  return box;
}

std::string place_text(const Vector<3>& x) { return fmt::format("({:.4g}, {:.4g}, {:.4g}) m", x[0], x[1], x[2]); }

/// Two unit vectors that make a right-handed system with a third.
std::array<Vector<3>, 2> across(const Vector<3>& axis) {
  int least = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(axis[k]) < std::abs(axis[least])) least = k;
  Vector<3> other;
  other[least] = 1.0;
  const Vector<3> first = unit(cross(axis, other));
  return {first, cross(axis, first)};
}

/// Where a line meets a facet between its ends; NaN if it does not.
double share_of_meeting(const std::array<Vector<3>, 3>& c, const Vector<3>& from, const Vector<3>& to) {
  // Moller & Trumbore 1997.
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const Vector<3> one = c[1] - c[0], two = c[2] - c[0], way = to - from, side = cross(way, two);
  const double size = dot(one, side);
  if (size == 0.0) return none;
  const Vector<3> off = from - c[0];
  const double u = dot(off, side) / size;
  if (u < 0.0 || u > 1.0) return none;
  const Vector<3> other = cross(off, one);
  const double v = dot(way, other) / size;
  if (v < 0.0 || u + v > 1.0) return none;
  const double share = dot(two, other) / size;
  return share >= 0.0 && share <= 1.0 ? share : none;
}

/// Gives points that coincide one number.
std::vector<int> joined_points(const std::vector<Vector<3>>& points, double apart) {
  struct Hash {
    std::size_t operator()(const std::array<std::int64_t, 3>& c) const {
      std::size_t sum = 0;
      for (const std::int64_t x : c) sum = (sum ^ static_cast<std::size_t>(x)) * 0x9e3779b97f4a7c15U;
      return sum ^ (sum >> 29U);
    }
  };
  std::unordered_map<std::array<std::int64_t, 3>, std::vector<int>, Hash> cells;
  std::vector<int> number(points.size());
  for (std::size_t p = 0; p < points.size(); ++p) {
    std::array<std::int64_t, 3> cell;
    for (std::size_t k = 0; k < 3; ++k)
      cell[k] = static_cast<std::int64_t>(std::floor(points[p][static_cast<int>(k)] / (2.0 * apart)));
    number[p] = static_cast<int>(p);
    for (std::int64_t n = 0; n < 27 && number[p] == static_cast<int>(p); ++n) {
      const auto found = cells.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
      if (found == cells.end()) continue;
      for (const int other : found->second)
        if (norm(points[static_cast<std::size_t>(other)] - points[p]) < apart) number[p] = other;
    }
    if (number[p] == static_cast<int>(p)) cells[cell].push_back(static_cast<int>(p));
  }
  return number;
}

/// Adds at most some mistakes of a kind.
class Told {
 public:
  explicit Told(std::vector<std::string>& mistakes) : mistakes_(mistakes) {}
  void add(const std::string& what) {
    if (count_++ < most_told) mistakes_.push_back(what);
  }
  ~Told() {
    if (count_ > most_told) mistakes_.push_back(fmt::format("{} more of these", count_ - most_told));
  }
  Told(const Told&) = delete;
  Told& operator=(const Told&) = delete;

 private:
  std::vector<std::string>& mistakes_;
  std::size_t count_ = 0;
};

}  // namespace

Facets box_facets(const Vector<3>& low, const Vector<3>& high) {
  Facets result;
  for (int k = 0; k < 8; ++k) result.points.push_back(Box<3>{low, high}.corner(k));
  for (const auto& [a, b, c, d] : {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
                                   std::array{2, 6, 7, 3}, std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}}) {
    result.facets.push_back({a, b, c});
    result.facets.push_back({a, c, d});
  }
  return result;
}

Facets sphere_facets(const Vector<3>& center, double radius) {
  constexpr int parts = 4;  // how often the facets of an icosahedron are cut into four
  const double golden = std::numbers::phi;
  Facets result;
  result.points = {{{-1, golden, 0}}, {{1, golden, 0}}, {{-1, -golden, 0}}, {{1, -golden, 0}},
                   {{0, -1, golden}}, {{0, 1, golden}}, {{0, -1, -golden}}, {{0, 1, -golden}},
                   {{golden, 0, -1}}, {{golden, 0, 1}}, {{-golden, 0, -1}}, {{-golden, 0, 1}}};
  result.facets = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                   {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                   {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int part = 0; part < parts; ++part) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [found, is_new] = middles.emplace(std::minmax(a, b), static_cast<int>(result.points.size()));
      if (is_new)
        result.points.push_back(unit(result.points[static_cast<std::size_t>(a)]) +
                                unit(result.points[static_cast<std::size_t>(b)]));
      return found->second;
    };
    std::vector<Facet> finer;
    for (const auto& [a, b, c] : result.facets) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    result.facets = finer;
  }
  for (Vector<3>& point : result.points) point = center + radius * unit(point);
  return result;
}

Facets cone_facets(const Vector<3>& begin, const Vector<3>& end, double radius, double end_radius) {
  constexpr int parts = 96;  // of a turn
  const auto [first, second] = across(unit(end - begin));
  Facets result;
  result.points = {begin, end};
  const auto add_ring = [&](const Vector<3>& middle, double size) {
    const auto ring = static_cast<int>(result.points.size());
    for (int k = 0; k < parts; ++k) {
      const double angle = 2.0 * pi * k / parts;
      result.points.push_back(middle + size * (std::cos(angle) * first + std::sin(angle) * second));
    }
    return ring;
  };
  const int low = radius > 0.0 ? add_ring(begin, radius) : -1, high = end_radius > 0.0 ? add_ring(end, end_radius) : -1;
  for (int k = 0; k < parts; ++k) {
    const int next = (k + 1) % parts;
    if (low >= 0) result.facets.push_back({0, low + next, low + k});
    if (high >= 0) result.facets.push_back({1, high + k, high + next});
    if (low >= 0) result.facets.push_back({low + k, low + next, high >= 0 ? high + next : 1});
    if (high >= 0) result.facets.push_back({low >= 0 ? low + k : 0, high + next, high + k});
  }
  return result;
}

// By cutting off ears.
std::optional<Facets> polygon_facets(const std::vector<Vector<3>>& points, std::vector<std::string>& mistakes) {
  if (points.size() < 3) {
    mistakes.push_back(fmt::format("{} points; allowed: at least 3", points.size()));
    return {};
  }
  Vector<3> area;
  double size = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    area += 0.5 * cross(points[k] - points[0], points[(k + 1) % points.size()] - points[0]);
    size = std::max(size, norm(points[k] - points[0]));
  }
  if (!(norm(area) > 1e-9 * size * size)) {
    mistakes.push_back("the points enclose no area");
    return {};
  }
  const Vector<3> up = unit(area);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double off = dot(points[k] - points[0], up);
    if (std::abs(off) <= 1e-6 * size) continue;
    mistakes.push_back(fmt::format("point {} is {:.3g} m off the plane of the others", k + 1, std::abs(off)));
    return {};
  }
  Facets result{points, {}};
  std::vector<int> ring(points.size());
  std::iota(ring.begin(), ring.end(), 0);
  const auto at = [&](std::size_t k) { return points[static_cast<std::size_t>(ring[k % ring.size()])]; };
  const auto turn = [&](const Vector<3>& a, const Vector<3>& b, const Vector<3>& c) {
    return dot(cross(b - a, c - b), up);
  };
  while (ring.size() > 3) {
    bool is_cut = false;
    for (std::size_t k = 0; k < ring.size() && !is_cut; ++k) {
      const std::size_t before = k + ring.size() - 1;
      const Vector<3> a = at(before), b = at(k), c = at(k + 1);
      if (!(turn(a, b, c) > 1e-12 * size * size)) continue;
      bool is_free = true;
      for (const int other : ring) {
        const Vector<3>& x = points[static_cast<std::size_t>(other)];
        if (x == a || x == b || x == c) continue;
        is_free &= !(turn(a, b, x) >= 0.0 && turn(b, c, x) >= 0.0 && turn(c, a, x) >= 0.0);
      }
      if (!is_free) continue;
      result.facets.push_back({ring[before % ring.size()], ring[k], ring[(k + 1) % ring.size()]});
      ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(k));
      is_cut = true;
    }
    if (!is_cut) {
      mistakes.push_back("the polygon crosses itself");
      return {};
    }
  }
  result.facets.push_back({ring[0], ring[1], ring[2]});
  return result;
}

std::array<Vector<3>, 3> Mesh::corners(int facet) const {
  const Facet& f = facets_[static_cast<std::size_t>(facet)];
  return {points_[static_cast<std::size_t>(f[0])], points_[static_cast<std::size_t>(f[1])],
          points_[static_cast<std::size_t>(f[2])]};
}

// Baerentzen & Aanaes 2005: the sign of the distance by normals weighted with the angles of the facets.
Mesh::Nearest Mesh::nearest(const Vector<3>& point) const {
  double best = std::numeric_limits<double>::infinity();
  int facet = -1;
  FacetPoint at{};
  tree_.nearest(point, best, [&](int f) {
    const FacetPoint here = nearest_on_facet(corners(f), point);
    const Vector<3> off = here.point - point;
    if (const double square = dot(off, off); square < best) {
      best = square;
      facet = f;
      at = here;
    }
    return best;
  });
  const auto f = static_cast<std::size_t>(facet);
  int zeros = 0;
  std::size_t zero = 0, full = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (at.share[k] == 0.0) {
      ++zeros;
      zero = k;
    } else {
      full = k;
    }
  }
  Vector<3> up;
  bool ends = false;
  if (zeros == 0) {
    const auto c = corners(facet);
    up = cross(c[1] - c[0], c[2] - c[0]);
  } else if (zeros == 1) {
    up = edge_normal_[f][(zero + 1) % 3];
    ends = edge_ends_[f][(zero + 1) % 3];
  } else {
    const auto v = static_cast<std::size_t>(facets_[f][full]);
    up = point_normal_[v];
    ends = at_end_[v] != 0;
  }
  return {at.point, std::sqrt(best), dot(point - at.point, up) >= 0.0, ends};
}

double Mesh::distance(const Vector<3>& point) const {
  const Nearest near = nearest(point);
  return closed_ && !near.is_in_front ? -near.distance : near.distance;
}

Vector<3> Mesh::normal(const Vector<3>& point) const {
  const Nearest near = nearest(point);
  const Vector<3> way = closed_ && !near.is_in_front ? near.point - point : point - near.point;
  return unit(way);
}

bool Mesh::meets(const Vector<3>& from, const Vector<3>& to) const {
  bool is_met = false;
  tree_.along(from, to, 0.0, [&](int f) { is_met |= !std::isnan(share_of_meeting(corners(f), from, to)); });
  return is_met;
}

// Patches and their edges; `neighbours`: of each facet beyond the edge that begins at a corner, -1 where it ends.
void Mesh::join(const std::vector<std::array<int, 3>>& neighbours) {
  const std::size_t count = facets_.size();
  std::vector<Vector<3>> up(count);
  std::vector<Box<3>> boxes;
  for (std::size_t f = 0; f < count; ++f) {
    const auto c = corners(static_cast<int>(f));
    const Vector<3> twice = cross(c[1] - c[0], c[2] - c[0]);
    area_ += 0.5 * norm(twice);
    volume_ += dot(c[0] - points_[0], twice) / 6.0;
    up[f] = unit(twice);
    boxes.push_back(box_around(c));
  }
  tree_ = BoxTree(boxes);
  point_normal_.assign(points_.size(), {});
  at_end_.assign(points_.size(), 0);
  edge_normal_.resize(count);
  edge_ends_.resize(count);
  for (std::size_t f = 0; f < count; ++f) {
    const auto c = corners(static_cast<int>(f));
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(facets_[f][k]);
      point_normal_[v] += angle_of(c[(k + 1) % 3] - c[k], c[(k + 2) % 3] - c[k]) * up[f];
      const int other = neighbours[f][k];
      edge_normal_[f][k] = other < 0 ? up[f] : up[f] + up[static_cast<std::size_t>(other)];
      edge_ends_[f][k] = other < 0;
      if (other < 0) {
        closed_ = false;
        at_end_[v] = 1;
        at_end_[static_cast<std::size_t>(facets_[f][(k + 1) % 3])] = 1;
      }
    }
  }
  // Facets that meet without a sharp edge.
  std::vector<int> patch(count, -1);
  std::vector<std::vector<Facet>> members;
  for (std::size_t seed = 0; seed < count; ++seed) {
    if (patch[seed] >= 0) continue;
    const auto number = static_cast<int>(members.size());
    members.emplace_back();
    std::vector<std::size_t> open{seed};
    patch[seed] = number;
    while (!open.empty()) {
      const std::size_t f = open.back();
      open.pop_back();
      members.back().push_back(facets_[f]);
      for (const int other : neighbours[f]) {
        if (other < 0) continue;
        const auto g = static_cast<std::size_t>(other);
        if (patch[g] >= 0 || angle_of(up[f], up[g]) >= smooth) continue;
        patch[g] = number;
        open.push_back(g);
      }
    }
  }
  for (const std::vector<Facet>& facets : members) patches_.push_back(std::make_shared<const Patch>(points_, facets));
  for (std::size_t f = 0; f < count; ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int other = neighbours[f][k];
      if (other >= 0 && patch[static_cast<std::size_t>(other)] == patch[f]) continue;
      const Vector<3>&begin = points_[static_cast<std::size_t>(facets_[f][k])],
            &end = points_[static_cast<std::size_t>(facets_[f][(k + 1) % 3])];
      double angle = 2.0 * pi;
      if (other >= 0) {
        const auto g = static_cast<std::size_t>(other);
        const bool is_ridge = dot(cross(up[f], up[g]), end - begin) > 0.0;
        angle = pi + (is_ridge ? 1.0 : -1.0) * angle_of(up[f], up[g]);
      }
      edges_.push_back({begin, end, patch[f], other < 0 ? -1 : patch[static_cast<std::size_t>(other)], angle});
    }
  }
}

std::optional<Mesh> make_mesh(const Facets& given, std::vector<std::string>& mistakes,
                              std::vector<std::string>& warnings) {
  const std::size_t before = mistakes.size();
  double size = 0.0;
  for (std::size_t p = 0; p < given.points.size(); ++p) {
    double sum = 0.0;
    for (const double x : given.points[p].component) sum += x;
    if (!std::isfinite(sum)) {
      mistakes.push_back(fmt::format("point {} is no place", p + 1));
      return {};
    }
    size = std::max(size, norm(given.points[p] - given.points[0]));
  }
  const std::vector<int> number = joined_points(given.points, std::max(coincident * size, 1e-300));
  Mesh mesh;
  mesh.points_ = given.points;
  std::vector<std::size_t> name;  // of each facet: its number in what was given
  std::size_t flat = 0, first_flat = 0;
  for (std::size_t f = 0; f < given.facets.size(); ++f) {
    Facet facet;
    for (std::size_t k = 0; k < 3; ++k) facet[k] = number[static_cast<std::size_t>(given.facets[f][k])];
    const auto c =
        std::array{mesh.points_[static_cast<std::size_t>(facet[0])], mesh.points_[static_cast<std::size_t>(facet[1])],
                   mesh.points_[static_cast<std::size_t>(facet[2])]};
    const double side = std::max({norm(c[1] - c[0]), norm(c[2] - c[1]), norm(c[0] - c[2])});
    if (!(norm(cross(c[1] - c[0], c[2] - c[0])) > least_height * side * side)) {
      if (flat++ == 0) first_flat = f + 1;
      continue;
    }
    mesh.facets_.push_back(facet);
    name.push_back(f + 1);
  }
  if (mesh.facets_.empty()) {
    mistakes.push_back("the surface has no facet with an area");
    return {};
  }
  if (flat > 0)
    warnings.push_back(fmt::format("{} facet(s) without an area left out, the first is facet {}", flat, first_flat));

  std::map<std::array<int, 3>, std::size_t> corners_seen;
  {
    Told told(mistakes);
    for (std::size_t f = 0; f < mesh.facets_.size(); ++f) {
      Facet sorted = mesh.facets_[f];
      std::ranges::sort(sorted);
      const auto [found, is_new] = corners_seen.emplace(sorted, f);
      if (!is_new) told.add(fmt::format("facets {} and {} have the same corners", name[found->second], name[f]));
    }
  }
  if (mistakes.size() > before) return {};

  std::map<std::pair<int, int>, std::vector<std::pair<std::size_t, std::size_t>>> sides;  // facets and corners
  for (std::size_t f = 0; f < mesh.facets_.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      sides[std::minmax(mesh.facets_[f][k], mesh.facets_[f][(k + 1) % 3])].emplace_back(f, k);
  std::vector<std::array<int, 3>> neighbours(mesh.facets_.size(), {-1, -1, -1});
  {
    Told told(mistakes), turned(mistakes);
    for (const auto& [ends, at] : sides) {
      const std::string place = place_text(mesh.points_[static_cast<std::size_t>(ends.first)]);
      if (at.size() > 2) {
        told.add(fmt::format("{} facets meet at one edge, at {}: facets {}, {} and {}", at.size(), place,
                             name[at[0].first], name[at[1].first], name[at[2].first]));
      } else if (at.size() == 2) {
        const auto& [f, k] = at[0];
        const auto& [g, l] = at[1];
        if (mesh.facets_[f][k] == mesh.facets_[g][l])
          turned.add(fmt::format("facets {} and {}, at {}, face opposite sides", name[f], name[g], place));
        neighbours[f][k] = static_cast<int>(g);
        neighbours[g][l] = static_cast<int>(f);
      }
    }
  }
  if (mistakes.size() > before) return {};

  mesh.join(neighbours);
  if (mesh.closed_ && mesh.volume_ < 0.0) {
    Facets turned{mesh.points_, mesh.facets_};
    for (Facet& facet : turned.facets) std::swap(facet[1], facet[2]);
    return make_mesh(turned, mistakes, warnings);
  }
  {
    Told told(mistakes);
    for (std::size_t f = 0; f < mesh.facets_.size(); ++f) {
      const Facet& own = mesh.facets_[f];
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector<3>&from = mesh.points_[static_cast<std::size_t>(own[k])],
              &to = mesh.points_[static_cast<std::size_t>(own[(k + 1) % 3])];
        mesh.tree_.along(from, to, 0.0, [&](int g) {
          const Facet& other = mesh.facets_[static_cast<std::size_t>(g)];
          for (const int a : own)
            for (const int b : other)
              if (a == b) return;
          const double share = share_of_meeting(mesh.corners(g), from, to);
          if (!std::isnan(share))
            told.add(fmt::format("facets {} and {} cross each other, at {}", name[f], name[static_cast<std::size_t>(g)],
                                 place_text(from + share * (to - from))));
        });
      }
    }
  }
  if (mistakes.size() > before) return {};
  return mesh;
}

}  // namespace impinge
