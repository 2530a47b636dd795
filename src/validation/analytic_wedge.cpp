#include "impinge/validation/analytic_wedge.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace impinge {
namespace {

using std::numbers::pi;

/// A point of the face.
struct FacePoint {
  double distance;  // from the edge [H]
  double speed;     // s [-]
};

/// The face, for m and delta = 1 + c, by Simpson's rule. With s = tanh(tau) and tau = w^{1/(1 - m)} the integrand is
/// smooth at the edge: x = H/pi (2 - delta) int (tanh(tau) / tau)^{-m} / (1 + 2 delta s / (1 - s)^2) / (1 - m) dw.
std::vector<FacePoint> face(double m, double delta) {
  constexpr int intervals = 2000;
  const double power = 1.0 / (1.0 - m);
  const double last_tau = 0.25 * (std::log(2.0 / delta) + 40.0);  // beyond it the integrand vanishes
  const double step = std::pow(last_tau, 1.0 - m) / intervals;
  const auto at = [&](double w) {
    const double tau = std::pow(w, power), s = std::tanh(tau);
    const double rest = 2.0 / (std::exp(2.0 * tau) + 1.0);  // 1 - s
    const double ratio = tau > 0.0 ? s / tau : 1.0;
    return std::pair{power * std::pow(ratio, -m) / (1.0 + 2.0 * delta * s / (rest * rest)), s};
  };
  std::vector<FacePoint> points{{0.0, 0.0}};
  double begin = at(0.0).first;
  for (int k = 0; k < intervals; ++k) {
    const double middle = at((k + 0.5) * step).first;
    const auto [end, s] = at((k + 1.0) * step);
    points.push_back({points.back().distance + (2.0 - delta) / pi * step / 6.0 * (begin + 4.0 * middle + end), s});
    begin = end;
  }
  return points;
}

}  // namespace

AnalyticWedge::AnalyticWedge(double width, double speed, double density, double half_angle, double face_length) {
  if (!(width > 0.0 && speed > 0.0 && density > 0.0 && half_angle > 0.0 && half_angle < pi && face_length > 0.0))
    throw std::invalid_argument(
        "analytic wedge: width, speed, density and length must be positive, the half-angle in (0, 180) deg");
  const double m = half_angle / pi;
  // A longer face is infinite to rounding.
  const double length = std::min(face_length / width, 20.0);
  double low = -300.0, high = std::log(2.0);  // of ln delta; the length falls with it
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (face(m, std::exp(middle)).back().distance > length ? low : high) = middle;
  }
  const double delta = std::exp(low);
  turn_ = half_angle / pi * std::acos(delta - 1.0);
  force_ = density * speed * speed * width * (1.0 - std::cos(turn_));
  dynamic_pressure_ = 0.5 * density * speed * speed;
  exponent_ = m;
  for (const FacePoint& point : face(m, delta)) {
    if (point.distance == 0.0) continue;
    log_distance_.push_back(std::log(width * point.distance));
    log_speed_.push_back(std::log(point.speed));
  }
}

// Between the points, and before the first, ln s is linear in ln x: at the edge s is a power of x.
double AnalyticWedge::pressure(double distance) const {
  if (distance <= 0.0) return dynamic_pressure_;
  const double x = std::log(distance);
  const auto after = std::ranges::upper_bound(log_distance_, x);
  if (after == log_distance_.end()) return 0.0;
  const auto k = static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, after - log_distance_.begin()));
  const double share = (x - log_distance_[k - 1]) / (log_distance_[k] - log_distance_[k - 1]);
  const double log_speed = log_speed_[k - 1] + share * (log_speed_[k] - log_speed_[k - 1]);
  return -dynamic_pressure_ * std::expm1(2.0 * exponent_ * log_speed);
}

}  // namespace impinge
