#include "impinge/scenes/jet.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "impinge/boundaries/wall.hpp"
#include "impinge/core/mpi.hpp"

namespace impinge {

JetGeometry::JetGeometry(const Case& config)
    : jet_(config.jet.width, config.jet.speed, config.fluid.density, config.jet.angle * std::numbers::pi / 180.0),
      start_(config.jet.start),
      mirror_(config.walls.model == WallModel::mirror),
      layers_(mirror_ ? 1 : wall_layers),
      spacing_(config.particles.spacing),
      speed_(config.jet.speed),
      plate_begin_(config.plate.begin),
      plate_end_(config.plate.end) {
  const double angle = config.jet.angle * std::numbers::pi / 180.0;
  const double width = config.jet.width;
  const double dp = spacing_;
  along_ = {{std::cos(angle), -std::sin(angle)}};
  across_ = {{std::sin(angle), std::cos(angle)}};
  particles_per_row_ = static_cast<int>(std::lround(width / dp));
  buffer_rows_ = static_cast<int>(std::ceil(config.kernel.laplacian_radius)) + 1;

  const double length = config.jet.inlet_distance * width;  // along the axis, inlet plane to plate
  const Vector<2> plate_point{{jet_.axis_position(), 0.0}};
  inlet_corner_ = plate_point - length * along_ - 0.5 * width * across_;

  // An impacting column ends in a straight edge whose lower corner touches the plate.
  // A steady one ends where the jet is still straight.
  const double column = start_ == JetStart::impact ? inlet_corner_[1] / std::sin(angle) : 0.5 * width;
  column_rows_ = static_cast<std::int64_t>(std::floor(column / dp + 1e-9));
  wall_columns_ = std::lround((plate_end_ - plate_begin_) / dp);
  column_end_ = static_cast<double>(column_rows_) * dp;
  steady_rows_ = start_ == JetStart::steady ? static_cast<std::int64_t>(std::ceil(at(column_end_, width)[1] / dp)) : 0;

  inlet_.last_row = -(buffer_rows_ - 0.5) * dp;
  inlet_.next_id =
      wall_columns_ * layers_ + (buffer_rows_ + column_rows_) * particles_per_row_ + steady_rows_ * wall_columns_;

  // Everything the plate, the ghosts and the buffer occupy, and room above for splash.
  bounds_ = {{{plate_begin_, mirror_ ? 0.0 : -wall_layers * dp}}, {{plate_end_, 0.0}}};
  for (const double s : {-(buffer_rows_ + 1) * dp, 0.0}) {
    for (const double t : {0.0, width}) {
      for (int k = 0; k < 2; ++k) {
        bounds_.low[k] = std::min(bounds_.low[k], at(s, t)[k] - dp);
        bounds_.high[k] = std::max(bounds_.high[k], at(s, t)[k] + dp);
      }
    }
  }
  bounds_.high[1] += width;
}

void JetGeometry::fill(int rank, int ranks, Particles<2>& particles) const {
  const double dp = spacing_;
  std::int64_t first_id = 0;

  for_share(wall_columns_ * layers_, rank, ranks, [&](std::int64_t k) {
    const std::int64_t layer = k % layers_;
    const double x = plate_begin_ + (static_cast<double>(k / layers_) + 0.5) * dp;
    const double y = mirror_ ? 0.0 : -(static_cast<double>(layer) + 0.5) * dp;
    const ParticleType type = layer == 0 ? ParticleType::wall : ParticleType::ghost;
    particles.append({{{x, y}}, {}, 0.0, 0.0, first_id + k, type});
  });
  first_id += wall_columns_ * layers_;

  for_share((buffer_rows_ + column_rows_) * particles_per_row_, rank, ranks, [&](std::int64_t k) {
    const double s = (static_cast<double>(k / particles_per_row_ - buffer_rows_) + 0.5) * dp;
    const double t = (static_cast<double>(k % particles_per_row_) + 0.5) * dp;
    const Vector<2> position = at(s, t);
    if (s < 0.0) {
      particles.append({position, inlet_velocity(), 0.0, 0.0, first_id + k, ParticleType::inlet});
    } else if (start_ == JetStart::impact) {
      if (position[1] >= 0.5 * dp * (1.0 - 1e-9))
        particles.append({position, inlet_velocity(), 0.0, 0.0, first_id + k, ParticleType::fluid});
    } else {
      particles.append(steady_fluid(position, first_id + k));
    }
  });
  first_id += (buffer_rows_ + column_rows_) * particles_per_row_;

  for_share(steady_rows_ * wall_columns_, rank, ranks, [&](std::int64_t k) {
    const double x = plate_begin_ + (static_cast<double>(k % wall_columns_) + 0.5) * dp;
    const double y = (static_cast<double>(k / wall_columns_) + 0.5) * dp;
    const Vector<2> position{{x, y}};
    const Vector<2> from_corner = position - inlet_corner_;
    const bool in_column = dot(from_corner, along_) < column_end_ && dot(from_corner, across_) > -dp;
    if (!in_column && jet_.contains(position)) particles.append(steady_fluid(position, first_id + k));
  });
}

ParticleRecord<2> JetGeometry::steady_fluid(const Vector<2>& position, std::int64_t id) const {
  const auto state = jet_.state(position);
  return {position,           state ? state->velocity : inlet_velocity(), state ? state->pressure : 0.0, 0.0, id,
          ParticleType::fluid};
}

bool JetGeometry::past_outlet(const Vector<2>& position) const {
  return position[0] < std::min(plate_begin_, bounds_.low[0] + spacing_) ||
         position[0] > std::max(plate_end_, bounds_.high[0] - spacing_) || position[1] > bounds_.high[1] - spacing_;
}

BoundaryFlow JetGeometry::move_boundaries(double dt, Particles<2>& particles,
                                          const std::function<bool(const Vector<2>&)>& owns) {
  BoundaryFlow flow;
  int kept = 0;
  for (int i = 0; i < particles.owned; ++i) {
    ParticleRecord<2> record = particles.record(i);
    if (record.type == ParticleType::inlet && distance_past_inlet(record.position) > 0.0) {
      record.type = ParticleType::fluid;
      ++flow.entered;
    }
    if (record.type == ParticleType::fluid && past_outlet(record.position)) {
      ++flow.left;
      continue;
    }
    particles.set_record(kept++, record);
  }
  particles.owned = kept;
  particles.resize(kept);

  // A new row each time the buffer has moved by a spacing.
  inlet_.last_row += speed_ * dt;
  while (inlet_.last_row - spacing_ >= -buffer_rows_ * spacing_) {
    inlet_.last_row -= spacing_;
    for (int k = 0; k < particles_per_row_; ++k) {
      const Vector<2> position = at(inlet_.last_row, (k + 0.5) * spacing_);
      if (owns(position))
        particles.append({position, inlet_velocity(), 0.0, 0.0, inlet_.next_id + k, ParticleType::inlet});
    }
    inlet_.next_id += particles_per_row_;
  }
  return flow;
}

Edges<2> JetGeometry::edges() const {
  Edges<2> edges;
  if (mirror_) edges[1].low = Edge::mirror;
  return edges;
}

}  // namespace impinge
