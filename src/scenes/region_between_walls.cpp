#include "impinge/scenes/region_between_walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <type_traits>

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

/// Of a cell's parts, the share whose middles are inside; `is_inside(offset)`: from the cell's middle [cell edges].
template <int Dim, class IsInside>
double share_inside(IsInside&& is_inside) {
  const BoxLattice<Dim> lattice = [] {
    BoxLattice<Dim> result{.spacing = 1.0 / parts};
    for (int k = 0; k < Dim; ++k) {
      result.low[k] = -0.5;
      result.extent[static_cast<std::size_t>(k)] = parts;
    }
    return result;
  }();
  int within = 0;
  for (std::int64_t k = 0; k < lattice.count(); ++k) within += is_inside(lattice.point(k)) ? 1 : 0;
  return static_cast<double>(within) / static_cast<double>(lattice.count());
}

/// The share of a cell in which several depths are positive. `depths`: at a place; `place(offset)`: of the cell, from
/// its middle [cell edges]. In three dimensions the depths are linear in the cell.
template <int Dim, class Place, class Depths>
double share_of_cell(Place&& place, Depths&& depths) {
  if constexpr (Dim == 2) {
    return share_inside<2>([&](const Vector<2>& offset) {
      const auto all = depths(place(offset));
      return std::ranges::all_of(all, [](double depth) { return depth > 0.0; });
    });
  } else {
    const auto middle = depths(place({}));
    std::array<Vector<3>, std::tuple_size_v<std::remove_const_t<decltype(middle)>>> slope;
    for (int axis = 0; axis < 3; ++axis) {
      Vector<3> half;
      half[axis] = 0.5;
      const auto above = depths(place(half)), below = depths(place(-1.0 * half));
      for (std::size_t k = 0; k < slope.size(); ++k) slope[k][axis] = above[k] - below[k];
    }
    return share_inside<3>([&](const Vector<3>& offset) {
      for (std::size_t k = 0; k < slope.size(); ++k)
        if (!(middle[k] + dot(slope[k], offset) > 0.0)) return false;
      return true;
    });
  }
}

}  // namespace

template <int Dim>
RegionBetweenWalls<Dim>::RegionBetweenWalls(const PlacedRegion<Dim>& region, const WetSpace<Dim>& wet, double spacing)
    : region_(region), wet_(wet), spacing_(spacing) {
  struct Candidate {
    double depth;  ///< in the region and between the walls [dp]
    std::uint64_t order;
    Point point;
  };
  std::vector<Candidate> candidates;
  // Of a cell, how much lies in the region and between the walls.
  const auto depths = [&](const Vector<Dim>& place) { return std::array{wet.depth(place), -region.distance(place)}; };
  const auto share_of = [&](std::int64_t k) {
    return share_of_cell<Dim>([&](const Vector<Dim>& offset) { return region.place(k, spacing * offset); }, depths);
  };
  double cells = 0.0;  // beside walls
  std::int64_t far = 0;
  for (std::int64_t k = 0; k < region.points(); ++k) {
    const Vector<Dim> position = region.place(k);
    const double wall_depth = wet.depth(position) / spacing;
    Vector<Dim> inside;
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
      Vector<Dim> aside;
      aside[0] = 0.8;
      aside[1] = 0.6;
      const Vector<Dim> near = candidate.point.position + 2.0 * side * step * spacing * aside;
      Vector<Dim> slope;
      for (int k = 0; k < Dim; ++k) {
        Vector<Dim> way;
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
template <int Dim>
double RegionBetweenWalls<Dim>::volume() const {
  const Box<Dim> box = region_.bounds();
  BoxLattice<Dim> cells{.spacing = 1.0};
  Vector<Dim> cell;
  double size = 1.0;
  for (int k = 0; k < Dim; ++k) {
    const double length = box.high[k] - box.low[k];
    const auto count = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(length / spacing_)));
    cells.extent[static_cast<std::size_t>(k)] = count;
    cell[k] = length / static_cast<double>(count);
    size *= cell[k];
  }
  const auto at = [&](const Vector<Dim>& number) {
    Vector<Dim> point = box.low;
    for (int k = 0; k < Dim; ++k) point[k] += number[k] * cell[k];
    return point;
  };
  const auto depths = [&](const Vector<Dim>& point) { return std::array{wet_.depth(point), -region_.distance(point)}; };
  double sum = 0.0;
  for (std::int64_t k = 0; k < cells.count(); ++k) {
    const Vector<Dim> middle = cells.point(k);
    const auto at_middle = depths(at(middle));
    const double depth = std::min(at_middle[0], at_middle[1]);
    if (std::abs(depth) > 0.5 * norm(cell)) {
      sum += depth > 0.0 ? 1.0 : 0.0;
    } else {
      sum += share_of_cell<Dim>([&](const Vector<Dim>& offset) { return at(middle + offset); }, depths);
    }
  }
  return sum * size;
}

template <int Dim>
bool RegionBetweenWalls<Dim>::point(std::int64_t k, Vector<Dim>& position) const {
  const auto found = std::ranges::lower_bound(near_, k, {}, &Point::number);
  if (found != near_.end() && found->number == k) {
    position = found->position;
    return true;
  }
  return region_.point(k, position) && !is_near(position);
}

template class RegionBetweenWalls<2>;
template class RegionBetweenWalls<3>;

}  // namespace impinge
