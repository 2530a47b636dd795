#pragma once
// Where the walls of a scene leave room for fluid.

#include <vector>

#include "impinge/boundaries/wall.hpp"

namespace impinge {

/// The outline in the wall's place at a time [s].
Outline outline_at(const Wall<2>& wall, double time);

/// The space between walls, at one time.
template <int Dim>
class WetSpace {
 public:
  /// `spacing`: dp [m].
  WetSpace(const std::vector<Wall<Dim>>& walls, double time, double spacing);

  /// False nearer to a wall than `margin` [m], inside a closed wall that is dry there, outside all that are wet inside
  /// only, and close behind an open surface that is dry there. `margin` is at most the reach of such a one, 3 dp.
  bool contains(const Vector<Dim>& point, double margin = 0.0) const;

  /// Distance to the nearest wall, negative in the dry [m]; exact within 3 dp of a wall, and at least that much beyond.
  double depth(const Vector<Dim>& point) const;

 private:
  struct Part {
    std::shared_ptr<const Surface<Dim>> surface;
    Pose<Dim> pose;
    bool wet_front, wet_back;
  };
  bool is_far(const Part& part, const Vector<Dim>& at_rest) const;
  bool is_behind(const Part& line, const Vector<Dim>& at_rest) const;

  std::vector<Part> parts_;
  double reach_;  // of an open surface: farther behind it there may be fluid [m]
};

}  // namespace impinge
