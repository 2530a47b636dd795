#pragma once
// All that a run measures into tables of its own: probes, gauges, sections, forces on walls, counts of outlets.

#include <mpi.h>

#include <span>
#include <string>
#include <vector>

#include "impinge/method/step_report.hpp"
#include "impinge/observe/gauges.hpp"
#include "impinge/observe/outlet_counts.hpp"
#include "impinge/observe/probes.hpp"
#include "impinge/observe/sections.hpp"
#include "impinge/observe/wall_forces.hpp"

namespace impinge {

/// A table's kind, the end of its file's name, with its header or one of its rows.
struct TableLine {
  std::string kind;  ///< "probes"
  std::string text;
};

template <int Dim>
class Observers {
 public:
  /// What there is after a step.
  struct Now {
    const Particles<Dim>& particles;
    std::span<const double> surface_depth;    ///< see Simulation
    const std::vector<Outlet<Dim>>& outlets;  ///< as they have counted
    const StepReport& report;
  };

  /// `scene`: as at the start. `particles`, `report`: as the run begins or goes on. Collective.
  Observers(MPI_Comm comm, const ObserverSettings& settings, const MethodSettings& method, const Scene<Dim>& scene,
            const Particles<Dim>& particles, const StepReport& report);

  /// The tables that have columns, each with its header.
  std::vector<TableLine> headers() const;

  /// Goes on from the last row of the table of sections, on all ranks; empty: there is none. Throws FileError for a row
  /// that is none of it.
  void go_on(const std::string& last_row);

  /// To be called after each step. Gives the rows that are due, the same on all ranks. Collective.
  std::vector<TableLine> observe(const Now& now);

  /// What a restart needs: the row of the sections after a step that had none. Collective.
  std::vector<TableLine> rows_for_restart(const StepReport& report);

 private:
  bool is_due(const StepReport& report) const;
  std::vector<double> measure_sections(const StepReport& report);
  template <class Self, class Use>
  static void for_tables(Self& self, Use&& use);

  MPI_Comm comm_;
  decltype(ObserverSettings::sampling) sampling_;
  Probes<Dim> probes_;
  Gauges<Dim> gauges_;
  Sections<Dim> sections_;
  WallForces<Dim> forces_;
  OutletCounts<Dim> outlets_;
  double last_time_;        // of the step before [s]
  std::int64_t last_step_;  // of the sections' last row
};

}  // namespace impinge
