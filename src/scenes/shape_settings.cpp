#include "impinge/scenes/shape_settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "impinge/geometry/mesh_file.hpp"
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
    case ShapeType::cylinder:
    case ShapeType::cone:
    case ShapeType::mesh:
      break;
  }
  mistakes.push_back(fmt::format("a {} has three dimensions", word_of(shape.shape)));
  return {};
}

/// The middle of the shape's numbers, unscaled.
Numbers middle_of(const ShapeSettings& shape, int dimension) {
  if (shape.shape == ShapeType::circle || shape.shape == ShapeType::sphere || shape.shape == ShapeType::arc)
    return shape.center;
  Numbers low = shape.low, high = shape.high;
  if (shape.shape == ShapeType::cylinder || shape.shape == ShapeType::cone) {
    low = shape.begin;
    high = shape.end;
  } else if (shape.shape == ShapeType::mesh) {
    return {};
  } else if (shape.shape != ShapeType::box && !shape.points.empty()) {
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
      open ? "2D: box, circle and polygon have an inside, arc and polyline are lines without thickness; 3D: box, "
             "sphere, "
             "cylinder and cone have an inside, polygon is flat and without thickness, mesh is the surface of a file"
           : "box, circle and polygon in 2D; box, sphere, cylinder, cone and mesh, the closed surface of a file, in 3D",
      {.required = true});
  keys.only_where(shape.shape, {ShapeType::box}, [&] {
    keys.add("low", shape.low, "corner with the smallest coordinates", {.unit = "m", .required = true});
    keys.add("high", shape.high, "corner with the largest coordinates", {.unit = "m", .required = true});
  });
  const auto only_where = [&](std::vector<ShapeType> types, const auto& add) {
    if (!open) std::erase_if(types, [](ShapeType type) { return !has_inside(type); });
    if (!types.empty()) keys.only_where(shape.shape, types, add);
  };
  only_where({ShapeType::circle, ShapeType::sphere, ShapeType::arc},
             [&] { keys.add("center", shape.center, "centre", {.unit = "m", .required = true}); });
  only_where({ShapeType::cylinder, ShapeType::cone}, [&] {
    keys.add("begin", shape.begin, "middle of one end", {.unit = "m", .required = true});
    keys.add("end", shape.end, "middle of the other end", {.unit = "m", .required = true});
  });
  only_where({ShapeType::circle, ShapeType::sphere, ShapeType::arc, ShapeType::cylinder, ShapeType::cone}, [&] {
    keys.add("radius", shape.radius, "radius; of a cone where it begins",
             {.unit = "m", .range = positive, .required = true});
  });
  only_where({ShapeType::cone}, [&] {
    keys.add("end_radius", shape.end_radius, "radius where the cone ends", {.unit = "m", .range = not_negative});
  });
  only_where({ShapeType::arc}, [&] {
    keys.add("from", shape.from, "where the arc begins, from the x axis counter-clockwise",
             {.unit = "deg", .required = true});
    keys.add("to", shape.to, "where it ends; clockwise if smaller", {.unit = "deg", .required = true});
  });
  only_where({ShapeType::polygon, ShapeType::polyline}, [&] {
    keys.add("points", shape.points, "corners in order, in either direction", {.unit = "m", .required = true});
  });
  only_where({ShapeType::mesh}, [&] {
    keys.add("file", shape.file,
             "an STL, OBJ or PLY file, relative to the case file; its lengths are in m, or see scale",
             {.required = true});
    keys.add("digest", shape.digest, "of the file's content: a run notes it, and a restart needs the same",
             {.fallback = "that of the file"});
  });
  keys.add("scale", shape.scale, "factor by which the shape is larger", {.range = positive});
  keys.add("rotate", shape.rotate, "angle by which the shape and what is on it are turned, counter-clockwise",
           {.unit = "deg"});
  keys.add("axis", shape.axis, "3D: direction of the line through about that rotate turns about, of any length",
           {.fallback = "the z axis"});
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
    if (kind == ShapeKind::closed && !shape.has_inside())
      keys.mistake(shape.shape, fmt::format("a line has no inside; allowed: {}",
                                            dimension == 2 ? "\"box\", \"circle\", \"polygon\""
                                                           : "\"box\", \"sphere\", \"cylinder\", \"cone\", \"mesh\""));
  }
  if (dimension == 3 && keys.usable(shape.axis) && !(norm(vector_of<3>(shape.axis)) > 0.0))
    keys.mistake(shape.axis, "no direction; allowed: any vector but 0");
}

bool is_usable(const Keys& keys, const ShapeSettings& shape) {
  if (!keys.usable(shape.shape, shape.scale, shape.rotate, shape.axis, shape.translate, shape.about)) return false;
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
    case ShapeType::cylinder:
      return keys.usable(shape.begin, shape.end, shape.radius);
    case ShapeType::cone:
      return keys.usable(shape.begin, shape.end, shape.radius, shape.end_radius);
    case ShapeType::mesh:
      return keys.usable(shape.file);
  }
  return false;
}

template <>
std::shared_ptr<const Shape<2>> scaled_shape(const ShapeSettings& shape, std::vector<std::string>& mistakes) {
  if (!shape.has_inside()) return nullptr;
  const std::optional<Outline> outline = scaled_outline(shape, mistakes);
  return outline ? std::make_shared<const Outline>(*outline) : nullptr;
}

template <>
std::shared_ptr<const Shape<3>> scaled_shape(const ShapeSettings& shape, std::vector<std::string>& mistakes) {
  if (shape.shape == ShapeType::sphere)
    return std::make_shared<const Sphere>(scaling_of<3>(shape)(vector_of<3>(shape.center)), shape.scale * shape.radius);
  if (shape.shape == ShapeType::cylinder || shape.shape == ShapeType::cone) {
    if (!scaled_facets(shape, mistakes)) return nullptr;
    const Transform<3> scaling = scaling_of<3>(shape);
    const double end_radius = shape.shape == ShapeType::cone ? shape.end_radius : shape.radius;
    return std::make_shared<const Frustum>(scaling(vector_of<3>(shape.begin)), scaling(vector_of<3>(shape.end)),
                                           shape.scale * shape.radius, shape.scale * end_radius);
  }
  if (shape.shape == ShapeType::mesh) {
    const std::optional<Facets> facets = scaled_facets(shape, mistakes);
    std::vector<std::string> left_out;
    std::optional<Mesh> mesh = facets ? make_mesh(*facets, mistakes, left_out) : std::nullopt;
    if (mesh && mesh->closed()) return std::make_shared<const Mesh>(std::move(*mesh));
    if (mesh) mistakes.push_back("the surface has an end, and no inside; allowed: a closed one");
    return nullptr;
  }
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

std::optional<Facets> scaled_facets(const ShapeSettings& shape, std::vector<std::string>& mistakes) {
  const Transform<3> scaling = scaling_of<3>(shape);
  switch (shape.shape) {
    case ShapeType::box: {
      const Box<3> box = scaled_box<3>(shape);
      if (box.low[0] < box.high[0] && box.low[1] < box.high[1] && box.low[2] < box.high[2])
        return box_facets(box.low, box.high);
      mistakes.push_back("the low corner is not below the high corner along every axis");
      return {};
    }
    case ShapeType::sphere:
      return sphere_facets(scaling(vector_of<3>(shape.center)), shape.scale * shape.radius);
    case ShapeType::cylinder:
    case ShapeType::cone: {
      const Vector<3> begin = scaling(vector_of<3>(shape.begin)), end = scaling(vector_of<3>(shape.end));
      const double radius = shape.scale * shape.radius;
      const double end_radius = shape.shape == ShapeType::cone ? shape.scale * shape.end_radius : radius;
      if (begin == end) mistakes.push_back("begins where it ends; allowed: two points");
      if (!(std::max(radius, end_radius) > 0.0)) mistakes.push_back("has no radius; allowed: > 0 (m) at one end");
      if (begin == end || !(std::max(radius, end_radius) > 0.0)) return {};
      return cone_facets(begin, end, radius, end_radius);
    }
    case ShapeType::polygon: {
      std::vector<Vector<3>> points;
      for (const Numbers& point : shape.points) points.push_back(scaling(vector_of<3>(point)));
      return polygon_facets(points, mistakes);
    }
    case ShapeType::mesh: {
      mistakes.insert(mistakes.end(), shape.file_mistakes.begin(), shape.file_mistakes.end());
      if (!shape.facets) return {};
      Facets facets = *shape.facets;
      for (Vector<3>& point : facets.points) point = scaling(point);
      return facets;
    }
    case ShapeType::circle:
    case ShapeType::arc:
    case ShapeType::polyline:
      break;
  }
  mistakes.push_back("circles, arcs and polylines have two dimensions");
  return {};
}

void take_mesh(Keys& keys, const std::vector<NamedText>& files, ShapeSettings& shape) {
  const Key& key = keys.of(shape.file);
  if (shape.shape != ShapeType::mesh || !key.given || !key.usable) return;
  const std::string path = path_of_named(key.place.name, shape.file);
  const auto found = std::ranges::find(files, path, &NamedText::first);
  if (const std::string problem = path_problem(shape.file); !problem.empty()) {
    keys.mistake(shape.file, problem);
  } else if (!is_mesh_file(shape.file)) {
    keys.mistake(shape.file, fmt::format("has another ending; allowed: {}", fmt::join(mesh_endings, ", ")));
  } else if (found == files.end()) {
    keys.mistake(shape.file, fmt::format("cannot read {}; allowed: a file of at most 200 MB", path));
  } else {
    const std::string digest = digest_of(found->second);
    if (keys.given(shape.digest) && keys.usable(shape.digest) && shape.digest != digest) {
      keys.mistake(shape.file, fmt::format("has another content, {}, than when the run was started; allowed: {}",
                                           digest, shape.digest));
      return;
    }
    shape.digest = digest;
    if (std::optional<Facets> facets = read_facets(path, found->second, shape.file_mistakes))
      shape.facets = std::make_shared<const Facets>(std::move(*facets));
    shape.file = std::filesystem::absolute(path).lexically_normal().string();
  }
}

template <int Dim>
Transform<Dim> placement_of(const ShapeSettings& shape) {
  Transform<Dim> placement{.about = vector_of<Dim>(shape.about), .translate = vector_of<Dim>(shape.translate)};
  if constexpr (Dim == 2) {
    placement.rotation = rotation(shape.rotate);
  } else {
    const Vector<3> axis = vector_of<3>(shape.axis);
    if (norm(axis) > 0.0) placement.rotation = rotation(1.0 / norm(axis) * axis, shape.rotate);
  }
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
