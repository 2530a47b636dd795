#include "impinge/boundaries/prescribed_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

namespace impinge {
namespace {

/// Displacement along x and y [m] and angle [rad], with their first and second derivatives in time.
struct Course {
  using Values = std::array<double, 3>;
  Values value{}, first{}, second{};

  Course at_rest() const { return {.value = value}; }
};

Pose<2> pose_of(const Course& course, const Vector<2>& center) {
  const auto shift = [](const Course::Values& x) { return Vector<2>{{x[0], x[1]}}; };
  const double cosine = std::cos(course.value[2]), sine = std::sin(course.value[2]);
  const double spin = course.first[2];
  Pose<2> pose;
  pose.rotation = {{{{{cosine, -sine}}, {{sine, cosine}}}}};
  pose.spin = {{{{{0.0, -spin}}, {{spin, 0.0}}}}};
  pose.bend = {{{{{-spin * spin, -course.second[2]}}, {{course.second[2], -spin * spin}}}}};
  const Vector<2> moved_center = center + shift(course.value);
  pose.shift = moved_center - pose.rotation * center;
  pose.velocity = shift(course.first) - pose.spin * moved_center;
  pose.acceleration = shift(course.second) - pose.bend * moved_center;
  return pose;
}

/// `course` takes the time since the start.
template <class CourseOf>
Motion<2> motion_by(const MotionFrame& frame, CourseOf course) {
  return [frame, course](double time) {
    if (time < frame.start) return pose_of(course(0.0).at_rest(), frame.center);
    if (time > frame.end) return pose_of(course(frame.end - frame.start).at_rest(), frame.center);
    return pose_of(course(time - frame.start), frame.center);
  };
}

/// A cubic spline with zero slope at its ends, through values at rising times.
class Spline {
 public:
  explicit Spline(const std::vector<MotionPoint>& points) {
    for (const MotionPoint& point : points) {
      times_.push_back(point.time);
      values_.push_back({point.shift[0], point.shift[1], point.angle});
    }
    slopes_.resize(times_.size());
    for (std::size_t k = 0; k < 3; ++k) solve(k);
  }

  Course operator()(double time) const {
    if (time <= times_.front()) return {.value = values_.front()};
    if (time >= times_.back()) return {.value = values_.back()};
    const auto after = std::ranges::upper_bound(times_, time);
    const auto i = static_cast<std::size_t>(after - times_.begin()) - 1;
    const double step = times_[i + 1] - times_[i], s = (time - times_[i]) / step;
    Course course;
    for (std::size_t k = 0; k < 3; ++k) {
      // Hermite's form: v + s (a + s (b + s c)).
      const double rise = values_[i + 1][k] - values_[i][k];
      const double a = step * slopes_[i][k], last = step * slopes_[i + 1][k];
      const double b = 3.0 * rise - 2.0 * a - last, c = a + last - 2.0 * rise;
      course.value[k] = values_[i][k] + s * (a + s * (b + s * c));
      course.first[k] = (a + s * (2.0 * b + 3.0 * s * c)) / step;
      course.second[k] = (2.0 * b + 6.0 * s * c) / (step * step);
    }
    return course;
  }

 private:
  /// Slopes for which the second derivative is continuous: a tridiagonal system.
  void solve(std::size_t k) {
    const std::size_t last = times_.size() - 1;
    std::vector<double> ratio(times_.size());
    for (std::size_t i = 1; i < last; ++i) {
      const double before = 1.0 / (times_[i] - times_[i - 1]), after = 1.0 / (times_[i + 1] - times_[i]);
      const double source = 3.0 * ((values_[i][k] - values_[i - 1][k]) * before * before +
                                   (values_[i + 1][k] - values_[i][k]) * after * after);
      const double pivot = 2.0 * (before + after) - before * ratio[i - 1];
      ratio[i] = after / pivot;
      slopes_[i][k] = (source - before * slopes_[i - 1][k]) / pivot;
    }
    for (std::size_t i = last; i-- > 1;) slopes_[i][k] -= ratio[i] * slopes_[i + 1][k];
  }

  std::vector<double> times_;
  std::vector<Course::Values> values_;
  std::vector<Course::Values> slopes_;
};

}  // namespace

Motion<2> steady_motion(const MotionFrame& frame, const Vector<2>& velocity, double spin) {
  return motion_by(frame, [=](double time) {
    return Course{.value = {velocity[0] * time, velocity[1] * time, spin * time},
                  .first = {velocity[0], velocity[1], spin}};
  });
}

Motion<2> harmonic_motion(const MotionFrame& frame, const Oscillation& oscillation) {
  return motion_by(frame, [=](double time) {
    const double rate = 2.0 * std::numbers::pi * oscillation.frequency;
    const double sine = std::sin(rate * time + oscillation.phase), cosine = std::cos(rate * time + oscillation.phase);
    double rise = 1.0, slope = 0.0, bend = 0.0;
    if (time < oscillation.ramp) {
      const double x = time / oscillation.ramp;
      rise = x * x * x * (10.0 + x * (6.0 * x - 15.0));
      slope = 30.0 * x * x * (1.0 - x) * (1.0 - x) / oscillation.ramp;
      bend = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (oscillation.ramp * oscillation.ramp);
    }
    const double value = rise * sine;
    const double first = slope * sine + rise * rate * cosine;
    const double second = bend * sine + 2.0 * slope * rate * cosine - rise * rate * rate * sine;
    const auto scaled = [&](double factor) {
      return Course::Values{factor * oscillation.amplitude[0], factor * oscillation.amplitude[1],
                            factor * oscillation.angle};
    };
    return Course{.value = scaled(value), .first = scaled(first), .second = scaled(second)};
  });
}

Motion<2> table_motion(const MotionFrame& frame, const std::vector<MotionPoint>& points) {
  const auto spline = std::make_shared<const Spline>(points);
  return motion_by(frame, [spline](double time) { return (*spline)(time); });
}

}  // namespace impinge
