#include "impinge/programs/scene_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "impinge/core/mpi.hpp"
#include "impinge/io/run_directory.hpp"
#include "impinge/io/snapshot_layout.hpp"
#include "impinge/io/vtkhdf.hpp"
#include "impinge/observe/place.hpp"
#include "impinge/scenes/scenes.hpp"
#include "impinge/scenes/wet_space.hpp"

namespace impinge {
namespace {

/// Cells with their data, as the file has them.
template <int Dim>
struct Cells {
  std::vector<Vector<Dim>> points;
  std::vector<std::int64_t> begin{0};
  std::vector<std::uint8_t> types, items;
  std::vector<std::int32_t> numbers;
  std::vector<Vector<Dim>> normals;

  /// A vertex, or a line through several points, or another cell of them.
  void add(SceneItem item, std::size_t number, const std::vector<Vector<Dim>>& places, const Vector<Dim>& normal = {},
           std::uint8_t type = vtk_poly_line) {
    points.insert(points.end(), places.begin(), places.end());
    begin.push_back(static_cast<std::int64_t>(points.size()));
    types.push_back(places.size() == 1 ? vtk_vertex : type);
    items.push_back(static_cast<std::uint8_t>(item));
    numbers.push_back(static_cast<std::int32_t>(number));
    normals.push_back(normal);
  }
};

/// The edges of a box that is placed by a transform; in two dimensions as one closed line.
template <int Dim>
void add_box(SceneItem item, std::size_t number, const Box<Dim>& box, Cells<Dim>& cells, const Vector<Dim>& normal = {},
             const Transform<Dim>& place = {}) {
  if constexpr (Dim == 2) {
    std::vector<Vector<2>> line;
    for (const int k : {0, 1, 3, 2, 0}) line.push_back(place(box.corner(k)));
    cells.add(item, number, line, normal);
  } else {
    for (int k = 0; k < 8; ++k)
      for (int axis = 0; axis < 3; ++axis)
        if (const int next = k | (1 << axis); next != k)
          cells.add(item, number, {place(box.corner(k)), place(box.corner(next))}, normal);
  }
}

/// Calls use(begin, end, normal to the right) for the straight pieces that stand for an edge.
template <class Use>
void for_pieces(const OutlineEdge& edge, Use&& use) {
  constexpr double longest = 5.0 * std::numbers::pi / 180.0;  // of an arc [rad]
  const int count = edge.straight() ? 1 : static_cast<int>(std::ceil(std::abs(edge.sweep) / longest));
  for (int k = 0; k < count; ++k)
    use(edge.at(static_cast<double>(k) / count), edge.at((k + 1.0) / count), edge.normal((k + 0.5) / count));
}

/// The line of an outline, closed if the outline is.
std::vector<Vector<2>> line_of(const Outline& outline) {
  std::vector<Vector<2>> line{outline.edges().front().begin};
  for (const OutlineEdge& edge : outline.edges())
    for_pieces(edge, [&](const Vector<2>&, const Vector<2>& end, const Vector<2>&) { line.push_back(end); });
  return line;
}

void add_walls(const std::vector<Wall<2>>& walls, Cells<2>& cells) {
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const Outline outline = outline_at(walls[w], 0.0);
    for (const OutlineEdge& edge : outline.edges()) {
      for_pieces(edge, [&](const Vector<2>& begin, const Vector<2>& end, const Vector<2>& normal) {
        if (walls[w].wet_front) cells.add(SceneItem::wall, w + 1, {begin, end}, normal);
        if (walls[w].wet_back) cells.add(SceneItem::wall, w + 1, {begin, end}, -1.0 * normal);
      });
    }
  }
}

/// Facets, each where it stands at the start.
void add_walls(const std::vector<Wall<3>>& walls, Cells<3>& cells) {
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const Pose<3> pose = walls[w].motion ? (*walls[w].motion)(0.0) : Pose<3>{};
    for (const auto& patch : walls[w].surface->patches()) {
      for (const Facet& facet : patch->facets()) {
        std::vector<Vector<3>> corners;
        for (const int corner : facet)
          corners.push_back(pose.of_position(patch->points()[static_cast<std::size_t>(corner)]));
        Vector<3> normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
        normal *= (walls[w].wet_front ? 1.0 : -1.0) / norm(normal);
        cells.add(SceneItem::wall, w + 1, corners, normal, vtk_triangle);
      }
    }
  }
}

/// Points whose ways tell how a wall moves.
std::vector<Vector<2>> tellers(const Outline& outline) {
  const auto& edges = outline.edges();
  std::vector<Vector<2>> corners{edges.back().end};
  for (std::size_t k = outline.closed() ? 1 : 0; k < edges.size(); ++k) corners.push_back(edges[k].begin);
  return corners;
}
std::vector<Vector<3>> tellers(const Mesh& mesh) {
  std::vector<Vector<3>> corners;
  for (int k = 0; k < 8; ++k) corners.push_back(mesh.nearest(mesh.bounds().corner(k)).point);
  return corners;
}

template <int Dim>
void add_paths(const Case& config, const std::vector<Wall<Dim>>& walls, Cells<Dim>& cells) {
  constexpr std::size_t most_points = 8, most_times = 400;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const MotionEntry* entry = motion_named(config.scene_walls[w].motion, config.motions);
    if (!entry) continue;
    const std::vector<double> times = times_of(*entry, config.time.end, most_times);
    const std::vector<Vector<Dim>> corners = tellers(*walls[w].surface);
    const std::size_t stride = (corners.size() + most_points - 1) / most_points;
    for (std::size_t k = 0; k < corners.size(); k += stride) {
      std::vector<Vector<Dim>> path;
      for (const double time : times) path.push_back((*walls[w].motion)(time).of_position(corners[k]));
      cells.add(SceneItem::path, w + 1, path);
    }
  }
}

/// The lines around an inlet's section.
std::vector<std::vector<Vector<2>>> rims_of(const Inlet<2>& inlet, double spacing) {
  const auto [low, high] = std::ranges::minmax(inlet.section, {}, [](const auto& x) { return x[0]; });
  const auto count = static_cast<double>(inlet.section.size());
  const double half = 0.5 * (count > 1.0 ? (high[0] - low[0]) / (count - 1.0) : spacing);  // of a particle
  return {{inlet.at(0.0, {low[0] - half}), inlet.at(0.0, {high[0] + half})}};
}
std::vector<std::vector<Vector<3>>> rims_of(const Inlet<3>& inlet, double) {
  constexpr int pieces = 72;  // of a circle
  std::vector<std::vector<Vector<3>>> rims;
  for (const double radius : {inlet.radius, inlet.inner_radius}) {
    if (radius == 0.0) continue;
    std::vector<Vector<3>>& rim = rims.emplace_back();
    for (int k = 0; k <= pieces; ++k) {
      const auto [cosine, sine] = cosine_and_sine(k * 360.0 / pieces);
      rim.push_back(inlet.at(0.0, {radius * cosine, radius * sine}));
    }
  }
  if (rims.empty()) {
    // The first and the last particle of a rectangle are as far from corners that are opposite each other.
    const auto [a0, b0] = inlet.section.front();
    const auto [a1, b1] = inlet.section.back();
    const double a = a0 + a1, b = b0 + b1;
    rims.push_back({inlet.at(0.0, {0.0, 0.0}), inlet.at(0.0, {a, 0.0}), inlet.at(0.0, {a, b}), inlet.at(0.0, {0.0, b}),
                    inlet.at(0.0, {0.0, 0.0})});
  }
  return rims;
}

template <int Dim>
void add_inlets(const Case& config, const Scene<Dim>& scene, Cells<Dim>& cells) {
  const double spacing = config.particles.spacing;
  std::vector<Inlet<Dim>> inlets = scene.inlets;
  if (!config.inlets.empty()) inlets.clear();  // there, one with a profile is in parts
  for (const InletEntry& entry : config.inlets) inlets.push_back(inlet_of<Dim>(entry, spacing, config.kernel));
  for (std::size_t k = 0; k < inlets.size(); ++k)
    for (const std::vector<Vector<Dim>>& rim : rims_of(inlets[k], spacing))
      cells.add(SceneItem::inlet, k + 1, rim, inlets[k].direction);
}

template <int Dim>
void add_outlets(const std::vector<OutletEntry>& outlets, Cells<Dim>& cells) {
  std::vector<std::string> mistakes;
  for (std::size_t k = 0; k < outlets.size(); ++k) {
    if constexpr (Dim == 2) {
      if (const auto outline = outline_of(outlets[k], mistakes)) cells.add(SceneItem::outlet, k + 1, line_of(*outline));
    } else if (const auto shape = scaled_shape<3>(outlets[k], mistakes)) {
      add_box(SceneItem::outlet, k + 1, shape->bounds(), cells, {}, placement_of<3>(outlets[k]));
    }
  }
}

template <int Dim>
void add_observers(const Case& config, const Scene<Dim>& scene, Cells<Dim>& cells) {
  for (std::size_t k = 0; k < config.probes.size(); ++k) {
    const ProbeSettings& probe = config.probes[k];
    auto position = vector_of<Dim>(probe.position);
    const auto wall = std::ranges::find(scene.walls, probe.wall, &Wall<Dim>::name);
    if (wall != scene.walls.end())
      position = poses_of(scene.walls, 0.0)[static_cast<std::size_t>(wall - scene.walls.begin())].of_position(position);
    cells.add(SceneItem::probe, k + 1, {position});
  }
  for (std::size_t k = 0; k < config.gauges.size(); ++k) {
    const GaugeSettings& gauge = config.gauges[k];
    const auto point = vector_of<Dim>(gauge.point), direction = vector_of<Dim>(gauge.direction);
    cells.add(SceneItem::gauge, k + 1, {point, point + gauge.length / norm(direction) * direction});
  }
  for (std::size_t k = 0; k < config.sections.size(); ++k) {
    std::vector<Vector<Dim>> line = corners_of<Dim>(config.sections[k]);
    if (Dim == 3) line.push_back(line.front());
    cells.add(SceneItem::section, k + 1, line);
  }
}

template <int Dim>
void add_lines(const Case& config, Cells<Dim>& cells) {
  const Scene<Dim> scene = make_scene<Dim>(config, config);
  add_walls(scene.walls, cells);
  add_paths(config, scene.walls, cells);
  add_inlets(config, scene, cells);
  add_outlets(config.outlets, cells);
  add_observers(config, scene, cells);
  for (std::size_t k = 0; k < config.damping.size(); ++k)
    add_box(SceneItem::damping, k + 1, {vector_of<Dim>(config.damping[k].low), vector_of<Dim>(config.damping[k].high)},
            cells, vector_of<Dim>(config.damping[k].direction));
  add_box(SceneItem::domain, 0, scene.bounds, cells);
}

/// Fluid, rows of inlets, and walls that have no lines.
template <int Dim>
void add_particles(const Case& config, std::int64_t count, const Particles<Dim>& particles, Cells<Dim>& cells) {
  constexpr std::int64_t most = 1'000'000;
  const std::int64_t stride = (count + most - 1) / most;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.id[i] % stride != 0) continue;
    const ParticleType type = particles.type[i];
    if (type == ParticleType::fluid) cells.add(SceneItem::fluid, 0, {particles.position[i]});
    if (type == ParticleType::inlet) cells.add(SceneItem::inlet, 0, {particles.position[i]});
    if (type == ParticleType::wall && config.scene_walls.empty())
      cells.add(SceneItem::wall, 0, {particles.position[i]});
  }
}

template <class Entry>
void write_names(Hdf5Writer& file, SceneItem item, const std::vector<Entry>& entries) {
  std::vector<std::string> names;
  for (const Entry& entry : entries) names.push_back(entry.name);
  file.attribute("/names", std::string(word_of(item)).c_str(), fmt::format("{}", fmt::join(names, "\n")));
}

}  // namespace

template <int Dim>
std::string write_scene(MPI_Comm comm, const Case& config, const Particles<Dim>& particles) {
  Cells<Dim> cells;
  if (rank_of(comm) == 0) add_lines(config, cells);
  add_particles(config, sum_over_ranks(comm, static_cast<std::int64_t>(particles.owned)), particles, cells);

  const std::string path = scene_path(config.output.directory, config.name);
  Hdf5Writer file(comm, path);
  file.attribute("/", "dimension", Dim);
  file.attribute("/", "spacing", config.particles.spacing);
  file.attribute("/", "name", config.name);
  file.attribute("/", "case", config.resolved_text);
  file.attribute("/", "code_version", std::string("impinge " IMPINGE_VERSION));
  file.attribute("/", "items", fmt::format("{}", fmt::join(words(SceneItem{}), "\n")));
  file.create_group("/names");
  write_names(file, SceneItem::wall, config.scene_walls);
  write_names(file, SceneItem::inlet, config.inlets);
  write_names(file, SceneItem::outlet, config.outlets);
  write_names(file, SceneItem::probe, config.probes);
  write_names(file, SceneItem::gauge, config.gauges);
  write_names(file, SceneItem::section, config.sections);
  write_names(file, SceneItem::damping, config.damping);
  create_grid(file);
  file.dataset(points_path, to_numbers(cells.points, static_cast<int>(cells.points.size())), 3, "m");
  write_cells(file, cells.begin, cells.types);
  file.create_group("/VTKHDF/CellData");
  file.dataset("/VTKHDF/CellData/item", cells.items, 0, "1");
  file.dataset("/VTKHDF/CellData/number", cells.numbers, 0, "1");
  file.dataset("/VTKHDF/CellData/normal", to_numbers(cells.normals, static_cast<int>(cells.normals.size())), 3, "1");
  file.finish();
  return path;
}

template std::string write_scene(MPI_Comm, const Case&, const Particles<2>&);
template std::string write_scene(MPI_Comm, const Case&, const Particles<3>&);

}  // namespace impinge
