#include "impinge/validation/round_jet.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>

namespace impinge {
namespace {

// Printed by jobs/round_jet.py; at equal steps of r/R.
constexpr double step = 0.05, table_end = 4.0;
constexpr std::array<double, 81> pressures{
    1.000000, 0.999504, 0.998013, 0.995512, 0.991982, 0.987392, 0.981702, 0.974864, 0.966820, 0.957502, 0.946831,
    0.934720, 0.921069, 0.905771, 0.888710, 0.869763, 0.848805, 0.825710, 0.800361, 0.772653, 0.742510, 0.709894,
    0.674821, 0.637381, 0.597752, 0.556216, 0.513173, 0.469136, 0.424725, 0.380635, 0.337599, 0.296339, 0.257506,
    0.221634, 0.189105, 0.160131, 0.134756, 0.112878, 0.094279, 0.078662, 0.065685, 0.054995, 0.046244, 0.039113,
    0.033315, 0.028601, 0.024762, 0.021624, 0.019043, 0.016905, 0.015119, 0.013614, 0.012333, 0.011232, 0.010276,
    0.009439, 0.008700, 0.008042, 0.007454, 0.006924, 0.006445, 0.006010, 0.005613, 0.005250, 0.004917, 0.004612,
    0.004330, 0.004070, 0.003830, 0.003607, 0.003401, 0.003209, 0.003031, 0.002866, 0.002711, 0.002567, 0.002433,
    0.002307, 0.002189, 0.002079, 0.001976};  // from r = 0 on [rho U^2 / 2]
constexpr std::array<double, 57> films{
    1.651866, 1.526415, 1.429444, 1.352142, 1.289382, 1.237879, 1.195388, 1.160274, 1.131268, 1.107361,
    1.087724, 1.071648, 1.058546, 1.047910, 1.039305, 1.032366, 1.026785, 1.022304, 1.018705, 1.015814,
    1.013487, 1.011607, 1.010080, 1.008832, 1.007804, 1.006950, 1.006234, 1.005627, 1.005108, 1.004659,
    1.004268, 1.003925, 1.003620, 1.003349, 1.003105, 1.002885, 1.002686, 1.002505, 1.002340, 1.002189,
    1.002050, 1.001923, 1.001805, 1.001697, 1.001597, 1.001504, 1.001418, 1.001338, 1.001264, 1.001195,
    1.001130, 1.001070, 1.001014, 1.000962, 1.000913, 1.000867, 1.000824};  // 2 r h / R^2, from r = film_begin on

/// Between the values at 0, 1, 2, ...: the cubic with the slopes of central differences. `before`: the value at -1.
double interpolated(std::span<const double> values, double before, double place) {
  const auto last = static_cast<std::ptrdiff_t>(values.size()) - 1;
  const auto k = std::clamp(static_cast<std::ptrdiff_t>(place), std::ptrdiff_t{0}, last - 1);
  const auto at = [&](std::ptrdiff_t i) {
    if (i < 0) return before;
    return i > last ? 2.0 * values[values.size() - 1] - values[values.size() - 2] : values[static_cast<std::size_t>(i)];
  };
  const double x = place - static_cast<double>(k), y = 1.0 - x;
  const double begin = 0.5 * (at(k + 1) - at(k - 1)), end = 0.5 * (at(k + 2) - at(k));
  return y * y * (1.0 + 2.0 * x) * at(k) + x * x * (1.0 + 2.0 * y) * at(k + 1) + x * y * (y * begin - x * end);
}

}  // namespace

RoundJet::RoundJet(double radius, double speed, double density) : radius_(radius), speed_(speed), density_(density) {
  if (!(radius > 0.0 && speed > 0.0 && density > 0.0))
    throw std::invalid_argument("round jet: radius, speed and density must be positive");
}

double RoundJet::force() const { return density_ * speed_ * speed_ * std::numbers::pi * radius_ * radius_; }

// A thin film of irrotational flow has the pressure rho U^2 / 2 (R/r)^4 / 2 on the plate, and the thickness
// R^2 / (2 r) (1 + 5/24 (R/r)^4).
double RoundJet::wall_pressure(double distance) const {
  const double r = std::abs(distance) / radius_;
  const double share = r < table_end ? interpolated(pressures, pressures[1], r / step) : 0.5 / std::pow(r, 4);
  return 0.5 * density_ * speed_ * speed_ * share;
}

double RoundJet::film(double distance) const {
  const double r = distance / radius_;
  const double before = 3.0 * films[0] - 3.0 * films[1] + films[2];
  const double share =
      r < table_end ? interpolated(films, before, (r - film_begin) / step) : 1.0 + 5.0 / 24.0 / std::pow(r, 4);
  return 0.5 * radius_ / r * share;
}

double footprint(double angle, double azimuth) { return std::sin(angle) / (1.0 - std::cos(angle) * std::cos(azimuth)); }

double film_law(double angle, double azimuth) { return 0.5 * std::sin(angle) * std::pow(footprint(angle, azimuth), 2); }

}  // namespace impinge
