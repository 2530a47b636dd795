#include "impinge/scenes/fluid_region.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "impinge/core/mpi.hpp"
#include "impinge/geometry/outline.hpp"
#include "impinge/geometry/solids.hpp"

namespace impinge {
namespace {

template <int Dim>
Vector<Dim> vector_of(const Numbers& x) {
  Vector<Dim> result;
  for (int k = 0; k < Dim; ++k) result[k] = x[static_cast<std::size_t>(k)];
  return result;
}

template <int Dim>
Box<Dim> scaled_box(const FluidRegion& region) {
  const Transform<Dim> scaling{.scale = region.scale, .about = vector_of<Dim>(region.about)};
  return {scaling(vector_of<Dim>(region.low)), scaling(vector_of<Dim>(region.high))};
}

/// The shape, scaled but not turned or moved; nothing, and what is wrong with it, if there is no such shape.
std::shared_ptr<const Shape<2>> shape_of(const FluidRegion& region, std::vector<std::string>& mistakes, Vector<2>) {
  const Transform<2> scaling{.scale = region.scale, .about = vector_of<2>(region.about)};
  std::optional<Outline> outline;
  if (region.shape == RegionShape::box) {
    const Box<2> box = scaled_box<2>(region);
    outline = make_box(box.low, box.high, mistakes);
  } else if (region.shape == RegionShape::circle) {
    outline = make_circle(scaling(vector_of<2>(region.center)), region.scale * region.radius, mistakes);
  } else if (region.shape == RegionShape::polygon) {
    std::vector<Vector<2>> points;
    for (const Numbers& point : region.points) points.push_back(scaling(vector_of<2>(point)));
    outline = make_polygon(points, mistakes);
  } else {
    mistakes.push_back("a sphere has three dimensions");
  }
  return outline ? std::make_shared<const Outline>(*outline) : nullptr;
}

std::shared_ptr<const Shape<3>> shape_of(const FluidRegion& region, std::vector<std::string>& mistakes, Vector<3>) {
  const Transform<3> scaling{.scale = region.scale, .about = vector_of<3>(region.about)};
  if (region.shape == RegionShape::sphere)
    return std::make_shared<const Sphere>(scaling(vector_of<3>(region.center)), region.scale * region.radius);
  if (region.shape != RegionShape::box) {
    mistakes.push_back("circles and polygons have two dimensions");
    return nullptr;
  }
  const Box<3> box = scaled_box<3>(region);
  for (int k = 0; k < 3; ++k) {
    if (box.low[k] < box.high[k]) continue;
    mistakes.push_back("the low corner is not below the high corner along every axis");
    return nullptr;
  }
  return std::make_shared<const Block>(box);
}

/// The middle of the shape's numbers, unscaled.
Numbers middle_of(const FluidRegion& region, int dimension) {
  if (region.shape == RegionShape::circle || region.shape == RegionShape::sphere) return region.center;
  Numbers low = region.low, high = region.high;
  if (region.shape == RegionShape::polygon && !region.points.empty()) {
    low = high = region.points.front();
    for (const Numbers& point : region.points) {
      for (std::size_t k = 0; k < static_cast<std::size_t>(dimension); ++k) {
        low[k] = std::min(low[k], point[k]);
        high[k] = std::max(high[k], point[k]);
      }
    }
  }
  Numbers middle{};
  for (std::size_t k = 0; k < static_cast<std::size_t>(dimension); ++k) middle[k] = 0.5 * (low[k] + high[k]);
  return middle;
}

/// True where what a region's shape and place depend on has allowed values.
bool is_usable(const Keys& keys, const FluidRegion& region) {
  if (!keys.usable(region.shape, region.scale, region.rotate, region.translate, region.about, region.velocity,
                   region.spin, region.gradient))
    return false;
  switch (region.shape) {
    case RegionShape::box:
      return keys.usable(region.low, region.high);
    case RegionShape::polygon:
      return keys.usable(region.points);
    case RegionShape::circle:
    case RegionShape::sphere:
      return keys.usable(region.center, region.radius);
  }
  return false;
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
    if (!is_usable(keys, region)) continue;
    std::vector<std::string> mistakes;
    if (shape_of(region, mistakes, Vector<Dim>{})) {
      const PlacedRegion<Dim> placed_region(region, spacing);
      const std::string problem = problem_of(placed_region, spacing, room);
      if (problem.empty()) {
        sound.push_back(&region);
        in_place.push_back(placed_region);
      } else {
        mistakes.push_back(problem);
      }
    }
    if (Dim == 3 && region.rotate != 0.0) keys.mistake(region.rotate, "turns in two dimensions only; allowed: 0 (deg)");
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
  keys.list(
      "fluid.region", regions, "a region full of fluid at the start", {.fixed = true},
      [](Keys& inner, FluidRegion& region) {
        inner.add("name", region.name, "name of the region", {.fallback = "region_<number>"});
        inner.add("shape", region.shape, "box, circle and polygon in 2D; box and sphere in 3D", {.required = true});
        inner.only_where(region.shape, {RegionShape::box}, [&] {
          inner.add("low", region.low, "corner with the smallest coordinates", {.unit = "m", .required = true});
          inner.add("high", region.high, "corner with the largest coordinates", {.unit = "m", .required = true});
        });
        inner.only_where(region.shape, {RegionShape::circle, RegionShape::sphere}, [&] {
          inner.add("center", region.center, "centre", {.unit = "m", .required = true});
          inner.add("radius", region.radius, "radius", {.unit = "m", .range = positive, .required = true});
        });
        inner.only_where(region.shape, {RegionShape::polygon}, [&] {
          inner.add("points", region.points, "corners in order, in either direction", {.unit = "m", .required = true});
        });
        inner.add("scale", region.scale, "factor by which the shape is larger", {.range = positive});
        inner.add("rotate", region.rotate, "angle by which the shape and its lattice are turned, 2D", {.unit = "deg"});
        inner.add("translate", region.translate, "by which the shape is then moved", {.unit = "m"});
        inner.add("about", region.about, "fixed point of scale, rotate, spin and gradient, before translate",
                  {.unit = "m", .fallback = "the middle of the shape"});
        inner.add("velocity", region.velocity, "velocity at the start", {.unit = "m/s"});
        inner.add("spin", region.spin, "solid rotation at the start, counter-clockwise, 2D", {.unit = "rad/s"});
        inner.add("gradient", region.gradient, "velocity gradient at the start, du_i/dx_j row by row", {.unit = "1/s"});
      });
}

void derive_fluid(const Keys& keys, int dimension, std::vector<FluidRegion>& regions) {
  for (std::size_t k = 0; k < regions.size(); ++k) {
    FluidRegion& region = regions[k];
    if (!keys.given(region.name)) region.name = fmt::format("region_{}", k + 1);
    if (!keys.given(region.about)) region.about = middle_of(region, dimension);
  }
}

bool has_shape(const FluidRegion& region, int dimension) {
  std::vector<std::string> mistakes;
  return dimension == 2 ? shape_of(region, mistakes, Vector<2>{}) != nullptr
                        : shape_of(region, mistakes, Vector<3>{}) != nullptr;
}

void check_fluid(Keys& keys, int dimension, double spacing, const Box<3>& room,
                 const std::vector<FluidRegion>& regions) {
  for (std::size_t b = 0; b < regions.size(); ++b)
    for (std::size_t a = 0; a < b; ++a)
      if (regions[a].name == regions[b].name)
        keys.mistake(regions[b].name, fmt::format("the name is used twice, first at {}", keys.place(regions[a].name)));
  if (dimension == 2) check_regions<2>(keys, spacing, room, regions);
  if (dimension == 3) check_regions<3>(keys, spacing, room, regions);
}

template <int Dim>
PlacedRegion<Dim>::PlacedRegion(const FluidRegion& region, double spacing)
    : velocity_(vector_of<Dim>(region.velocity)) {
  std::vector<std::string> mistakes;
  shape_ = shape_of(region, mistakes, Vector<Dim>{});
  placement_.about = vector_of<Dim>(region.about);
  placement_.translate = vector_of<Dim>(region.translate);
  if constexpr (Dim == 2) placement_.rotation = rotation(region.rotate);
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
    Vector<Dim> corner;
    for (int k = 0; k < Dim; ++k) corner[k] = (code >> k) % 2 == 0 ? own.low[k] : own.high[k];
    const Vector<Dim> at = placement_(corner);
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
