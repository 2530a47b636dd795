#include "impinge/method/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "impinge/core/errors.hpp"
#include "impinge/method/costs.hpp"
#include "impinge/method/density.hpp"
#include "impinge/method/motion.hpp"
#include "impinge/method/shifting.hpp"
#include "impinge/method/smoothing.hpp"
#include "impinge/method/time_step.hpp"
#include "impinge/method/viscosity.hpp"

namespace impinge {
namespace {

constexpr int most_halvings = 4;           // of dt, where the pressure cannot be solved
constexpr double worth_a_partition = 1.1;  // growth of an imbalance that a partition could not take below its bound

template <int Dim>
State<Dim> make_state(MPI_Comm comm, const MethodSettings& settings, const Scene<Dim>& scene) {
  const double near = settings.kernel.radius * settings.particles.spacing;
  const double far = settings.kernel.laplacian_radius * settings.particles.spacing;
  Decomposition<Dim> decomposition(comm, scene.bounds, scene.periodic, least_cell_edge(settings),
                                   settings.parallel.partitioner);
  NeighbourSearch<Dim> search(decomposition.sorting_cells(), Decomposition<Dim>::cell_parts, settings.kernel.type, near,
                              far, settings.walls.model == WallModel::mirror);
  return {.particles = {},
          .decomposition = std::move(decomposition),
          .walls = MirrorWalls<Dim>(scene.mirrors, scene.walls, settings.kernel.largest() * settings.particles.spacing,
                                    settings.particles.spacing),
          .search = std::move(search),
          .wall_normal = {},
          .asymmetry = {},
          .correction = {},
          .role = {}};
}

// A free surface that faces a wall nearer than a spacing and a half is a gap between the fluid's lattice and the wall:
// it closes as any other. Collective.
template <int Dim>
void leave_out_gaps(double spacing, State<Dim>& state) {
  Particles<Dim>& particles = state.particles;
  for (std::size_t i = 0; i < state.owned(); ++i) {
    const double size = norm(state.asymmetry[i]);
    if (!particles.free_surface[i] || size == 0.0) continue;
    const Vector<Dim>& from = particles.position[i];
    const Vector<Dim> to = from + 1.5 * spacing / size * state.asymmetry[i];
    if (state.walls.faces().line_factor(from, to, state.walls.faces().around(from)) == 0.0)
      particles.free_surface[i] = 0;
  }
  state.refresh(particles.free_surface);
}

}  // namespace

template <int Dim>
Simulation<Dim>::Simulation(MPI_Comm comm, const MethodSettings& settings, Scene<Dim> scene,
                            const Checkpoint<Dim>* checkpoint)
    : comm_(comm),
      settings_(settings),
      scene_(std::move(scene)),
      state_(make_state(comm, settings, scene_)),
      projection_(comm, settings_, state_.decomposition.cells()),
      damping_(settings_.damping) {
  if (checkpoint) {
    restore(*checkpoint);
    return;
  }
  scene_.fill(rank_of(comm), ranks_of(comm), state_.particles);
  place_wall_points(0.0);
  state_.decomposition.partition(state_.particles);
  redistribute();
  find_neighbours();
  if (scene_.settles) settle();
  measure_totals();
  report_.in = report_.fluid;
}

// Particles drift to even distances, as they do in a step, but without flow.
template <int Dim>
void Simulation<Dim>::settle() {
  constexpr int passes = 60;
  constexpr double way = 0.25;  // over the asymmetry [dp]
  const ShiftingSettings shifting{
      .coefficient = 1.0, .least_distance = 0.9, .correct_velocity = needs_velocity_gradients(settings_)};
  const double spacing = settings_.particles.spacing;
  for (int pass = 0; pass < passes; ++pass) {
    leave_out_gaps(spacing, state_);
    const double n0 = projection_.lattice().number_density;
    std::vector<Matrix<Dim>> gradient;
    if (shifting.correct_velocity) gradient = velocity_gradients(n0, state_);
    const Shift<Dim> shift = shift_of<Dim>(shifting, way * spacing, 1.0, spacing, n0, gradient, state_);
    for (std::size_t i = 0; i < shift.displacement.size(); ++i) {
      state_.particles.position[i] += shift.displacement[i];
      state_.particles.velocity[i] += shift.velocity_change[i];
    }
    state_.walls.confine([&](int i) { return state_.search.searched_position(i); }, state_.particles);
    redistribute();
    find_neighbours();
  }
}

template <int Dim>
void Simulation<Dim>::step(double target) {
  save(step_start_);
  report_.cold_solves = 0;
  report_.halvings = 0;
  while (true) {
    try {
      return try_step(target);
    } catch (const SolveError& error) {
      if (error.phase() != Phase::solve || report_.halvings == most_halvings) throw;
      restore(step_start_);
      ++report_.halvings;
    }
  }
}

template <int Dim>
void Simulation<Dim>::try_step(double target) {
  ++report_.step;
  const double spacing = settings_.particles.spacing;
  const Flow flow = measure_flow();
  choose_time_step(settings_.time, spacing, flow.passing_speed, flow.pull, target, report_);
  const double end = report_.dt == target - report_.time ? target : report_.time + report_.dt;
  const BodyForce<Dim> force(settings_.fluid, report_.time + 0.5 * report_.dt);
  const MotionRule rule(settings_.time, report_.dt);
  // Of a fall over one spacing: it keeps shifting and density correction active in water at rest [m/s].
  const double fall_speed = std::sqrt(flow.pull * spacing);
  {
    const PhaseLog log(Phase::predict);
    set_inlets(report_.time + 0.5 * report_.dt, scene_.inlets, state_.particles);
    const std::vector<Vector<Dim>> viscous = viscous_change(settings_, rule.dt, projection_.lattice().number_density,
                                                            projection_.laplacian_factor(), state_);
    accelerate<Dim>(rule, force, damping_, viscous, state_);
    collide(settings_.collision, spacing, report_.dt, state_);
    advance(rule.before, scene_.inlets, state_.particles);
  }
  move_walls(report_.time + rule.before, end);
  pass_boundaries();
  redistribute();
  find_neighbours();
  solve_pressure(rule, force, std::max(flow.speed, 3.0 * fall_speed), fall_speed);
  correct(rule, flow.speed, fall_speed);
  report_.time = end;
  place_wall_points(end);
  measure_totals();
}

// Calls use(name, number) for all that the next step, or a restarted run, reads of a step.
template <int Dim>
template <class Use>
void Simulation<Dim>::for_numbers(StepReport& report, AveragingWindow& window, std::vector<Inlet<Dim>>& inlets,
                                  std::vector<Outlet<Dim>>& outlets, std::int64_t& next_id, WallTimes& wall_times,
                                  Use&& use) {
  use("step", report.step);
  use("time", report.time);
  use("dt", report.dt);
  use("free_dt", report.free_dt);
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
  use("window_begin", window.begin);
  use("window_end", window.end);
  use("next_id", next_id);
  use("wall_time", wall_times.place);
  use("wall_velocity_time", wall_times.velocity);
  for (std::size_t k = 0; k < inlets.size(); ++k) use(fmt::format("inlet_{}_last_row", k + 1), inlets[k].last_row);
  for (std::size_t k = 0; k < outlets.size(); ++k)
    if (outlets[k].region) use(fmt::format("outlet_{}_out", k + 1), outlets[k].out);
}

template <int Dim>
void Simulation<Dim>::save(Checkpoint<Dim>& state) const {
  const Particles<Dim>& particles = state_.particles;
  state.particles.copy_owned(particles);
  state.searched_position.assign(state.particles.position.begin(), state.particles.position.end());
  for (std::size_t i = 0; i < state_.owned(); ++i)
    if (particles.type[i] == ParticleType::fluid || particles.type[i] == ParticleType::inlet) {
      state.searched_position[i] = state_.search.searched_position(static_cast<int>(i));
    } else if (is_wall_point(i)) {
      state.searched_position[i] = wall_point_at(particles.id[i], wall_times_.place);
    }
  StepReport report = report_;
  AveragingWindow window = window_;
  std::vector<Inlet<Dim>> inlets = scene_.inlets;
  std::vector<Outlet<Dim>> outlets = scene_.outlets;
  std::int64_t next_id = scene_.next_id;
  WallTimes wall_times = wall_times_;
  for_numbers(report, window, inlets, outlets, next_id, wall_times,
              [&](const std::string& name, auto number) { state.numbers[name] = static_cast<double>(number); });
}

template <int Dim>
Checkpoint<Dim> Simulation<Dim>::checkpoint() const {
  Checkpoint<Dim> state;
  save(state);
  const Decomposition<Dim>& decomposition = state_.decomposition;
  state.segments = decomposition.owners().segments();
  state.numbers["cells"] = static_cast<double>(decomposition.cells().count());
  state.numbers["achieved_imbalance"] = decomposition.achieved_imbalance();
  if (const auto& two_level = projection_.two_level()) {
    state.coarse = two_level->coarse_rows();
    state.numbers["coarse_age"] = two_level->age();
    state.numbers["coarse_fresh_iterations"] = two_level->fresh_iterations();
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
  for_numbers(report_, window_, scene_.inlets, scene_.outlets, scene_.next_id, wall_times_,
              [&]<class T>(const std::string& name, T& target) { target = static_cast<T>(number(name)); });

  Decomposition<Dim>& decomposition = state_.decomposition;
  Particles<Dim>& particles = state_.particles;
  particles = state.particles;
  particles.position = state.searched_position;
  if (!state.segments.empty()) {
    if (const auto cells = static_cast<double>(decomposition.cells().count()); number("cells") != cells)
      throw FileError(
          fmt::format("the checkpoint has {:.0f} background cells, but the case has {:.0f}", number("cells"), cells));
    decomposition.set_owners({state.segments, number("achieved_imbalance")});
    const auto is_here = [&](std::int64_t cell) {
      return cell >= 0 && cell < decomposition.cells().count() && decomposition.owners()(cell) == rank_of(comm_);
    };
    if (any_rank(comm_, !std::ranges::all_of(state.coarse.cell, is_here)))
      throw FileError("the checkpoint has rows of the coarse matrix on ranks that do not own their cells");
  } else if (decomposition.partitions() == 0) {
    decomposition.partition(particles);
  }
  if (!std::ranges::all_of(scene_.inlets, &Inlet<Dim>::is_in_place))
    throw FileError("the checkpoint's inlet is elsewhere");
  bool has_strange_wall = false;
  for (std::size_t i = 0; i < state_.owned(); ++i)
    has_strange_wall |= is_wall_point(i) && static_cast<std::uint64_t>(particles.id[i]) >= scene_.wall_points.size();
  if (any_rank(comm_, has_strange_wall)) throw FileError("a wall particle of the checkpoint is on no wall");
  state_.walls.move_to(wall_times_.place, wall_times_.velocity);
  // The positions at the end of the step go the particles' way in the place of velocities.
  Particles<Dim> later = particles;
  later.velocity = state.particles.position;
  decomposition.migrate(later);
  migrate();
  find_neighbours();
  std::copy_n(later.velocity.begin(), particles.owned, particles.position.begin());

  auto& two_level = projection_.two_level();
  if (!two_level) return;
  if (state.segments.empty() || number("coarse_age") == 0.0) {
    two_level->expire();
  } else {
    projection_.follow_partition(decomposition);
    two_level->set_coarse_rows(state.coarse, static_cast<int>(number("coarse_age")),
                               static_cast<int>(number("coarse_fresh_iterations")));
  }
}

template <int Dim>
void Simulation<Dim>::pass_boundaries() {
  const PhaseLog log(Phase::redistribute);
  Particles<Dim>& particles = state_.particles;
  particles.resize(particles.owned);
  state_.walls.confine([&](int i) { return state_.search.searched_position(i); }, particles);
  const BoundaryFlow flow =
      pass_open_boundaries<Dim>(scene_.inlets, scene_.outlets, scene_.next_id, particles,
                                [&](const Vector<Dim>& position) { return state_.decomposition.owns(position); });
  std::vector<std::int64_t> counts = flow.left_by;
  counts.insert(counts.end(), {flow.entered, flow.left});
  MPI_Allreduce(MPI_IN_PLACE, counts.data(), static_cast<int>(counts.size()), MPI_INT64_T, MPI_SUM, comm_);
  report_.out += counts.back();
  report_.in += counts[counts.size() - 2];
  for (std::size_t k = 0; k < scene_.outlets.size(); ++k)
    if (scene_.outlets[k].region) scene_.outlets[k].out += counts[k];
}

// Before particles are told to stay on their side.
template <int Dim>
void Simulation<Dim>::move_walls(double time, double velocity_time) {
  if (!state_.walls.any_moves()) return;
  wall_times_ = {time, velocity_time};
  state_.walls.move_to(time, velocity_time);
  place_wall_points(time);
}

template <int Dim>
Vector<Dim> Simulation<Dim>::wall_point_at(std::int64_t id, double time) const {
  const WallPoint<Dim>& point = scene_.wall_points[static_cast<std::size_t>(id)];
  const Wall<Dim>& wall = scene_.walls[static_cast<std::size_t>(point.wall)];
  return wall.motion ? (*wall.motion)(time).of_position(point.position) : point.position;
}

// Wall particles of walls that move to where these are at a time.
template <int Dim>
void Simulation<Dim>::place_wall_points(double time) {
  if (!state_.walls.any_moves()) return;
  for (std::size_t i = 0; i < state_.owned(); ++i)
    if (is_wall_point(i)) state_.particles.position[i] = wall_point_at(state_.particles.id[i], time);
}

// Where the walls move as one body, in their frame: a tank at constant velocity is one at rest, and what turns with a
// drum is pulled outwards.
template <int Dim>
typename Simulation<Dim>::Flow Simulation<Dim>::measure_flow() const {
  const WallFaces<Dim>& faces = state_.walls.faces();
  const BodyForce<Dim> force(settings_.fluid, report_.time);
  const double latest = report_.time + longest_step(settings_.time, report_);
  const double in_space = std::max({report_.max_speed, faces.largest_speed(report_.time), faces.largest_speed(latest)});
  const Motion<Dim>* const motion = faces.common_motion();
  if (!motion)
    return {.speed = report_.max_speed, .passing_speed = in_space, .pull = force.largest(comm_, state_.particles)};
  const Pose<Dim> pose = (*motion)(report_.time), later = (*motion)(latest);
  std::array<double, 3> largest{};
  for (std::size_t i = 0; i < state_.owned(); ++i) {
    if (!state_.moves(i)) continue;
    const Vector<Dim>&place = state_.particles.position[i], &velocity = state_.particles.velocity[i];
    largest[0] = std::max(largest[0], norm(velocity - pose.velocity_at(place)));
    largest[1] = std::max(largest[1], norm(velocity - later.velocity_at(place)));
    largest[2] = std::max(largest[2], norm(force.at(place) - pose.acceleration_at(place)));
  }
  MPI_Allreduce(MPI_IN_PLACE, largest.data(), static_cast<int>(largest.size()), MPI_DOUBLE, MPI_MAX, comm_);
  const bool all_moves_along = scene_.inlets.empty() && scene_.outlets.empty();
  return {.speed = largest[0],
          .passing_speed = all_moves_along ? std::max(largest[0], largest[1]) : in_space,
          .pull = largest[2]};
}

template <int Dim>
void Simulation<Dim>::redistribute() {
  const PhaseLog log(Phase::redistribute);
  Decomposition<Dim>& decomposition = state_.decomposition;
  const double bound = std::max(settings_.parallel.imbalance, worth_a_partition * decomposition.achieved_imbalance());
  if (decomposition.imbalance(state_.particles) > bound) decomposition.partition(state_.particles);
  migrate();
}

template <int Dim>
void Simulation<Dim>::count_strays(const Strays& strays) {
  const std::int64_t lost = sum_over_ranks(comm_, strays.outside);
  report_.lost += lost;
  if (any_rank(comm_, strays.not_finite > 0)) fail(Phase::redistribute, "a position is not a number");
  if (settings_.outside == Outside::error || report_.step == 0)  // a scene fits into its bounds
    fail(Phase::redistribute, fmt::format("{} particle(s) left the domain other than by an outlet", lost));
}

// Particles to their ranks, and what depends on who has which.
template <int Dim>
void Simulation<Dim>::migrate() {
  Particles<Dim>& particles = state_.particles;
  const Strays strays = state_.decomposition.migrate(particles);
  if (sum_over_ranks(comm_, strays.outside + strays.not_finite) > 0) count_strays(strays);
  state_.decomposition.build_halo(particles);
  state_.walls.append_images(particles);
  if (settings_.walls.model == WallModel::mirror) return;
  state_.wall_normal.assign(particles.position.size(), {});
  for (std::size_t i = 0; i < particles.position.size(); ++i)
    if (particles.type[i] == ParticleType::wall) state_.wall_normal[i] = scene_.wall_normal(particles.position[i]);
}

template <int Dim>
void Simulation<Dim>::find_neighbours() {
  Particles<Dim>& particles = state_.particles;
  {
    const PhaseLog log(Phase::neighbours);
    NeighbourSearch<Dim>& search = state_.search;
    search.arrange(particles);
    state_.walls.append_own_images(
        [&](int i) { return search.around(i, particles.position[static_cast<std::size_t>(i)]); }, particles);
    search.find(particles, scene_.walls.empty() ? nullptr : &state_.walls);
  }
  const PhaseLog log(Phase::density);
  measure_density(settings_, projection_.lattice(), state_);
}

template <int Dim>
void Simulation<Dim>::solve_pressure(const MotionRule& rule, const BodyForce<Dim>& force, double speed,
                                     double fall_speed) {
  report_.pressure = projection_.solve({.dt = rule.dt, .after = rule.after, .speed = speed, .fall_speed = fall_speed},
                                       force, state_, report_.pressure.iterations, report_.cold_solves);
  if (!report_.pressure.failure.empty()) fail(Phase::solve, report_.pressure.failure);
}

// u = u* - dt/rho grad p, the displacement that goes with it, the shift and the smoothing.
template <int Dim>
void Simulation<Dim>::correct(const MotionRule& rule, double flow_speed, double fall_speed) {
  const PhaseLog log(Phase::correct);
  const double spacing = settings_.particles.spacing, n0 = projection_.lattice().number_density;
  Particles<Dim>& particles = state_.particles;
  const std::vector<Vector<Dim>> change = projection_.velocity_change(rule.dt, fall_speed, state_);
  for (std::size_t i = 0; i < change.size(); ++i) particles.velocity[i] += change[i];
  std::vector<Matrix<Dim>> gradient;
  if (needs_velocity_gradients(settings_)) gradient = velocity_gradients(n0, state_);
  const Shift<Dim> shift =
      shift_of<Dim>(settings_.shifting, std::max(flow_speed, fall_speed), rule.dt, spacing, n0, gradient, state_);
  const std::vector<Vector<Dim>> smoothing = smoothing_of<Dim>(
      settings_.smoothing, std::max(flow_speed, 3.0 * fall_speed), rule.dt, spacing, n0, gradient, state_);
  advance(rule.after, scene_.inlets, particles);
  for (std::size_t i = 0; i < change.size(); ++i) {
    particles.position[i] += (rule.before - rule.after) * change[i] + shift.displacement[i];
    particles.velocity[i] += shift.velocity_change[i] + smoothing[i];
  }
}

template <int Dim>
void Simulation<Dim>::measure_totals() {
  const PhaseLog log(Phase::totals);
  const bool is_finite = impinge::measure_totals(comm_, settings_, state_.particles, scene_.on_floor, report_);
  if (report_.step > 0 && report_.time > settings_.average_start)
    average_wall_pressure(report_, window_, state_.particles);
  if (!is_finite) fail(Phase::correct, "a velocity or a pressure is not a number");
  if (report_.max_speed > settings_.time.max_speed)
    fail(Phase::correct, fmt::format("the largest speed, {:.4g} m/s, passed time.max_speed = {:.4g} m/s",
                                     report_.max_speed, settings_.time.max_speed));
}

template <int Dim>
std::size_t Simulation<Dim>::bytes() const {
  return static_cast<std::size_t>(state_.particles.size()) * bytes_per_particle<Dim>() + state_.search.bytes() +
         state_.decomposition.bytes() + projection_.bytes();
}

template <int Dim>
void Simulation<Dim>::fail(Phase phase, const std::string& reason) const {
  throw SolveError(report_.step, phase, reason);
}

template class Simulation<2>;
template class Simulation<3>;

}  // namespace impinge
