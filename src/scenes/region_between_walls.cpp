#include "impinge/scenes/region_between_walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace impinge {
namespace {

constexpr int parts = 8;              // of a cell along an axis, to measure what is left of it
constexpr double least_depth = 0.3;   // of a point [dp]
constexpr double most_outside = 0.5;  // of a point that stands for a cell [dp]
constexpr double step = 1e-3;         // of the depth's gradient [dp]
constexpr double rounding = 1e-3;     // of a depth [dp]

/// Scatters numbers, so that of equal points not all of one side are taken.
std::uint64_t scattered(std::int64_t number) {
  std::uint64_t x = static_cast<std::uint64_t>(number) + 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

/// Of a cell's parts, the share whose middles are inside; `is_inside(x, y)`: from the cell's middle [cell edges].
template <class IsInside>
double share_inside(IsInside&& is_inside) {
  int within = 0;
  for (int a = 0; a < parts; ++a)
    for (int b = 0; b < parts; ++b) within += is_inside((a + 0.5) / parts - 0.5, (b + 0.5) / parts - 0.5) ? 1 : 0;
  return static_cast<double>(within) / (parts * parts);
}

}  // namespace

RegionBetweenWalls::RegionBetweenWalls(const PlacedRegion<2>& region, const WetSpace& wet, double spacing)
    : region_(region), wet_(wet), spacing_(spacing) {
  struct Candidate {
    double depth;  ///< in the region and between the walls [dp]
    std::uint64_t order;
    Point point;
  };
  std::vector<Candidate> candidates;
  // Of a cell, how much lies in the region and between the walls.
  const auto share_of = [&](std::int64_t k) {
    return share_inside([&](double x, double y) {
      const Vector<2> part = region.place(k, spacing * Vector<2>{{x, y}});
      return region.contains(part) && wet.depth(part) > 0.0;
    });
  };
  double cells = 0.0;  // beside walls
  std::int64_t far = 0;
  for (std::int64_t k = 0; k < region.points(); ++k) {
    const Vector<2> position = region.place(k);
    const double wall_depth = wet.depth(position) / spacing;
    Vector<2> inside;
    if (wall_depth >= 1.0) {
      far += region.point(k, inside) ? 1 : 0;
      continue;
    }
    if (wall_depth < -1.0) continue;
    cells += share_of(k);
    const double depth = std::min(wall_depth, -region.distance(position) / spacing);
    if (depth > -most_outside + rounding) candidates.push_back({depth, scattered(k), {k, position}});
  }
  std::ranges::sort(candidates, [](const Candidate& a, const Candidate& b) {
    const double difference = a.depth - b.depth;
    return std::abs(difference) > rounding ? difference > 0.0 : a.order < b.order;
  });
  candidates.resize(std::min(candidates.size(), static_cast<std::size_t>(std::llround(cells))));
  for (Candidate& candidate : candidates) {
    const double depth = wet.depth(candidate.point.position) / spacing;
    is_cut_ |= std::abs(depth - 0.5) > 10.0 * rounding;
    if (depth < least_depth) {
      // On a plate, to one side or the other.
      const double side = candidate.order % 2 == 0 ? 1.0 : -1.0;
      const Vector<2> near = candidate.point.position + 2.0 * side * step * spacing * Vector<2>{{0.8, 0.6}};
      Vector<2> slope;
      for (int k = 0; k < 2; ++k) {
        Vector<2> way;
        way[k] = step * spacing;
        slope[k] = wet.depth(near + way) - wet.depth(near - way);
      }
      if (const double size = norm(slope); size > 0.0)
        candidate.point.position += (least_depth - depth) * spacing / size * slope;
    }
    if (wet.depth(candidate.point.position) > 0.0) near_.push_back(candidate.point);
  }
  std::ranges::sort(near_, {}, &Point::number);
  count_ = far + static_cast<std::int64_t>(near_.size());
}

// By cells of the region's bounds, those that an edge may cut by their parts.
double RegionBetweenWalls::volume() const {
  const Box<2> box = region_.bounds();
  std::array<int, 2> extent{};
  Vector<2> cell;
  for (int k = 0; k < 2; ++k) {
    const double length = box.high[k] - box.low[k];
    extent[static_cast<std::size_t>(k)] = std::max(1, static_cast<int>(std::ceil(length / spacing_)));
    cell[k] = length / extent[static_cast<std::size_t>(k)];
  }
  const auto depth = [&](double x, double y) {
    const Vector<2> point{{box.low[0] + x * cell[0], box.low[1] + y * cell[1]}};
    return std::min(wet_.depth(point), -region_.distance(point));
  };
  double cells = 0.0;
  for (int x = 0; x < extent[0]; ++x) {
    for (int y = 0; y < extent[1]; ++y) {
      const double middle_x = x + 0.5, middle_y = y + 0.5;
      const double at_middle = depth(middle_x, middle_y);
      if (std::abs(at_middle) > 0.5 * norm(cell)) {
        cells += at_middle > 0.0 ? 1.0 : 0.0;
      } else {
        cells += share_inside([&](double a, double b) { return depth(middle_x + a, middle_y + b) > 0.0; });
      }
    }
  }
  return cells * cell[0] * cell[1];
}

bool RegionBetweenWalls::point(std::int64_t k, Vector<2>& position) const {
  const auto found = std::ranges::lower_bound(near_, k, {}, &Point::number);
  if (found != near_.end() && found->number == k) {
    position = found->position;
    return true;
  }
  return region_.point(k, position) && !is_near(position);
}

}  // namespace impinge
