#pragma once
// What a run measures besides its history: [[probe]], [[gauge]] and [[section]] of a case file. SI units.

#include <string>
#include <vector>

#include "impinge/boundaries/scene.hpp"
#include "impinge/config/key.hpp"

namespace impinge {

/// One table of [[probe]]: pressure and velocity at a point, or their means over the face of a sensor.
struct ProbeSettings {
  std::string name{};
  std::string wall = "none";  ///< that it rides on; "none": it is fixed in space
  Numbers position{};         ///< of a riding one where the wall's pose is the identity [m]
  double diameter = 0.0;      ///< of the face [m]; 0: a point
  Numbers normal{};           ///< of the face of a fixed one
};

/// One table of [[gauge]]: the water level along a line.
struct GaugeSettings {
  std::string name{};
  Numbers point{};      ///< where the line begins [m]
  Numbers direction{};  ///< of any length but 0
  double length = 0.0;  ///< [m]
};

/// One table of [[section]]: the discharge through a line, in three dimensions through a parallelogram.
struct SectionSettings {
  std::string name{};
  Numbers begin{}, end{};  ///< of the line, or of one side [m]
  Numbers side{};          ///< the other side, as a vector from either end; in two dimensions 0 [m]
};

/// The ends of a section's line, or the corners of its parallelogram in order [m].
template <int Dim>
std::vector<Vector<Dim>> corners_of(const SectionSettings& section) {
  std::vector<Vector<Dim>> corners{vector_of<Dim>(section.begin), vector_of<Dim>(section.end)};
  if constexpr (Dim == 3)
    for (const Numbers& end : {section.end, section.begin})
      corners.push_back(vector_of<Dim>(end) + vector_of<Dim>(section.side));
  return corners;
}

/// The part of a case that says what is measured, and when rows are written.
struct ObserverSettings {
  std::vector<ProbeSettings> probes;
  std::vector<GaugeSettings> gauges;
  std::vector<SectionSettings> sections;
  struct {
    double interval = 0.0;  ///< time from one row to the next [s]; 0: none by time
    int steps = 1;          ///< steps from one row to the next; 0: none by steps
  } sampling;

  bool observes() const { return !probes.empty() || !gauges.empty() || !sections.empty(); }
};

/// Declares [[probe]], [[gauge]], [[section]], output.sample_interval and output.sample_steps.
void declare_observers(Keys& keys, ObserverSettings& settings);

/// Sets names, directions and the steps between rows that are not given. `dimension`: of space.
void derive_observers(const Keys& keys, int dimension, ObserverSettings& settings);

/// Notes names that are used twice or do not fit into the header of a table, and lines and faces without a length or a
/// direction. The keys of `dimension` are usable.
void check_observers(Keys& keys, int dimension, const ObserverSettings& settings);

/// Notes what does not fit into the scene: probes and lines outside its bounds, probes inside a wall, riding probes off
/// their wall or on one that does not exist. `spacing`: dp [m].
template <int Dim>
void check_observers_in(Keys& keys, const Scene<Dim>& scene, double spacing, const ObserverSettings& settings);

}  // namespace impinge
