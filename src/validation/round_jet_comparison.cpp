#include "impinge/validation/round_jet_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "impinge/validation/statistics.hpp"

namespace impinge {
namespace {

using std::numbers::pi;

constexpr int sector_number = 24;
constexpr double ring_begin = 2.25, ring_end = 2.75;  // [footprints]

/// Weighted sums of a bin.
struct Bin {
  double area = 0.0, x = 0.0, pressure = 0.0, analytic = 0.0;
};

}  // namespace

bool is_perpendicular(const JetTarget& target) { return 0.5 * pi - target.angle < 1e-9; }

RoundJetComparison::RoundJetComparison(const JetTarget& target)
    : target_(target),
      radius_(0.5 * target.width),
      jet_(radius_, target.speed, target.density),
      at_d_{target.width - target.spacing, target.width + target.spacing},
      at_1_5_d_{1.5 * target.width - target.spacing, 1.5 * target.width + target.spacing},
      sectors_(sector_number) {
  if (!is_perpendicular(target_)) return;
  stagnation_ = {0.0, 0.0};
  const double width = 2.0 * target_.spacing;
  for (double begin = RoundJet::film_begin * radius_; begin + width <= target_.space->reach; begin += width)
    rings_.push_back({begin, begin + width});
}

double RoundJetComparison::force() const {
  return jet_.force() * (std::sin(target_.angle) - target_.space->force_beyond);
}

void RoundJetComparison::set_wall_average(const Particles<3>& particles, double duration) {
  map_.clear();
  areas_.clear();
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.type[i] != ParticleType::wall) continue;
    const auto found = target_.space->points.find(particles.id[i]);
    if (found == target_.space->points.end()) continue;
    map_.push_back({found->second.x, found->second.y, particles.pressure_impulse[i] / duration});
    areas_.push_back(found->second.area);
  }
  find_peak();
}

void RoundJetComparison::find_peak() {
  std::vector<std::size_t> near;
  for (std::size_t k = 0; k < map_.size(); ++k) {
    const double azimuth = std::atan2(map_[k].y, map_[k].x);
    const double beside_jet = radius_ * (1.0 + footprint(target_.angle, azimuth));
    if (std::hypot(map_[k].x, map_[k].y) < beside_jet) near.push_back(k);
  }
  largest_.reset();
  for (const std::size_t middle : near) {
    double area = 0.0, pressure = 0.0, x = 0.0, y = 0.0;
    for (const std::size_t k : near) {
      if (std::hypot(map_[k].x - map_[middle].x, map_[k].y - map_[middle].y) >= target_.spacing) continue;
      area += areas_[k];
      pressure += areas_[k] * map_[k].pressure;
      x += areas_[k] * map_[k].x;
      y += areas_[k] * map_[k].y;
    }
    if (largest_ && !(pressure / area > *largest_)) continue;
    largest_ = pressure / area;
    peak_ = {x / area, y / area};
  }
  if (!is_perpendicular(target_) && largest_) stagnation_ = peak_;
}

void RoundJetComparison::add_snapshot(const Particles<3>& particles) {
  ++snapshots_;
  double force = 0.0, near = 0.0, stagnation = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.type[i] == ParticleType::fluid) finite_ = finite_ && is_finite(particles, i);
    if (particles.type[i] != ParticleType::wall) continue;
    const auto found = target_.space->points.find(particles.id[i]);
    if (found == target_.space->points.end()) continue;
    const SpacePlate::Point& point = found->second;
    force += particles.pressure[i] * point.area;
    if (!stagnation_ || std::hypot(point.x - stagnation_->first, point.y - stagnation_->second) >= target_.spacing)
      continue;
    stagnation += particles.pressure[i] * point.area;
    near += point.area;
  }
  force_ratio_.push_back(force / this->force());
  pressure_.push_back(stagnation / near);
  if (!finite_) return;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
    if (particles.type[i] == ParticleType::fluid)
      add_film(target_.space->of_position(particles.position[i]), target_.space->of_direction(particles.velocity[i]));
}

// The jet passes over the thin sheet: what is above the middle of the gap belongs to it.
bool RoundJetComparison::is_of_jet(const Vector<3>& place) const {
  const double cosine = std::cos(target_.angle), sine = std::sin(target_.angle);
  const double beside = std::abs(place[1]);
  if (is_perpendicular(target_) || beside >= radius_ + target_.spacing) return false;
  const double half = std::sqrt(std::max(radius_ * radius_ - beside * beside, 0.0));
  const double ceiling = ((radius_ * cosine / sine - place[0]) * sine - half) / cosine;
  const double film =
      radius_ * radius_ * film_law(target_.angle, std::atan2(place[1], place[0])) / std::hypot(place[0], place[1]);
  return ceiling > 0.0 && place[2] > 0.5 * (film + ceiling);
}

void RoundJetComparison::add_film(const Vector<3>& place, const Vector<3>& velocity) {
  const double r = std::hypot(place[0], place[1]);
  const auto count = [&](Ring& ring) { ring.count += r >= ring.begin && r < ring.end ? 1.0 : 0.0; };
  for (Ring& ring : rings_) count(ring);
  count(at_d_);
  count(at_1_5_d_);

  const double azimuth = std::atan2(place[1], place[0]), cosine = std::cos(target_.angle);
  const double edge = radius_ * footprint(target_.angle, azimuth), share = r / edge;
  if (!(share >= ring_begin && share < ring_end) || is_of_jet(place)) return;
  // u . grad(share); d(edge)/d(psi) / edge = -cos a sin psi / (1 - cos a cos psi).
  const double radial = (velocity[0] * place[0] + velocity[1] * place[1]) / r;
  const double turning = (velocity[1] * place[0] - velocity[0] * place[1]) / r;
  const double slope = -cosine * std::sin(azimuth) / (1.0 - cosine * std::cos(azimuth));
  const double width = (ring_end - ring_begin) * edge;
  const double flux = (radial - turning * slope) / width;
  const auto number = static_cast<std::size_t>((azimuth + pi) / (2.0 * pi) * sector_number) % sector_number;
  sectors_[number].depth += 1.0 / width;
  sectors_[number].flux += flux;
  momentum_ += flux * velocity[0];
}

double RoundJetComparison::thickness(const Ring& ring) const {
  const double area = pi * (ring.end * ring.end - ring.begin * ring.begin);
  return ring.count * std::pow(target_.spacing, 3) / (area * snapshots_);
}

// The mean over the ring's area, by Simpson's rule.
double RoundJetComparison::exact_thickness(const Ring& ring) const {
  const double middle = 0.5 * (ring.begin + ring.end);
  const auto share = [&](double r) { return r * jet_.film(r); };
  return (share(ring.begin) + 4.0 * share(middle) + share(ring.end)) / (6.0 * middle);
}

std::optional<double> RoundJetComparison::film_ratio(const Ring& ring) const {
  if (ring.end > target_.space->reach) return std::nullopt;
  return if_finite(thickness(ring) / exact_thickness(ring));
}

JetMetrics RoundJetComparison::metrics() const {
  JetMetrics metrics;
  const double dynamic_pressure = 0.5 * target_.density * target_.speed * target_.speed;
  if (!map_.empty()) {
    double force = 0.0, x = 0.0, y = 0.0;
    // Sums of squares: all, and those near the stagnation point.
    double error = 0.0, reference = 0.0, near_error = 0.0, near_reference = 0.0;
    for (std::size_t k = 0; k < map_.size(); ++k) {
      const auto& [place_x, place_y, pressure] = map_[k];
      force += pressure * areas_[k];
      x += pressure * areas_[k] * place_x;
      y += pressure * areas_[k] * place_y;
      const double r = std::hypot(place_x, place_y), analytic = jet_.wall_pressure(r);
      if (analytic <= 1e-3 * dynamic_pressure) continue;
      const double square = std::pow(pressure - analytic, 2) * areas_[k], exact = analytic * analytic * areas_[k];
      error += square;
      reference += exact;
      if (r >= 1.5 * radius_) continue;
      near_error += square;
      near_reference += exact;
    }
    const double foot = is_perpendicular(target_) ? 0.0 : radius_ / std::tan(target_.angle);
    const double centre =
        (foot * std::sin(target_.angle) - target_.space->moment_beyond) / (this->force() / jet_.force());
    metrics.force_ratio = if_finite(force / this->force());
    metrics.centre_x = if_finite((x / force - centre) / target_.width);
    metrics.centre_y = if_finite(y / force / target_.width);
    if (is_perpendicular(target_)) {
      metrics.wall_l2 = if_finite(std::sqrt(error / reference));
      metrics.wall_l2_near = if_finite(std::sqrt(near_error / near_reference));
    }
    if (std::isfinite(force) && largest_) {
      metrics.peak_pressure = largest_;
      metrics.peak_x = peak_.first;
    }
  }
  metrics.force_scatter = if_finite(scatter_of(force_ratio_));
  metrics.stagnation_mean = if_finite(mean_of(pressure_));
  metrics.stagnation_scatter = if_finite(scatter_of(pressure_));
  metrics.stagnation_ratio = if_finite(mean_of(pressure_) / dynamic_pressure);
  if (snapshots_ == 0 || !finite_) return metrics;

  const double volume = std::pow(target_.spacing, 3) / snapshots_, area = pi * radius_ * radius_;
  double flux = 0.0;
  for (const Sector& sector : sectors_) flux += sector.flux * volume;
  metrics.film_flux = if_finite(flux / (target_.speed * area));
  if (is_perpendicular(target_)) {
    metrics.film_at_d = film_ratio(at_d_);
    metrics.film_at_1_5_d = film_ratio(at_1_5_d_);
    return metrics;
  }
  metrics.film_momentum =
      if_finite(momentum_ * volume / (target_.speed * target_.speed * area * std::cos(target_.angle)));
  double squares = 0.0;
  for (const FilmColumn& column : film_profile()) {
    const double r = middle_of_ring(column.x);
    squares += std::pow((column.thickness - column.analytic) * r, 2);
  }
  constexpr double mean_law = 0.5;  // of film_law over all azimuths
  metrics.film_law_rms = if_finite(std::sqrt(squares / sector_number) / (mean_law * radius_ * radius_));
  return metrics;
}

std::vector<PlatePoint> RoundJetComparison::wall_profile() const {
  std::map<double, Bin> bins;  // by their numbers
  for (std::size_t k = 0; k < map_.size(); ++k) {
    const auto& [x, y, pressure] = map_[k];
    const double r = std::hypot(x, y), place = is_perpendicular(target_) ? r : x;
    if (is_perpendicular(target_) ? r > target_.space->reach : std::abs(y) > target_.spacing) continue;
    Bin& bin = bins[std::floor(place / target_.spacing)];
    bin.area += areas_[k];
    bin.x += areas_[k] * place;
    bin.pressure += areas_[k] * pressure;
    bin.analytic +=
        areas_[k] * (is_perpendicular(target_) ? jet_.wall_pressure(r) : std::numeric_limits<double>::quiet_NaN());
  }
  std::vector<PlatePoint> profile;
  for (const auto& [number, bin] : bins)
    profile.push_back({bin.x / bin.area, bin.pressure / bin.area, bin.analytic / bin.area});
  return profile;
}

double RoundJetComparison::middle_of_ring(double azimuth) const {
  return 0.5 * (ring_begin + ring_end) * radius_ * footprint(target_.angle, azimuth);
}

std::vector<FilmColumn> RoundJetComparison::film_profile() const {
  std::vector<FilmColumn> profile;
  if (snapshots_ == 0 || !finite_) return profile;
  for (const Ring& ring : rings_)
    profile.push_back({0.5 * (ring.begin + ring.end), thickness(ring), exact_thickness(ring)});
  if (is_perpendicular(target_)) return profile;
  constexpr double width = 2.0 * pi / sector_number;
  for (std::size_t k = 0; k < sectors_.size(); ++k) {
    const double azimuth = -pi + (static_cast<double>(k) + 0.5) * width, r = middle_of_ring(azimuth);
    const double depth = sectors_[k].depth * std::pow(target_.spacing, 3) / (snapshots_ * width);  // times r
    profile.push_back({azimuth, depth / r, radius_ * radius_ * film_law(target_.angle, azimuth) / r});
  }
  return profile;
}

}  // namespace impinge
