#include "impinge/scenes/scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "impinge/boundaries/wall.hpp"
#include "impinge/core/mpi.hpp"
#include "impinge/scenes/jet.hpp"

namespace impinge {
namespace {

// Cells of an axis-aligned lattice of `extent` points whose first point is half a spacing inside the corner `low`.
template <int Dim>
struct BoxLattice {
  Vector<Dim> low;
  std::array<std::int64_t, Dim> extent;
  double spacing;

  std::int64_t count() const {
    std::int64_t points = 1;
    for (const auto n : extent) points *= n;
    return points;
  }
  std::array<std::int64_t, Dim> coordinates(std::int64_t k) const {
    std::array<std::int64_t, Dim> at;
    for (std::size_t axis = Dim; axis-- > 0;) {
      at[axis] = k % extent[axis];
      k /= extent[axis];
    }
    return at;
  }
  Vector<Dim> point(std::int64_t k) const {
    const auto at = coordinates(k);
    Vector<Dim> position;
    for (int axis = 0; axis < Dim; ++axis)
      position[axis] = low[axis] + (static_cast<double>(at[static_cast<std::size_t>(axis)]) + 0.5) * spacing;
    return position;
  }
};

/// A box open at the top, partly filled with fluid at rest; the last axis is the vertical one.
template <int Dim>
class TankGeometry final : public Geometry<Dim> {
 public:
  explicit TankGeometry(const Case& config)
      : fluid_height_(config.tank.fluid_height), mirror_(config.walls.model == WallModel::mirror) {
    lattice_.spacing = config.particles.spacing;
    for (int k = 0; k < Dim; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      size_[k] = config.tank.size[axis];
      lattice_.low[k] = -wall_layers * lattice_.spacing;
      lattice_.extent[axis] = std::lround(size_[k] / lattice_.spacing) + (k == Dim - 1 ? 1 : 2) * wall_layers;
    }
  }

  Box<Dim> bounds() const override {
    Box<Dim> box{mirror_ ? Vector<Dim>{} : lattice_.low, size_};
    if (!mirror_)
      for (int k = 0; k < Dim - 1; ++k) box.high[k] += wall_layers * lattice_.spacing;
    box.high[Dim - 1] += size_[Dim - 1];
    return box;
  }

  Edges<Dim> edges() const override {
    Edges<Dim> all;
    if (!mirror_) return all;
    all.fill({Edge::mirror, Edge::mirror});
    all[Dim - 1].high = Edge::open;
    return all;
  }

  void fill(int rank, int ranks, Particles<Dim>& particles) const override {
    for_share(lattice_.count(), rank, ranks, [&](std::int64_t k) {
      Vector<Dim> position = lattice_.point(k);
      double depth = 0.0;  // into the walls
      for (int axis = 0; axis < Dim; ++axis) {
        depth = std::max(depth, -position[axis]);
        if (axis < Dim - 1) depth = std::max(depth, position[axis] - size_[axis]);
      }
      if (depth == 0.0 && position[Dim - 1] > fluid_height_) return;
      const ParticleType type = depth == 0.0               ? ParticleType::fluid
                                : depth < lattice_.spacing ? ParticleType::wall
                                                           : ParticleType::ghost;
      if (mirror_ && type == ParticleType::ghost) return;
      if (mirror_)  // wall particles stand on the surface
        for (int axis = 0; axis < Dim; ++axis)
          position[axis] = std::clamp(position[axis], 0.0, std::nextafter(size_[axis], 0.0));
      particles.append({position, {}, 0.0, 0.0, k, type});
    });
  }

  Vector<Dim> wall_normal(const Vector<Dim>& position) const override {
    Vector<Dim> normal;
    for (int axis = 0; axis < Dim; ++axis) {
      if (position[axis] <= 0.0) normal[axis] = 1.0;
      if (is_past_high(position, axis)) normal[axis] = -1.0;
    }
    return 1.0 / norm(normal) * normal;
  }

  bool on_floor(const Vector<Dim>& position) const override {
    for (int axis = 0; axis < Dim - 1; ++axis)
      if (position[axis] <= 0.0 || is_past_high(position, axis)) return false;
    return position[Dim - 1] <= 0.0;
  }

 private:
  bool is_past_high(const Vector<Dim>& position, int axis) const {
    return axis < Dim - 1 && position[axis] > size_[axis] - 1e-9 * lattice_.spacing;
  }

  Vector<Dim> size_;
  double fluid_height_;
  bool mirror_;
  BoxLattice<Dim> lattice_;
};

/// Fluid that fills a box periodic along every axis, in a shear flow u_x = U sin(2 pi y/L_y).
template <int Dim>
class PeriodicBoxGeometry final : public Geometry<Dim> {
 public:
  explicit PeriodicBoxGeometry(const Case& config) : shear_speed_(config.periodic_box.shear_speed) {
    lattice_.spacing = config.particles.spacing;
    for (int k = 0; k < Dim; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      size_[k] = config.periodic_box.size[axis];
      lattice_.extent[axis] = std::lround(size_[k] / lattice_.spacing);
    }
  }

  Box<Dim> bounds() const override { return {{}, size_}; }

  Edges<Dim> edges() const override {
    Edges<Dim> all;
    all.fill({Edge::periodic, Edge::periodic});
    return all;
  }

  void fill(int rank, int ranks, Particles<Dim>& particles) const override {
    for_share(lattice_.count(), rank, ranks, [&](std::int64_t k) {
      const Vector<Dim> position = lattice_.point(k);
      Vector<Dim> velocity;
      velocity[0] = shear_speed_ * std::sin(2.0 * std::numbers::pi * position[1] / size_[1]);
      particles.append({position, velocity, 0.0, 0.0, k, ParticleType::fluid});
    });
  }

 private:
  Vector<Dim> size_;
  double shear_speed_;
  BoxLattice<Dim> lattice_{};
};

}  // namespace

template <int Dim>
std::unique_ptr<Geometry<Dim>> make_geometry(const Case& config) {
  switch (config.geometry) {
    case SceneType::tank:
      return std::make_unique<TankGeometry<Dim>>(config);
    case SceneType::periodic_box:
      return std::make_unique<PeriodicBoxGeometry<Dim>>(config);
    case SceneType::jet:
      break;
  }
  if constexpr (Dim == 2) {
    return std::make_unique<JetGeometry>(config);
  } else {
    throw InputError({"geometry = \"jet\" exists in two dimensions only"});
  }
}

template std::unique_ptr<Geometry<2>> make_geometry(const Case&);
template std::unique_ptr<Geometry<3>> make_geometry(const Case&);

}  // namespace impinge
