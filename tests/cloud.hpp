#pragma once
// Clouds of particles for the tests, in units of their spacing.

#include <algorithm>
#include <random>
#include <tuple>

#include "impinge/boundaries/mirror_walls.hpp"
#include "impinge/particles/cell_grid.hpp"
#include "impinge/particles/neighbours.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

/// What is beyond the ends of a test's box.
enum class Edge { open, periodic, mirror };

template <int Dim>
std::array<bool, Dim> periodic_axes(Edge edge) {
  std::array<bool, Dim> axes;
  axes.fill(edge == Edge::periodic);
  return axes;
}

/// Mirrors on all sides of a box, if its edges are some.
template <int Dim>
MirrorWalls<Dim> mirrors_of(Edge edge, const Box<Dim>& box, double reach, double spacing = 1.0) {
  std::vector<Face<Dim>> faces;
  for (int k = 0; k < Dim && edge == Edge::mirror; ++k) {
    Face<Dim> low{box.low, {}}, high{box.high, {}};
    low.normal[k] = 1.0;
    high.normal[k] = -1.0;
    faces.insert(faces.end(), {low, high});
  }
  return {faces, {}, reach, spacing};
}

/// A lattice of spacing 1 in the box [0, extent), each particle displaced by up to `jitter` along every axis; velocity
/// and pressure are random. Fluid, ids 0, 1, 2, ... The same at every call.
template <int Dim>
Particles<Dim> make_cloud(const std::array<int, Dim>& extent, double jitter) {
  std::mt19937 random(42);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::int64_t count = 1;
  for (const int n : extent) count *= n;
  Particles<Dim> cloud;
  for (std::int64_t k = 0; k < count; ++k) {
    ParticleRecord<Dim> record{};
    std::int64_t rest = k;
    for (int axis = 0; axis < Dim; ++axis) {
      const int n = extent[static_cast<std::size_t>(axis)];
      record.position[axis] = static_cast<double>(rest % n) + 0.5 + jitter * uniform(random);
      record.velocity[axis] = uniform(random);
      rest /= n;
    }
    record.pressure = uniform(random);
    record.pressure_impulse = uniform(random);
    record.id = k;
    cloud.append(record);
  }
  return cloud;
}

/// The particles `keep(record)` says yes to, sorted along the cells and, within a cell, by id.
template <int Dim, class Keep>
Particles<Dim> sorted(const CellGrid<Dim>& cells, const Particles<Dim>& particles, Keep&& keep) {
  std::vector<std::tuple<std::int64_t, std::int64_t, int>> order;
  for (int i = 0; i < particles.owned; ++i) {
    const ParticleRecord<Dim> record = particles.record(i);
    if (keep(record)) order.emplace_back(cells.cell(record.position), record.id, i);
  }
  std::sort(order.begin(), order.end());
  Particles<Dim> result;
  for (const auto& [cell, id, i] : order) result.append(particles.record(i));
  return result;
}

/// The far rows of a search as a list; each without the particle itself, if `with_self` is false.
template <int Dim>
PairList far_list(NeighbourSearch<Dim>& search, bool with_self = true) {
  PairList list;
  search.for_far_rows([&](int i, const PairRow& row) {
    for (std::size_t k = 0; k < row.index.size(); ++k) {
      if (row.index[k] == i && !with_self) continue;
      list.index.push_back(row.index[k]);
      list.weight.push_back(row.weight[k]);
    }
    list.start.push_back(static_cast<int>(list.index.size()));
  });
  return list;
}

}  // namespace impinge
