#include "impinge/scenes/analytic_jet.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace impinge {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

// Beyond |tau| = outline_reach a free surface is straight to rounding.
constexpr double outline_reach = 32.0;
constexpr double outline_step = 0.25;

// Largest |tau| in use: e^-tau is still a normal number.
constexpr double tau_limit = 690.0;

double softplus(double tau) { return tau > 0.0 ? tau + std::log1p(std::exp(-tau)) : std::log1p(std::exp(tau)); }
double inverse_softplus(double k) { return k > 40.0 ? k : std::log(std::expm1(k)); }

Complex to_complex(const Vector<2>& v) { return {v[0], v[1]}; }
Vector<2> to_vec(Complex z) { return {{z.real(), z.imag()}}; }

/// Argument where a function that is positive at `inside` and negative at `outside` changes sign.
template <class Function>
double bisect(Function&& function, double inside, double outside) {
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (inside + outside);
    (function(middle) > 0.0 ? inside : outside) = middle;
  }
  return inside;
}

}  // namespace

AnalyticJet::AnalyticJet(double width, double speed, double density, double angle)
    : width_(width), speed_(speed), density_(density), angle_(angle), sin_(std::sin(angle)), cos_(std::cos(angle)) {
  if (!(width > 0.0 && speed > 0.0 && density > 0.0 && angle > 0.0 && angle <= 0.5 * pi * (1.0 + 1e-12)))
    throw std::invalid_argument("analytic jet: width, speed and density must be positive, the angle in (0, 90] deg");

  const Complex direction = std::polar(1.0, angle);
  const double scale = width / pi;
  ends_ = {End{1.0, scale * (1.0 + cos_), 0.0}, End{-1.0, -scale * (1.0 - cos_), 0.0},
           End{direction, -scale * std::conj(direction), 0.0}, End{std::conj(direction), -scale * direction, 0.0}};
  for (End& end : ends_)
    for (const End& other : ends_)
      if (&other != &end) end.offset -= other.strength * std::log(1.0 - end.location * std::conj(other.location));

  // The corner at h2 gets tighter with the angle: 16 rings serve 20 degrees and more.
  const int rings = std::max(16, static_cast<int>(std::ceil(16.0 * 20.0 * pi / 180.0 / angle)));
  for (int ring = 0; ring < rings; ++ring) {
    for (int ray = 0; ray < 2 * rings; ++ray) {
      const Complex zeta = std::polar((ring + 0.95) / rings, pi * (ray + 0.5) / (2.0 * rings));
      samples_.push_back({zeta, position(nearest_end(zeta))});
    }
  }

  for (const Side side : {Side::h1, Side::h2})
    for (double tau = -outline_reach; tau <= outline_reach; tau += outline_step)
      outline_[static_cast<std::size_t>(side)].push_back(surface_at(side, softplus(tau)));
}

double AnalyticJet::sheet_thickness(Side side) const {
  return 0.5 * width_ * (side == Side::h1 ? 1.0 + cos_ : 1.0 - cos_);
}

double AnalyticJet::normal_force() const { return density_ * speed_ * speed_ * width_ * sin_; }

double AnalyticJet::axis_position() const {
  const double half = 0.5 * angle_;
  return width_ / pi *
         ((1.0 + cos_) * std::log(2.0 * std::cos(half)) - (1.0 - cos_) * std::log(2.0 * std::sin(half)) +
          (0.5 * pi - angle_) * sin_ + 0.5 * pi * cos_ / sin_);
}

double AnalyticJet::centre_of_pressure() const { return axis_position() - 0.5 * width_ * cos_ / sin_; }

double AnalyticJet::plate_position(double q) const {
  if (!(std::abs(q) < 1.0)) throw std::domain_error("analytic jet: a speed on the plate must be in (-U, U)");
  return position(nearest_end(q)).real();
}

double AnalyticJet::plate_speed(double x) const { return zeta(solve(x)).real(); }

double AnalyticJet::wall_pressure(double x) const { return stagnation_pressure() * pressure_coefficient(solve(x)); }

double AnalyticJet::plate_position_of_cp(double cp, Side side) const {
  if (!(cp > 0.0 && cp <= 1.0)) throw std::domain_error("analytic jet: a pressure coefficient must be in (0, 1]");
  const double q = std::sqrt(1.0 - cp);
  const double omega = -std::log(cp / (1.0 + q));
  return position(Hodograph{side == Side::h1 ? 0 : 1, omega}).real();
}

Vector<2> AnalyticJet::surface_point(double theta) const {
  if (!(theta > 0.0 && theta < pi && theta != angle_))
    throw std::domain_error("analytic jet: a direction on the free surface must be in (0, pi), without the jet's");
  const Side side = theta < angle_ ? Side::h1 : Side::h2;
  return surface_at(side, surface_parameter(side, theta));
}

std::vector<Vector<2>> AnalyticJet::surface(Side side, double sheet_length, double jet_length, double spacing) const {
  if (!(spacing > 0.0)) throw std::invalid_argument("analytic jet: the spacing of a surface must be positive");
  const auto at = [&](double tau) { return surface_at(side, softplus(tau)); };
  const double sign = side == Side::h1 ? 1.0 : -1.0;

  // |x| grows steadily downstream of the foremost point, the distance along the axis upstream of the point where
  // the surface is normal to the jet.
  const double first =
      bisect([&](double tau) { return sheet_length - sign * at(tau)[0]; }, foremost_tau(side), -tau_limit);
  const double normal =
      side == Side::h2 && angle_ < 0.5 * pi ? inverse_softplus(surface_parameter(side, angle_ + 0.5 * pi)) : -tau_limit;
  const double foot = axis_position();
  const double last = bisect(
      [&](double tau) {
        const Vector<2> p = at(tau);
        return jet_length + (p[0] - foot) * cos_ - p[1] * sin_;
      },
      normal, tau_limit);

  const double length_per_tau = std::max(width_, 2.0 * sheet_thickness(side)) / pi;
  const int segments = std::max(1, static_cast<int>(std::ceil((last - first) * length_per_tau / spacing)));
  std::vector<Vector<2>> line;
  for (int i = 0; i <= segments; ++i) line.push_back(at(first + (last - first) * i / segments));
  return line;
}

std::optional<AnalyticJet::Film> AnalyticJet::film(double x) const {
  const Side side = x > 0.0 ? Side::h1 : Side::h2;
  const double sign = side == Side::h1 ? 1.0 : -1.0;
  const auto at = [&](double tau) { return surface_at(side, softplus(tau)); };
  const auto beyond = [&](double tau) { return sign * (at(tau)[0] - x); };
  const double foremost = foremost_tau(side);
  if (beyond(foremost) >= 0.0) return std::nullopt;
  Film film{at(bisect(beyond, -tau_limit, foremost))[1], std::numeric_limits<double>::infinity()};
  if (film.top > width_) return std::nullopt;
  if (beyond(tau_limit) > 0.0) film.ceiling = at(bisect(beyond, tau_limit, foremost))[1];
  return film;
}

Vector<2> AnalyticJet::position(Complex zeta) const { return to_vec(position(nearest_end(zeta))); }

std::optional<Complex> AnalyticJet::hodograph(const Vector<2>& point) const {
  if (!contains(point)) return std::nullopt;
  return zeta(solve(to_complex(point)));
}

std::optional<AnalyticJet::State> AnalyticJet::state(const Vector<2>& point) const {
  if (!contains(point)) return std::nullopt;
  const Hodograph at = solve(to_complex(point));
  const Complex value = zeta(at);
  return State{{{speed_ * value.real(), -speed_ * value.imag()}}, stagnation_pressure() * pressure_coefficient(at)};
}

AnalyticJet::SurfacePoint AnalyticJet::nearest_surface(const Vector<2>& point) const {
  double best = std::numeric_limits<double>::infinity();
  SurfacePoint result;
  const auto offer = [&](const Vector<2>& position, const Vector<2>& velocity) {
    const Vector<2> difference = position - point;
    const double squared = dot(difference, difference);
    if (squared >= best) return;
    best = squared;
    result.position = position;
    result.velocity = velocity;
  };

  for (const Side side : {Side::h1, Side::h2}) {
    const auto& outline = outline_[static_cast<std::size_t>(side)];
    const auto squared = [&](const Vector<2>& p) { return dot(p - point, p - point); };

    // Straight ends. The velocity leads out of the jet and into the sheet.
    const Vector<2> jet{{speed_ * cos_, -speed_ * sin_}}, sheet{{side == Side::h1 ? speed_ : -speed_, 0.0}};
    const auto offer_ray = [&](const Vector<2>& from, const Vector<2>& direction, const Vector<2>& velocity) {
      const double along = std::max(0.0, dot(point - from, direction) / dot(direction, direction));
      offer(from + along * direction, velocity);
    };
    offer_ray(outline.front(), sheet, sheet);
    offer_ray(outline.back(), -1.0 * jet, jet);

    // Golden section between the neighbours of the nearest vertex.
    const auto vertex = std::min_element(outline.begin(), outline.end(), [&](const Vector<2>& p, const Vector<2>& q) {
      return squared(p) < squared(q);
    });
    const double tau = -outline_reach + outline_step * static_cast<double>(vertex - outline.begin());
    const auto value = [&](double t) { return squared(surface_at(side, softplus(t))); };
    constexpr double ratio = 1.0 / std::numbers::phi;
    double low = tau - outline_step, high = tau + outline_step;
    double left = high - ratio * (high - low), right = low + ratio * (high - low);
    double at_left = value(left), at_right = value(right);
    while (high - low > 1e-9) {
      if (at_left < at_right) {
        high = right;
        right = left;
        at_right = at_left;
        left = high - ratio * (high - low);
        at_left = value(left);
      } else {
        low = left;
        left = right;
        at_left = at_right;
        right = low + ratio * (high - low);
        at_right = value(right);
      }
    }
    Vector<2> velocity;
    const Vector<2> position = surface_at(side, softplus(0.5 * (low + high)), &velocity);
    offer(position, velocity);
  }
  result.depth = below_surface(point) ? std::sqrt(best) : -std::sqrt(best);
  return result;
}

Complex AnalyticJet::zeta(const Hodograph& at) const {
  return ends_[static_cast<std::size_t>(at.end)].location * (1.0 - std::exp(-at.omega));
}

Complex AnalyticJet::position(const Hodograph& at) const {
  const End& end = ends_[static_cast<std::size_t>(at.end)];
  const Complex value = zeta(at);
  Complex z = end.strength * at.omega;
  for (const End& other : ends_)
    if (&other != &end) z -= other.strength * std::log(1.0 - value * std::conj(other.location));
  return z;
}

/// dz/domega [m]. It has no zero in the disc.
Complex AnalyticJet::derivative(const Hodograph& at) const {
  const End& end = ends_[static_cast<std::size_t>(at.end)];
  const Complex value = zeta(at);
  const Complex slope = end.location * std::exp(-at.omega);  // dzeta/domega
  Complex sum = end.strength;
  for (const End& other : ends_)
    if (&other != &end) sum += other.strength * slope / (other.location - value);
  return sum;
}

AnalyticJet::Hodograph AnalyticJet::nearest_end(Complex zeta) const {
  int nearest = 0;
  for (int k = 1; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k), j = static_cast<std::size_t>(nearest);
    if (std::norm(zeta - ends_[i].location) < std::norm(zeta - ends_[j].location)) nearest = k;
  }
  const Complex location = ends_[static_cast<std::size_t>(nearest)].location;
  return {nearest, -std::log((location - zeta) * std::conj(location))};
}

/// The best of the three far-field solutions, or, near the stagnation point, the nearest tabulated one.
AnalyticJet::Hodograph AnalyticJet::start(Complex z) const {
  static constexpr std::array<std::array<double, 2>, 3> strip{
      {{0.0, 0.5 * pi}, {-0.5 * pi, 0.0}, {-0.5 * pi, 0.5 * pi}}};  // range of Im omega
  Hodograph best{0, 0.0};
  double residual = std::abs(z);
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const Complex omega = (z - ends_[i].offset) / ends_[i].strength;
    const Hodograph guess{k, {std::max(omega.real(), 0.0), std::clamp(omega.imag(), strip[i][0], strip[i][1])}};
    const double miss = std::abs(position(guess) - z);
    if (miss < residual) {
      residual = miss;
      best = guess;
    }
  }
  if (residual < 0.1 * sheet_thickness(Side::h2)) return best;
  const auto sample = std::min_element(samples_.begin(), samples_.end(), [&](const Sample& a, const Sample& b) {
    return std::norm(a.position - z) < std::norm(b.position - z);
  });
  return std::abs(sample->position - z) < residual ? nearest_end(sample->zeta) : best;
}

/// zeta of a point of the fluid, by Newton's method in omega with halved steps where a full one does not help.
AnalyticJet::Hodograph AnalyticJet::solve(Complex z) const {
  const double rounding = 8.0 * std::numeric_limits<double>::epsilon() * (width_ + std::abs(z));
  Hodograph at = start(z);
  Complex miss = position(at) - z;
  for (int iteration = 0; iteration < 50 && std::abs(miss) > rounding; ++iteration) {
    const Complex step = miss / derivative(at);
    double fraction = 1.0;
    Hodograph next;
    Complex next_miss;
    do {
      next = {at.end, at.omega - fraction * step};
      next_miss = position(next) - z;
      fraction *= 0.5;
    } while (!(std::abs(next_miss) < std::abs(miss)) && fraction > 1e-6);
    if (!(std::abs(next_miss) < std::abs(miss))) break;
    at = next;
    miss = next_miss;
  }
  const Complex value = zeta(at);
  if (!(std::abs(miss) < 1e3 * rounding && std::abs(value) < 1.0 + 1e-9 && value.imag() > -1e-9))
    throw std::runtime_error("analytic jet: Newton's method failed at (" + std::to_string(z.real()) + ", " +
                             std::to_string(z.imag()) + ")");
  return at;
}

/// 1 - |zeta|^2, without cancellation next to the free surface's far ends.
double AnalyticJet::pressure_coefficient(const Hodograph& at) const {
  const Complex gap = std::exp(-at.omega);
  return std::clamp(2.0 * gap.real() - std::norm(gap), 0.0, 1.0);
}

/// The free surface zeta = e^{i theta},
///   x = H/pi [cos a ln|2 (cos a - cos theta)| + sin a (pi - a or -a) - (1 + cos a) ln(2 sin(theta/2))
///       + (1 - cos a) ln(2 cos(theta/2))],
///   y = h + H/pi sin a ln(sin((a + theta)/2) / |sin((a - theta)/2)|),
/// where the second equation gives tan(theta/2) = tan(a/2) tanh(k/2) on the h1 side, tan(a/2) / tanh(k/2) on the h2
/// side.
Vector<2> AnalyticJet::surface_at(Side side, double k, Vector<2>* velocity) const {
  const bool thick = side == Side::h1;
  const double slope = std::tan(0.5 * angle_), t = std::tanh(0.5 * k);
  const double opposite = thick ? slope * t : slope, adjacent = thick ? 1.0 : t;
  const double hypotenuse = std::hypot(opposite, adjacent);
  const double sine = opposite / hypotenuse, cosine = adjacent / hypotenuse;  // of theta / 2
  const double log_gap = 2.0 * std::log(4.0 * std::sin(0.5 * angle_) / hypotenuse) - k -
                         2.0 * std::log1p(std::exp(-k));  // ln|2 (cos a - cos theta)|
  if (velocity) *velocity = {{speed_ * (cosine * cosine - sine * sine), -speed_ * 2.0 * sine * cosine}};
  return {{width_ / pi *
               (cos_ * log_gap + sin_ * (thick ? pi - angle_ : -angle_) - (1.0 + cos_) * std::log(2.0 * sine) +
                (1.0 - cos_) * std::log(2.0 * cosine)),
           sheet_thickness(side) + width_ / pi * sin_ * k}};
}

/// k of the point with direction theta.
double AnalyticJet::surface_parameter(Side side, double theta) const {
  const double ratio = std::tan(0.5 * theta) / std::tan(0.5 * angle_);
  return 2.0 * std::atanh(side == Side::h1 ? ratio : 1.0 / ratio);
}

/// tau where the surface comes closest to the other sheet's side: where it is vertical, in the jet if nowhere.
double AnalyticJet::foremost_tau(Side side) const {
  if (side == Side::h1 || angle_ >= 0.5 * pi) return tau_limit;
  return std::min(inverse_softplus(surface_parameter(side, 0.5 * pi)), tau_limit);
}

/// Both surfaces rise monotonically from their sheet into the jet, so each has one x per height.
bool AnalyticJet::below_surface(const Vector<2>& point) const {
  const auto within = [&](Side side) {
    const double k = pi * (point[1] - sheet_thickness(side)) / (width_ * sin_);
    if (k <= 0.0) return true;
    const double x = surface_at(side, k)[0];
    return side == Side::h1 ? point[0] <= x : point[0] >= x;
  };
  return within(Side::h1) && within(Side::h2);
}

}  // namespace impinge
