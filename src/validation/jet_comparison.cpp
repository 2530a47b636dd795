#include "impinge/validation/jet_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "impinge/validation/statistics.hpp"

namespace impinge {
namespace {

using Side = AnalyticJet::Side;

std::optional<AnalyticWedge> wedge_of(const JetTarget& target) {
  if (target.type != TargetType::wedge) return std::nullopt;
  return AnalyticWedge(target.width, target.speed, target.density, target.angle, std::min(target.end, -target.begin));
}

}  // namespace

AnalyticJet analytic_jet(const JetTarget& target) { return {target.width, target.speed, target.density, target.angle}; }

WallComparison::WallComparison(const JetTarget& target, double force, std::function<double(double)> pressure)
    : target_(target), force_(force), pressure_(std::move(pressure)) {}

void WallComparison::set_average(const Particles<2>& particles, double duration) {
  average_.clear();
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
    if (const auto point = target_.point_of(particles, i))
      average_.emplace_back(*point, particles.pressure_impulse[i] / duration);
  std::ranges::sort(average_, {}, [](const auto& entry) { return entry.first.x; });
}

void WallComparison::add_snapshot(const Particles<2>& particles) {
  double stagnation = 0.0, near = 0.0, force = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    const auto point = target_.point_of(particles, i);
    if (!point) continue;
    force += particles.pressure[i] * point->length * point->share;
    if (std::abs(point->x) >= target_.spacing) continue;
    stagnation += particles.pressure[i];
    near += 1.0;
  }
  stagnation_.push_back(stagnation / near);
  force_ratio_.push_back(force / force_);
}

std::vector<PlatePoint> WallComparison::profile() const {
  std::vector<PlatePoint> profile;
  for (const auto& [point, pressure] : average_) profile.push_back({point.x, pressure, pressure_(point.x)});
  return profile;
}

void WallComparison::measure(JetMetrics& metrics) const {
  if (!average_.empty()) {
    double error = 0.0, reference = 0.0, force = 0.0;
    auto [peak, largest] = average_.front();
    for (const auto& [point, pressure] : average_) {
      force += pressure * point.length * point.share;
      if (pressure > largest) std::tie(peak, largest) = std::pair{point, pressure};
      const double analytic = pressure_(point.x);
      if (analytic <= 1e-3 * 0.5 * target_.density * target_.speed * target_.speed) continue;
      error += std::pow(pressure - analytic, 2) * point.length;
      reference += analytic * analytic * point.length;
    }
    metrics.wall_l2 = if_finite(std::sqrt(error / reference));
    metrics.force_ratio = if_finite(force / force_);
    if (std::isfinite(force)) {
      metrics.peak_pressure = largest;
      metrics.peak_x = peak.x;
    }
  }
  metrics.force_scatter = if_finite(scatter_of(force_ratio_));
  metrics.stagnation_mean = if_finite(mean_of(stagnation_));
  metrics.stagnation_scatter = if_finite(scatter_of(stagnation_));
  metrics.stagnation_ratio = if_finite(mean_of(stagnation_) / (0.5 * target_.density * target_.speed * target_.speed));
}

JetComparison::JetComparison(const JetTarget& target)
    : jet_(analytic_jet(target)),
      spacing_(target.spacing),
      area_(target.particle_area()),
      wall_(target, jet_.normal_force(), [jet = jet_](double x) { return jet.wall_pressure(x); }) {
  const double width = jet_.width();
  const double thin = jet_.plate_position_of_cp(0.01, Side::h2);
  constexpr double beside_outlet = 2.0;  // particles there have a free surface where they are cut off [dp]
  field_begin_ = std::max(-2.0 * width, target.begin + beside_outlet * spacing_);
  field_end_ = std::min(4.0 * width, target.end - beside_outlet * spacing_);
  plate_ = columns(target.begin, target.end);
  h1_ = columns(1.5 * width, std::min(3.0 * width, target.end));
  h2_ = columns(std::max(thin - width, target.begin), thin - 0.5 * width);
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
  return particles * area_ / (length * snapshots_ * jet_.sheet_thickness(side));
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
                       static_cast<double>(column.count) * area_ / (plate_.width * snapshots_), *column.analytic});
  }
  return profile;
}

void JetComparison::add_snapshot(const Particles<2>& particles) {
  ++snapshots_;
  wall_.add_snapshot(particles);
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
    if (particles.type[i] == ParticleType::fluid) finite_ = finite_ && is_finite(particles, i);
  if (finite_) add_field(particles);
}

void JetComparison::add_field(const Particles<2>& particles) {
  double error = 0.0, reference = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    const Vector<2>& position = particles.position[i];
    if (particles.type[i] != ParticleType::fluid) continue;
    for (Columns* stretch : {&plate_, &h1_, &h2_}) count(position, *stretch);
    if (position[0] < field_begin_ || position[0] > field_end_) continue;

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
  wall_.measure(metrics);
  if (snapshots_ == 0 || !finite_) return metrics;

  const auto number = static_cast<double>(snapshots_);
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

SplitJetComparison::SplitJetComparison(const JetTarget& target) : SplitJetComparison(target, wedge_of(target)) {}

SplitJetComparison::SplitJetComparison(const JetTarget& target, const std::optional<AnalyticWedge>& wedge)
    : target_(target),
      force_(wedge ? wedge->force()
                   : target.density * target.speed * target.speed * target.width * (1.0 - std::cos(target.angle))),
      wall_(target, force_,
            [wedge](double x) {
              return wedge ? wedge->pressure(std::abs(x)) : std::numeric_limits<double>::quiet_NaN();
            }),
      sheets_(target.sheets.size()) {}

void SplitJetComparison::add_snapshot(const Particles<2>& particles) {
  ++snapshots_;
  wall_.add_snapshot(particles);
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.type[i] != ParticleType::fluid) continue;
    finite_ = finite_ && is_finite(particles, i);
    for (std::size_t k = 0; k < sheets_.size(); ++k) {
      const JetTarget::Sheet& sheet = target_.sheets[k];
      const Vector<2> place = sheet.frame.of_position(particles.position[i]);
      if (!(place[0] >= 0.0 && place[0] < sheet.length && place[1] >= 0.0 && place[1] < target_.width)) continue;
      sheets_[k].count += 1.0;
      sheets_[k].speed += dot(particles.velocity[i], sheet.frame.x);
    }
  }
}

JetMetrics SplitJetComparison::metrics() const {
  JetMetrics metrics;
  wall_.measure(metrics);
  if (snapshots_ == 0 || !finite_ || sheets_.size() != 2) return metrics;
  const auto thickness = [&](std::size_t k) {
    const double area = sheets_[k].count * target_.spacing * target_.spacing / snapshots_;
    return if_finite(area / (target_.sheets[k].length * 0.5 * target_.width));
  };
  metrics.film_h1 = thickness(0);
  metrics.film_h2 = thickness(1);
  metrics.sheet_speed =
      if_finite((sheets_[0].speed + sheets_[1].speed) / (sheets_[0].count + sheets_[1].count) / target_.speed);
  return metrics;
}

}  // namespace impinge
