#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "impinge/boundaries/wall.hpp"
#include "impinge/core/mpi.hpp"
#include "impinge/scenes/analytic_jet.hpp"
#include "impinge/scenes/scenes.hpp"

namespace impinge {
namespace {

/// The initial particles of a jet, numbered block by block: walls, inlet buffer, jet column, the rest of a steady jet.
/// Along the jet, s runs downstream from the inlet plane and t across, from its lower edge.
struct JetFilling {
  AnalyticJet jet;
  Inlet<2> inlet;
  bool mirror;  // the plate is a mirror
  JetStart start;
  int layers;  // rows of the plate's particles
  double spacing;
  double plate_begin;
  double column_end;  // s where a steady start changes from the jet's lattice to the plate's [m]
  std::int64_t wall_columns;
  std::int64_t column_rows;
  std::int64_t steady_rows;

  std::int64_t row_particles() const { return static_cast<std::int64_t>(inlet.section.size()); }
  std::int64_t in_plate() const { return wall_columns * layers; }
  std::int64_t in_column() const { return (inlet.rows + column_rows) * row_particles(); }
  std::int64_t in_steady_rest() const { return steady_rows * wall_columns; }

  void operator()(int rank, int ranks, Particles<2>& particles) const;
  ParticleRecord<2> steady_fluid(const Vector<2>& position, std::int64_t id) const;
};

void JetFilling::operator()(int rank, int ranks, Particles<2>& particles) const {
  const double dp = spacing;
  std::int64_t first_id = 0;

  for_share(in_plate(), rank, ranks, [&](std::int64_t k) {
    const std::int64_t layer = k % layers;
    const double x = plate_begin + (static_cast<double>(k / layers) + 0.5) * dp;
    const double y = mirror ? 0.0 : -(static_cast<double>(layer) + 0.5) * dp;
    const ParticleType type = layer == 0 ? ParticleType::wall : ParticleType::ghost;
    particles.append({{{x, y}}, {}, 0.0, 0.0, first_id + k, type});
  });
  first_id += in_plate();

  for_share(in_column(), rank, ranks, [&](std::int64_t k) {
    const double s = (static_cast<double>(k / row_particles() - inlet.rows) + 0.5) * dp;
    const Vector<2> position = inlet.at(s, inlet.section[static_cast<std::size_t>(k % row_particles())]);
    if (s < 0.0) {
      particles.append({position, inlet.velocity(), 0.0, 0.0, first_id + k, ParticleType::inlet});
    } else if (start == JetStart::impact) {
      if (position[1] >= 0.5 * dp * (1.0 - 1e-9))
        particles.append({position, inlet.velocity(), 0.0, 0.0, first_id + k, ParticleType::fluid});
    } else {
      particles.append(steady_fluid(position, first_id + k));
    }
  });
  first_id += in_column();

  for_share(in_steady_rest(), rank, ranks, [&](std::int64_t k) {
    const double x = plate_begin + (static_cast<double>(k % wall_columns) + 0.5) * dp;
    const double y = (static_cast<double>(k / wall_columns) + 0.5) * dp;
    const Vector<2> position{{x, y}};
    const Vector<2> from_corner = position - inlet.corner;
    const bool in_column = dot(from_corner, inlet.direction) < column_end && dot(from_corner, inlet.across[0]) > -dp;
    if (!in_column && jet.contains(position)) particles.append(steady_fluid(position, first_id + k));
  });
}

ParticleRecord<2> JetFilling::steady_fluid(const Vector<2>& position, std::int64_t id) const {
  const auto state = jet.state(position);
  return {position,           state ? state->velocity : inlet.velocity(), state ? state->pressure : 0.0, 0.0, id,
          ParticleType::fluid};
}

}  // namespace

Scene<2> make_jet(const MethodSettings& method, const JetSettings& jet, const PlateSettings& plate) {
  const double angle = jet.angle * std::numbers::pi / 180.0;
  const double width = jet.width;
  const double dp = method.particles.spacing;
  const bool mirror = method.walls.model == WallModel::mirror;
  const AnalyticJet analytic(width, jet.speed, method.fluid.density, angle);
  const Vector<2> along{{std::cos(angle), -std::sin(angle)}};
  const Vector<2> across{{std::sin(angle), std::cos(angle)}};

  Inlet<2> inlet;
  inlet.direction = along;
  inlet.across = {across};
  inlet.speed = jet.speed;
  inlet.spacing = dp;
  inlet.rows = static_cast<int>(std::ceil(method.kernel.largest())) + 1;
  inlet.last_row = -(inlet.rows - 0.5) * dp;
  for (int k = 0; k < static_cast<int>(std::lround(width / dp)); ++k) inlet.section.push_back({(k + 0.5) * dp});
  const double length = jet.inlet_distance * width;  // along the axis, inlet plane to plate
  const Vector<2> plate_point{{analytic.axis_position(), 0.0}};
  inlet.corner = plate_point - length * along - 0.5 * width * across;
  const auto at = [&](double s, double t) { return inlet.at(s, {t}); };

  // An impacting column ends in a straight edge whose lower corner touches the plate.
  // A steady one ends where the jet is still straight.
  const double column = jet.start == JetStart::impact ? inlet.corner[1] / std::sin(angle) : 0.5 * width;
  const auto column_rows = static_cast<std::int64_t>(std::floor(column / dp + 1e-9));
  const double column_end = static_cast<double>(column_rows) * dp;
  const JetFilling filling{.jet = analytic,
                           .inlet = inlet,
                           .mirror = mirror,
                           .start = jet.start,
                           .layers = mirror ? 1 : wall_layers,
                           .spacing = dp,
                           .plate_begin = plate.begin,
                           .column_end = column_end,
                           .wall_columns = std::lround((plate.end - plate.begin) / dp),
                           .column_rows = column_rows,
                           .steady_rows = jet.start == JetStart::steady
                                              ? static_cast<std::int64_t>(std::ceil(at(column_end, width)[1] / dp))
                                              : 0};

  Scene<2> scene;
  scene.next_id = filling.in_plate() + filling.in_column() + filling.in_steady_rest();
  scene.inlets = {inlet};
  // Everything the plate, the ghosts and the buffer occupy, and room above for splash.
  scene.bounds = {{{plate.begin, mirror ? 0.0 : -wall_layers * dp}}, {{plate.end, 0.0}}};
  for (const double s : {-(inlet.rows + 1) * dp, 0.0}) {
    for (const double t : {0.0, width}) {
      for (int k = 0; k < 2; ++k) {
        scene.bounds.low[k] = std::min(scene.bounds.low[k], at(s, t)[k] - dp);
        scene.bounds.high[k] = std::max(scene.bounds.high[k], at(s, t)[k] + dp);
      }
    }
  }
  scene.bounds.high[1] += width;
  const double left = std::min(plate.begin, scene.bounds.low[0] + dp);
  const double right = std::max(plate.end, scene.bounds.high[0] - dp);
  scene.outlets = {{{{left, 0.0}}, {{-1.0, 0.0}}},
                   {{{right, 0.0}}, {{1.0, 0.0}}},
                   {{{0.0, scene.bounds.high[1] - dp}}, {{0.0, 1.0}}}};
  if (mirror) scene.mirrors = {{{}, {{0.0, 1.0}}}};
  scene.fill = filling;
  scene.wall_normal = [](const Vector<2>&) { return Vector<2>{{0.0, 1.0}}; };
  scene.on_floor = [](const Vector<2>&) { return true; };
  return scene;
}

}  // namespace impinge
