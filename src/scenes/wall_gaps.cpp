#include "impinge/scenes/wall_gaps.hpp"

#include <algorithm>
#include <cmath>

#include "impinge/scenes/wet_space.hpp"

namespace impinge {
namespace {

constexpr double touching = 0.01;  // nearer faces have no gap [dp]
constexpr double on_face = 1e-6;   // [dp], and of a gap's width

/// True if the way from a point of a wall in a direction begins on a wet side. Of a corner, one of its faces suffices.
bool begins_wet(const Wall<2>& wall, const Outline& outline, const Vector<2>& point, const Vector<2>& direction,
                double spacing) {
  return std::ranges::any_of(outline.edges(), [&](const OutlineEdge& edge) {
    const double share = edge.nearest_share(point);
    if (norm(edge.at(share) - point) > on_face * spacing) return false;
    const double rise = dot(direction, edge.normal(share)), along = on_face * norm(direction);
    return (wall.wet_front && rise > -along) || (wall.wet_back && rise < along);
  });
}

/// The walls at a time.
class Placed {
 public:
  Placed(const std::vector<Wall<2>>& walls, double time, double spacing)
      : walls_(walls), wet_(walls, time, spacing), spacing_(spacing) {
    for (const Wall<2>& wall : walls) outlines_.push_back(outline_at(wall, time));
  }

  std::optional<Gap> gap(std::size_t a, std::size_t b) const {
    return narrowest_throat(outlines_[a], outlines_[b], touching * spacing_, [&](const Gap& gap) {
      const Vector<2> way = gap.end - gap.begin;
      if (!wet_.contains(gap.begin + 0.5 * way)) return false;
      if (!begins_wet(walls_[a], outlines_[a], gap.begin, way, spacing_)) return false;
      if (!begins_wet(walls_[b], outlines_[b], gap.end, -1.0 * way, spacing_)) return false;
      return std::ranges::none_of(outlines_, [&](const Outline& outline) {
        return outline.first_hit(gap.begin + on_face * way, gap.end - on_face * way).has_value() ||
               leads_on(outline, gap.begin, way) || leads_on(outline, gap.end, -1.0 * way);
      });
    });
  }

 private:
  /// True if a wall that touches a gap's end comes nearer to the other end: what runs into a corner there is no gap.
  bool leads_on(const Outline& outline, const Vector<2>& end, const Vector<2>& way) const {
    constexpr double step = 0.01, rounding = 1e-9;  // of the width
    if (outline.nearest(end).distance > touching * spacing_) return false;
    return norm(outline.nearest(end + step * way).point - end - way) < (1.0 - rounding) * norm(way);
  }

  const std::vector<Wall<2>>& walls_;
  WetSpace<2> wet_;
  double spacing_;
  std::vector<Outline> outlines_;
};

/// Every so manieth of the times, so that it is no long work.
std::vector<double> some_of(const std::vector<double>& times, const std::vector<Wall<2>>& walls) {
  constexpr double most = 2e6;  // pairs of edges
  double edges = 0.0;
  for (const Wall<2>& wall : walls) edges += static_cast<double>(wall.surface->edges().size());
  const double kept = std::clamp(most / (edges * edges), 10.0, static_cast<double>(times.size()) + 10.0);
  const auto stride = static_cast<std::size_t>(std::ceil(static_cast<double>(times.size()) / kept));
  std::vector<double> result;
  for (std::size_t k = 0; k < times.size(); k += stride) result.push_back(times[k]);
  return result;
}

}  // namespace

std::vector<WallGap> wall_gaps(const std::vector<Wall<2>>& walls, const std::vector<double>& times, double spacing) {
  std::vector<WallGap> gaps;
  bool is_start = true;
  for (const double time : some_of(times, walls)) {
    const Placed placed(walls, time, spacing);
    for (std::size_t b = 0; b < walls.size(); ++b) {
      for (std::size_t a = 0; a <= b; ++a) {
        if (!is_start && walls[a].motion == walls[b].motion) continue;
        const auto gap = placed.gap(a, b);
        if (!gap) continue;
        const WallGap now{a, b, gap->width / spacing, 0.5 * (gap->begin + gap->end), time};
        const auto known = std::ranges::find_if(gaps, [&](const WallGap& x) { return x.one == a && x.other == b; });
        constexpr double rounding = 1e-9;
        if (known == gaps.end()) {
          gaps.push_back(now);
        } else if (now.width < (1.0 - rounding) * known->width) {
          *known = now;
        }
      }
    }
    is_start = false;
  }
  return gaps;
}

}  // namespace impinge
