#pragma once
// Where the walls of a scene leave room for fluid.

#include <vector>

#include "impinge/boundaries/wall.hpp"

namespace impinge {

/// The outline in the wall's place at a time [s].
Outline outline_at(const Wall& wall, double time);

/// The space between walls, at one time.
class WetSpace {
 public:
  /// `spacing`: dp [m].
  WetSpace(const std::vector<Wall>& walls, double time, double spacing);

  /// False nearer to a wall than `margin` [m], inside a closed wall that is dry there, outside all that are wet inside
  /// only, and close behind a line that is dry there. `margin` is at most the reach of a line, 3 dp.
  bool contains(const Vector<2>& point, double margin = 0.0) const;

  /// Distance to the nearest wall, negative in the dry [m]; exact within 3 dp of a wall, and at least that much beyond.
  double depth(const Vector<2>& point) const;

 private:
  struct Part {
    Outline outline;
    bool wet_right, wet_left;
  };
  bool is_behind(const Part& line, const Vector<2>& point) const;

  std::vector<Part> parts_;
  double reach_;  // of a line: farther behind it there may be fluid [m]
};

}  // namespace impinge
