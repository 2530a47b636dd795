#pragma once
// What the searches for a jet's target in two and three dimensions share.

#include <algorithm>
#include <numbers>
#include <string>

#include "impinge/cases/case.hpp"
#include "impinge/scenes/analytic_jet.hpp"
#include "impinge/validation/jet_target.hpp"

namespace impinge {

constexpr double grazing = std::numbers::pi / 180.0;  ///< jets at a smaller angle are not measured [rad]
constexpr double outlet_height = 0.25;                ///< above a wall, at which outlets are looked for [dp]
constexpr double search_step = 0.25;                  ///< along a wall in the search for its end [dp]

/// Throws InputError: the case has no jet that is measured, for a reason.
[[noreturn]] void refuse_target(const Case& config, const std::string& reason);

/// Refuses a case without an inlet, with more than `most`, or with one whose speed changes in time.
void check_inlets_of_target(const Case& config, std::size_t most);

/// True where the analytic pressure is below a hundredth of rho U^2 / 2 at both ends of a plate, x = `begin`, `end`
/// [m].
bool is_long_enough(const AnalyticJet& jet, double begin, double end);

/// The first distance from which on `is_past(distance)` is true, at most `length` [m]: by steps [m], then by bisection.
template <class IsPast>
double distance_until(double length, double step, IsPast&& is_past) {
  double before = 0.0;
  for (double next = std::min(step, length); before < length; before = next, next = std::min(next + step, length)) {
    if (!is_past(next)) continue;
    for (int k = 0; k < 50; ++k) {
      const double middle = 0.5 * (before + next);
      (is_past(middle) ? next : before) = middle;
    }
    return before;
  }
  return length;
}

}  // namespace impinge
