#include "impinge/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "impinge/operators.hpp"

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

template <int Dim>
double reach_of(const Config& config) {
  return config.kernel.laplacian_radius * config.particles.spacing;
}

// Arrays of one entry per particle.
template <int Dim>
constexpr std::size_t particle_bytes = sizeof(ParticleRecord<Dim>) + sizeof(double) + sizeof(std::uint8_t) +
                                       sizeof(PressureRole) + sizeof(double) + sizeof(Vec<Dim>) + sizeof(PetscInt);

bool moves(ParticleType type) { return type == ParticleType::fluid; }

}  // namespace

SolveError::SolveError(std::int64_t step, std::string phase, const std::string& reason)
    : std::runtime_error(fmt::format("step {}, phase {}: {}", step, phase, reason)),
      step_(step),
      phase_(std::move(phase)) {}

template <int Dim>
Simulation<Dim>::Simulation(MPI_Comm comm, const Config& config)
    : comm_(comm),
      config_(config),
      near_sums_(lattice_sums<Dim>(config.kernel.type, config.kernel.radius)),
      far_sums_(lattice_sums<Dim>(config.kernel.type, config.kernel.laplacian_radius)),
      laplacian_factor_(2.0 * Dim /
                        (far_sums_.number_density * far_sums_.lambda * std::pow(config.particles.spacing, 2))),
      geometry_(make_geometry<Dim>(config)),
      domain_(comm, geometry_->bounds(), geometry_->periodic(), reach_of<Dim>(config), config.parallel.partitioner),
      search_(domain_.sorting_cells(), Domain<Dim>::cell_parts, config.kernel.type,
              config.kernel.radius * config.particles.spacing, reach_of<Dim>(config)),
      pressure_solver_(comm, config.pressure.tolerance) {
  if (pressure_solver_.is_two_level()) two_level_.emplace(comm, domain_.cells());
  for (int k = 0; k < Dim; ++k) gravity_[k] = config.fluid.gravity[static_cast<std::size_t>(k)];
  geometry_->fill(rank_of(comm), ranks_of(comm), particles_);
  domain_.partition(particles_);
  redistribute();
  find_neighbours();
  measure_density();
  take_stock();
  report_.in = report_.fluid;
}

template <int Dim>
void Simulation<Dim>::step() {
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
  report_.time += report_.dt;
  take_stock();
}

template <int Dim>
void Simulation<Dim>::forget_pressure() {
  std::fill(particles_.pressure.begin(), particles_.pressure.end(), 0.0);
  if (two_level_) two_level_->expire();
}

template <int Dim>
void Simulation<Dim>::choose_time_step() {
  const double largest = config_.time.cfl * config_.particles.spacing / report_.max_speed;  // infinite at rest
  report_.limit = largest < config_.time.dt ? StepLimit::cfl : StepLimit::case_dt;
  report_.dt = std::min(config_.time.dt, largest);
}

// u* = u + dt (nu lap u + g), with the pairs of the last step.
template <int Dim>
void Simulation<Dim>::accelerate() {
  const LogStage log(stage(predicting));
  const double nu = config_.fluid.viscosity;
  velocity_change_.assign(static_cast<std::size_t>(particles_.owned), report_.dt * gravity_);
  if (nu > 0.0) {
    domain_.halo().refresh(particles_.velocity, particles_.owned);
    for (int i = 0; i < particles_.owned; ++i)
      velocity_change_[static_cast<std::size_t>(i)] +=
          nu * report_.dt * velocity_laplacian<Dim>(search_.far(), particles_.velocity, laplacian_factor_, i);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles_.owned); ++i)
    if (moves(particles_.type[i])) particles_.velocity[i] += velocity_change_[i];
}

// Fluid particles that are about to come too near to each other bounce.
template <int Dim>
void Simulation<Dim>::collide() {
  const LogStage log(stage(predicting));
  if (config_.collision.distance == 0.0) return;
  domain_.refresh_positions(particles_);
  domain_.halo().refresh(particles_.velocity, particles_.owned);
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
  const Vec<Dim> inlet_step = report_.dt * geometry_->inlet_velocity();
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
      report_.dt, particles_, [&](const Vec<Dim>& position) { return domain_.owns(position); });
  report_.in += sum_over_ranks(comm_, flow.entered);
  report_.out += sum_over_ranks(comm_, flow.left);
}

template <int Dim>
void Simulation<Dim>::redistribute() {
  const LogStage log(stage(redistributing));
  // A partition that could not reach the threshold is not tried again before the balance has become worse.
  if (domain_.imbalance(particles_) > std::max(config_.parallel.imbalance, 1.1 * domain_.achieved_imbalance()))
    domain_.partition(particles_);
  const std::int64_t lost = sum_over_ranks(comm_, domain_.migrate(particles_));
  report_.lost += lost;
  if (lost > 0) fail("redistribute", fmt::format("{} particle(s) left the domain other than by an outlet", lost));
  domain_.build_halo(particles_);
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
  role_.assign(static_cast<std::size_t>(particles_.size()), PressureRole::excluded);
  for (int i = 0; i < particles_.owned; ++i) {
    const auto self = static_cast<std::size_t>(i);
    const ParticleType type = particles_.type[self];
    particles_.free_surface[self] = 0;
    if (type == ParticleType::inlet) role_[self] = PressureRole::zero;
    if (type != ParticleType::fluid && type != ParticleType::wall) continue;
    const double n = particles_.number_density[self];
    const bool surface =
        n < limits.surface_density * n0 ||
        (n <= limits.interior_density * n0 &&
         asymmetry<Dim>(search_.near(), particles_.position, n0, i) > limits.asymmetry * near_sums_.surface_asymmetry);
    particles_.free_surface[self] = surface;
    role_[self] = surface ? PressureRole::zero : PressureRole::unknown;
  }
  domain_.halo().refresh(role_, particles_.owned);
}

// lap p = (1 - gamma) rho/dt div u* - gamma rho/dt^2 (n* - n0)/n0 (paper eq. 8).
template <int Dim>
void Simulation<Dim>::solve_pressure() {
  const double n0 = near_sums_.number_density;
  const double gamma = config_.pressure.gamma;
  const double rho = config_.fluid.density;
  const double dt = report_.dt;
  {
    const LogStage log(stage(assembling));
    source_.assign(static_cast<std::size_t>(particles_.owned), 0.0);
    for (int i = 0; i < particles_.owned; ++i) {
      const auto self = static_cast<std::size_t>(i);
      if (role_[self] != PressureRole::unknown) {
        particles_.pressure[self] = 0.0;
        continue;
      }
      const double flow = divergence<Dim>(search_.near(), particles_.position, particles_.velocity, n0, i);
      const double crowding = (particles_.number_density[self] - n0) / n0;
      source_[self] = (1.0 - gamma) * rho / dt * flow - gamma * rho / (dt * dt) * crowding;
    }
    const PressureEquation equation{search_.far(),           role_, domain_.rows(), source_, laplacian_factor_,
                                    far_sums_.number_density};
    pressure_solver_.assemble(equation, domain_.halo());
    if (two_level_) {
      const LogStage log_set_up(stage(preconditioning));
      if (std::exchange(partitions_seen_, domain_.partitions()) != domain_.partitions())
        two_level_->set_owners(domain_.owners());
      two_level_->update(equation, particles_.position, pressure_solver_.diagonal(), report_.pressure.iterations);
      two_level_->attach(pressure_solver_.preconditioner());
    }
  }
  const LogStage log(stage(solving));
  report_.pressure = pressure_solver_.solve(particles_.pressure);
  if (!report_.pressure.failure.empty()) fail("pressure", report_.pressure.failure);
  if (config_.pressure.clamp_negative)
    for (int i = 0; i < particles_.owned; ++i) {
      double& pressure = particles_.pressure[static_cast<std::size_t>(i)];
      pressure = std::max(pressure, 0.0);
    }
  domain_.halo().refresh(particles_.pressure, particles_.owned);
}

// u = u* - dt/rho grad p, r = r* - dt^2/rho grad p.
template <int Dim>
void Simulation<Dim>::correct() {
  const LogStage log(stage(correcting));
  const double factor = report_.dt / config_.fluid.density;
  velocity_change_.assign(static_cast<std::size_t>(particles_.owned), {});
  for (int i = 0; i < particles_.owned; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (moves(particles_.type[self]))
      velocity_change_[self] =
          -factor * pressure_gradient<Dim>(search_.near(), particles_.position, particles_.pressure, particles_.type,
                                           wall_normal_, near_sums_.number_density, i);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles_.owned); ++i) {
    particles_.velocity[i] += velocity_change_[i];
    particles_.position[i] += report_.dt * velocity_change_[i];
  }
}

template <int Dim>
void Simulation<Dim>::take_stock() {
  const LogStage log(stage(stocktaking));
  const double spacing = config_.particles.spacing;
  const double mass = config_.fluid.density * std::pow(spacing, Dim);
  const double area = std::pow(spacing, Dim - 1);
  const bool averaging = report_.step > 0 && report_.time > config_.output.average_start;
  std::array<double, 4> sums{};    // particles, fluid, kinetic energy, floor force
  std::array<double, 3> maxima{};  // speed squared, pressure, not a number
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles_.owned); ++i) {
    sums[0] += 1.0;
    const double pressure = particles_.pressure[i];
    maxima[1] = std::max(maxima[1], pressure);
    if (particles_.type[i] == ParticleType::fluid) {
      const double speed2 = dot(particles_.velocity[i], particles_.velocity[i]);
      if (!std::isfinite(speed2)) maxima[2] = 1.0;
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
  if (maxima[2] > 0.0) fail("correct", "a velocity is not a number");
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
UnitCosts Simulation<Dim>::unit_costs(const Config& config) {
  const int near = lattice_sums<Dim>(config.kernel.type, config.kernel.radius).neighbours;
  const int far = lattice_sums<Dim>(config.kernel.type, config.kernel.laplacian_radius).neighbours;
  constexpr double pair = sizeof(int) + sizeof(double);
  constexpr double entry = sizeof(PetscInt) + sizeof(double);
  // A step builds the halo, refreshes role and pressure, and the marks of the search for pockets at least twice.
  double traffic = sizeof(typename Domain<Dim>::HaloRecord) + sizeof(PressureRole) + sizeof(double) + 2.0;
  if (config.fluid.viscosity > 0.0) traffic += sizeof(Vec<Dim>);
  if (config.collision.distance > 0.0) traffic += 2.0 * sizeof(Vec<Dim>);
  return {.particle_memory = particle_bytes<Dim> + 2.0 * sizeof(int) + sizeof(Vec<Dim>),  // with the cells' order
          .row_memory = (near + far) * pair + far * entry + TwoLevelPreconditioner<Dim>::bytes_per_row,
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
