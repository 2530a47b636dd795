#include "impinge/method/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "impinge/boundaries/wall.hpp"
#include "impinge/core/errors.hpp"
#include "impinge/core/mpi.hpp"
#include "impinge/method/operators.hpp"

namespace impinge {
namespace {

// Their names are phase_names.
enum Phase {
  predicting,
  redistributing,
  searching,
  measuring,
  assembling,
  preconditioning,
  solving,
  correcting,
  stocktaking
};

PetscLogStage stage(Phase phase) {
  static const auto stages = [] {
    std::array<PetscLogStage, phase_names.size()> all{};
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = LogStage::register_stage(phase_names[k]);
    return all;
  }();
  return stages[phase];
}

constexpr double splash_density = 0.5;  // n/n0 below which a fluid particle is spray: p = 0, no shifting
constexpr double first_courant = 0.05;  // of the first step: an impact may be about to change the speeds
constexpr double most_growth = 1.1;     // of dt from step to step
constexpr double largest_shift = 0.1;   // of a step [dp]
constexpr int most_halvings = 4;        // of dt, where the pressure cannot be solved

bool is_mirrored(const Case& config) { return config.walls.model == WallModel::mirror; }

// Arrays of one entry per particle.
template <int Dim>
constexpr std::size_t particle_bytes = 2 * (sizeof(ParticleRecord<Dim>) + sizeof(double) + sizeof(std::uint8_t)) +
                                       sizeof(PressureRole) + 2 * sizeof(double) + 5 * sizeof(Vector<Dim>) +
                                       sizeof(Matrix<Dim>) + sizeof(PetscInt);

bool moves(ParticleType type) { return type == ParticleType::fluid; }

constexpr const char* pressure_phase = "pressure";

}  // namespace

double cell_reach(const Case& config) { return config.kernel.laplacian_radius * config.particles.spacing; }

SolveError::SolveError(std::int64_t step, std::string phase, const std::string& reason)
    : std::runtime_error(fmt::format("step {}, phase {}: {}", step, phase, reason)),
      step_(step),
      phase_(std::move(phase)) {}

template <int Dim>
Simulation<Dim>::Simulation(MPI_Comm comm, const Case& config, const Checkpoint<Dim>* checkpoint)
    : comm_(comm),
      config_(config),
      near_sums_(lattice_sums<Dim>(config.kernel.type, config.kernel.radius)),
      far_sums_(lattice_sums<Dim>(config.kernel.type, config.kernel.laplacian_radius)),
      laplacian_factor_(2.0 * Dim /
                        (far_sums_.number_density * far_sums_.lambda * std::pow(config.particles.spacing, 2))),
      geometry_(make_geometry<Dim>(config)),
      decomposition_(comm, geometry_->bounds(), geometry_->edges(), cell_reach(config), config.parallel.partitioner),
      search_(decomposition_.sorting_cells(), Decomposition<Dim>::cell_parts, config.kernel.type,
              config.kernel.radius * config.particles.spacing,
              config.kernel.laplacian_radius * config.particles.spacing, is_mirrored(config)),
      pressure_solver_(comm, config.pressure.tolerance),
      closure_(config.kernel.type, config.kernel.laplacian_radius) {
  if (pressure_solver_.is_two_level()) two_level_.emplace(comm, decomposition_.cells());
  for (int k = 0; k < Dim; ++k) gravity_[k] = config.fluid.gravity[static_cast<std::size_t>(k)];
  if (checkpoint) {
    restore(*checkpoint);
    return;
  }
  geometry_->fill(rank_of(comm), ranks_of(comm), particles_);
  decomposition_.partition(particles_);
  redistribute();
  find_neighbours();
  measure_density();
  take_stock();
  report_.in = report_.fluid;
}

template <int Dim>
void Simulation<Dim>::step() {
  save(step_start_);
  report_.cold_solves = 0;
  report_.halvings = 0;
  while (true) {
    try {
      return try_step();
    } catch (const SolveError& error) {
      if (error.phase() != pressure_phase || report_.halvings == most_halvings) throw;
      restore(step_start_);
      ++report_.halvings;
    }
  }
}

template <int Dim>
void Simulation<Dim>::try_step() {
  ++report_.step;
  choose_time_step();
  accelerate();
  collide();
  advance();
  move_boundaries();
  redistribute();
  find_neighbours();
  measure_density();
  solve_pressure();
  correct();
  shift();
  report_.time += report_.dt;
  take_stock();
}

// Calls use(name, number) for all that the next step, or a restarted run, reads of a step.
template <int Dim>
template <class Use>
void Simulation<Dim>::for_numbers(StepReport& report, double& window_begin, double& window_end, InletState& inlet,
                                  Use&& use) {
  use("step", report.step);
  use("time", report.time);
  use("dt", report.dt);
  use("limit", report.limit);
  use("particles", report.particles);
  use("fluid", report.fluid);
  use("in", report.in);
  use("out", report.out);
  use("lost", report.lost);
  use("kinetic_energy", report.kinetic_energy);
  use("max_speed", report.max_speed);
  use("max_pressure", report.max_pressure);
  use("floor_force", report.floor_force);
  use("iterations", report.pressure.iterations);
  use("window_begin", window_begin);
  use("window_end", window_end);
  use("inlet_last_row", inlet.last_row);
  use("inlet_next_id", inlet.next_id);
}

template <int Dim>
void Simulation<Dim>::save(Checkpoint<Dim>& state) const {
  state.particles.copy_owned(particles_);
  state.searched_position.assign(state.particles.position.begin(), state.particles.position.end());
  for (int i = 0; i < particles_.owned; ++i)
    if (moves(particles_.type[static_cast<std::size_t>(i)]) ||
        particles_.type[static_cast<std::size_t>(i)] == ParticleType::inlet)
      state.searched_position[static_cast<std::size_t>(i)] = search_.searched_position(i);
  StepReport report = report_;
  double window_begin = window_begin_;
  double window_end = window_end_;
  InletState inlet = geometry_->inlet();
  for_numbers(report, window_begin, window_end, inlet,
              [&](const char* name, auto number) { state.numbers[name] = static_cast<double>(number); });
}

template <int Dim>
Checkpoint<Dim> Simulation<Dim>::checkpoint() const {
  Checkpoint<Dim> state;
  save(state);
  state.owner.assign(decomposition_.owners().begin(), decomposition_.owners().end());
  state.numbers["achieved_imbalance"] = decomposition_.achieved_imbalance();
  if (two_level_) {
    state.coarse = two_level_->coarse_rows();
    state.numbers["coarse_age"] = two_level_->age();
    state.numbers["coarse_fresh_iterations"] = two_level_->fresh_iterations();
  }
  return state;
}

// The pairs that the next step starts with are those of the places where neighbours were searched last. Collective.
template <int Dim>
void Simulation<Dim>::restore(const Checkpoint<Dim>& state) {
  const auto number = [&](const std::string& name) {
    const auto found = state.numbers.find(name);
    if (found == state.numbers.end()) throw FileError(fmt::format("the checkpoint has no {}", name));
    return found->second;
  };
  InletState inlet;
  for_numbers(report_, window_begin_, window_end_, inlet,
              [&]<class T>(const char* name, T& target) { target = static_cast<T>(number(name)); });
  geometry_->set_inlet(inlet);

  particles_ = state.particles;
  particles_.position = state.searched_position;
  if (!state.owner.empty()) {
    if (state.owner.size() != static_cast<std::size_t>(decomposition_.cells().count()))
      throw FileError(fmt::format("the checkpoint has {} background cells, but the case has {}", state.owner.size(),
                                  decomposition_.cells().count()));
    decomposition_.set_owners(state.owner, number("achieved_imbalance"));
  } else if (decomposition_.owners().empty()) {
    decomposition_.partition(particles_);
  }
  // The positions at the end of the step go the particles' way in the place of velocities.
  Particles<Dim> later = particles_;
  later.velocity = state.particles.position;
  decomposition_.migrate(later);
  migrate();
  find_neighbours();
  measure_density();
  std::copy_n(later.velocity.begin(), particles_.owned, particles_.position.begin());

  if (!two_level_) return;
  if (state.owner.empty() || number("coarse_age") == 0.0) {
    two_level_->expire();
  } else {
    two_level_->set_owners(decomposition_.owners());
    partitions_seen_ = decomposition_.partitions();
    two_level_->set_coarse_rows(state.coarse, static_cast<int>(number("coarse_age")),
                                static_cast<int>(number("coarse_fresh_iterations")));
  }
}

template <int Dim>
void Simulation<Dim>::forget_pressure() {
  std::fill(particles_.pressure.begin(), particles_.pressure.end(), 0.0);
  if (two_level_) two_level_->expire();
}

// Of a fall from particle to particle: water at rest disorders, too.
template <int Dim>
double Simulation<Dim>::least_speed() const {
  return std::sqrt(norm(gravity_) * config_.particles.spacing);
}

template <int Dim>
void Simulation<Dim>::choose_time_step() {
  const double largest = config_.time.cfl * config_.particles.spacing / report_.max_speed;  // infinite at rest
  const double grown = report_.dt > 0.0 ? most_growth * report_.dt : first_courant / config_.time.cfl * largest;
  report_.dt = std::min({config_.time.dt, largest, grown});
  if (report_.halvings > 0) {
    report_.dt = std::ldexp(report_.dt, -report_.halvings);
    report_.limit = StepLimit::retry;
    return;
  }
  report_.limit = report_.dt == config_.time.dt ? StepLimit::case_dt
                  : report_.dt == largest       ? StepLimit::cfl
                                                : StepLimit::growth;
}

// Of a change of velocity in a step, what the particle moves by.
template <int Dim>
double Simulation<Dim>::moving_share() const {
  return config_.time.mean_velocity ? 0.5 : 1.0;
}

// u* = u + dt (nu lap u + g), with the pairs of the last step. Places are moved back by what advance() moves too far.
template <int Dim>
void Simulation<Dim>::accelerate() {
  const LogStage log(stage(predicting));
  const double nu = config_.fluid.viscosity;
  velocity_change_.assign(static_cast<std::size_t>(particles_.owned), report_.dt * gravity_);
  if (nu > 0.0) {
    decomposition_.refresh_directions(particles_.velocity, particles_.owned);
    hold_to_walls();
    search_.for_far_rows([&](int i, const PairRow& row) {
      velocity_change_[static_cast<std::size_t>(i)] +=
          nu * report_.dt * velocity_laplacian<Dim>(row, particles_.velocity, laplacian_factor_, i);
    });
  }
  const double excess = (1.0 - moving_share()) * report_.dt;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles_.owned); ++i) {
    if (!moves(particles_.type[i])) continue;
    particles_.velocity[i] += velocity_change_[i];
    particles_.position[i] -= excess * velocity_change_[i];
  }
}

// A viscous fluid does not slip: its images move against it; those of two mirrors, in a corner, with it.
template <int Dim>
void Simulation<Dim>::hold_to_walls() {
  if (!is_mirrored(config_)) return;
  for (auto k = static_cast<std::size_t>(particles_.owned); k < particles_.velocity.size(); ++k) {
    Image<Dim> image;
    decomposition_.cells().wrapped(particles_.position[k], image);
    double parity = 1.0;
    for (int axis = 0; axis < Dim; ++axis) parity *= image.sign[axis];
    if (image.reflects()) particles_.velocity[k] = parity * image.of_direction(particles_.velocity[k]);
  }
}

// Fluid particles that are about to come too near to each other bounce.
template <int Dim>
void Simulation<Dim>::collide() {
  const LogStage log(stage(predicting));
  if (config_.collision.distance == 0.0) return;
  decomposition_.refresh_positions(particles_);
  decomposition_.refresh_directions(particles_.velocity, particles_.owned);
  const double distance = config_.collision.distance * config_.particles.spacing;
  velocity_change_.assign(static_cast<std::size_t>(particles_.owned), {});
  for (int i = 0; i < particles_.owned; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (moves(particles_.type[self]))
      velocity_change_[self] = collision<Dim>(search_.near(), particles_.position, particles_.velocity, particles_.type,
                                              wall_normal_, report_.dt, distance, config_.collision.restitution, i);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles_.owned); ++i)
    particles_.velocity[i] += velocity_change_[i];
}

// r* = r + dt u*.
template <int Dim>
void Simulation<Dim>::advance() {
  const LogStage log(stage(predicting));
  const Vector<Dim> inlet_step = report_.dt * geometry_->inlet_velocity();
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles_.owned); ++i) {
    if (moves(particles_.type[i])) particles_.position[i] += report_.dt * particles_.velocity[i];
    if (particles_.type[i] == ParticleType::inlet) particles_.position[i] += inlet_step;
  }
}

template <int Dim>
void Simulation<Dim>::move_boundaries() {
  const LogStage log(stage(redistributing));
  particles_.resize(particles_.owned);
  const BoundaryFlow flow = geometry_->move_boundaries(
      report_.dt, particles_, [&](const Vector<Dim>& position) { return decomposition_.owns(position); });
  report_.in += sum_over_ranks(comm_, flow.entered);
  report_.out += sum_over_ranks(comm_, flow.left);
}

template <int Dim>
void Simulation<Dim>::redistribute() {
  const LogStage log(stage(redistributing));
  // A partition that could not reach the threshold is not tried again before the balance has become worse.
  if (decomposition_.imbalance(particles_) >
      std::max(config_.parallel.imbalance, 1.1 * decomposition_.achieved_imbalance()))
    decomposition_.partition(particles_);
  migrate();
}

// Particles to their ranks, and what depends on who has which.
template <int Dim>
void Simulation<Dim>::migrate() {
  const std::int64_t lost = sum_over_ranks(comm_, decomposition_.migrate(particles_));
  report_.lost += lost;
  if (lost > 0) fail("redistribute", fmt::format("{} particle(s) left the domain other than by an outlet", lost));
  decomposition_.build_halo(particles_);
  wall_normal_.assign(static_cast<std::size_t>(particles_.size()), {});
  for (std::size_t i = 0; i < wall_normal_.size(); ++i)
    if (particles_.type[i] == ParticleType::wall) wall_normal_[i] = geometry_->wall_normal(particles_.position[i]);
}

template <int Dim>
void Simulation<Dim>::find_neighbours() {
  const LogStage log(stage(searching));
  search_.search(particles_);
}

template <int Dim>
void Simulation<Dim>::measure_density() {
  const LogStage log(stage(measuring));
  number_density(search_.near(), particles_.number_density);
  const double n0 = near_sums_.number_density;
  const auto& limits = config_.free_surface;
  const auto size = static_cast<std::size_t>(particles_.size());
  const bool corrects = config_.pressure.corrected_divergence || config_.pressure.corrected_gradient;
  const bool needs_asymmetry = limits.zero_outside || config_.shifting.coefficient > 0.0;
  role_.assign(size, PressureRole::excluded);
  asymmetry_.assign(size, {});
  if (corrects) correction_.assign(static_cast<std::size_t>(particles_.owned), Matrix<Dim>::identity());
  for (int i = 0; i < particles_.owned; ++i) {
    const auto self = static_cast<std::size_t>(i);
    const ParticleType type = particles_.type[self];
    particles_.free_surface[self] = 0;
    if (type == ParticleType::inlet) role_[self] = PressureRole::zero;
    if (type != ParticleType::fluid && (type != ParticleType::wall || is_mirrored(config_))) continue;
    const double n = particles_.number_density[self];
    const bool undecided = n >= limits.surface_density * n0 && n <= limits.interior_density * n0;
    if (undecided || needs_asymmetry) asymmetry_[self] = asymmetry<Dim>(search_.near(), particles_.position, n0, i);
    if (corrects && type == ParticleType::fluid)
      correction_[self] = moment_correction<Dim>(search_.near(), particles_.position, n0, i);
    const bool surface = n < limits.surface_density * n0 ||
                         (undecided && norm(asymmetry_[self]) > limits.asymmetry * near_sums_.surface_asymmetry);
    particles_.free_surface[self] = surface;
    const bool zero = limits.zero_outside && type == ParticleType::fluid ? is_splash(self) : surface;
    role_[self] = zero ? PressureRole::zero : PressureRole::unknown;
    if (type == ParticleType::wall) asymmetry_[self] = {};  // the free surface is the fluid's
  }
  decomposition_.halo().refresh(role_, particles_.owned);
  if (corrects || needs_asymmetry) decomposition_.halo().refresh(particles_.free_surface, particles_.owned);
  if (needs_asymmetry) decomposition_.refresh_directions(asymmetry_, particles_.owned);
}

template <int Dim>
bool Simulation<Dim>::is_splash(std::size_t i) const {
  return particles_.number_density[i] < splash_density * near_sums_.number_density;
}

// Of p = 0 beyond the surface, on the diagonal of a particle's row.
template <int Dim>
double Simulation<Dim>::surface_weight(int i, const PairRow& far) const {
  const auto self = static_cast<std::size_t>(i);
  if (role_[self] != PressureRole::unknown) return 0.0;
  const double depth =
      surface_depth<Dim>(far, particles_.position, asymmetry_, particles_.free_surface, config_.particles.spacing, i);
  return closure_.weight(depth);
}

// Gravity acts on an image as on its original, so that its velocity is the mirrored one but for dt g, and a pressure
// that balances gravity differs by rho g.(r' - r).
template <int Dim>
void Simulation<Dim>::weigh_images() {
  image_pressure_.clear();
  if (!is_mirrored(config_) || gravity_ == Vector<Dim>{}) return;
  const auto owned = static_cast<std::size_t>(particles_.owned);
  image_pressure_.assign(particles_.position.size() - owned, 0.0);
  for (std::size_t k = 0; k < image_pressure_.size(); ++k) {
    Image<Dim> image;
    const Vector<Dim>& position = particles_.position[owned + k];
    const Vector<Dim> original = decomposition_.cells().wrapped(position, image);
    if (!image.reflects()) continue;
    image_pressure_[k] = config_.fluid.density * dot(gravity_, position - original);
    particles_.velocity[owned + k] += report_.dt * (gravity_ - image.of_direction(gravity_));
  }
}

// (1 - gamma) rho/dt div u* - gamma rho/dt^2 crowding (paper eq. 8).
template <int Dim>
void Simulation<Dim>::find_sources() {
  const double n0 = near_sums_.number_density;
  const double rho = config_.fluid.density;
  const double dt = report_.dt;
  const double speed = std::max(config_.pressure.density_speed * report_.max_speed, least_speed());
  const double gamma = config_.pressure.density_speed > 0.0
                           ? std::min(1.0, std::pow(speed * dt / config_.particles.spacing, 2))
                           : config_.pressure.gamma;
  source_.assign(static_cast<std::size_t>(particles_.owned), 0.0);
  for (int i = 0; i < particles_.owned; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (role_[self] != PressureRole::unknown) {
      particles_.pressure[self] = 0.0;
      continue;
    }
    const double flow = config_.pressure.corrected_divergence
                            ? corrected_divergence<Dim>(search_.near(), particles_.position, particles_.velocity,
                                                        wall_normal_, correction_[self], n0, i)
                            : divergence<Dim>(search_.near(), particles_.position, particles_.velocity, n0, i);
    source_[self] = (1.0 - gamma) * rho / dt * flow - gamma * rho / (dt * dt) * crowding(i);
  }
}

// (n* - n0)/n0, or the packing's. Ghosts and the free surface miss neighbours, which says nothing of crowding.
template <int Dim>
double Simulation<Dim>::crowding(int i) const {
  const auto self = static_cast<std::size_t>(i);
  if (particles_.free_surface[self]) return 0.0;
  return config_.pressure.packing ? packing(search_.near(), config_.kernel.type, i) / near_sums_.packing - 1.0
                                  : particles_.number_density[self] / near_sums_.number_density - 1.0;
}

// lap p = source.
template <int Dim>
void Simulation<Dim>::solve_pressure() {
  {
    const LogStage log(stage(assembling));
    weigh_images();
    find_sources();
  }
  try_pressure();
  if (!report_.pressure.failure.empty()) {
    ++report_.cold_solves;
    forget_pressure();
    try_pressure();
  }
  if (!report_.pressure.failure.empty()) fail(pressure_phase, report_.pressure.failure);
  if (config_.pressure.clamp_negative)
    for (int i = 0; i < particles_.owned; ++i) {
      double& pressure = particles_.pressure[static_cast<std::size_t>(i)];
      pressure = std::max(pressure, 0.0);
    }
  share_wall_pressure();
}

template <int Dim>
void Simulation<Dim>::try_pressure() {
  {
    const LogStage log(stage(assembling));
    if (config_.free_surface.zero_outside) surface_weight_.resize(static_cast<std::size_t>(particles_.owned));
    const auto for_rows = [&](const auto& use) {
      search_.for_far_rows([&](int i, const PairRow& row) {
        if (!surface_weight_.empty()) surface_weight_[static_cast<std::size_t>(i)] = surface_weight(i, row);
        use(i, row);
      });
    };
    pressure_solver_.assemble({.for_rows = for_rows,
                               .role = role_,
                               .row = decomposition_.rows(),
                               .source = source_,
                               .factor = laplacian_factor_,
                               .n0 = far_sums_.number_density,
                               .usual_pairs = far_sums_.neighbours,
                               .surface = surface_weight_,
                               .excess = image_pressure_},
                              decomposition_.halo());
    if (two_level_) {
      const LogStage log_set_up(stage(preconditioning));
      if (std::exchange(partitions_seen_, decomposition_.partitions()) != decomposition_.partitions())
        two_level_->set_owners(decomposition_.owners());
      two_level_->update(pressure_solver_.rows(), role_, particles_.position, decomposition_.halo(),
                         report_.pressure.iterations);
      two_level_->attach(pressure_solver_.preconditioner());
    }
  }
  const LogStage log(stage(solving));
  report_.pressure = pressure_solver_.solve(particles_.pressure);
}

// The wall particles of a mirror measure the mean around them.
template <int Dim>
void Simulation<Dim>::share_wall_pressure() {
  auto& pressure = particles_.pressure;
  decomposition_.halo().refresh(pressure, particles_.owned);
  for (std::size_t k = 0; k < image_pressure_.size(); ++k)
    pressure[static_cast<std::size_t>(particles_.owned) + k] += image_pressure_[k];
  for (int i = 0; is_mirrored(config_) && i < particles_.owned; ++i)
    if (particles_.type[static_cast<std::size_t>(i)] == ParticleType::wall)
      pressure[static_cast<std::size_t>(i)] = weighted_mean(search_.near(), pressure, i);
}

// u = u* - dt/rho grad p, and the displacement that goes with it.
template <int Dim>
void Simulation<Dim>::correct() {
  const LogStage log(stage(correcting));
  const double factor = report_.dt / config_.fluid.density;
  const double n0 = near_sums_.number_density;
  velocity_change_.assign(static_cast<std::size_t>(particles_.owned), {});
  for (int i = 0; i < particles_.owned; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (!moves(particles_.type[self])) continue;
    const Vector<Dim> gradient = config_.pressure.corrected_gradient && !particles_.free_surface[self]
                                     ? corrected_gradient<Dim>(search_.near(), particles_.position, particles_.pressure,
                                                               base_pressure(i), correction_[self], n0, i)
                                     : pressure_gradient<Dim>(search_.near(), particles_.position, particles_.pressure,
                                                              particles_.type, wall_normal_, n0, i);
    velocity_change_[self] = -factor * gradient;
  }
  displacement_.resize(static_cast<std::size_t>(particles_.owned));
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles_.owned); ++i) {
    particles_.velocity[i] += velocity_change_[i];
    displacement_[i] = moving_share() * report_.dt * velocity_change_[i];
  }
}

// Differences of pressure alone leave the forces of a pair unequal: beside the surface, whose particles have them
// equal, that feeds its waves, so the pressures there push as well.
template <int Dim>
double Simulation<Dim>::base_pressure(int i) const {
  const PairList& near = search_.near();
  for (int k = near.begin(i); k < near.end(i); ++k)
    if (particles_.free_surface[static_cast<std::size_t>(near.index[static_cast<std::size_t>(k)])])
      return least_pressure(near, particles_.pressure, i);
  return particles_.pressure[static_cast<std::size_t>(i)];
}

// r = r* + share dt (u - u*) + delta. Particles drift to where neighbours are missing, delta = C u_ref dt F, but not
// through the free surface: beside it, they push each other apart where they are too near. They take the velocity of
// their new place.
template <int Dim>
void Simulation<Dim>::shift() {
  const LogStage log(stage(correcting));
  const double largest = largest_shift * config_.particles.spacing;
  const double scale = config_.shifting.coefficient * std::max(report_.max_speed, least_speed()) * report_.dt;
  const bool corrects = scale > 0.0 && config_.shifting.correct_velocity;
  if (corrects) decomposition_.refresh_directions(particles_.velocity, particles_.owned);
  velocity_change_.assign(static_cast<std::size_t>(particles_.owned), {});
  for (int i = 0; i < particles_.owned; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (scale == 0.0 || !moves(particles_.type[self]) || is_splash(self)) continue;
    const Vector<Dim> normal = surface_normal<Dim>(search_.near(), asymmetry_, particles_.free_surface, i);
    Vector<Dim> delta = scale * asymmetry_[self];
    if (normal != Vector<Dim>{}) {
      delta -= dot(delta, normal) * normal;
      delta += scale * repulsion<Dim>(search_.near(), particles_.position, particles_.type,
                                      config_.shifting.least_distance, config_.particles.spacing, i);
    }
    if (const double length = norm(delta); length > largest) delta *= largest / length;
    displacement_[self] += delta;
    if (corrects)
      velocity_change_[self] = velocity_change_along<Dim>(search_.near(), particles_.position, particles_.velocity,
                                                          particles_.type, delta, near_sums_.number_density, i);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles_.owned); ++i) {
    particles_.position[i] += displacement_[i];
    particles_.velocity[i] += velocity_change_[i];
  }
}

template <int Dim>
void Simulation<Dim>::take_stock() {
  const LogStage log(stage(stocktaking));
  const double spacing = config_.particles.spacing;
  const double mass = config_.fluid.density * std::pow(spacing, Dim);
  const double area = std::pow(spacing, Dim - 1);
  const bool averaging = report_.step > 0 && report_.time > config_.average_start;
  std::array<double, 4> sums{};    // particles, fluid, kinetic energy, floor force
  std::array<double, 3> maxima{};  // speed squared, pressure, not a number
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles_.owned); ++i) {
    sums[0] += 1.0;
    const double pressure = particles_.pressure[i];
    maxima[1] = std::max(maxima[1], pressure);
    if (!std::isfinite(pressure) || !std::isfinite(norm(particles_.velocity[i]))) maxima[2] = 1.0;
    if (particles_.type[i] == ParticleType::fluid) {
      const double speed2 = dot(particles_.velocity[i], particles_.velocity[i]);
      sums[1] += 1.0;
      sums[2] += 0.5 * mass * speed2;
      maxima[0] = std::max(maxima[0], speed2);
    } else if (particles_.type[i] == ParticleType::wall) {
      if (geometry_->on_floor(particles_.position[i])) sums[3] += area * pressure;
      if (averaging) particles_.pressure_impulse[i] += report_.dt * pressure;
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, comm_);
  MPI_Allreduce(MPI_IN_PLACE, maxima.data(), static_cast<int>(maxima.size()), MPI_DOUBLE, MPI_MAX, comm_);
  report_.particles = static_cast<std::int64_t>(sums[0]);
  report_.fluid = static_cast<std::int64_t>(sums[1]);
  report_.kinetic_energy = sums[2];
  report_.floor_force = sums[3];
  report_.max_speed = std::sqrt(maxima[0]);
  report_.max_pressure = maxima[1];
  if (averaging) {
    if (window_end_ == 0.0) window_begin_ = report_.time - report_.dt;
    window_end_ = report_.time;
  }
  if (maxima[2] > 0.0) fail("correct", "a velocity or a pressure is not a number");
  if (report_.max_speed > config_.time.max_speed)
    fail("correct", fmt::format("the largest speed, {:.4g} m/s, passed time.max_speed = {:.4g} m/s", report_.max_speed,
                                config_.time.max_speed));
}

template <int Dim>
std::size_t Simulation<Dim>::bytes() const {
  return static_cast<std::size_t>(particles_.size()) * particle_bytes<Dim> + search_.bytes() +
         pressure_solver_.bytes() + (two_level_ ? two_level_->bytes() : 0);
}

template <int Dim>
UnitCosts Simulation<Dim>::unit_costs(const Case& config) {
  const int near = lattice_sums<Dim>(config.kernel.type, config.kernel.radius).neighbours;
  const int far = lattice_sums<Dim>(config.kernel.type, config.kernel.laplacian_radius).neighbours;
  constexpr double pair = sizeof(int) + sizeof(double);
  constexpr double entry = sizeof(PetscInt) + sizeof(double);
  // A step builds the halo, refreshes role and pressure, and the marks of the search for pockets at least twice; the
  // consistent scheme also surface marks, asymmetry and velocity.
  double traffic = sizeof(typename Decomposition<Dim>::HaloRecord) + sizeof(PressureRole) + sizeof(double) + 2.0;
  if (config.fluid.viscosity > 0.0) traffic += sizeof(Vector<Dim>);
  if (config.collision.distance > 0.0) traffic += 2.0 * sizeof(Vector<Dim>);
  if (config.free_surface.zero_outside || config.shifting.coefficient > 0.0) traffic += sizeof(Vector<Dim>) + 1.0;
  if (config.shifting.coefficient > 0.0 && config.shifting.correct_velocity) traffic += sizeof(Vector<Dim>);
  return {.particle_memory = particle_bytes<Dim> + 2.0 * sizeof(int) + sizeof(Vector<Dim>),  // with the cells' order
          .row_memory = near * pair + (0.5 * far + 1.0) * entry + TwoLevelPreconditioner<Dim>::bytes_per_row,
          .cell_memory = 3.0 * sizeof(int),
          .halo_traffic = traffic};
}

template <int Dim>
void Simulation<Dim>::fail(const char* phase, const std::string& reason) const {
  throw SolveError(report_.step, phase, reason);
}

template class Simulation<2>;
template class Simulation<3>;

}  // namespace impinge
