#pragma once
// What a run of the method can be told, besides its scene. SI units; lengths that the method scales are in dp.

#include <algorithm>

#include "impinge/config/key.hpp"
#include "impinge/method/damping.hpp"
#include "impinge/parallel/graph_partition.hpp"
#include "impinge/particles/kernel.hpp"

namespace impinge {

enum class Scheme { consistent, paper };
enum class WallModel { mirror, particles };
enum class Outside { remove, error };

constexpr auto words(Scheme) { return std::to_array<std::string_view>({"consistent", "paper"}); }
constexpr auto words(WallModel) { return std::to_array<std::string_view>({"mirror", "particles"}); }
constexpr auto words(Outside) { return std::to_array<std::string_view>({"remove", "error"}); }

/// An entry of the table of gravity in time.
struct GravityEntry {
  double time = 0.0;  ///< [s]
  Numbers value{};    ///< [m/s^2]
};

struct FluidSettings {
  double density = 1000.0;               ///< [kg/m^3]
  double viscosity = 0.0;                ///< kinematic [m^2/s]
  bool corrected_viscosity = true;       ///< (11a) instead of (11)
  double smagorinsky = 0.0;              ///< C_s of the eddies' viscosity (11b) [dp]; 0: none
  Numbers gravity{};                     ///< [m/s^2]
  std::vector<GravityEntry> gravity_at;  ///< instead of gravity: linear in time between the entries
  double central_force = 0.0;            ///< B of the force per mass -B^2 (r - center) [1/s]
  Numbers force_center{};                ///< its centre [m]
};

/// True where viscosity, of the fluid or of its eddies, acts.
inline bool is_viscous(const FluidSettings& fluid) { return fluid.viscosity > 0.0 || fluid.smagorinsky > 0.0; }

struct ParticleSettings {
  double spacing = 0.0;  ///< dp [m]
};

struct KernelSettings {
  KernelType type = KernelType::non_singular;
  double radius{};            ///< r_e of number density, gradient and divergence [dp]; by scheme
  double laplacian_radius{};  ///< r_e of the Laplacian [dp]; by scheme

  double largest() const { return std::max(radius, laplacian_radius); }
  /// Least edge of the background cells [dp]: no pair reaches over one; 3, since smaller ones cost more than they save.
  double cell_edge() const { return std::max(3.0, largest()); }
};

struct PressureSettings {
  double gamma = 0.01;          ///< weight of the density term in the PPE source, unless density_rate is set
  double density_rate{};        ///< rate at which a density error is corrected [u/dp]; by scheme
  bool corrected_divergence{};  ///< divergence exact on linear velocities; by scheme
  bool packing{};               ///< density errors by the packing around, not by the number density; by scheme
  bool corrected_gradient{};    ///< gradient exact on linear pressures; by scheme
  double tolerance = 1e-6;      ///< relative residual of the PPE solve
  bool clamp_negative = false;  ///< set negative pressures to zero after the solve
};

struct WallSettings {
  WallModel model{};  ///< by scheme
};

struct FreeSurfaceSettings {
  double surface_density = 0.8;    ///< n/n0 below which a particle is free surface
  double interior_density = 0.97;  ///< n/n0 above which it is not
  double asymmetry = 0.9;          ///< between the two: surface if |F| > asymmetry |F|0
  bool zero_outside{};             ///< p = 0 half a spacing outside the surface particles, not at them; by scheme
};

struct CollisionSettings {
  double distance{};         ///< [dp]; 0 switches collisions off; by scheme
  double restitution = 0.2;  ///< [-]
};

struct ShiftingSettings {
  double coefficient{};     ///< displacement over asymmetry and Courant number [dp]; 0: none; by scheme
  double least_distance{};  ///< nearer pairs beside the surface drift apart [dp]; 0: none do; by scheme
  bool correct_velocity{};  ///< take the velocity of the new place; by scheme
};

struct SmoothingSettings {
  double rate{};  ///< at which velocities off the linear field of their neighbours decay [u/dp]; by scheme
};

struct TimeSettings {
  double end = 0.0;        ///< [s]
  double dt = 0.0;         ///< largest step [s]
  double cfl = 0.2;        ///< dt <= cfl dp / |u|max
  bool mean_velocity{};    ///< half a step with the old velocity, half with the new; by scheme
  double max_speed = 0.0;  ///< speed that counts as divergence [m/s]
};

/// The method's part of a case. What is said to be "by scheme" has no value before derive_method.
struct MethodSettings {
  int dimension = 2;
  Scheme scheme = Scheme::consistent;  ///< sets the defaults of what is "by scheme"
  FluidSettings fluid;
  ParticleSettings particles;
  KernelSettings kernel;
  PressureSettings pressure;
  WallSettings walls;
  FreeSurfaceSettings free_surface;
  CollisionSettings collision;
  ShiftingSettings shifting;
  SmoothingSettings smoothing;
  TimeSettings time;
  std::vector<DampingSettings> damping;
  ParallelSettings parallel;
  Outside outside = Outside::remove;  ///< what happens to fluid that leaves the bounds; key domain.outside
  double average_start = 0.0;         ///< start of the wall-pressure average [s]; key output.average_start
};

/// Least edge of a run's background cells [m].
inline double least_cell_edge(const MethodSettings& settings) {
  return settings.kernel.cell_edge() * settings.particles.spacing;
}

/// Declares dimension, scheme and the tables from [fluid] to [time].
void declare_method(Keys& keys, MethodSettings& settings);

/// Sets the defaults that depend on the scheme and on other keys. `reference_speed` is the scene's [m/s]; 0: none.
void derive_method(const Keys& keys, MethodSettings& settings, double reference_speed);

/// Notes where the method's keys contradict each other.
void check_method(Keys& keys, const MethodSettings& settings);

/// Keys without which the consistent scheme does not hold, where a case has switched them off, each with what happens
/// then (docs/notebook/pairs.md has all pairs of keys). The paper's scheme has none.
std::vector<std::string> scheme_warnings(const MethodSettings& settings);

}  // namespace impinge
