#pragma once
// A run of the method, step by step.

#include <limits>
#include <span>
#include <vector>

#include "impinge/boundaries/scene.hpp"
#include "impinge/method/body_force.hpp"
#include "impinge/method/checkpoint.hpp"
#include "impinge/method/motion.hpp"
#include "impinge/method/phase.hpp"
#include "impinge/method/pressure/projection.hpp"
#include "impinge/method/settings.hpp"
#include "impinge/method/state.hpp"
#include "impinge/method/step_report.hpp"
#include "impinge/method/totals.hpp"

namespace impinge {

/// The MPS method on the particles of all ranks. Every public function that is not const is collective, and so is
/// imbalance().
template <int Dim>
class Simulation {
 public:
  /// Creates, partitions and sorts the initial particles, or those of a checkpoint, which go on as those of the
  /// simulation that it was taken from would: bitwise on the same number of ranks. Number density and free surface are
  /// measured. Throws SolveError where particles lie outside the bounds, FileError where the checkpoint does not fit
  /// the case.
  Simulation(MPI_Comm comm, const MethodSettings& settings, Scene<Dim> scene,
             const Checkpoint<Dim>* checkpoint = nullptr);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Advances by one time step. The last steps before `target` [s] are shortened so that one ends exactly there. A
  /// pressure solve that fails is repeated from zero with a new preconditioner, then the
  /// step with half its dt, at most four times. Throws SolveError; particles() then hold the state of the phase that
  /// failed.
  void step(double target = std::numeric_limits<double>::infinity());

  /// All that the next step depends on.
  Checkpoint<Dim> checkpoint() const;

  /// Makes the next pressure solve a cold one: it starts from zero and with a new coarse matrix.
  void forget_pressure() { projection_.forget(state_.particles); }

  /// Particles; number density and free surface are those the last pressure was solved with.
  const Particles<Dim>& particles() const { return state_.particles; }
  const StepReport& report() const { return report_; }
  const PressureSolver& pressure_solver() const { return projection_.solver(); }

  /// Time span over which the wall pressure has been averaged so far.
  const AveragingWindow& window() const { return window_; }

  /// How deep the last pressure took surface particles to be below the surface, others half a spacing; owned ones first
  /// [dp]. Empty before the first step.
  std::span<const double> surface_depth() const { return projection_.layer(); }

  /// Outlets, each with the fluid that has left through it if it is a region.
  const std::vector<Outlet<Dim>>& outlets() const { return scene_.outlets; }

  /// Memory of particles, pair lists and matrix on this rank [bytes].
  std::size_t bytes() const;

  /// Who owns which particle.
  const Decomposition<Dim>& decomposition() const { return state_.decomposition; }

  /// Largest over mean work of the ranks.
  double imbalance() const { return state_.decomposition.imbalance(state_.particles); }

 private:
  void settle();
  void try_step(double target);
  void pass_boundaries();
  void move_walls(double time, double velocity_time);
  void place_wall_points(double time);
  bool is_wall_point(std::size_t i) const {
    return state_.particles.type[i] == ParticleType::wall && !scene_.walls.empty();
  }
  Vector<Dim> wall_point_at(std::int64_t id, double time) const;
  /// Largest values at the start of a step.
  struct Flow {
    double speed;          ///< of the fluid [m/s]
    double passing_speed;  ///< likewise, and of the walls until the step ends [m/s]
    double pull;           ///< body force per mass [m/s^2]
  };
  Flow measure_flow() const;
  void redistribute();
  void migrate();
  void count_strays(const Strays& strays);
  void find_neighbours();
  void solve_pressure(const MotionRule& rule, const BodyForce<Dim>& force, double speed, double fall_speed);
  void correct(const MotionRule& rule, double flow_speed, double fall_speed);
  void measure_totals();

  void save(Checkpoint<Dim>& state) const;
  void restore(const Checkpoint<Dim>& state);
  /// When the walls stood where the last search saw them, and when they had the velocities that it saw [s].
  struct WallTimes {
    double place = 0.0;
    double velocity = 0.0;
  };
  template <class Use>
  static void for_numbers(StepReport& report, AveragingWindow& window, std::vector<Inlet<Dim>>& inlets,
                          std::vector<Outlet<Dim>>& outlets, std::int64_t& next_id, WallTimes& wall_times, Use&& use);

  [[noreturn]] void fail(Phase phase, const std::string& reason) const;

  MPI_Comm comm_;
  MethodSettings settings_;
  Scene<Dim> scene_;  // its inlets move, its outlets count
  State<Dim> state_;
  Projection<Dim> projection_;
  DampingZones<Dim> damping_;
  StepReport report_;
  AveragingWindow window_;
  WallTimes wall_times_;
  Checkpoint<Dim> step_start_;  // without owners and coarse matrix
};

}  // namespace impinge
