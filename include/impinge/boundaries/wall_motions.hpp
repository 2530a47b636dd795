#pragma once
// Where the bodies of the walls are, and how they move.

#include <algorithm>
#include <memory>
#include <vector>

#include "impinge/boundaries/motion.hpp"

namespace impinge {

/// The motions of a scene's walls, each a number; -1 is that of walls at rest.
template <int Dim>
class WallMotions {
 public:
  /// The number of a wall's motion; walls that share it have the same.
  int add(const std::shared_ptr<const Motion<Dim>>& motion) {
    if (!motion) return -1;
    const auto found = std::ranges::find(motions_, motion);
    const auto number = static_cast<int>(found - motions_.begin());
    if (found == motions_.end()) {
      motions_.push_back(motion);
      pose_.emplace_back();
      old_pose_.emplace_back();
      velocity_pose_.emplace_back();
    }
    return number;
  }

  bool empty() const { return motions_.empty(); }
  int count() const { return static_cast<int>(motions_.size()); }
  const std::shared_ptr<const Motion<Dim>>& motion(int number) const { return motions_[at(number)]; }

  /// Moves the bodies to where they are at a time [s]. Their velocity is that at another time.
  void move_to(double time, double velocity_time) {
    old_pose_ = pose_;
    for (std::size_t m = 0; m < motions_.size(); ++m) {
      pose_[m] = (*motions_[m])(time);
      velocity_pose_[m] = (*motions_[m])(velocity_time);
    }
  }

  const Pose<Dim>& pose(int number) const { return pose_[at(number)]; }

  /// Of the body's material at a position [m/s], [m/s^2].
  Vector<Dim> velocity(int number, const Vector<Dim>& x) const {
    return number < 0 ? Vector<Dim>{} : velocity_pose_[at(number)].velocity_at(x);
  }
  Vector<Dim> acceleration(int number, const Vector<Dim>& x) const {
    return number < 0 ? Vector<Dim>{} : pose_[at(number)].acceleration_at(x);
  }
  /// Omega x a velocity, with the body's rate of turning [m/s^2].
  Vector<Dim> turning(int number, const Vector<Dim>& velocity) const {
    return number < 0 ? Vector<Dim>{} : pose_[at(number)].spin * velocity;
  }

  /// A position in the frame of the body, where its pose is the identity [m].
  Vector<Dim> at_rest(int number, const Vector<Dim>& x) const {
    return number < 0 ? x : pose_[at(number)].origin_of(x);
  }
  Vector<Dim> in_place(int number, const Vector<Dim>& x) const {
    return number < 0 ? x : pose_[at(number)].of_position(x);
  }
  Vector<Dim> turned(int number, const Vector<Dim>& a) const {
    return number < 0 ? a : pose_[at(number)].of_direction(a);
  }
  /// Where a position would be, had it moved with the body since the time before the last move [m].
  Vector<Dim> moved_along(int number, const Vector<Dim>& x) const {
    return number < 0 ? x : pose_[at(number)].of_position(old_pose_[at(number)].origin_of(x));
  }

 private:
  static std::size_t at(int number) { return static_cast<std::size_t>(number); }

  std::vector<std::shared_ptr<const Motion<Dim>>> motions_;
  std::vector<Pose<Dim>> pose_, old_pose_, velocity_pose_;
};

}  // namespace impinge
