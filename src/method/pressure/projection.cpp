#include "impinge/method/pressure/projection.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "impinge/method/operators.hpp"
#include "impinge/method/phase.hpp"

namespace impinge {

constexpr int crowding_passes = 2;  // of means over neighbours
constexpr int layer_passes = 3;     // likewise
constexpr double least_calm = 0.5;  // at a surface in disordered motion; still less would only make it noisier

template <int Dim>
Projection<Dim>::Projection(MPI_Comm comm, const MethodSettings& settings, const CellGrid<Dim>& cells)
    : settings_(settings),
      near_sums_(lattice_sums<Dim>(settings.kernel.type, settings.kernel.radius)),
      far_sums_(lattice_sums<Dim>(settings.kernel.type, settings.kernel.laplacian_radius)),
      laplacian_factor_(2.0 * Dim /
                        (far_sums_.number_density * far_sums_.lambda * std::pow(settings.particles.spacing, 2))),
      closure_(settings.kernel.type, settings.kernel.laplacian_radius, settings.kernel.radius),
      surface_layer_(settings.kernel.radius),
      solver_(comm, settings.pressure.tolerance) {
  if (solver_.is_two_level()) two_level_.emplace(comm, cells);
}

template <int Dim>
void Projection<Dim>::forget(Particles<Dim>& particles) {
  std::fill(particles.pressure.begin(), particles.pressure.end(), 0.0);
  if (two_level_) two_level_->expire();
}

template <int Dim>
void Projection<Dim>::follow_partition(const Decomposition<Dim>& decomposition) {
  if (std::exchange(partitions_seen_, decomposition.partitions()) != decomposition.partitions())
    two_level_->set_owners(decomposition.owners());
}

template <int Dim>
PressureReport Projection<Dim>::solve(const Step& step, const BodyForce<Dim>& force, State<Dim>& state,
                                      int last_iterations, int& cold_solves) {
  std::vector<double> source;
  {
    const PhaseLog log(Phase::assembly);
    find_image_offsets(step, force, state);
    find_layer(state);
    source = sources(step, force, state);
  }
  PressureReport report = try_solve(source, state, last_iterations);
  if (!report.failure.empty()) {
    ++cold_solves;
    forget(state.particles);
    report = try_solve(source, state, report.iterations);
  }
  if (!report.failure.empty()) return report;
  limit_suction(step.fall_speed, state);
  share_pressure(state);
  return report;
}

// Fluid that is whole may be under tension. It tears where its surface is rough or its motion disordered. Beside both
// surface and wall there is none: air gets in between.
template <int Dim>
void Projection<Dim>::limit_suction(double fall_speed, State<Dim>& state) const {
  for (std::size_t i = 0; i < state.owned(); ++i) {
    double& pressure = state.particles.pressure[i];
    if (pressure >= 0.0) continue;
    const auto self = static_cast<int>(i);
    if (!settings_.pressure.clamp_negative && !meets_air(state, self)) continue;
    if (settings_.pressure.clamp_negative || sees_images(state, self)) {
      pressure = 0.0;
    } else {
      pressure *= (1.0 - disorder_around(state, fall_speed, self)) *
                  surface_flatness<Dim>(state.near(), state.asymmetry, state.particles.free_surface, self);
    }
  }
}

template <int Dim>
bool Projection<Dim>::sees_images(const State<Dim>& state, int i) const {
  return !state.walls.empty() &&
         std::ranges::any_of(state.near().row(i), [&](int j) { return j >= state.walls.first_image(); });
}

template <int Dim>
bool Projection<Dim>::meets_air(const State<Dim>& state, int i) const {
  const std::vector<std::uint8_t>& free_surface = state.particles.free_surface;
  return free_surface[static_cast<std::size_t>(i)] || is_beside_surface(state.near(), free_surface, i);
}

// Of a single particle it tells of disorder, of several around it of the flow.
template <int Dim>
void Projection<Dim>::find_layer(const State<Dim>& state) {
  const Particles<Dim>& particles = state.particles;
  layer_.assign(particles.position.size(), SurfaceClosure<Dim>::usual_depth);
  if (!settings_.free_surface.zero_outside) return;
  const typename SurfaceLayer<Dim>::View view{state.near(),           particles.position, state.asymmetry,
                                              particles.free_surface, particles.type,     settings_.particles.spacing};
  for (int i = 0; i < particles.owned; ++i)
    if (particles.free_surface[static_cast<std::size_t>(i)])
      layer_[static_cast<std::size_t>(i)] = surface_layer_.depth(view, i);
  for (int pass = 0; pass < layer_passes; ++pass) {
    state.refresh(layer_);
    std::vector<double> mean = layer_;
    for (int i = 0; i < particles.owned; ++i)
      if (particles.free_surface[static_cast<std::size_t>(i)])
        mean[static_cast<std::size_t>(i)] = surface_layer_.mean(view, layer_, i);
    layer_ = std::move(mean);
  }
  state.refresh(layer_);
}

template <int Dim>
void Projection<Dim>::find_image_offsets(const Step& step, const BodyForce<Dim>& force, State<Dim>& state) {
  image_offset_.clear();
  const MirrorWalls<Dim>& walls = state.walls;
  if (force.is_zero() && !walls.any_moves() && !walls.faces().has_curves()) return;
  const auto force_at = [&](const Vector<Dim>& position) { return force.at(position); };
  walls.apply_force(step.dt, step.after, settings_.fluid.density, force_at, state.particles, image_offset_);
}

template <int Dim>
std::vector<double> Projection<Dim>::sources(const Step& step, const BodyForce<Dim>& force, State<Dim>& state) {
  const PressureSettings& pressure = settings_.pressure;
  const double rho = settings_.fluid.density;
  const double dt = step.dt;
  const double gamma = pressure.density_rate > 0.0
                           ? std::min(1.0, pressure.density_rate * step.speed * dt / settings_.particles.spacing)
                           : pressure.gamma;
  const std::vector<double> crowded = crowding(state);
  std::vector<double> source(state.owned(), 0.0);
  curvature_.assign(source.size(), 0.0);
  for (std::size_t i = 0; i < source.size(); ++i) {
    if (state.role[i] != PressureRole::unknown) {
      state.particles.pressure[i] = 0.0;
      continue;
    }
    double divergence_after = 0.0;  // of the velocity, where the particles will be
    if (pressure.corrected_divergence) {
      // Along the way of the particles, d/dt div u = -(grad u):(grad u)^T but for the acceleration.
      const Matrix<Dim> slope = slope_of_velocity(state, static_cast<int>(i));
      const double square = trace_of_square(slope);
      divergence_after = trace(slope) - step.after * square;
      curvature_[i] = rho * (force.divergence() - square);
    } else {
      divergence_after = divergence<Dim>(state.near(), state.particles.position, state.particles.velocity,
                                         near_sums_.number_density, static_cast<int>(i));
    }
    source[i] = (1.0 - gamma) * rho / dt * divergence_after;
    source[i] -= gamma * rho / (dt * dt) * crowded[i];
  }
  return source;
}

template <int Dim>
Matrix<Dim> Projection<Dim>::slope_of_velocity(const State<Dim>& state, int i) const {
  return velocity_gradient<Dim>(state.near(), state.particles.position, state.particles.velocity, state.wall_normal,
                                state.correction[static_cast<std::size_t>(i)], near_sums_.number_density, i);
}

template <int Dim>
double Projection<Dim>::depth(const State<Dim>& state, std::span<const int> around, int i) const {
  return surface_depth<Dim>(around, state.particles.position, state.asymmetry, state.particles.free_surface, layer_,
                            settings_.particles.spacing, i);
}

// Packing, with what is missing beyond the free surface, over that of the lattice.
template <int Dim>
double Projection<Dim>::relative_packing(const State<Dim>& state, int i) const {
  const PairList& near = state.near();
  double sum = packing<Dim>(near, state.particles.position, settings_.kernel.type,
                            settings_.kernel.radius * settings_.particles.spacing, state.walls.first_own_image(), i);
  if (is_beside_surface(near, state.particles.free_surface, i)) sum += closure_.packing(depth(state, near.row(i), i));
  return sum / near_sums_.packing;
}

// (n* - n0)/n0, or the packing's; owned particles first, then room for the others. The free surface misses neighbours,
// which says nothing of crowding.
template <int Dim>
std::vector<double> Projection<Dim>::crowding(const State<Dim>& state) const {
  const Particles<Dim>& particles = state.particles;
  std::vector<double> crowded(particles.position.size(), 0.0);
  for (int i = 0; i < particles.owned; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (state.role[self] != PressureRole::unknown || particles.free_surface[self]) continue;
    crowded[self] = (settings_.pressure.packing ? relative_packing(state, i)
                                                : particles.number_density[self] / near_sums_.number_density) -
                    1.0;
  }
  if (settings_.pressure.packing)
    for (int pass = 0; pass < crowding_passes; ++pass) smooth(state, crowded);
  return crowded;
}

// A particle's crowding is mostly the disorder around it; the mean over its surroundings tells of the volume.
template <int Dim>
void Projection<Dim>::smooth(const State<Dim>& state, std::vector<double>& field) const {
  const std::vector<std::uint8_t>& free_surface = state.particles.free_surface;
  const double own_weight = 2.0 * with_kernel(settings_.kernel.type, [&](auto kernel) {
                              return decltype(kernel)::weight(1.0, settings_.kernel.radius);
                            });
  state.refresh(field);
  std::vector<double> mean = field;
  for (std::size_t i = 0; i < state.owned(); ++i)
    if (!free_surface[i]) mean[i] = mean_inside(state.near(), field, free_surface, own_weight, static_cast<int>(i));
  field = std::move(mean);
}

// Of the pressure equation, with p = 0 beyond the surface.
template <int Dim>
PressureEquation::Row Projection<Dim>::row(const State<Dim>& state, int i, const PairRow& far) const {
  if (!settings_.free_surface.zero_outside || state.role[static_cast<std::size_t>(i)] != PressureRole::unknown)
    return {far};
  const double below = depth(state, far.index, i);
  const double flux = curvature_[static_cast<std::size_t>(i)] * std::pow(settings_.particles.spacing, 2) *
                      closure_.flux_of_curvature(below);
  return {far, closure_.weight(below), flux};
}

template <int Dim>
PressureReport Projection<Dim>::try_solve(std::span<const double> source, State<Dim>& state, int last_iterations) {
  {
    const PhaseLog log(Phase::assembly);
    const auto for_rows = [&](const auto& use) {
      state.search.for_far_rows([&](int i, const PairRow& far) { use(i, row(state, i, far)); });
    };
    solver_.assemble({.for_rows = for_rows,
                      .role = state.role,
                      .row = state.decomposition.rows(),
                      .source = source,
                      .laplacian_factor = laplacian_factor_,
                      .n0 = far_sums_.number_density,
                      .usual_pairs = far_sums_.neighbours,
                      .original = state.walls.originals(),
                      .image_offset = image_offset_},
                     state.decomposition.halo());
    if (two_level_) {
      const PhaseLog log_set_up(Phase::set_up);
      follow_partition(state.decomposition);
      const std::span<const Vector<Dim>> position(state.particles.position);
      two_level_->update(solver_.rows(), state.role, position.first(state.role.size()), state.decomposition.halo(),
                         last_iterations);
      two_level_->attach(solver_.preconditioner());
    }
  }
  const PhaseLog log(Phase::solve);
  return solver_.solve(state.particles.pressure);
}

// To halo and images; wall particles that measure take the mean around them. Air gets between a wall and the fluid
// beside the free surface: no wall pulls there.
template <int Dim>
void Projection<Dim>::share_pressure(State<Dim>& state) const {
  std::vector<double>& pressure = state.particles.pressure;
  if (settings_.walls.model != WallModel::mirror || state.walls.empty()) return state.refresh(pressure);
  std::vector<std::uint8_t> lets_go(pressure.size(), settings_.pressure.clamp_negative ? 1 : 0);
  if (!settings_.pressure.clamp_negative) {
    for (std::size_t i = 0; i < state.owned(); ++i)
      lets_go[i] =
          !state.walls.faces().around(state.particles.position[i]).empty() && meets_air(state, static_cast<int>(i));
  }
  state.decomposition.halo().refresh_together(state.particles.owned, pressure, lets_go);
  state.walls.copy(pressure);
  state.walls.for_images([&](std::size_t image, std::size_t at, std::size_t from) {
    if (!image_offset_.empty()) pressure[at] += image_offset_[image];
    if (lets_go[from]) pressure[at] = std::max(pressure[at], 0.0);
  });
  for (std::size_t i = 0; i < state.owned(); ++i)
    if (state.particles.type[i] == ParticleType::wall)
      pressure[i] = weighted_mean(state.near(), pressure, static_cast<int>(i));
}

template <int Dim>
std::vector<Vector<Dim>> Projection<Dim>::velocity_change(double dt, double fall_speed, const State<Dim>& state) const {
  const double factor = dt / settings_.fluid.density;
  std::vector<Vector<Dim>> change(state.owned());
  for (std::size_t i = 0; i < change.size(); ++i)
    if (state.moves(i)) change[i] = -factor * gradient(state, fall_speed, static_cast<int>(i));
  return change;
}

// Differences of pressure alone leave the forces of a pair unequal. At a rough surface and beside it that makes energy,
// and so it does where a force holds a surface whose particles are in disordered motion. Pressures push there as well:
// equally for both at the surface, off the smallest pressure around beside it.
template <int Dim>
Vector<Dim> Projection<Dim>::gradient(const State<Dim>& state, double fall_speed, int i) const {
  const auto self = static_cast<std::size_t>(i);
  const Particles<Dim>& particles = state.particles;
  const PairList& near = state.near();
  const double n0 = near_sums_.number_density;
  const auto pushing = [&] {
    return pressure_gradient<Dim>(near, particles.position, particles.pressure, particles.type, state.wall_normal, n0,
                                  i);
  };
  if (!settings_.pressure.corrected_gradient) return pushing();
  const double flatness = surface_flatness<Dim>(near, state.asymmetry, particles.free_surface, i);
  const auto off = [&](double base) {
    return corrected_gradient<Dim>(near, particles.position, particles.pressure, base, state.correction[self], n0, i);
  };
  if (!particles.free_surface[self]) {
    const double own = particles.pressure[self];
    if (!is_beside_surface(near, particles.free_surface, i)) return off(own);
    const double share = std::min(flatness, calm(state, fall_speed, i));
    return off(share < 1.0 ? own - (1.0 - share) * (own - least_pressure(near, particles.pressure, i)) : own);
  }
  if (flatness == 0.0) return pushing();
  const Vector<Dim> normal = surface_normal<Dim>(near, state.asymmetry, particles.free_surface, i);
  // In three dimensions jets are better without the curvature. Beyond `most`, which a film half a spacing thicker than
  // the depth would have, it is noise.
  const double depth = layer_[self] * settings_.particles.spacing;
  const double most =
      Dim == 2 ? 2.0 * std::abs(particles.pressure[self]) / (depth * (depth + settings_.particles.spacing)) : 0.0;
  const std::optional<Vector<Dim>> even = surface_gradient<Dim>(
      near, particles.position, particles.pressure, normal, depth, std::clamp(curvature_[self], -most, most), n0, i);
  if (!even) return pushing();
  const double share = std::min(flatness, calm(state, fall_speed, i));
  return share < 1.0 ? share * *even + (1.0 - share) * pushing() : *even;
}

template <int Dim>
double Projection<Dim>::calm(const State<Dim>& state, double fall_speed, int i) const {
  return 1.0 + (least_calm - 1.0) * disorder_around(state, fall_speed, i);
}

template <int Dim>
double Projection<Dim>::disorder_around(const State<Dim>& state, double fall_speed, int i) const {
  if (fall_speed == 0.0) return 0.0;
  const Particles<Dim>& particles = state.particles;
  return disorder<Dim>(state.near(), particles.position, particles.velocity, slope_of_velocity(state, i), fall_speed,
                       i);
}

template <int Dim>
std::size_t Projection<Dim>::bytes() const {
  return solver_.bytes() + (two_level_ ? two_level_->bytes() : 0);
}

template class Projection<2>;
template class Projection<3>;

}  // namespace impinge
