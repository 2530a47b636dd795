#pragma once
// The pressure of a step, and what it does to the velocities; docs/method.md (10), (12) to (17).

#include <optional>
#include <span>
#include <vector>

#include "impinge/method/body_force.hpp"
#include "impinge/method/pressure/solver.hpp"
#include "impinge/method/pressure/two_level.hpp"
#include "impinge/method/settings.hpp"
#include "impinge/method/state.hpp"
#include "impinge/method/surface.hpp"
#include "impinge/method/surface_layer.hpp"

namespace impinge {

/// Makes the velocity u* of a step divergence-free: lap p = (1 - gamma) rho/dt div u* - gamma rho/dt^2 crowding (paper
/// eq. 8), then u = u* - dt/rho grad p. Where particles move on by u after that, the divergence is what it will be
/// then, div u - after (grad u):(grad u)^T. Every function that is not const is collective.
template <int Dim>
class Projection {
 public:
  Projection(MPI_Comm comm, const MethodSettings& settings, const CellGrid<Dim>& cells);

  /// What a step's sources depend on besides the particles.
  struct Step {
    double dt;          ///< [s]
    double after;       ///< time that particles move with the new velocity from their places now [s]
    double speed;       ///< that the rate at which density errors are corrected refers to [m/s]
    double fall_speed;  ///< sqrt(|g| dp), g the apparent body force [m/s]
  };

  /// Solves for the pressures of all particles. A solve that fails is repeated from zero with a new preconditioner;
  /// `cold_solves` counts these. The report of a second failure says why.
  PressureReport solve(const Step& step, const BodyForce<Dim>& force, State<Dim>& state, int last_iterations,
                       int& cold_solves);

  /// -dt/rho grad p of the owned fluid particles [m/s]. `fall_speed`: see Step [m/s]. Not collective.
  std::vector<Vector<Dim>> velocity_change(double dt, double fall_speed, const State<Dim>& state) const;

  /// Makes the next solve a cold one: it starts from zero and with a new coarse matrix. Not collective.
  void forget(Particles<Dim>& particles);

  const PressureSolver& solver() const { return solver_; }

  /// The preconditioner, unless the options chose another.
  std::optional<TwoLevelPreconditioner<Dim>>& two_level() { return two_level_; }
  const std::optional<TwoLevelPreconditioner<Dim>>& two_level() const { return two_level_; }

  /// Sums of the near radius on the full lattice.
  const LatticeSums& lattice() const { return near_sums_; }

  /// 2 Dim/(n0 lambda) of the Laplacian [1/m^2].
  double laplacian_factor() const { return laplacian_factor_; }

  /// Gives the preconditioner the owners of the cells where they are new to it.
  void follow_partition(const Decomposition<Dim>& decomposition);

  /// See Simulation.
  std::span<const double> layer() const { return layer_; }

  /// Memory of matrix and preconditioner [bytes].
  std::size_t bytes() const;

 private:
  void find_layer(const State<Dim>& state);
  void find_image_offsets(const Step& step, const BodyForce<Dim>& force, State<Dim>& state);
  std::vector<double> sources(const Step& step, const BodyForce<Dim>& force, State<Dim>& state);
  Matrix<Dim> slope_of_velocity(const State<Dim>& state, int i) const;
  double depth(const State<Dim>& state, std::span<const int> around, int i) const;
  double relative_packing(const State<Dim>& state, int i) const;
  std::vector<double> crowding(const State<Dim>& state) const;
  void smooth(const State<Dim>& state, std::vector<double>& field) const;
  PressureEquation::Row row(const State<Dim>& state, int i, const PairRow& far) const;
  PressureReport try_solve(std::span<const double> source, State<Dim>& state, int last_iterations);
  void limit_suction(double fall_speed, State<Dim>& state) const;
  bool meets_air(const State<Dim>& state, int i) const;
  bool sees_images(const State<Dim>& state, int i) const;
  void share_pressure(State<Dim>& state) const;
  Vector<Dim> gradient(const State<Dim>& state, double fall_speed, int i) const;
  double calm(const State<Dim>& state, double fall_speed, int i) const;
  double disorder_around(const State<Dim>& state, double fall_speed, int i) const;

  const MethodSettings& settings_;
  LatticeSums near_sums_;    // of the number density's radius
  LatticeSums far_sums_;     // of the Laplacian's radius
  double laplacian_factor_;  // [1/m^2]
  SurfaceClosure<Dim> closure_;
  SurfaceLayer<Dim> surface_layer_;
  PressureSolver solver_;
  std::optional<TwoLevelPreconditioner<Dim>> two_level_;
  int partitions_seen_ = 0;           // by two_level_
  std::vector<double> layer_;         // depth of surface particles, also of halo and images [dp]
  std::vector<double> curvature_;     // lap p of a flow that keeps free of divergence [Pa/m^2]; 0 where no part of it
  std::vector<double> image_offset_;  // of an image's pressure over that of its original [Pa]; empty: none
};

}  // namespace impinge
