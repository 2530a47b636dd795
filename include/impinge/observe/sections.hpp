#pragma once
// Discharge through lines, in three dimensions through parallelograms.

#include <mpi.h>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "impinge/observe/place.hpp"
#include "impinge/observe/settings.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

/// Counts the fluid and inlet particles that cross each line or parallelogram. From the left to the right of the way
/// from its begin to its end is positive, in three dimensions the direction of that way x side. A particle that comes
/// back is taken off again, so that a total is the volume that is beyond.
template <int Dim>
class Sections {
 public:
  /// The particles as they are before the first step that counts, at a time [s]. `spacing`: dp [m]. Collective.
  Sections(MPI_Comm comm, const std::vector<SectionSettings>& settings, const Scene<Dim>& scene, double spacing,
           const Particles<Dim>& particles, double time);

  bool empty() const { return sections_.empty(); }

  /// Names and units of the values.
  std::vector<std::string> columns() const;

  /// Takes the totals of a table's last row, a value per column, and its time [s] as the one that the next discharge
  /// begins at.
  void go_on(double time, const std::vector<double>& values);

  /// Counts what has crossed since the last call, whichever ranks the particles were on. To be called after each step.
  /// Collective.
  void count(const Particles<Dim>& particles);

  /// Discharge since the last call [m^Dim/s] and total [m^Dim] of each section, the same on all ranks. Collective.
  std::vector<double> measure(double time);

 private:
  struct Section {
    std::string name;
    Vector<Dim> middle, across;                  // across: a unit vector
    std::array<Vector<Dim>, Dim - 1> inverse{};  // places along the sides, from -1/2 to 1/2, per offset [1/m]
    std::int64_t crossings = 0;                  // of this rank since the last measure
    std::int64_t total = 0;                      // of all ranks before
  };
  struct Place {
    std::int64_t id;
    Vector<Dim> position;
  };

  double volume() const;  // of a particle
  bool is_near(const Vector<Dim>& position, double width) const;
  void remember(const Particles<Dim>& particles);

  MPI_Comm comm_;
  double spacing_;
  Offsets<Dim> offsets_;
  std::vector<Section> sections_;
  double since_;                                            // time of the last measure [s]
  std::unordered_map<std::int64_t, Vector<Dim>> position_;  // of this rank's particles near a section, by id
};

}  // namespace impinge
