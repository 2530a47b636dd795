#include "impinge/observe/settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "impinge/observe/place.hpp"

namespace impinge {
namespace {

constexpr const char* no_wall = "none";

template <class Element>
void derive_names(const Keys& keys, std::string_view kind, std::vector<Element>& elements) {
  for (std::size_t k = 0; k < elements.size(); ++k)
    if (!keys.given(elements[k].name)) elements[k].name = fmt::format("{}_{}", kind, k + 1);
}

/// Names are parts of a table's header.
template <class Element>
void check_names(Keys& keys, const std::vector<Element>& elements) {
  for (std::size_t b = 0; b < elements.size(); ++b) {
    const std::string& name = elements[b].name;
    if (!keys.usable(name)) continue;
    if (const auto found = name.find_first_of(",\"[]"); found != name.npos)
      keys.mistake(name, fmt::format("has a '{}', but a table's header is made of it; allowed: a text without , \" [ ]",
                                     name[found]));
    for (std::size_t a = 0; a < b; ++a) {
      if (elements[a].name != name) continue;
      keys.mistake(name, fmt::format("the name is used twice, first at {}; allowed: a name of its own",
                                     keys.place(elements[a].name)));
      break;
    }
  }
}

double length_of(const Numbers& x, int dimension) {
  double sum = 0.0;
  for (int k = 0; k < dimension; ++k) sum += x[static_cast<std::size_t>(k)] * x[static_cast<std::size_t>(k)];
  return std::sqrt(sum);
}

/// True where a vector of this length has a direction.
bool is_length(double x) { return x > 0.0 && std::isfinite(x); }

template <int Dim>
std::string box_text(const Box<Dim>& box) {
  return fmt::format("from ({:.6g}) to ({:.6g}) m", fmt::join(box.low.component, ", "),
                     fmt::join(box.high.component, ", "));
}

/// The wall that a point lies in at the start, as a text; nothing if all is well. `depth`: what does not count [m].
template <int Dim>
std::string wall_around(const Scene<Dim>& scene, const Vector<Dim>& point, double depth) {
  for (const Face<Dim>& face : scene.mirrors)
    if (face.distance(point) < -depth) return "a wall";
  const std::vector<Pose<Dim>> poses = poses_of(scene.walls, 0.0);
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    const Wall<Dim>& wall = scene.walls[w];
    if (wall.surface->closed() && !wall.wet_back && wall.surface->distance(poses[w].origin_of(point)) < -depth)
      return fmt::format("the wall \"{}\"", wall.name);
  }
  return "";
}

}  // namespace

void declare_observers(Keys& keys, ObserverSettings& settings) {
  keys.add("output.sample_interval", settings.sampling.interval,
           "time from one row of probes, gauges, sections, forces and outlets to the next; 0: none by time",
           {.unit = "s", .range = not_negative});
  keys.add("output.sample_steps", settings.sampling.steps, "steps from one such row to the next; 0: none by steps",
           {.range = from_to(0, 1e9), .fallback = "1; with output.sample_interval 0"});
  keys.list("probe", settings.probes, "pressure and velocity at a point, or their means over a sensor's face",
            {.fixed = true}, [](Keys& inner, ProbeSettings& probe) {
              inner.add("name", probe.name, "name in the table's header", {.fallback = "probe_<number>"});
              inner.add("wall", probe.wall,
                        "name of the wall that it rides on: its pressure is that of the wall particles nearest; "
                        "\"none\": it is fixed in space");
              inner.add("position", probe.position, "its place; of a riding one where the wall's motion is zero",
                        {.unit = "m", .required = true});
              inner.add("diameter", probe.diameter, "of the face, in 2D its length; 0: a point",
                        {.unit = "m", .range = not_negative});
              inner.add("normal", probe.normal, "direction that a fixed face looks at, of any length",
                        {.fallback = "up, along the last axis"});
            });
  keys.list("gauge", settings.gauges, "water level along a line: the farthest fluid particle within 0.75 dp of it",
            {.fixed = true}, [](Keys& inner, GaugeSettings& gauge) {
              inner.add("name", gauge.name, "name in the table's header", {.fallback = "gauge_<number>"});
              inner.add("point", gauge.point, "where the line begins: level 0", {.unit = "m", .required = true});
              inner.add("direction", gauge.direction, "of the line, of any length",
                        {.fallback = "up, along the last axis"});
              inner.add("length", gauge.length, "of the line", {.unit = "m", .range = positive, .required = true});
            });
  keys.list(
      "section", settings.sections,
      "discharge through a line, from the left to the right of the way from its begin to its end; in 3D through a "
      "parallelogram, to the side that the way and then its side turn to like a right hand's fingers to the thumb",
      {.fixed = true}, [](Keys& inner, SectionSettings& section) {
        inner.add("name", section.name, "name in the table's header", {.fallback = "section_<number>"});
        inner.add("begin", section.begin, "one end", {.unit = "m", .required = true});
        inner.add("end", section.end, "the other end", {.unit = "m", .required = true});
        inner.add("side", section.side, "3D: the other side of the parallelogram, as a vector", {.unit = "m"});
      });
}

void derive_observers(const Keys& keys, int dimension, ObserverSettings& settings) {
  derive_names(keys, "probe", settings.probes);
  derive_names(keys, "gauge", settings.gauges);
  derive_names(keys, "section", settings.sections);
  Numbers up{};
  if (dimension == 2 || dimension == 3) up[static_cast<std::size_t>(dimension - 1)] = 1.0;
  for (ProbeSettings& probe : settings.probes)
    if (!keys.given(probe.normal)) probe.normal = up;
  for (GaugeSettings& gauge : settings.gauges)
    if (!keys.given(gauge.direction)) gauge.direction = up;
  if (!keys.given(settings.sampling.steps) && settings.sampling.interval > 0.0) settings.sampling.steps = 0;
}

void check_observers(Keys& keys, int dimension, const ObserverSettings& settings) {
  check_names(keys, settings.probes);
  check_names(keys, settings.gauges);
  check_names(keys, settings.sections);
  constexpr const char* no_direction = "no direction; allowed: a vector that is not 0";
  for (const ProbeSettings& probe : settings.probes)
    if (keys.usable(probe.normal) && !is_length(length_of(probe.normal, dimension)))
      keys.mistake(probe.normal, no_direction);
  for (const GaugeSettings& gauge : settings.gauges)
    if (keys.usable(gauge.direction) && !is_length(length_of(gauge.direction, dimension)))
      keys.mistake(gauge.direction, no_direction);
  for (const SectionSettings& section : settings.sections) {
    if (!keys.usable(section.begin, section.end, section.side)) continue;
    const Vector<3> side = vector_of<3>(section.side), way = vector_of<3>(section.end) - vector_of<3>(section.begin);
    if (!is_length(norm(way))) {
      keys.mistake(section.end, "the line has no length; allowed: another point than its begin");
    } else if (dimension == 3 && !(norm(cross(way, side)) > 1e-6 * norm(way) * norm(side))) {
      keys.mistake(section.side, "0, or along the line from begin to end; allowed: any other vector (m)");
    } else if (dimension == 2 && norm(side) > 0.0) {
      keys.mistake(section.side, "a section is a line in two dimensions; allowed: 0 (m)");
    }
  }
}

template <int Dim>
void check_observers_in(Keys& keys, const Scene<Dim>& scene, double spacing, const ObserverSettings& settings) {
  const double tolerance = 0.01 * spacing;
  const std::string inside = "allowed: within the scene's bounds, " + box_text(scene.bounds);
  for (const ProbeSettings& probe : settings.probes) {
    if (!keys.usable(probe.wall, probe.position, probe.diameter)) continue;
    const auto position = vector_of<Dim>(probe.position);
    if (const double most = norm(scene.bounds.high - scene.bounds.low); probe.diameter > most)
      keys.mistake(probe.diameter, fmt::format("larger than the scene; allowed: [0, {:.6g}] (m)", most));
    if (probe.wall == no_wall) {
      if (!scene.bounds.contains(position, tolerance)) {
        keys.mistake(probe.position, "outside the scene; " + inside);
      } else if (const std::string wall = wall_around(scene, position, tolerance); !wall.empty()) {
        keys.mistake(probe.position, fmt::format("inside {}; allowed: in the fluid or on the wall", wall));
      }
      continue;
    }
    const auto wall = std::ranges::find(scene.walls, probe.wall, &Wall<Dim>::name);
    if (wall == scene.walls.end()) {
      std::vector<std::string> names{in_quotes(no_wall)};
      for (const Wall<Dim>& one : scene.walls) names.push_back(in_quotes(one.name));
      keys.mistake(probe.wall, fmt::format("no wall of this name; allowed: {}", fmt::join(names, ", ")));
    } else if (const double distance = wall->surface->nearest(position).distance; distance > spacing) {
      keys.mistake(probe.position, fmt::format("{:.6g} m from the wall \"{}\"; allowed: at most a spacing, {:.6g} m",
                                               distance, wall->name, spacing));
    }
  }
  for (const GaugeSettings& gauge : settings.gauges)
    if (keys.usable(gauge.point) && !scene.bounds.contains(vector_of<Dim>(gauge.point), tolerance))
      keys.mistake(gauge.point, "outside the scene; " + inside);
  for (const SectionSettings& section : settings.sections) {
    if (!keys.usable(section.begin, section.end)) continue;
    for (const Numbers* end : {&section.begin, &section.end})
      if (!scene.bounds.contains(vector_of<Dim>(*end), tolerance)) keys.mistake(*end, "outside the scene; " + inside);
    const std::vector<Vector<Dim>> corners = corners_of<Dim>(section);
    if (keys.usable(section.side) && std::any_of(corners.begin() + 2, corners.end(), [&](const Vector<Dim>& corner) {
          return !scene.bounds.contains(corner, tolerance);
        }))
      keys.mistake(section.side, "ends outside the scene; " + inside);
  }
}

template void check_observers_in(Keys&, const Scene<2>&, double, const ObserverSettings&);
template void check_observers_in(Keys&, const Scene<3>&, double, const ObserverSettings&);

}  // namespace impinge
