#include "impinge/boundaries/prescribed_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

namespace impinge {
namespace {

/// Displacement [m] and angle [rad], with their first and second derivatives in time.
struct Course {
  using Values = std::array<double, 4>;  // the angle is the last
  Values value{}, first{}, second{};

  Course at_rest() const { return {.value = value}; }
};

template <int Dim>
Course::Values values_of(const Vector<Dim>& shift, double angle) {
  Course::Values values{};
  std::copy(shift.component.begin(), shift.component.end(), values.begin());
  values.back() = angle;
  return values;
}

/// The matrix that takes x to rate axis x x [1/s].
template <int Dim>
Matrix<Dim> spin_about(const Vector<3>& axis, double rate) {
  if constexpr (Dim == 2) {
    return {{{{{0.0, -rate}}, {{rate, 0.0}}}}};
  } else {
    const Vector<3> spin = rate * axis;
    return {{{{{0.0, -spin[2], spin[1]}}, {{spin[2], 0.0, -spin[0]}}, {{-spin[1], spin[0], 0.0}}}}};
  }
}

template <int Dim>
Matrix<Dim> turned(const Vector<3>& axis, double angle) {
  const double cosine = std::cos(angle), sine = std::sin(angle);
  Matrix<Dim> result = spin_about<Dim>(axis, sine);
  for (int k = 0; k < Dim; ++k) {
    result.row[static_cast<std::size_t>(k)][k] += cosine;
    if constexpr (Dim == 3) result.row[static_cast<std::size_t>(k)] += (1.0 - cosine) * axis[k] * axis;
  }
  return result;
}

template <int Dim>
Pose<Dim> pose_of(const Course& course, const MotionFrame<Dim>& frame) {
  const auto shift = [](const Course::Values& x) {
    Vector<Dim> result;
    std::copy_n(x.begin(), Dim, result.component.begin());
    return result;
  };
  const double spin = course.first.back();
  Pose<Dim> pose;
  pose.rotation = turned<Dim>(frame.axis, course.value.back());
  pose.spin = spin_about<Dim>(frame.axis, spin);
  // spin' + spin spin, of which the latter is spin^2 (axis axis^T - 1).
  pose.bend = spin_about<Dim>(frame.axis, course.second.back());
  for (int k = 0; k < Dim; ++k) {
    pose.bend.row[static_cast<std::size_t>(k)][k] -= spin * spin;
    if constexpr (Dim == 3) pose.bend.row[static_cast<std::size_t>(k)] += spin * spin * frame.axis[k] * frame.axis;
  }
  const Vector<Dim> moved_center = frame.center + shift(course.value);
  pose.shift = moved_center - pose.rotation * frame.center;
  pose.velocity = shift(course.first) - pose.spin * moved_center;
  pose.acceleration = shift(course.second) - pose.bend * moved_center;
  return pose;
}

/// `course` takes the time since the start.
template <int Dim, class CourseOf>
Motion<Dim> motion_by(const MotionFrame<Dim>& frame, CourseOf course) {
  return [frame, course](double time) {
    if (time < frame.start) return pose_of(course(0.0).at_rest(), frame);
    if (time > frame.end) return pose_of(course(frame.end - frame.start).at_rest(), frame);
    return pose_of(course(time - frame.start), frame);
  };
}

/// A cubic spline with zero slope at its ends, through values at rising times.
class Spline {
 public:
  template <int Dim>
  explicit Spline(const std::vector<MotionPoint<Dim>>& points) {
    for (const MotionPoint<Dim>& point : points) {
      times_.push_back(point.time);
      values_.push_back(values_of(point.shift, point.angle));
    }
    slopes_.resize(times_.size());
    for (std::size_t k = 0; k < Course::Values{}.size(); ++k) solve(k);
  }

  Course operator()(double time) const {
    if (time <= times_.front()) return {.value = values_.front()};
    if (time >= times_.back()) return {.value = values_.back()};
    const auto after = std::ranges::upper_bound(times_, time);
    const auto i = static_cast<std::size_t>(after - times_.begin()) - 1;
    const double step = times_[i + 1] - times_[i], s = (time - times_[i]) / step;
    Course course;
    for (std::size_t k = 0; k < course.value.size(); ++k) {
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

template <int Dim>
Motion<Dim> steady_motion(const MotionFrame<Dim>& frame, const Vector<Dim>& velocity, double spin) {
  return motion_by(frame, [=](double time) {
    return Course{.value = values_of(time * velocity, spin * time), .first = values_of(velocity, spin)};
  });
}

template <int Dim>
Motion<Dim> harmonic_motion(const MotionFrame<Dim>& frame, const Oscillation<Dim>& oscillation) {
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
      return values_of(factor * oscillation.amplitude, factor * oscillation.angle);
    };
    return Course{.value = scaled(value), .first = scaled(first), .second = scaled(second)};
  });
}

template <int Dim>
Motion<Dim> table_motion(const MotionFrame<Dim>& frame, const std::vector<MotionPoint<Dim>>& points) {
  const auto spline = std::make_shared<const Spline>(points);
  return motion_by(frame, [spline](double time) { return (*spline)(time); });
}

#define IMPINGE_INSTANTIATE(Dim)                                                           \
  template Motion<Dim> steady_motion(const MotionFrame<Dim>&, const Vector<Dim>&, double); \
  template Motion<Dim> harmonic_motion(const MotionFrame<Dim>&, const Oscillation<Dim>&);  \
  template Motion<Dim> table_motion(const MotionFrame<Dim>&, const std::vector<MotionPoint<Dim>>&);
IMPINGE_INSTANTIATE(2)
IMPINGE_INSTANTIATE(3)
#undef IMPINGE_INSTANTIATE

}  // namespace impinge
