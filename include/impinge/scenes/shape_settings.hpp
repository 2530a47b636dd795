#pragma once
// Shapes in a case file: the keys that regions of fluid, walls and outlets have in common.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "impinge/config/case_file.hpp"
#include "impinge/config/key.hpp"
#include "impinge/geometry/mesh.hpp"
#include "impinge/geometry/outline.hpp"
#include "impinge/geometry/shape.hpp"
#include "impinge/geometry/transform.hpp"

namespace impinge {

enum class ShapeType { box, circle, polygon, sphere, cylinder, cone, mesh, arc, polyline };
constexpr auto words(ShapeType) {
  return std::to_array<std::string_view>(
      {"box", "circle", "polygon", "sphere", "cylinder", "cone", "mesh", "arc", "polyline"});
}

/// True for shapes with an inside in two dimensions or three; whether a mesh has one, its file decides.
constexpr bool has_inside(ShapeType type) { return type != ShapeType::arc && type != ShapeType::polyline; }

/// A shape and its place. Lengths in m, angles in degrees.
struct ShapeSettings {
  ShapeType shape = ShapeType::box;
  Numbers low{}, high{};         ///< corners of a box
  Numbers center{};              ///< of a circle, sphere or arc
  double radius = 0.0;           ///< likewise, and of a cylinder or, where it begins, of a cone
  Numbers begin{}, end{};        ///< middles of the ends of a cylinder or a cone
  double end_radius = 0.0;       ///< of a cone where it ends
  std::string file;              ///< of a mesh
  std::string digest;            ///< of the file's content
  double from = 0.0, to = 90.0;  ///< ends of an arc, as angles from the x axis
  std::vector<Numbers> points;   ///< corners of a polygon or polyline
  double scale = 1.0;            ///< about `about`
  double rotate = 0.0;           ///< about `about`, counter-clockwise
  Numbers axis{0.0, 0.0, 1.0};   ///< of the rotation, in three dimensions; of any length
  Numbers translate{};
  Numbers about{};  ///< where scale and rotate leave things as they are

  std::shared_ptr<const Facets> facets{};  ///< of the file
  std::vector<std::string> file_mistakes{};

  bool has_inside() const { return impinge::has_inside(shape); }
};

/// Which shapes there may be: those with an inside, or lines without thickness, too.
enum class ShapeKind { closed, any };

/// Declares the shape's keys.
void declare_shape(Keys& keys, ShapeSettings& shape, ShapeKind kind);

/// Reads the facets of the file that the shape names, if it does. `files`: names and contents of files; a name is
/// relative to the case file that names it. Notes a file that has changed since its digest was taken. Afterwards the
/// name is absolute.
void take_mesh(Keys& keys, const std::vector<NamedText>& files, ShapeSettings& shape);

/// Sets `about` where it is not given. `dimension`: of space.
void derive_shape(const Keys& keys, int dimension, ShapeSettings& shape);

/// Notes a shape that is not of the kind, and an axis without a direction.
void check_shape(Keys& keys, int dimension, ShapeKind kind, const ShapeSettings& shape);

/// True where all that the shape and its place depend on has allowed values.
bool is_usable(const Keys& keys, const ShapeSettings& shape);

/// The shape with an inside, scaled but not turned or moved; nothing, and what is wrong with its numbers, if there is
/// no such shape in Dim dimensions.
template <int Dim>
std::shared_ptr<const Shape<Dim>> scaled_shape(const ShapeSettings& shape, std::vector<std::string>& mistakes);

/// The surface of a shape in three dimensions, scaled but not turned or moved; nothing, and what is wrong with its
/// numbers, if there is no such shape.
std::optional<Facets> scaled_facets(const ShapeSettings& shape, std::vector<std::string>& mistakes);

/// What turns and moves it.
template <int Dim>
Transform<Dim> placement_of(const ShapeSettings& shape);

/// The line or outline in its place; nothing, and what is wrong with its numbers, if there is none.
std::optional<Outline> outline_of(const ShapeSettings& shape, std::vector<std::string>& mistakes);

}  // namespace impinge
