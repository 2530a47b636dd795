#include "impinge/geometry/patch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace impinge {
namespace {

constexpr double flatness = 1e-5;  // distance of a flat patch's corners from its plane, over its size
constexpr int smoothings = 8;      // of the normals at corners

Vector<3> unit(const Vector<3>& a) {
  const double size = norm(a);
  return size > 0.0 ? 1.0 / size * a : a;
}

double angle_of(const Vector<3>& a, const Vector<3>& b) { return std::atan2(norm(cross(a, b)), dot(a, b)); }

Matrix<3> sum_of(const Matrix<3>& a, double factor, const Matrix<3>& b) {
  Matrix<3> result = a;
  for (std::size_t k = 0; k < 3; ++k) result.row[k] += factor * b.row[k];
  return result;
}

/// The symmetric part of the slope of normals over a facet, along its plane [1/m].
Matrix<3> bending_of(const std::array<Vector<3>, 3>& corner, const std::array<Vector<3>, 3>& normal) {
  const Vector<3> one = corner[1] - corner[0], two = corner[2] - corner[0];
  const Vector<3> across = cross(one, two);
  const double square = dot(across, across);
  // Gradients of the shares of corners 1 and 2.
  const Vector<3> first = 1.0 / square * cross(two, across), second = 1.0 / square * cross(across, one);
  const Vector<3> up = 1.0 / std::sqrt(square) * across;
  Matrix<3> slope;
  const auto add = [&](const Vector<3>& change, const Vector<3>& gradient) {
    slope.add_product(change - dot(change, up) * up, gradient);
  };
  add(normal[1] - normal[0], first);
  add(normal[2] - normal[0], second);
  Matrix<3> result;
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      result.row[r][static_cast<int>(c)] =
          0.5 * (slope.row[r][static_cast<int>(c)] + slope.row[c][static_cast<int>(r)]);
  return result;
}

}  // namespace

// Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
FacetPoint nearest_on_facet(const std::array<Vector<3>, 3>& corner, const Vector<3>& x) {
  const Vector<3>&a = corner[0], &b = corner[1], &c = corner[2];
  const Vector<3> ab = b - a, ac = c - a, ax = x - a;
  const double d1 = dot(ab, ax), d2 = dot(ac, ax);
  if (d1 <= 0.0 && d2 <= 0.0) return {a, {1.0, 0.0, 0.0}};
  const Vector<3> bx = x - b;
  const double d3 = dot(ab, bx), d4 = dot(ac, bx);
  if (d3 >= 0.0 && d4 <= d3) return {b, {0.0, 1.0, 0.0}};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    const double v = d1 / (d1 - d3);
    return {a + v * ab, {1.0 - v, v, 0.0}};
  }
  const Vector<3> cx = x - c;
  const double d5 = dot(ab, cx), d6 = dot(ac, cx);
  if (d6 >= 0.0 && d5 <= d6) return {c, {0.0, 0.0, 1.0}};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    const double w = d2 / (d2 - d6);
    return {a + w * ac, {1.0 - w, 0.0, w}};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {b + w * (c - b), {0.0, 1.0 - w, w}};
  }
  const double sum = va + vb + vc;
  const double v = vb / sum, w = vc / sum;
  return {a + v * ab + w * ac, {1.0 - v - w, v, w}};
}

Patch::Patch(const std::vector<Vector<3>>& points, const std::vector<Facet>& facets) {
  std::unordered_map<int, int> number;
  for (const Facet& facet : facets) {
    Facet own;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [found, is_new] = number.emplace(facet[k], static_cast<int>(corner_.size()));
      if (is_new) corner_.push_back(points[static_cast<std::size_t>(facet[k])]);
      own[k] = found->second;
    }
    facet_.push_back(own);
  }
  std::vector<Box<3>> boxes;
  Vector<3> area;
  for (int f = 0; f < static_cast<int>(facet_.size()); ++f) {
    const auto corner = corners(f);
    area += 0.5 * cross(corner[1] - corner[0], corner[2] - corner[0]);
    Box<3> box{corner[0], corner[0]};
    for (int k = 0; k < 3; ++k) {
      box.low[k] = std::min({corner[0][k], corner[1][k], corner[2][k]});
      box.high[k] = std::max({corner[0][k], corner[1][k], corner[2][k]});
    }
    boxes.push_back(box);
  }
  tree_ = BoxTree(boxes);
  normal_ = unit(area);
  double size = 0.0, off = 0.0;
  for (const Vector<3>& corner : corner_) {
    size = std::max(size, norm(corner - corner_[0]));
    off = std::max(off, std::abs(dot(corner - corner_[0], normal_)));
  }
  flat_ = off <= flatness * size;
  if (!flat_) find_normals();
}

// The mean normal of the facets around a corner, each as it is at the corner: at the edge of the patch, with facets on
// one side alone, the slope of the normals leads from the facets' middles to the corner.
void Patch::find_normals() {
  const std::size_t count = corner_.size(), facets = facet_.size();
  std::vector<Vector<3>> up(facets), middle(facets);
  std::vector<double> area(facets);
  std::vector<std::array<double, 3>> weight(facets);
  for (std::size_t f = 0; f < facets; ++f) {
    const auto c = corners(static_cast<int>(f));
    const Vector<3> across = cross(c[1] - c[0], c[2] - c[0]);
    area[f] = 0.5 * norm(across);
    up[f] = unit(across);
    // The normal of a chord surface is the surface's at the centre of the facet's circle.
    const Vector<3> one = c[1] - c[0], two = c[2] - c[0];
    const Vector<3> to_centre = cross(dot(one, one) * two - dot(two, two) * one, across);
    middle[f] = nearest_on_facet(c, c[0] + 0.5 / dot(across, across) * to_centre).point;
    for (std::size_t k = 0; k < 3; ++k) weight[f][k] = angle_of(c[(k + 1) % 3] - c[k], c[(k + 2) % 3] - c[k]);
  }
  corner_normal_.assign(count, {});
  std::vector<Matrix<3>> bending(facets);
  for (int pass = 0; pass <= smoothings; ++pass) {
    std::vector<Vector<3>> sum(count);
    for (std::size_t f = 0; f < facets; ++f) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto v = static_cast<std::size_t>(facet_[f][k]);
        sum[v] += weight[f][k] * unit(up[f] + bending[f] * (corner_[v] - middle[f]));
      }
    }
    for (std::size_t v = 0; v < count; ++v) corner_normal_[v] = unit(sum[v]);
    for (std::size_t f = 0; f < facets; ++f) {
      const auto normal = [&](std::size_t k) { return corner_normal_[static_cast<std::size_t>(facet_[f][k])]; };
      bending[f] = bending_of(corners(static_cast<int>(f)), {normal(0), normal(1), normal(2)});
    }
  }
  corner_bending_.assign(count, {});
  std::vector<double> whole(count);
  for (std::size_t f = 0; f < facets; ++f) {
    for (const int v : facet_[f]) {
      const auto at = static_cast<std::size_t>(v);
      corner_bending_[at] = sum_of(corner_bending_[at], area[f], bending[f]);
      whole[at] += area[f];
    }
  }
  for (std::size_t v = 0; v < count; ++v) {
    corner_bending_[v] = 1.0 / whole[v] * corner_bending_[v];
    double square = 0.0;
    for (const Vector<3>& row : corner_bending_[v].row) square += dot(row, row);
    // The principal curvatures: the eigenvalues beside 0, of the normal.
    const double sum = trace(corner_bending_[v]), root = std::sqrt(std::max(2.0 * square - sum * sum, 0.0));
    front_bulge_ = std::max(front_bulge_, 0.5 * (sum + root));
    back_bulge_ = std::max(back_bulge_, 0.5 * (root - sum));
  }
}

// `first`: a facet to begin with; -1: any.
Patch::Place Patch::nearest_facet(const Vector<3>& x, double square, int first) const {
  Place best;
  best.square = square;
  const auto use = [&](int f) {
    const FacetPoint at = nearest_on_facet(corners(f), x);
    const Vector<3> off = at.point - x;
    const double here = dot(off, off);
    if (here < best.square || (here == best.square && f < best.facet)) best = {f, at, here};
    return best.square;
  };
  if (first >= 0) use(first);
  tree_.nearest(x, best.square, use);
  return best;
}

double Patch::distance(const Vector<3>& x, double limit) const {
  return std::sqrt(nearest_facet(x, limit * limit).square);
}

PatchPoint Patch::nearest(const Vector<3>& x) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr double rounding = 1e-12;  // of a point, over its distance
  if (flat_) {
    const double height = dot(x - corner_[0], normal_);
    const Vector<3> foot = x - height * normal_;
    const Place place = nearest_facet(foot, infinity);
    const Vector<3> off = foot - place.at.point;
    const double beyond = norm(off - dot(off, normal_) * normal_);
    const bool is_on = beyond <= rounding * (norm(place.at.point - corner_[0]) + std::abs(height));
    return {foot, normal_, height, is_on ? 0.0 : beyond, {}};
  }
  constexpr int most = 12;
  constexpr double accuracy = 1e-9;  // of the foot, over the height
  Vector<3> aim = x, normal, point, rest;
  Matrix<3> bending;
  double height = 0.0, beyond = 0.0;
  Place place, last;
  for (int k = 0; k < most; ++k) {
    place = nearest_facet(aim, infinity, place.facet);
    const Facet& facet = facet_[static_cast<std::size_t>(place.facet)];
    normal = {};
    bending = {};
    Vector<3> lift;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto v = static_cast<std::size_t>(facet[c]);
      const double share = place.at.share[c];
      normal += share * corner_normal_[v];
      bending = sum_of(bending, share, corner_bending_[v]);
      lift += share * dot(corner_[v] - place.at.point, corner_normal_[v]) * corner_normal_[v];
    }
    normal = unit(normal);
    point = place.at.point + 0.5 * lift;
    height = dot(x - point, normal);
    rest = x - point - height * normal;
    beyond = norm(rest);
    if (beyond <= accuracy * (std::abs(height) + norm(lift))) return {point, normal, height, 0.0, bending};
    aim = place.at.point + rest;
    // At the patch's edge the foot goes no farther.
    if (k > 0 && norm(place.at.point - last.at.point) <= 1e-3 * beyond) {
      const Vector<3> step =
          nearest_facet(place.at.point + 1e-3 * rest, infinity, place.facet).at.point - place.at.point;
      if (norm(step) < 0.5e-3 * beyond) return {point + rest, normal, height, beyond, bending};
    }
    last = place;
  }
  const Vector<3> step = nearest_facet(place.at.point + rest, infinity, place.facet).at.point - place.at.point;
  const bool is_at_edge = norm(step) < 0.5 * beyond;
  return {point + rest, normal, height, is_at_edge ? beyond : 0.0, bending};
}

}  // namespace impinge
