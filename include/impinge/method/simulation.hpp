#pragma once
// The state of a run and one time step.

#include <array>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "impinge/method/checkpoint.hpp"
#include "impinge/method/pressure/solver.hpp"
#include "impinge/method/pressure/two_level.hpp"
#include "impinge/method/surface.hpp"
#include "impinge/parallel/decomposition.hpp"
#include "impinge/particles/neighbours.hpp"
#include "impinge/programs/case.hpp"
#include "impinge/scenes/scene.hpp"

namespace impinge {

/// A step that could not be completed: divergence of the flow or of the linear solver. Thrown by all ranks. Exit 3.
class SolveError : public std::runtime_error {
 public:
  SolveError(std::int64_t step, std::string phase, const std::string& reason);
  std::int64_t step() const { return step_; }
  const std::string& phase() const { return phase_; }

 private:
  std::int64_t step_;
  std::string phase_;
};

/// The phases of a step: stages in PETSc's -log_view.
inline constexpr std::array phase_names{"Predict",    "Redistribute", "Neighbours", "Density",    "PPE assembly",
                                        "PPE set-up", "PPE solve",    "Correct",    "Stocktaking"};

/// What bounds the time step.
enum class StepLimit { case_dt, cfl, growth, retry };
inline constexpr std::array step_limit_names{"case", "CFL", "growth", "retry"};

/// Totals over all ranks after a step.
struct StepReport {
  std::int64_t step = 0;
  double time = 0.0;                     ///< [s]
  double dt = 0.0;                       ///< [s]
  StepLimit limit = StepLimit::case_dt;  ///< what dt was bounded by
  std::int64_t particles = 0;            ///< of every type
  std::int64_t fluid = 0;                ///< stored
  std::int64_t in = 0;                   ///< fluid at the start and through the inlet since
  std::int64_t out = 0;                  ///< fluid through the outlets
  std::int64_t lost = 0;                 ///< outside the background grid
  double kinetic_energy = 0.0;           ///< of the fluid [J; J/m in 2D]
  double max_speed = 0.0;                ///< of the fluid [m/s]
  double max_pressure = 0.0;             ///< [Pa]
  double floor_force = 0.0;              ///< pressure force on plate or floor [N; N/m in 2D]
  PressureReport pressure;
  int cold_solves = 0;  ///< pressure solves of the step that were repeated from zero with a new preconditioner
  int halvings = 0;     ///< how often the step was repeated with half the time step
};

/// What a run takes for each of its items: sizes of the arrays and messages, rows as on the full lattice.
struct UnitCosts {
  double particle_memory;  ///< of an owned or halo particle [bytes]
  double row_memory;       ///< of a row of pairs, matrix and interpolation on top of its particle [bytes]
  double cell_memory;      ///< of a background cell, on every rank [bytes]
  double halo_traffic;     ///< sent per halo particle and step, but for the iterations of the solver [bytes]
};

/// Least edge of a run's background cells [m]: the Laplacian's radius.
double cell_reach(const Case& config);

/// The MPS method on the particles of all ranks. Every public function that is not const is collective.
template <int Dim>
class Simulation {
 public:
  /// Creates, partitions and sorts the initial particles, or those of a checkpoint, which go on as those of the
  /// simulation that it was taken from would: bitwise on the same number of ranks. Number density and free surface are
  /// measured. Throws SolveError where particles lie outside the background grid, FileError where the checkpoint does
  /// not fit the case.
  Simulation(MPI_Comm comm, const Case& config, const Checkpoint<Dim>* checkpoint = nullptr);

  /// Advances by one time step. A pressure solve that fails is repeated from zero with a new preconditioner, then the
  /// step with half its dt, at most four times. Throws SolveError; particles() then hold the state of the phase that
  /// failed.
  void step();

  /// All that the next step depends on.
  Checkpoint<Dim> checkpoint() const;

  /// Makes the next pressure solve a cold one: it starts from zero and with a new coarse matrix.
  void forget_pressure();

  /// Particles; number density and free surface are those the last pressure was solved with.
  const Particles<Dim>& particles() const { return particles_; }
  const StepReport& report() const { return report_; }
  const PressureSolver& pressure_solver() const { return pressure_solver_; }

  /// Time span over which the wall pressure has been averaged so far [s].
  double window_begin() const { return window_begin_; }
  double window_end() const { return window_end_; }

  /// Memory of particles, pair lists and matrix on this rank [bytes].
  std::size_t bytes() const;

  /// Touches nothing; not collective.
  static UnitCosts unit_costs(const Case& config);

  /// Who owns which particle.
  const Decomposition<Dim>& domain() const { return decomposition_; }

  /// Largest over mean work of the ranks.
  double imbalance() const { return decomposition_.imbalance(particles_); }

 private:
  void try_step();
  void save(Checkpoint<Dim>& state) const;
  void restore(const Checkpoint<Dim>& state);
  template <class Use>
  static void for_numbers(StepReport& report, double& window_begin, double& window_end, InletState& inlet, Use&& use);

  void choose_time_step();
  void accelerate();
  void collide();
  void advance();
  void move_boundaries();
  void redistribute();
  void migrate();
  void find_neighbours();
  void measure_density();
  void solve_pressure();
  void try_pressure();
  void correct();
  void shift();
  void take_stock();

  void hold_to_walls();
  double surface_weight(int i, const PairRow& far) const;
  void weigh_images();
  void find_sources();
  void share_wall_pressure();
  double crowding(int i) const;
  double base_pressure(int i) const;
  double least_speed() const;
  double moving_share() const;
  bool is_splash(std::size_t i) const;

  [[noreturn]] void fail(const char* phase, const std::string& reason) const;

  MPI_Comm comm_;
  Case config_;
  LatticeSums near_sums_;    // of the number density's radius
  LatticeSums far_sums_;     // of the Laplacian's radius
  double laplacian_factor_;  // 2 Dim/(n0 lambda) [1/m^2]
  Vector<Dim> gravity_;
  std::unique_ptr<Geometry<Dim>> geometry_;
  Decomposition<Dim> decomposition_;
  NeighbourSearch<Dim> search_;
  PressureSolver pressure_solver_;
  std::optional<TwoLevelPreconditioner<Dim>> two_level_;  // if the options chose no other preconditioner
  int partitions_seen_ = 0;                               // by two_level_
  Particles<Dim> particles_;
  Checkpoint<Dim> step_start_;  // without owners and coarse matrix
  StepReport report_;
  double window_begin_ = 0.0;
  double window_end_ = 0.0;
  SurfaceClosure<Dim> closure_;           // of a particle's Laplacian
  std::vector<Vector<Dim>> wall_normal_;  // zero but at wall particles
  std::vector<Vector<Dim>> asymmetry_;    // F_i; owned and halo
  std::vector<Matrix<Dim>> correction_;   // L_i, owned
  std::vector<PressureRole> role_;
  std::vector<double> image_pressure_;  // of a halo particle over that of its original [Pa]; empty: none
  std::vector<double> surface_weight_;  // empty: p = 0 at the surface particles
  std::vector<double> source_;
  std::vector<Vector<Dim>> velocity_change_;
  std::vector<Vector<Dim>> displacement_;  // by the correction
};

}  // namespace impinge
