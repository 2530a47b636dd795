#include "impinge/boundaries/wall.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

namespace impinge {
namespace {

constexpr double off_surface = 1e-6;  // of a point [dp]

/// What facets add to the point that stands for them.
struct Gathered {
  Vector<3> place, area;  ///< weighted with the area [m^3]; facing the front [m^2]
  double size = 0.0;      ///< [m^2]
};

/// The pieces of a patch's facets, gathered by cells of a spacing.
std::map<std::array<std::int64_t, 3>, Gathered> gathered(const Patch& patch, double spacing) {
  std::map<std::array<std::int64_t, 3>, Gathered> cells;
  for (const Facet& facet : patch.facets()) {
    const auto corner = [&](std::size_t k) { return patch.points()[static_cast<std::size_t>(facet[k])]; };
    const Vector<3> one = corner(1) - corner(0), two = corner(2) - corner(0);
    const Vector<3> area = 0.5 * cross(one, two);
    const double longest = std::max({norm(one), norm(two), norm(two - one)});
    const int parts = std::max(1, static_cast<int>(std::ceil(2.0 * longest / spacing)));
    const double share = 1.0 / (static_cast<double>(parts) * parts);
    const auto add = [&](double a, double b) {
      const Vector<3> middle = corner(0) + a / parts * one + b / parts * two;
      std::array<std::int64_t, 3> cell;
      for (std::size_t k = 0; k < 3; ++k)
        cell[k] = static_cast<std::int64_t>(std::floor(middle[static_cast<int>(k)] / spacing));
      Gathered& sum = cells[cell];
      const double size = share * norm(area);
      sum.place += size * middle;
      sum.area += share * area;
      sum.size += size;
    };
    constexpr double third = 1.0 / 3.0;
    for (int a = 0; a < parts; ++a) {
      for (int b = 0; a + b < parts; ++b) {
        add(a + third, b + third);
        if (a + b + 1 < parts) add(a + 2.0 * third, b + 2.0 * third);
      }
    }
  }
  return cells;
}

}  // namespace

template <>
std::vector<WallPoint<2>> wall_points(const std::vector<Wall<2>>& walls, double spacing) {
  std::vector<WallPoint<2>> points;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    for (const OutlineEdge& edge : walls[w].surface->edges()) {
      const int count = std::max(1, static_cast<int>(std::lround(edge.length() / spacing)));
      for (int k = 0; k < count; ++k) {
        const double share = (k + 0.5) / count;
        for (const double side : {1.0, -1.0}) {
          if (!(side > 0.0 ? walls[w].wet_front : walls[w].wet_back)) continue;
          const Vector<2> normal = side * edge.normal(share);
          points.push_back(
              {edge.at(share) + off_surface * spacing * normal, normal, edge.length() / count, static_cast<int>(w)});
        }
      }
    }
  }
  return points;
}

template <>
std::vector<WallPoint<3>> wall_points(const std::vector<Wall<3>>& walls, double spacing) {
  std::vector<WallPoint<3>> points;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    for (const auto& patch : walls[w].surface->patches()) {
      for (const auto& [cell, sum] : gathered(*patch, spacing)) {
        const double area = norm(sum.area);
        if (!(area > 0.0)) continue;
        const PatchPoint at = patch->nearest(1.0 / sum.size * sum.place);
        for (const double side : {1.0, -1.0}) {
          if (!(side > 0.0 ? walls[w].wet_front : walls[w].wet_back)) continue;
          const Vector<3> position = at.point + off_surface * spacing * side * at.normal;
          points.push_back({position, side / area * sum.area, area, static_cast<int>(w)});
        }
      }
    }
  }
  return points;
}

}  // namespace impinge
