#include "impinge/validation/jet_target.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "impinge/core/errors.hpp"
#include "impinge/observe/fluid_value.hpp"
#include "impinge/scenes/analytic_jet.hpp"
#include "impinge/validation/analytic_wedge.hpp"
#include "impinge/validation/space_target.hpp"
#include "impinge/validation/target_search.hpp"

namespace impinge {
namespace {

using std::numbers::pi;
using Side = AnalyticJet::Side;

constexpr double same_direction = 1e-6;  // [rad]
constexpr double symmetric = 1e-3;       // [H]
constexpr double leaving = pi / 180.0;   // a sheet leaves a wall that turns away by more [rad]

/// The angle from one direction to another, counter-clockwise positive [rad].
double angle_between(const Vector<2>& from, const Vector<2>& to) { return std::atan2(cross(from, to), dot(from, to)); }

OutlineEdge reversed(OutlineEdge edge) {
  std::swap(edge.begin, edge.end);
  edge.sweep = -edge.sweep;
  return edge;
}

/// The part of an edge up to a share of its length.
OutlineEdge first_part(OutlineEdge edge, double share) {
  edge.end = edge.at(share);
  edge.sweep *= share;
  return edge;
}

OutlineEdge last_part(const OutlineEdge& edge, double share) {
  return reversed(first_part(reversed(edge), 1.0 - share));
}

Vector<2> tangent(const OutlineEdge& edge, double share) { return turned_left(edge.normal(share)); }

/// A wall's way from where the jet meets it. `side`: of the way, on which the fluid is: 1 right, -1 left.
struct Arm {
  std::vector<OutlineEdge> edges;
  double side;

  double length() const {
    double sum = 0.0;
    for (const OutlineEdge& edge : edges) sum += edge.length();
    return sum;
  }
  Vector<2> at(double distance) const {
    for (const OutlineEdge& edge : edges) {
      if (distance <= edge.length()) return edge.at(distance / edge.length());
      distance -= edge.length();
    }
    return edges.back().end;
  }
  Vector<2> exit() const { return tangent(edges.back(), 1.0); }
  /// The length of the last edges that are in line with each other.
  double straight_end() const {
    double sum = 0.0;
    for (auto edge = edges.rbegin(); edge != edges.rend() && edge->straight(); ++edge) {
      if (std::abs(angle_between(tangent(*edge, 0.0), exit())) > same_direction) break;
      sum += edge->length();
    }
    return sum;
  }
  bool straight() const { return straight_end() > (1.0 - 1e-9) * length(); }
};

/// The wet sides of all walls, as ways with the fluid on their right.
std::vector<OutlineEdge> faces_of(const std::vector<Wall<2>>& walls) {
  std::vector<OutlineEdge> faces;
  for (const Wall<2>& wall : walls) {
    for (const OutlineEdge& edge : wall.surface->edges()) {
      if (wall.wet_front) faces.push_back(edge);
      if (wall.wet_back) faces.push_back(reversed(edge));
    }
  }
  return faces;
}

/// Where a ray meets a wet face.
struct Meeting {
  std::size_t face = 0;
  double distance = std::numeric_limits<double>::infinity();  // [m]
  Vector<2> point;
};

class TargetSearch {
 public:
  explicit TargetSearch(const Case& config) : config_(config), walls_(walls_of<2>(config.scene_walls, config.motions)) {
    for (const OutletEntry& entry : config.outlets)
      if (auto outlet = outlet_of<2>(entry)) outlets_.push_back(std::move(*outlet));
  }

  JetTarget target() {
    check_inlets_of_target(config_, 2);
    const auto& inlets = config_.inlets;
    const InletEntry& inlet = inlets.front();
    target_.width = inlet.width;
    target_.speed = inlet.speed;
    target_.density = config_.fluid.density;
    target_.spacing = config_.particles.spacing;
    from_ = vector_of<2>(inlet.center);
    direction_ = unit(inlet);
    if (inlets.size() == 2) {
      meet_jet(inlets.back());
    } else {
      meet_wall();
    }
    return std::move(target_);
  }

 private:
  [[noreturn]] void refuse(const std::string& reason) const { refuse_target(config_, reason); }

  static Vector<2> unit(const InletEntry& inlet) {
    const Vector<2> direction = vector_of<2>(inlet.direction);
    return 1.0 / norm(direction) * direction;
  }

  bool is_swallowed(const Vector<2>& place) const {
    return std::ranges::any_of(outlets_, [&](const Outlet<2>& outlet) { return outlet.has_passed(place); });
  }

  /// The distance along a way at which an outlet begins, at most `length` [m].
  template <class Way>
  double until_outlet(Way&& at, double length) const {
    return distance_until(length, search_step * target_.spacing, [&](double x) { return is_swallowed(at(x)); });
  }

  /// Two equal jets: the frame's y runs against the first.
  void meet_jet(const InletEntry& other) {
    const Vector<2> way = vector_of<2>(other.center) - from_;
    const double apart = dot(way, direction_);
    if (!(std::abs(other.width - target_.width) <= 1e-9 * target_.width &&
          std::abs(other.speed - target_.speed) <= 1e-9 * target_.speed))
      refuse("its two jets are not equal");
    if (!(apart > 0.0 && std::abs(cross(direction_, way)) <= symmetric * target_.width &&
          std::abs(angle_between(-1.0 * direction_, unit(other))) <= same_direction))
      refuse("its two inlets do not blow at each other");
    if (meeting(from_).distance < apart) refuse("a wall is between its two inlets");
    target_.type = TargetType::jet;
    target_.angle = 0.5 * pi;
    target_.distance = 0.5 * apart;
    target_.frame = {.origin = from_ + 0.5 * apart * direction_, .x = turned_left(direction_), .y = -1.0 * direction_};
    constexpr double far = 10.0;  // [H]
    const auto reach = [&](double sign) {
      return until_outlet([&](double x) { return target_.frame.origin + sign * x * target_.frame.x; },
                          far * target_.width);
    };
    target_.begin = -reach(-1.0);
    target_.end = reach(1.0);
  }

  Meeting meeting(const Vector<2>& from) const {
    const double far = 2.0 * (norm(vector_of<2>(config_.domain.high) - vector_of<2>(config_.domain.low)));
    Meeting first;
    std::size_t face = 0;
    for (const Wall<2>& wall : walls_) {
      const auto hit = wall.surface->first_hit(from, from + far * direction_);
      const std::size_t sides = (wall.wet_front ? 1u : 0u) + (wall.wet_back ? 1u : 0u);
      if (hit && far * hit->share < first.distance) {
        const OutlineEdge& edge = wall.surface->edges()[hit->edge];
        const bool on_right = dot(edge.normal(edge.nearest_share(hit->point)), direction_) < 0.0;
        if (wall.motion) refuse(fmt::format("the wall {} that its jet meets moves", wall.name));
        if (!(on_right ? wall.wet_front : wall.wet_back))
          refuse(fmt::format("its jet meets the dry side of the wall {}", wall.name));
        first = {face + sides * hit->edge + (on_right || sides == 1 ? 0u : 1u), far * hit->share, hit->point};
      }
      face += sides * wall.surface->edges().size();
    }
    return first;
  }

  /// True for an arc that leaves the flow along it: where a sheet leaves it is not known.
  static bool turns_away(const OutlineEdge& edge, double side) { return side * edge.sweep > 0.0; }

  /// The way from a point of a face along it and the faces that join it, up to an outlet, an end, or where the wall
  /// turns away from the flow.
  Arm arm(const Meeting& from, double side) const {
    Arm arm{{}, side};
    std::vector<OutlineEdge> ways = faces_of(walls_);
    if (side < 0.0) std::ranges::transform(ways, ways.begin(), reversed);
    const OutlineEdge& first = ways[from.face];
    const double share = first.nearest_share(from.point);
    const double tolerance = 1e-3 * target_.spacing;
    if ((1.0 - share) * first.length() > tolerance) arm.edges.push_back(last_part(first, share));
    const OutlineEdge* last = &first;
    for (std::size_t count = 0; count < ways.size(); ++count) {
      const OutlineEdge* next = nullptr;
      double most = -leaving;
      for (const OutlineEdge& way : ways) {
        if (&way == last || norm(way.begin - last->end) > tolerance || turns_away(way, side)) continue;
        const double turn = -side * angle_between(tangent(*last, 1.0), tangent(way, 0.0));  // towards the fluid
        if (turn < most || std::abs(turn) > pi - leaving) continue;
        most = turn;
        next = &way;
      }
      if (!next) break;
      arm.edges.push_back(*next);
      last = next;
    }
    if (arm.edges.empty()) refuse("its jet meets the end of a wall");
    if (turns_away(arm.edges.front(), side)) refuse("its jet meets a wall that curves away from it");
    // Short of the first outlet.
    const double above = outlet_height * target_.spacing;
    for (std::size_t k = 0; k < arm.edges.size(); ++k) {
      OutlineEdge& edge = arm.edges[k];
      const double length = edge.length();
      const double wet =
          until_outlet([&](double x) { return edge.at(x / length) + side * above * edge.normal(x / length); }, length);
      if (wet == length) continue;
      edge = first_part(edge, wet / length);
      arm.edges.resize(wet > tolerance ? k + 1 : k);
    }
    if (arm.edges.empty()) refuse("an outlet is where its jet meets a wall");
    return arm;
  }

  void meet_wall() {
    // Beside the axis at both sides, so that it does not matter on which face an edge counts.
    const Vector<2> beside = 1e-6 * target_.width * turned_left(direction_);
    const Meeting left = meeting(from_ + beside), right = meeting(from_ - beside);
    if (std::isinf(left.distance) && std::isinf(right.distance)) refuse("its inlet's axis meets no wall");
    if (!(std::abs(left.distance - right.distance) <= symmetric * target_.width))
      refuse("its inlet's axis meets the end of a wall");
    target_.distance = 0.5 * (left.distance + right.distance);
    target_.frame = {.origin = from_ + target_.distance * direction_, .x = direction_, .y = turned_left(direction_)};
    // The fluid is on the right of the ways, before the wall: they run from left to right.
    Meeting start = right, end = left;
    start.point = end.point = target_.frame.origin;
    const std::array<Arm, 2> arms{arm(start, 1.0), arm(end, -1.0)};
    const double turn = angle_between(arms[0].exit(), -1.0 * arms[1].exit());
    if (arms[0].straight() && arms[1].straight() && std::abs(turn) <= same_direction) {
      meet_straight(arms);
    } else {
      meet_symmetric(arms);
    }
  }

  void meet_straight(const std::array<Arm, 2>& arms) {
    const bool along_first = dot(direction_, arms[0].exit()) >= 0.0;
    const Arm& thick = arms[along_first ? 0 : 1];
    const Arm& thin = arms[along_first ? 1 : 0];
    const Vector<2> x = thick.exit(), y = thick.side * thick.edges.back().normal(1.0);
    const double angle = std::min(std::atan2(-dot(direction_, y), dot(direction_, x)), 0.5 * pi);
    if (angle < grazing) refuse("its jet grazes a wall, at less than 1 degree");
    const AnalyticJet jet(target_.width, target_.speed, target_.density, angle);
    const double begin = jet.axis_position() - thin.length(), end = jet.axis_position() + thick.length();
    if (!is_long_enough(jet, begin, end)) {
      if (0.5 * pi - angle > same_direction)
        refuse(
            fmt::format("the wall that its jet meets at {:.4g} degrees reaches from {:.3g} to {:.3g} jet widths from "
                        "the stagnation point, up to the outlets, and has a pressure there",
                        angle * 180.0 / pi, begin / target_.width, end / target_.width));
      meet_symmetric(arms);
      return;
    }
    target_.type = TargetType::plate;
    target_.angle = angle;
    target_.begin = begin;
    target_.end = end;
    target_.frame = {.origin = target_.frame.origin - jet.axis_position() * x, .x = x, .y = y};
    add_points(arms, [&](const Vector<2>& place, const Vector<2>&, double) {
      return std::pair{target_.frame.of_position(place)[0], 1.0};
    });
  }

  void meet_symmetric(const std::array<Arm, 2>& arms) {
    const std::array<double, 2> length{arms[0].length(), arms[1].length()};
    const double shorter = std::min(length[0], length[1]);
    constexpr int samples = 200;
    for (int k = 0; k <= samples; ++k) {
      const double distance = shorter * k / samples;
      const Vector<2> one = target_.frame.of_position(arms[0].at(distance));
      const Vector<2> two = target_.frame.of_position(arms[1].at(distance));
      if (std::hypot(one[0] - two[0], one[1] + two[1]) > symmetric * target_.width)
        refuse("the wall that its jet meets is not symmetric to its inlet's axis");
    }
    const std::array<double, 2> turn{std::abs(angle_between(direction_, arms[0].exit())),
                                     std::abs(angle_between(direction_, arms[1].exit()))};
    if (std::abs(turn[0] - turn[1]) > symmetric) refuse("the wall that its jet meets does not turn its halves alike");
    target_.type = arms[0].straight() && arms[1].straight() ? TargetType::wedge : TargetType::cup;
    target_.angle = turn[0];
    target_.begin = -length[1];
    target_.end = length[0];
    add_points(arms, [&](const Vector<2>&, const Vector<2>& normal, double x) {
      return std::pair{x, -dot(normal, direction_)};
    });
    if (target_.type == TargetType::wedge) {
      const AnalyticWedge wedge(target_.width, target_.speed, target_.density, target_.angle, shorter);
      if (target_.angle - wedge.turn() > leaving) return;
    }
    for (const Arm& arm : arms) add_sheet(arm);
  }

  /// From 2 H, or where the wall's last straight stretch begins, to half a width before its end.
  void add_sheet(const Arm& arm) {
    const double end = 0.5 * target_.width;  // before the wall's
    const double begin = std::min(2.0 * target_.width, arm.straight_end());
    if (begin - end < 0.5 * target_.width) return;
    const OutlineEdge& last = arm.edges.back();
    const Vector<2> x = arm.exit();
    target_.sheets.push_back({{.origin = last.end - begin * x, .x = x, .y = arm.side * last.normal(1.0)}, begin - end});
  }

  /// Adds the wall particles on two arms. `describe(place, normal, x)` gives a point's x and share; its own x is the
  /// distance along the first arm, and negative along the second.
  template <class Describe>
  void add_points(const std::array<Arm, 2>& arms, Describe&& describe) {
    const double tolerance = 1e-3 * target_.spacing;
    const std::vector<WallPoint<2>> points = wall_points(walls_, target_.spacing);
    target_.points.emplace();
    for (std::size_t k = 0; k < points.size(); ++k) {
      const WallPoint<2>& point = points[k];
      const auto x = distance_along(arms, point, tolerance);
      if (!x) continue;
      const auto [place, share] = describe(point.position, point.normal, *x);
      target_.points->insert({static_cast<std::int64_t>(k), {place, point.area, share}});
    }
  }

  static std::optional<double> distance_along(const std::array<Arm, 2>& arms, const WallPoint<2>& point,
                                              double tolerance) {
    for (const Arm& arm : arms) {
      double before = 0.0;
      for (const OutlineEdge& edge : arm.edges) {
        const double share = edge.nearest_share(point.position);
        if (norm(edge.at(share) - point.position) <= tolerance &&
            dot(arm.side * edge.normal(share), point.normal) > 0.5)
          return arm.side * (before + share * edge.length());
        before += edge.length();
      }
    }
    return std::nullopt;
  }

  const Case& config_;
  std::vector<Wall<2>> walls_;
  std::vector<Outlet<2>> outlets_;
  Vector<2> from_, direction_;  // of the first jet
  JetTarget target_;
};

}  // namespace

void refuse_target(const Case& config, const std::string& reason) {
  throw InputError(
      {fmt::format("the case {} has no jet with an exact solution here: {}. Measured are: geometry = \"jet\"; in a "
                   "scene an inlet whose axis meets a long straight wall, the middle of a shorter one across it, the "
                   "edge of a wedge or the bottom of a cup, both symmetric to it; two equal inlets that blow at "
                   "each other; and in three dimensions an inlet of circular section, or of a rectangular one that "
                   "fills the gap between two walls, whose axis meets a large flat wall",
                   config.name, reason)});
}

void check_inlets_of_target(const Case& config, std::size_t most) {
  const auto& inlets = config.inlets;
  if (inlets.empty() || inlets.size() > most) refuse_target(config, fmt::format("it has {} inlets", inlets.size()));
  for (const InletEntry& inlet : inlets) {
    if (!inlet.speeds.empty())
      refuse_target(config, fmt::format("the speed of the inlet {} changes in time", inlet.name));
    if (!inlet.profile.empty())
      refuse_target(config, fmt::format("the speed of the inlet {} changes over its section", inlet.name));
  }
}

bool is_long_enough(const AnalyticJet& jet, double begin, double end) {
  constexpr double without_pressure = 0.01;
  return begin <= jet.plate_position_of_cp(without_pressure, Side::h2) &&
         end >= jet.plate_position_of_cp(without_pressure, Side::h1);
}

double JetTarget::particle_area() const {
  const double area = spacing * spacing;
  if (space) return area * spacing / space->depth;
  return type == TargetType::jet ? 0.5 * area : area;
}

std::optional<JetTarget::Point> JetTarget::point_of(const Particles<2>& particles, std::size_t i) const {
  if (particles.type[i] != ParticleType::wall) return std::nullopt;
  if (!points) return Point{particles.position[i][0], spacing, 1.0};
  const auto found = points->find(particles.id[i]);
  return found == points->end() ? std::nullopt : std::optional(found->second);
}

JetTarget jet_target(const Case& config) {
  if (config.dimension == 3) return space_target(config);
  if (config.geometry != SceneType::jet) return TargetSearch(config).target();
  return {.type = TargetType::plate,
          .width = config.jet.width,
          .speed = config.jet.speed,
          .density = config.fluid.density,
          .spacing = config.particles.spacing,
          .distance = config.jet.inlet_distance * config.jet.width,
          .angle = config.jet.angle * pi / 180.0,
          .frame = {},
          .begin = config.plate.begin,
          .end = config.plate.end,
          .points = {},
          .sheets = {}};
}

Particles<2> in_frame(const JetTarget& target, const Particles<2>& particles) {
  Particles<2> result;
  result.copy_owned(particles);
  const bool folds = target.type == TargetType::jet;
  for (std::size_t i = 0; i < static_cast<std::size_t>(result.owned); ++i) {
    Vector<2>& position = result.position[i];
    Vector<2>& velocity = result.velocity[i];
    position = target.frame.of_position(position);
    velocity = target.frame.of_direction(velocity);
    if (!folds) continue;
    if (position[1] < 0.0) {
      position[1] = -position[1];
      velocity[1] = -velocity[1];
    }
    if (result.type[i] == ParticleType::wall) result.type[i] = ParticleType::ghost;
  }
  if (!folds) return result;

  const double dp = target.spacing, radius = FluidFit<2>::radius * dp;
  const auto first = static_cast<int>(std::ceil(target.begin / dp)), last = static_cast<int>(target.end / dp);
  std::vector<FluidFit<2>> fits(static_cast<std::size_t>(last - first));  // at (first + k + 1/2) dp
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    const Vector<2> position = target.frame.of_position(particles.position[i]);
    if (particles.type[i] != ParticleType::fluid || !(std::abs(position[1]) <= radius)) continue;
    for (std::size_t k = 0; k < fits.size(); ++k) {
      const Vector<2> offset = position - Vector<2>{{(first + static_cast<double>(k) + 0.5) * dp, 0.0}};
      if (dot(offset, offset) <= radius * radius)
        fits[k].add(1.0 / dp * offset, {particles.pressure[i], particles.velocity[i]});
    }
  }
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const auto value = fits[k].value();
    result.append({{{(first + static_cast<double>(k) + 0.5) * dp, 0.0}},
                   {},
                   value ? value->pressure : 0.0,
                   0.0,
                   static_cast<std::int64_t>(k),
                   ParticleType::wall});
  }
  return result;
}

// u ~ a + G d at the offset d, weighted by (1 - d^2/R^2)^2, so that a particle that enters the circle changes nothing.
std::optional<Vector<2>> stagnation_point(const Particles<2>& particles, const Vector<2>& start, double radius) {
  Vector<2> place = start;
  for (int iteration = 0; iteration < 50; ++iteration) {
    Matrix<3> moments;
    std::array<Vector<3>, 2> sums;
    for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
      if (particles.type[i] != ParticleType::fluid) continue;
      const Vector<2> offset = 1.0 / radius * (particles.position[i] - place);
      const double gap = 1.0 - dot(offset, offset);
      if (!(gap > 0.0)) continue;
      const Vector<3> basis{{1.0, offset[0], offset[1]}};
      moments.add_product(gap * gap * basis, basis);
      for (std::size_t k = 0; k < 2; ++k) sums[k] += gap * gap * particles.velocity[i][static_cast<int>(k)] * basis;
    }
    const double scale = determinant(moments);
    if (!(scale > 0.0)) return std::nullopt;
    const Matrix<3> inverse = 1.0 / scale * adjugate(moments);
    Matrix<2> gradient;
    Vector<2> velocity;
    for (int k = 0; k < 2; ++k) {
      const Vector<3> fit = inverse * sums[static_cast<std::size_t>(k)];
      velocity[k] = fit[0];
      gradient.row[static_cast<std::size_t>(k)] = {{fit[1], fit[2]}};
    }
    const double slope = determinant(gradient);
    if (slope == 0.0) return std::nullopt;
    const Vector<2> move = -radius / slope * (adjugate(gradient) * velocity);
    place += move;
    if (!(norm(place - start) <= radius)) return std::nullopt;
    if (norm(move) < 1e-6 * radius) break;
  }
  return place;
}

}  // namespace impinge
