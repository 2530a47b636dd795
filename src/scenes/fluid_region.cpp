#include "impinge/scenes/fluid_region.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "impinge/core/mpi.hpp"
#include "impinge/scenes/check_names.hpp"

namespace impinge {
namespace {

/// True where what a region's particles depend on has allowed values.
bool is_usable(const Keys& keys, const FluidRegion& region) {
  const ShapeSettings& shape = region;
  return is_usable(keys, shape) && keys.usable(region.velocity, region.spin, region.gradient);
}

/// A point that lies deeper than `depth` in both regions, of a fine lattice over what their bounds have in common.
template <int Dim>
std::optional<Vector<Dim>> common_point(const PlacedRegion<Dim>& a, const PlacedRegion<Dim>& b, double depth) {
  constexpr double most = Dim == 2 ? 200.0 : 40.0;  // points along an axis
  const Box<Dim> first = a.bounds(), second = b.bounds();
  BoxLattice<Dim> numbers{.spacing = 1.0};
  Vector<Dim> low, step;
  for (int k = 0; k < Dim; ++k) {
    low[k] = std::max(first.low[k], second.low[k]);
    const double length = std::min(first.high[k], second.high[k]) - low[k];
    if (length <= 2.0 * depth) return {};
    const double count = std::ceil(std::min(length / depth, most));
    numbers.extent[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(count);
    step[k] = length / count;
  }
  for (std::int64_t k = 0; k < numbers.count(); ++k) {
    Vector<Dim> point = numbers.point(k);
    for (int axis = 0; axis < Dim; ++axis) point[axis] = low[axis] + step[axis] * point[axis];
    if (a.contains(point, depth) && b.contains(point, depth)) return point;
  }
  return {};
}

/// The first numbers of a corner: "(0, 1.5)".
std::string corner_text(const Vector<3>& corner, int dimension) {
  return fmt::format("({:.6g})", fmt::join(corner.component.begin(), corner.component.begin() + dimension, ", "));
}

/// What is wrong with where a shape lies and how large it is; nothing if all is well.
template <int Dim>
std::string problem_of(const PlacedRegion<Dim>& region, double spacing, const Box<3>& room) {
  const Box<Dim> bounds = region.bounds();
  double points = 1.0;  // of the region's lattice, or more
  bool is_outside = false;
  for (int k = 0; k < Dim; ++k) {
    points *= (bounds.high[k] - bounds.low[k]) / spacing;
    is_outside |= bounds.high[k] <= room.low[k] || bounds.low[k] >= room.high[k];
  }
  constexpr int most = std::numeric_limits<std::int32_t>::max();
  if (!(points <= most)) return fmt::format("makes some {:.2g} particles; allowed: at most {}", points, most);
  if (region.volume() < 0.5 * std::pow(spacing, Dim))
    return fmt::format("holds no particle; its {} is {:.3g} m^{}", Dim == 2 ? "area" : "volume", region.volume(), Dim);
  if (is_outside)
    return fmt::format("lies outside the scene, which reaches from {} to {} m", corner_text(room.low, Dim),
                       corner_text(room.high, Dim));
  return "";
}

template <int Dim>
void check_regions(Keys& keys, double spacing, const Box<3>& room, const std::vector<FluidRegion>& regions) {
  std::vector<const FluidRegion*> sound;
  std::vector<PlacedRegion<Dim>> in_place;  // of the sound ones
  for (const FluidRegion& region : regions) {
    check_shape(keys, Dim, ShapeKind::closed, region);
    if (!is_usable(keys, region)) continue;
    std::vector<std::string> mistakes;
    if (scaled_shape<Dim>(region, mistakes)) {
      const PlacedRegion<Dim> placed_region(region, spacing);
      const std::string problem = problem_of(placed_region, spacing, room);
      if (problem.empty()) {
        sound.push_back(&region);
        in_place.push_back(placed_region);
      } else {
        mistakes.push_back(problem);
      }
    }
    if (Dim == 3 && region.spin != 0.0)
      keys.mistake(region.spin, "a rotation in two dimensions only; allowed: 0 (rad/s), and fluid.region.gradient");
    if (!region.gradient.empty() && region.gradient.size() != Dim * Dim)
      keys.mistake(region.gradient, fmt::format("has {} numbers; allowed: {}, the rows of du_i/dx_j (1/s)",
                                                region.gradient.size(), Dim * Dim));
    for (const std::string& what : mistakes) keys.mistake(region.shape, what);
  }
  for (std::size_t b = 0; b < sound.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      const auto point = common_point(in_place[a], in_place[b], 0.25 * spacing);
      if (!point) continue;
      keys.mistake(sound[b]->shape, fmt::format("overlaps the fluid \"{}\", given at {}, at ({:.6g}) m", sound[a]->name,
                                                keys.place(sound[a]->shape), fmt::join(point->component, ", ")));
      break;
    }
  }
}

}  // namespace

void declare_fluid(Keys& keys, std::vector<FluidRegion>& regions) {
  keys.list("fluid.region", regions, "a region full of fluid at the start", {.fixed = true},
            [](Keys& inner, FluidRegion& region) {
              inner.add("name", region.name, "name of the region", {.fallback = "region_<number>"});
              declare_shape(inner, region, ShapeKind::closed);
              inner.add("velocity", region.velocity, "velocity at the start", {.unit = "m/s"});
              inner.add("spin", region.spin, "solid rotation at the start, counter-clockwise, 2D", {.unit = "rad/s"});
              inner.add("gradient", region.gradient, "velocity gradient at the start, du_i/dx_j row by row",
                        {.unit = "1/s"});
            });
}

void derive_fluid(const Keys& keys, int dimension, std::vector<FluidRegion>& regions) {
  for (std::size_t k = 0; k < regions.size(); ++k) {
    FluidRegion& region = regions[k];
    if (!keys.given(region.name)) region.name = fmt::format("region_{}", k + 1);
    derive_shape(keys, dimension, region);
  }
}

bool has_shape(const FluidRegion& region, int dimension) {
  std::vector<std::string> mistakes;
  return dimension == 2 ? scaled_shape<2>(region, mistakes) != nullptr : scaled_shape<3>(region, mistakes) != nullptr;
}

void check_fluid(Keys& keys, int dimension, double spacing, const Box<3>& room,
                 const std::vector<FluidRegion>& regions) {
  check_names(keys, regions);
  if (dimension == 2) check_regions<2>(keys, spacing, room, regions);
  if (dimension == 3) check_regions<3>(keys, spacing, room, regions);
}

template <int Dim>
PlacedRegion<Dim>::PlacedRegion(const FluidRegion& region, double spacing)
    : placement_(placement_of<Dim>(region)), velocity_(vector_of<Dim>(region.velocity)) {
  std::vector<std::string> mistakes;
  shape_ = scaled_shape<Dim>(region, mistakes);
  centre_ = placement_(placement_.about);
  for (std::size_t k = 0; k < region.gradient.size(); ++k)
    gradient_.row[k / Dim][static_cast<int>(k % Dim)] = region.gradient[k];
  if constexpr (Dim == 2) {
    gradient_.row[0][1] -= region.spin;
    gradient_.row[1][0] += region.spin;
  }
  // The lattice stands in the middle of the shape's own bounds.
  const Box<Dim> box = shape_->bounds();
  lattice_.spacing = spacing;
  for (int k = 0; k < Dim; ++k) {
    const double length = box.high[k] - box.low[k];
    const std::int64_t points = std::max<std::int64_t>(1, std::llround(length / spacing));
    lattice_.extent[static_cast<std::size_t>(k)] = points;
    const double rest = length - static_cast<double>(points) * spacing;
    lattice_.low[k] = std::abs(rest) < 1e-6 * spacing ? box.low[k] : box.low[k] + 0.5 * rest;
  }
}

template <int Dim>
Box<Dim> PlacedRegion<Dim>::bounds() const {
  const Box<Dim> own = shape_->bounds();
  Box<Dim> around;
  for (int code = 0; code < 1 << Dim; ++code) {
    const Vector<Dim> at = placement_(own.corner(code));
    for (int k = 0; k < Dim; ++k) {
      around.low[k] = code == 0 ? at[k] : std::min(around.low[k], at[k]);
      around.high[k] = code == 0 ? at[k] : std::max(around.high[k], at[k]);
    }
  }
  return around;
}

template <int Dim>
Vector<Dim> PlacedRegion<Dim>::velocity(const Vector<Dim>& point) const {
  return velocity_ + gradient_ * (point - centre_);
}

template <int Dim>
bool PlacedRegion<Dim>::point(std::int64_t k, Vector<Dim>& position) const {
  const Vector<Dim> own = lattice_.point(k);
  position = placement_(own);
  constexpr double on_outline = 1e-6;  // nearer to it, rounding would decide [dp]
  return shape_->distance(own) < -on_outline * lattice_.spacing;
}

template <int Dim>
std::int64_t PlacedRegion<Dim>::count() const {
  std::int64_t sum = 0;
  Vector<Dim> position;
  for (std::int64_t k = 0; k < points(); ++k) sum += point(k, position);
  return sum;
}

template <int Dim>
std::int64_t count_points(const std::vector<PlacedRegion<Dim>>& regions) {
  std::int64_t sum = 0;
  for (const PlacedRegion<Dim>& region : regions) sum += region.points();
  return sum;
}

template <int Dim>
void fill_regions(const std::vector<PlacedRegion<Dim>>& regions, std::int64_t first_id, int rank, int ranks,
                  const std::function<bool(const Vector<Dim>&)>& keep, Particles<Dim>& particles) {
  for (const PlacedRegion<Dim>& region : regions) {
    for_share(region.points(), rank, ranks, [&](std::int64_t k) {
      Vector<Dim> position;
      if (region.point(k, position) && keep(position))
        particles.append({position, region.velocity(position), 0.0, 0.0, first_id + k, ParticleType::fluid});
    });
    first_id += region.points();
  }
}

#define IMPINGE_INSTANTIATE(Dim)                                                            \
  template class PlacedRegion<Dim>;                                                         \
  template std::int64_t count_points(const std::vector<PlacedRegion<Dim>>&);                \
  template void fill_regions(const std::vector<PlacedRegion<Dim>>&, std::int64_t, int, int, \
                             const std::function<bool(const Vector<Dim>&)>&, Particles<Dim>&);
IMPINGE_INSTANTIATE(2)
IMPINGE_INSTANTIATE(3)
#undef IMPINGE_INSTANTIATE

}  // namespace impinge
