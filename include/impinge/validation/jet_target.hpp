#pragma once
// What the jet of a case meets, found from its inlets, walls and outlets.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "impinge/cases/case.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

enum class TargetType {
  plate,     ///< a straight wall that is long enough for the analytic jet
  wedge,     ///< two straight faces that split the jet into halves; also a groove, and a short plate across the jet
  cup,       ///< any other wall that turns both halves of the jet alike
  jet,       ///< an equal jet that comes the other way
  flat_wall  ///< in three dimensions: a flat wall that a round jet meets
};
constexpr auto words(TargetType) {
  return std::to_array<std::string_view>({"plate", "wedge", "cup", "jet", "flat_wall"});
}

/// A frame at rest; its axes may be a left-handed pair.
struct JetFrame {
  Vector<2> origin{};  ///< [m]
  Vector<2> x{{1.0, 0.0}}, y{{0.0, 1.0}};

  Vector<2> of_direction(const Vector<2>& v) const { return {{dot(v, x), dot(v, y)}}; }
  Vector<2> of_position(const Vector<2>& r) const { return of_direction(r - origin); }
};

/// A flat wall in three dimensions, and the jet on it.
struct SpacePlate {
  /// A wall particle, in the frame of the wall [m].
  struct Point {
    double x, y;
    double area;  ///< of wall that it stands for [m^2]
  };

  /// The stagnation point of the analytic jet [m]; of an oblique round jet that of film_law, R cot a off the foot of
  /// the jet's axis.
  Vector<3> origin;
  Vector<3> x, y;      ///< unit vectors along the wall: towards the thick sheet, across the incline [-]
  Vector<3> z;         ///< into the fluid [-]
  double depth = 0.0;  ///< of a slot jet, along y [m]; 0 of a round jet
  double reach = 0.0;  ///< radius of the largest disc around the origin that the wall holds [m]
  /// What of a round jet's force lies beyond the wall's ends, where the film of film_law sinks on and presses with
  /// rho U^2 (h/r)^2: over rho U^2 A [-], and its moment along x about the origin over rho U^2 A [m].
  double force_beyond = 0.0, moment_beyond = 0.0;
  std::unordered_map<std::int64_t, Point> points{};  ///< by the ids of the wall particles

  Vector<3> of_direction(const Vector<3>& v) const { return {{dot(v, x), dot(v, y), dot(v, z)}}; }
  Vector<3> of_position(const Vector<3>& r) const { return of_direction(r - origin); }
};

struct JetTarget {
  /// A wall particle on the target.
  struct Point {
    double x;       ///< along the wall from the stagnation point [m]; on the second half of a wedge or cup negative
    double length;  ///< of wall that it stands for [m]
    double share;   ///< of its pressure force that counts: all on a plate, else the part along the jet [-]
  };

  /// The last straight stretch of a wall, which a sheet leaves along.
  struct Sheet {
    JetFrame frame;  ///< x along the flow, y into the fluid
    double length;   ///< [m]
  };

  TargetType type = TargetType::plate;
  double width = 0.0, speed = 0.0, density = 0.0;  ///< of the jet: H or diameter D [m], U [m/s], [kg/m^3]
  double spacing = 0.0;                            ///< dp [m]
  double distance = 0.0;                           ///< from the inlet along its axis [m]
  /// Angle [rad] between the jet and a wall (of two jets 90 degrees), half-angle of a wedge, turn of a cup.
  double angle = 0.0;
  /// That of the AnalyticJet where the target is a plate or a jet: plate y = 0, thick sheet to +x. Else at the edge or
  /// the bottom with x along the jet. Of no use in three dimensions.
  JetFrame frame{};
  double begin = 0.0, end = 0.0;  ///< of the wall, or of the plane between two jets, up to the outlets, as Point::x [m]
  /// By the ids of the wall particles; without: each wall particle, at its x, for a length of dp.
  std::optional<std::unordered_map<std::int64_t, Point>> points;
  std::vector<Sheet> sheets;          ///< of a wedge or a cup; none where a sheet does not leave along a straight wall
  std::optional<SpacePlate> space{};  ///< in three dimensions

  /// The area of the plane that a particle of a plane jet stands for [m^2]: of two folded halves each has half, and in
  /// a slot the particles stand behind each other.
  double particle_area() const;

  /// The point of a wall particle, in the particle's or the jet's frame; nothing for one of another wall.
  std::optional<Point> point_of(const Particles<2>& particles, std::size_t i) const;
};

/// The target of a jet, or of the inlets of a scene; in three dimensions see space_target. A plate is long enough where
/// the analytic pressure at its ends, or where the outlets begin, is below a hundredth of rho U^2 / 2. Walls in line
/// with each other are one. Throws InputError where there is no target that is measured.
JetTarget jet_target(const Case& config);

/// The particles in the frame of a plate or of two jets; without halo. Between two jets both halves are folded onto
/// y > 0, and wall particles dp apart on the plane between them have the pressure that a FluidFit gives there.
Particles<2> in_frame(const JetTarget& target, const Particles<2>& particles);

/// The point near `start` where the fluid is at rest, by a linear fit of the velocity within a radius [m]; nothing
/// where there is none within the radius of `start`.
std::optional<Vector<2>> stagnation_point(const Particles<2>& particles, const Vector<2>& start, double radius);

}  // namespace impinge
