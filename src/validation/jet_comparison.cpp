#include "impinge/validation/jet_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace impinge {
namespace {

using Side = AnalyticJet::Side;

std::optional<double> if_finite(double value) { return std::isfinite(value) ? std::optional(value) : std::nullopt; }

bool is_finite(const Vector<2>& v) { return std::isfinite(v[0]) && std::isfinite(v[1]); }

}  // namespace

AnalyticJet analytic_jet(const Case& config) {
  return {config.jet.width, config.jet.speed, config.fluid.density, config.jet.angle * std::numbers::pi / 180.0};
}

JetComparison::JetComparison(const Case& config) : jet_(analytic_jet(config)), spacing_(config.particles.spacing) {
  const double width = jet_.width();
  const double thin = jet_.plate_position_of_cp(0.01, Side::h2);
  plate_ = columns(config.plate.begin, config.plate.end);
  h1_ = columns(1.5 * width, std::min(3.0 * width, config.plate.end));
  h2_ = columns(std::max(thin - width, config.plate.begin), thin - 0.5 * width);
}

JetComparison::Columns JetComparison::columns(double begin, double end) const {
  const double length = end - begin, least = 2.0 * spacing_;
  Columns stretch;
  if (length < least * (1.0 - 1e-9)) return stretch;
  const auto number = static_cast<std::size_t>(std::floor(length / least + 1e-9));
  stretch.begin = begin;
  stretch.width = length / static_cast<double>(number);
  for (std::size_t k = 0; k < number; ++k) {
    const auto film = jet_.film(begin + (static_cast<double>(k) + 0.5) * stretch.width);
    Columns::Column column{.analytic = {}, .divider = std::numeric_limits<double>::infinity()};
    if (film) {
      column.analytic = film->top;
      column.divider = 0.5 * (film->top + film->ceiling);
    }
    stretch.columns.push_back(column);
  }
  return stretch;
}

void JetComparison::count(const Vector<2>& position, Columns& stretch) const {
  const double place = std::floor((position[0] - stretch.begin) / stretch.width);
  if (!(place >= 0.0 && place < static_cast<double>(stretch.columns.size()))) return;
  Columns::Column& column = stretch.columns[static_cast<std::size_t>(place)];
  if (position[1] < column.divider) ++column.count;
}

std::optional<double> JetComparison::film_ratio(Side side) const {
  const Columns& sheet = stretch(side);
  if (sheet.columns.empty() || snapshots_ == 0 || !finite_) return std::nullopt;
  double particles = 0.0;
  for (const auto& column : sheet.columns) particles += static_cast<double>(column.count);
  const double length = sheet.width * static_cast<double>(sheet.columns.size());
  return particles * spacing_ * spacing_ / (length * snapshots_ * jet_.sheet_thickness(side));
}

std::optional<double> JetComparison::analytic_film(Side side) const {
  const Columns& sheet = stretch(side);
  double sum = 0.0;
  for (const auto& column : sheet.columns) sum += column.analytic.value_or(std::nan(""));
  return if_finite(sum / (static_cast<double>(sheet.columns.size()) * jet_.sheet_thickness(side)));
}

std::vector<FilmColumn> JetComparison::film_profile() const {
  std::vector<FilmColumn> profile;
  if (snapshots_ == 0 || !finite_) return profile;
  for (std::size_t k = 0; k < plate_.columns.size(); ++k) {
    const auto& column = plate_.columns[k];
    if (!column.analytic) continue;
    profile.push_back({plate_.begin + (static_cast<double>(k) + 0.5) * plate_.width,
                       static_cast<double>(column.count) * spacing_ * spacing_ / (plate_.width * snapshots_),
                       *column.analytic});
  }
  return profile;
}

void JetComparison::set_wall_average(const Particles<2>& particles, double duration) {
  wall_.clear();
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.type[i] != ParticleType::wall) continue;
    const double x = particles.position[i][0];
    wall_.push_back({x, particles.pressure_impulse[i] / duration, jet_.wall_pressure(x)});
  }
  std::ranges::sort(wall_, {}, &PlatePoint::x);
}

void JetComparison::add_snapshot(const Particles<2>& particles) {
  ++snapshots_;
  double stagnation = 0.0, walls = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.type[i] == ParticleType::wall && std::abs(particles.position[i][0]) < spacing_) {
      stagnation += particles.pressure[i];
      walls += 1.0;
    } else if (particles.type[i] == ParticleType::fluid) {
      finite_ = finite_ && is_finite(particles.position[i]) && is_finite(particles.velocity[i]) &&
                std::isfinite(particles.pressure[i]);
    }
  }
  stagnation_.push_back(stagnation / walls);
  if (finite_) add_field(particles);
}

void JetComparison::add_field(const Particles<2>& particles) {
  double error = 0.0, reference = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    const Vector<2>& position = particles.position[i];
    if (particles.type[i] != ParticleType::fluid) continue;
    for (Columns* stretch : {&plate_, &h1_, &h2_}) count(position, *stretch);
    if (position[0] < -2.0 * jet_.width() || position[0] > 4.0 * jet_.width()) continue;

    const auto state = jet_.state(position);
    const double analytic = state ? state->pressure : 0.0;
    error += std::pow(particles.pressure[i] - analytic, 2);
    reference += analytic * analytic;
    Bin& bin = bins_[{std::floor(position[0] / spacing_), std::floor(position[1] / spacing_)}];
    bin.count += 1.0;
    bin.pressure += particles.pressure[i];
    bin.analytic += analytic;

    const bool flagged = particles.free_surface[i] != 0;
    AnalyticJet::SurfacePoint surface;
    if (flagged || !state) surface = jet_.nearest_surface(position);
    const Vector<2> slip = particles.velocity[i] - (state ? state->velocity : surface.velocity);
    particles_ += 1.0;
    velocity_error_ += dot(slip, slip);
    if (flagged) {
      surface_ += 1.0;
      surface_error_ += std::pow(surface.depth - 0.5 * spacing_, 2);
    }
  }
  field_l2_ += std::sqrt(error / reference);
}

JetMetrics JetComparison::metrics() const {
  JetMetrics metrics;
  if (!wall_.empty()) {
    double error = 0.0, reference = 0.0, sum = 0.0;
    PlatePoint peak = wall_.front();
    for (const PlatePoint& point : wall_) {
      sum += point.pressure;
      if (point.pressure > peak.pressure) peak = point;
      if (point.analytic <= 1e-3 * jet_.stagnation_pressure()) continue;
      error += std::pow(point.pressure - point.analytic, 2);
      reference += point.analytic * point.analytic;
    }
    metrics.wall_l2 = if_finite(std::sqrt(error / reference));
    metrics.force_ratio = if_finite(spacing_ * sum / jet_.normal_force());
    if (std::isfinite(sum)) {
      metrics.peak_pressure = peak.pressure;
      metrics.peak_x = peak.x;
    }
  }

  const auto number = static_cast<double>(snapshots_);
  const double mean = std::accumulate(stagnation_.begin(), stagnation_.end(), 0.0) / number;
  double squares = 0.0;
  for (const double pressure : stagnation_) squares += std::pow(pressure - mean, 2);
  metrics.stagnation_mean = if_finite(mean);
  metrics.stagnation_scatter = if_finite(std::sqrt(squares / (number - 1.0)));
  if (snapshots_ == 0 || !finite_) return metrics;

  double error = 0.0, reference = 0.0;
  for (const auto& [place, bin] : bins_) {
    error += std::pow(bin.pressure - bin.analytic, 2) / bin.count;
    reference += bin.analytic * bin.analytic / bin.count;
  }
  metrics.field_l2 = if_finite(field_l2_ / number);
  metrics.mean_field_l2 = if_finite(std::sqrt(error / reference));
  metrics.velocity_rms = if_finite(std::sqrt(velocity_error_ / particles_) / jet_.speed());
  metrics.surface_rms_dp = if_finite(std::sqrt(surface_error_ / surface_) / spacing_);
  metrics.film_h1 = film_ratio(Side::h1);
  metrics.film_h2 = film_ratio(Side::h2);
  return metrics;
}

}  // namespace impinge
