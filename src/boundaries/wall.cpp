#include "impinge/boundaries/wall.hpp"

#include <algorithm>
#include <cmath>

namespace impinge {

constexpr double off_surface = 1e-6;  // of a point [dp]

std::vector<WallPoint> wall_points(const std::vector<Wall>& walls, double spacing) {
  std::vector<WallPoint> points;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    for (const OutlineEdge& edge : walls[w].outline.edges()) {
      const int count = std::max(1, static_cast<int>(std::lround(edge.length() / spacing)));
      for (int k = 0; k < count; ++k) {
        const double share = (k + 0.5) / count;
        for (const double side : {1.0, -1.0}) {
          if (!(side > 0.0 ? walls[w].wet_right : walls[w].wet_left)) continue;
          const Vector<2> normal = side * edge.normal(share);
          points.push_back(
              {edge.at(share) + off_surface * spacing * normal, normal, edge.length() / count, static_cast<int>(w)});
        }
      }
    }
  }
  return points;
}

}  // namespace impinge
