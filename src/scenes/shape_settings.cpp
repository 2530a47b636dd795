#include "impinge/scenes/shape_settings.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "impinge/geometry/solids.hpp"

namespace impinge {
namespace {

template <int Dim>
Transform<Dim> scaling_of(const ShapeSettings& shape) {
  return {.scale = shape.scale, .about = vector_of<Dim>(shape.about)};
}

template <int Dim>
Box<Dim> scaled_box(const ShapeSettings& shape) {
  const Transform<Dim> scaling = scaling_of<Dim>(shape);
  return {scaling(vector_of<Dim>(shape.low)), scaling(vector_of<Dim>(shape.high))};
}

std::optional<Outline> scaled_outline(const ShapeSettings& shape, std::vector<std::string>& mistakes) {
  const Transform<2> scaling = scaling_of<2>(shape);
  const Vector<2> center = scaling(vector_of<2>(shape.center));
  std::vector<Vector<2>> points;
  for (const Numbers& point : shape.points) points.push_back(scaling(vector_of<2>(point)));
  switch (shape.shape) {
    case ShapeType::box: {
      const Box<2> box = scaled_box<2>(shape);
      return make_box(box.low, box.high, mistakes);
    }
    case ShapeType::circle:
      return make_circle(center, shape.scale * shape.radius, mistakes);
    case ShapeType::polygon:
      return make_polygon(std::move(points), mistakes);
    case ShapeType::arc:
      return make_arc(center, shape.scale * shape.radius, shape.from, shape.to, mistakes);
    case ShapeType::polyline:
      return make_polyline(std::move(points), mistakes);
    case ShapeType::sphere:
      break;
  }
  mistakes.push_back("a sphere has three dimensions");
  return {};
}

/// The middle of the shape's numbers, unscaled.
Numbers middle_of(const ShapeSettings& shape, int dimension) {
  if (shape.shape == ShapeType::circle || shape.shape == ShapeType::sphere || shape.shape == ShapeType::arc)
    return shape.center;
  Numbers low = shape.low, high = shape.high;
  if (shape.shape != ShapeType::box && !shape.points.empty()) {
    low = high = shape.points.front();
    for (const Numbers& point : shape.points) {
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

}  // namespace

void declare_shape(Keys& keys, ShapeSettings& shape, ShapeKind kind) {
  const bool open = kind == ShapeKind::any;
  keys.add(
      "shape", shape.shape,
      open ? "2D: box, circle and polygon have an inside, arc and polyline are lines without thickness; 3D: box and "
             "sphere have an inside, polygon is flat and without thickness"
           : "box, circle and polygon in 2D; box and sphere in 3D",
      {.required = true});
  keys.only_where(shape.shape, {ShapeType::box}, [&] {
    keys.add("low", shape.low, "corner with the smallest coordinates", {.unit = "m", .required = true});
    keys.add("high", shape.high, "corner with the largest coordinates", {.unit = "m", .required = true});
  });
  const auto round = [&] {
    keys.add("center", shape.center, "centre", {.unit = "m", .required = true});
    keys.add("radius", shape.radius, "radius", {.unit = "m", .range = positive, .required = true});
  };
  if (open) {
    keys.only_where(shape.shape, {ShapeType::circle, ShapeType::sphere, ShapeType::arc}, round);
    keys.only_where(shape.shape, {ShapeType::arc}, [&] {
      keys.add("from", shape.from, "where the arc begins, from the x axis counter-clockwise",
               {.unit = "deg", .required = true});
      keys.add("to", shape.to, "where it ends; clockwise if smaller", {.unit = "deg", .required = true});
    });
    keys.only_where(shape.shape, {ShapeType::polygon, ShapeType::polyline}, [&] {
      keys.add("points", shape.points, "corners in order; those of a polygon in either direction",
               {.unit = "m", .required = true});
    });
  } else {
    keys.only_where(shape.shape, {ShapeType::circle, ShapeType::sphere}, round);
    keys.only_where(shape.shape, {ShapeType::polygon}, [&] {
      keys.add("points", shape.points, "corners in order, in either direction", {.unit = "m", .required = true});
    });
  }
  keys.add("scale", shape.scale, "factor by which the shape is larger", {.range = positive});
  keys.add("rotate", shape.rotate, "angle by which the shape and what is on it are turned, 2D", {.unit = "deg"});
  keys.add("translate", shape.translate, "by which the shape is then moved", {.unit = "m"});
  keys.add("about", shape.about,
           "fixed point of scale and rotate, before translate; of a fluid's spin and gradient, too",
           {.unit = "m", .fallback = "the middle of the shape"});
}

void derive_shape(const Keys& keys, int dimension, ShapeSettings& shape) {
  if (!keys.given(shape.about)) shape.about = middle_of(shape, dimension);
}

void check_shape(Keys& keys, int dimension, ShapeKind kind, const ShapeSettings& shape) {
  if (keys.usable(shape.shape)) {
    if (kind == ShapeKind::closed && shape.is_open())
      keys.mistake(shape.shape,
                   fmt::format("a line has no inside; allowed: {}",
                               dimension == 2 ? "\"box\", \"circle\", \"polygon\"" : "\"box\", \"sphere\""));
  }
  if (dimension == 3 && keys.usable(shape.rotate) && shape.rotate != 0.0)
    keys.mistake(shape.rotate, "turns in two dimensions only; allowed: 0 (deg)");
}

bool is_usable(const Keys& keys, const ShapeSettings& shape) {
  if (!keys.usable(shape.shape, shape.scale, shape.rotate, shape.translate, shape.about)) return false;
  switch (shape.shape) {
    case ShapeType::box:
      return keys.usable(shape.low, shape.high);
    case ShapeType::polygon:
    case ShapeType::polyline:
      return keys.usable(shape.points);
    case ShapeType::arc:
      return keys.usable(shape.center, shape.radius, shape.from, shape.to);
    case ShapeType::circle:
    case ShapeType::sphere:
      return keys.usable(shape.center, shape.radius);
  }
  return false;
}

template <>
std::shared_ptr<const Shape<2>> scaled_shape(const ShapeSettings& shape, std::vector<std::string>& mistakes) {
  if (shape.is_open()) return nullptr;
  const std::optional<Outline> outline = scaled_outline(shape, mistakes);
  return outline ? std::make_shared<const Outline>(*outline) : nullptr;
}

template <>
std::shared_ptr<const Shape<3>> scaled_shape(const ShapeSettings& shape, std::vector<std::string>& mistakes) {
  if (shape.shape == ShapeType::sphere)
    return std::make_shared<const Sphere>(scaling_of<3>(shape)(vector_of<3>(shape.center)), shape.scale * shape.radius);
  if (shape.shape != ShapeType::box) {
    mistakes.push_back("circles and polygons have two dimensions");
    return nullptr;
  }
  const Box<3> box = scaled_box<3>(shape);
  for (int k = 0; k < 3; ++k) {
    if (box.low[k] < box.high[k]) continue;
    mistakes.push_back("the low corner is not below the high corner along every axis");
    return nullptr;
  }
  return std::make_shared<const Block>(box);
}

template <int Dim>
Transform<Dim> placement_of(const ShapeSettings& shape) {
  Transform<Dim> placement{.about = vector_of<Dim>(shape.about), .translate = vector_of<Dim>(shape.translate)};
  if constexpr (Dim == 2) placement.rotation = rotation(shape.rotate);
  return placement;
}

template Transform<2> placement_of(const ShapeSettings&);
template Transform<3> placement_of(const ShapeSettings&);

std::optional<Outline> outline_of(const ShapeSettings& shape, std::vector<std::string>& mistakes) {
  const std::optional<Outline> outline = scaled_outline(shape, mistakes);
  if (!outline) return {};
  return transformed(*outline, placement_of<2>(shape));
}

}  // namespace impinge
