#include "impinge/programs/run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <sstream>

#include "impinge/cases/make_simulation.hpp"
#include "impinge/core/memory.hpp"
#include "impinge/io/checkpoint_file.hpp"
#include "impinge/io/output.hpp"
#include "impinge/io/run_directory.hpp"
#include "impinge/io/snapshot.hpp"
#include "impinge/io/together.hpp"
#include "impinge/observe/observer_report.hpp"
#include "impinge/observe/observers.hpp"
#include "impinge/parallel/exchange.hpp"
#include "impinge/programs/core_check.hpp"
#include "impinge/programs/figures.hpp"
#include "impinge/programs/memory_check.hpp"
#include "impinge/programs/plan.hpp"
#include "impinge/programs/progress.hpp"
#include "impinge/programs/scene_file.hpp"
#include "impinge/programs/schedule.hpp"
#include "impinge/programs/stop_signals.hpp"
#include "impinge/scenes/scene_report.hpp"

namespace impinge {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Runs use(std::integral_constant<int, Dim>) for the case's dimension.
template <class Use>
auto with_dimension(const Case& config, Use&& use) {
  if (config.dimension == 3) return use(std::integral_constant<int, 3>{});
  return use(std::integral_constant<int, 2>{});
}

/// Throws InputError on all ranks if the command line has PETSc options that no rank has asked for (a solver may live
/// on some ranks only); `ours`: set by the program. Collective.
void refuse_unused_options(MPI_Comm comm, const std::vector<std::string>& ours) {
  const std::vector<std::string> unused_here = unused_petsc_options();
  const auto used_here = [&](const std::string& option) {
    return std::ranges::find(unused_here, option) == unused_here.end();
  };
  std::vector<std::string> mistakes;
  std::istringstream unused(broadcast(comm, fmt::format("{}", fmt::join(unused_here, "\n")), 0));
  for (std::string option; std::getline(unused, option);)
    if (!any_rank(comm, used_here(option)) && std::ranges::find(ours, option) == ours.end())
      mistakes.push_back(fmt::format("command line: {}: no part of PETSc or Impinge uses this option", option));
  if (!mistakes.empty()) throw InputError(std::move(mistakes));
}

/// Throws InputError on all ranks where the run cannot write its files. Collective.
void check_output(MPI_Comm comm, const Case& config) {
  std::vector<std::string> mistakes;
  if (rank_of(comm) == 0) {
    try {
      check_writable(config);
      const auto& [directory, place, interval] = config.output;
      if (const std::string reason = try_longest_name(directory, config.name); !reason.empty())
        mistakes.push_back(fmt::format("{}: output.directory = \"{}\": cannot write a checkpoint of \"{}\" there: {}",
                                       place, directory, config.name, reason));
    } catch (const InputError& error) {
      mistakes = error.mistakes();
    }
  }
  if (any_rank(comm, !mistakes.empty())) throw InputError(mistakes);
}

/// A line for each region: its volume between the walls, its particles, the error of their volume.
template <int Dim>
std::vector<std::string> region_lines(const Case& config) {
  std::vector<std::string> lines;
  for (const FluidRegion& region : config.regions) {
    const auto [volume, of_particles] = volume_between_walls<Dim>(config, config, region);
    lines.push_back(fmt::format("fluid       {}: {:.6g} m^{}, {:.0f} particles, their volume {:+.2f} %", region.name,
                                volume, Dim, of_particles / std::pow(config.particles.spacing, Dim),
                                100.0 * (of_particles / volume - 1.0)));
  }
  return lines;
}

/// Of the scheme and the scene.
void print_warnings(const Case& config, const SceneReport& report) {
  for (const auto& texts : {scheme_warnings(config), report.warnings})
    for (const std::string& text : texts) fmt::print(stderr, "impinge: warning: {}\n", text);
}

/// Regions, walls, motions, openings and what is observed, a line each, and warnings.
template <int Dim>
void print_scene(const Case& config) {
  const SceneReport report = report_scene(config, config);
  for (const auto& lines : {region_lines<Dim>(config), report.lines, observer_lines(config, Dim)})
    for (const std::string& line : lines) fmt::print("{}\n", line);
  print_warnings(config, report);
}

/// Writes the scene for ParaView and draws it. Collective; throws FileError.
template <int Dim>
void show_scene(MPI_Comm comm, const Case& config, const Particles<Dim>& particles) {
  const std::string path = write_scene(comm, config, particles);
  on_first_rank(comm, [&] {
    fmt::print("scene       {}\n", path);
    std::fflush(stdout);
    remove_file(std::filesystem::path(path).replace_extension(".png").string());  // of another scene
    if (!draw({"--scene", path})) fmt::print("picture     none\n");
  });
}

template <int Dim>
void check(MPI_Comm comm, const Case& config) {
  check_memory<Dim>(comm, config);
  check_output(comm, config);
  const auto simulation = make_simulation<Dim>(comm, config);
  refuse_unused_options(comm, simulation.pressure_solver().default_options());
  const StepReport& report = simulation.report();
  std::array<std::int64_t, 4> counts{};
  const Particles<Dim>& particles = simulation.particles();
  for (int i = 0; i < particles.owned; ++i)
    ++counts[static_cast<std::size_t>(particles.type[static_cast<std::size_t>(i)])];
  for (std::int64_t& count : counts) count = sum_over_ranks(comm, count);
  const double bytes = sum_over_ranks(comm, static_cast<double>(simulation.bytes()));
  const double most = max_over_ranks(comm, static_cast<double>(simulation.bytes()));
  const double imbalance = simulation.imbalance();
  const double free = free_memory(comm);
  const double acceleration = BodyForce<Dim>(config.fluid, 0.0).largest(comm, particles);
  if (rank_of(comm) == 0) {
    const double cfl_dt = config.time.cfl * config.particles.spacing / report.max_speed;
    const double force_dt = config.time.cfl * std::sqrt(config.particles.spacing / acceleration);
    fmt::print("case        {}, {} dimensions: all keys are in range\n", config.name, config.dimension);
    fmt::print("particles   {}: {} fluid, {} inlet, {} wall, {} ghost\n", report.particles, counts[0], counts[1],
               counts[2], counts[3]);
    fmt::print("ranks       {}, largest over mean work {:.3f}\n", ranks_of(comm), imbalance);
    fmt::print(
        "memory      {} ({:.0f} bytes per particle), {} on the fullest rank; preconditioner and libraries come on top; "
        "{} are free for a rank\n",
        bytes_text(bytes), bytes / static_cast<double>(report.particles), bytes_text(most), bytes_text(free));
    print_scene<Dim>(config);
    fmt::print("dt          at most {:.3g} s (time.dt)", config.time.dt);
    if (std::isfinite(cfl_dt))
      fmt::print(", {:.3g} s (CFL {} at the initial {:.3g} m/s)", cfl_dt, config.time.cfl, report.max_speed);
    if (std::isfinite(force_dt)) fmt::print(", {:.3g} s (force, {:.3g} m/s^2)", force_dt, acceleration);
    fmt::print("\nsteps       at least {:.0f} to t = {} s\n",
               std::ceil(config.time.end / std::min({config.time.dt, cfl_dt, force_dt})), config.time.end);
    fmt::print("output      {}\n", config.output.directory);
  }
  show_scene(comm, config, particles);
}

/// Mean and largest over the ranks of a number that use(rank plan) gives.
template <class Use>
std::pair<double, double> mean_and_largest(const Plan& plan, Use&& use) {
  double sum = 0.0;
  double largest = 0.0;
  for (const RankPlan& rank : plan.ranks) {
    const auto value = static_cast<double>(use(rank));
    sum += value;
    largest = std::max(largest, value);
  }
  return {sum / static_cast<double>(plan.ranks.size()), largest};
}

void print_plan(const Case& config, const Plan& plan) {
  const auto of = [&](auto member, double unit = 1.0) {
    return mean_and_largest(plan, [&](const RankPlan& rank) { return static_cast<double>(rank.*member) / unit; });
  };
  const auto [work, most_work] = of(&RankPlan::work);
  const auto [owned, most_owned] = of(&RankPlan::owned);
  const auto [halo, most_halo] = of(&RankPlan::halo);
  const double worst_fraction =
      mean_and_largest(plan, [](const RankPlan& rank) {
        return static_cast<double>(rank.halo) / std::max(1.0, static_cast<double>(rank.owned));
      }).second;
  const auto [neighbours, most_neighbours] = of(&RankPlan::neighbours);
  const auto [field, most_field] = of(&RankPlan::field_bytes, 1e3);
  const auto [step, most_step] = of(&RankPlan::step_bytes, 1e3);
  const auto [iteration, most_iteration] = of(&RankPlan::iteration_bytes, 1e3);
  const auto [memory, most_memory] = of(&RankPlan::memory);
  const auto [nodes, most_nodes] = of(&RankPlan::nodes);
  const auto ranks = static_cast<double>(plan.ranks.size());
  fmt::print("case        {}, {} dimensions, planned for {} ranks; numbers are those of a rank\n", config.name,
             config.dimension, plan.ranks.size());
  fmt::print("particles   mean {:.1f}, most {:.0f}, {:.0f} in all\n", owned, most_owned, owned * ranks);
  fmt::print("imbalance   {:.3f} (largest over mean work)\n", work > 0.0 ? most_work / work : 1.0);
  fmt::print("empty       {} ranks\n", std::ranges::count(plan.ranks, 0, &RankPlan::owned));
  fmt::print("halo        mean {:.1f}, most {:.0f} particles; over owned: mean {:.4f}, worst {:.4f}\n", halo, most_halo,
             halo / owned, worst_fraction);
  fmt::print("neighbours  mean {:.2f}, most {:.0f} ranks\n", neighbours, most_neighbours);
  fmt::print("refresh     mean {:.1f}, most {:.1f} kB received for one double per halo particle\n", field, most_field);
  fmt::print("step        mean {:.1f}, most {:.1f} kB received, and up to {:.1f}, {:.1f} kB per solver iteration\n",
             step, most_step, iteration, most_iteration);
  fmt::print("memory      mean {}, most {}; preconditioner and libraries come on top\n", bytes_text(memory),
             bytes_text(most_memory));
  fmt::print("nodes       mean {:.1f}, most {:.0f} cells with particles: rows of the coarse matrix\n", nodes,
             most_nodes);
  fmt::print("cells       {}, {} of them with particles: {:.1f} of a rank\n", plan.cells, plan.occupied,
             static_cast<double>(plan.occupied) / ranks);
  fmt::print("partition   by {}; {} segments, {:.3g} kB on each rank\n",
             words(plan.partitioner)[static_cast<std::size_t>(plan.partitioner)], plan.segments,
             static_cast<double>(plan.table_bytes()) / 1e3);
  if (plan.partitioner == Partitioner::curve)
    fmt::print("repartition {} sums of {:.3g} kB over the ranks\n", plan.key_bits,
               static_cast<double>((plan.ranks.size() - 1) * sizeof(std::int64_t)) / 1e3);
}

/// Tells once that fluid has left the bounds, and warns once where it is a hundredth of all.
class LossNotice {
 public:
  explicit LossNotice(const StepReport& report) : told_(report.lost > 0), warned_(is_much(report)) {}

  void update(const StepReport& report) {
    if (!told_ && report.lost > 0) {
      fmt::print("step {}: {} particle(s) left the bounds and were removed; the history counts them as lost\n",
                 report.step, report.lost);
      told_ = true;
    }
    if (!warned_ && is_much(report)) {
      fmt::print(stderr, "impinge: warning: 1 % of the fluid, {} particles, has left the bounds by t = {:.6g} s\n",
                 report.lost, report.time);
      warned_ = true;
    }
  }

 private:
  static bool is_much(const StepReport& report) { return report.lost > 0 && 100 * report.lost >= report.in; }

  bool told_;
  bool warned_;
};

/// Says after each step whether a checkpoint is due or a signal asks for the end.
class Interruptions {
 public:
  enum Kind { none, checkpoint, stop };

  Interruptions(MPI_Comm comm, const Case& config) : comm_(comm), config_(config.checkpoint), schedule_(config) {}

  /// The same on every rank, whichever rank's clock or signal it was. Collective.
  Kind after_step(const StepReport& report) {
    Kind kind = none;
    if (config_.steps > 0 && report.step % config_.steps == 0) kind = checkpoint;
    if (schedule_.has_checkpoint(report.time)) kind = checkpoint;
    if (config_.minutes > 0.0 && seconds_since(last_) >= 60.0 * config_.minutes) kind = checkpoint;
    if (StopSignals::received() != 0) kind = stop;
    kind = static_cast<Kind>(max_over_ranks(comm_, kind));
    if (kind != none) last_ = Clock::now();
    return kind;
  }

  /// The signal that a rank received. Collective.
  int signal() const { return static_cast<int>(max_over_ranks(comm_, StopSignals::received())); }

 private:
  StopSignals signals_;
  MPI_Comm comm_;
  decltype(Case::checkpoint) config_;
  Schedule schedule_;
  Clock::time_point last_ = Clock::now();
};

template <int Dim>
Observers<Dim> observers_of(MPI_Comm comm, const Case& config, const Simulation<Dim>& simulation) {
  return Observers<Dim>(comm, config, config, make_scene<Dim>(config, config), simulation.particles(),
                        simulation.report());
}

/// Runs from where the simulation is to the case's end. Returns false where a signal ended the run before. Collective.
template <int Dim>
bool run(MPI_Comm comm, const Case& config, Simulation<Dim>& simulation, Observers<Dim>& observers, Output& output) {
  const bool first = rank_of(comm) == 0;
  check_cores(comm);
  const auto start = Clock::now();
  const StepReport& report = simulation.report();
  const std::int64_t first_step = report.step;

  const Schedule schedule(config);
  const auto finished = [&] { return schedule.is_over(report.time); };
  const auto& [steps, interval, minutes] = config.checkpoint;
  const bool has_checkpoints = steps > 0 || interval > 0.0 || minutes > 0.0;
  Interruptions interruptions(comm, config);
  bool options_checked = false;
  Progress progress(report.time, config.time.end, first);
  LossNotice losses(report);
  while (!finished()) {
    const auto step_start = Clock::now();
    try {
      simulation.step(schedule.next(report.time));
    } catch (const SolveError& error) {
      output.record(report, seconds_since(step_start));
      const std::string path = output.save(simulation, "failed", error.what());
      if (first) fmt::print("the last state is in {}\n", path);
      throw;
    }
    output.record(report, seconds_since(step_start));
    output.record(
        observers.observe({simulation.particles(), simulation.surface_depth(), simulation.outlets(), report}));
    if (!options_checked && (report.pressure.iterations > 0 || finished())) {
      refuse_unused_options(comm, simulation.pressure_solver().default_options());
      options_checked = true;
    }
    progress.update(report);
    if (first) losses.update(report);
    if (finished()) {
      output.save(simulation, "finished");
    } else if (schedule.has_snapshot(report.time)) {
      output.save(simulation, "running");
    }
    const Interruptions::Kind interruption = interruptions.after_step(report);
    if (finished() ? has_checkpoints : interruption != Interruptions::none) {
      output.record(observers.rows_for_restart(report));
      const std::string path = output.save_checkpoint(simulation);
      if (interruption == Interruptions::stop && !finished()) {
        const char* signal = signal_name(interruptions.signal());
        if (first)
          fmt::print("{}: stopped after step {}, t = {:.6g} s, with the state in {}\nto go on: impinge --restart {}\n",
                     signal, report.step, report.time, path, config.output.directory);
        return false;
      }
    }
  }
  if (first)
    fmt::print("done: {} steps in {}, particles in - out - lost - stored = {}\n", report.step - first_step,
               duration_text(seconds_since(start)), report.in - report.out - report.lost - report.fluid);
  for (const Outlet<Dim>& outlet : simulation.outlets())
    if (first && outlet.region) fmt::print("outlet {}: {} particles\n", outlet.name, outlet.out);
  std::fflush(stdout);  // while a reader that has gone is no reason to end
  return true;
}

RunFiles files_of(const Case& config) { return {config.output.directory, config.name, config.resolved_text}; }

/// Throws what would end the run in its first step: SolveError, InputError for PETSc options that nothing uses.
/// Collective.
template <int Dim>
void try_first_step(MPI_Comm comm, const Case& config) {
  auto trial = make_simulation<Dim>(comm, config);
  trial.step(Schedule(config).next(0.0));
  refuse_unused_options(comm, trial.pressure_solver().default_options());
}

template <int Dim>
bool start_run(MPI_Comm comm, const Case& config) {
  const bool first = rank_of(comm) == 0;
  check_memory<Dim>(comm, config);
  check_output(comm, config);
  // An earlier run stays where it is until this one is known to start.
  bool has_earlier_run = false;
  on_first_rank(comm, [&] { has_earlier_run = holds_run(config.output.directory, config.name); });
  if (any_rank(comm, has_earlier_run)) try_first_step<Dim>(comm, config);
  auto simulation = make_simulation<Dim>(comm, config);
  Observers<Dim> observers = observers_of(comm, config, simulation);
  Output output(comm, files_of(config), observers.headers());
  if (first && !output.set_aside().empty())
    fmt::print("the earlier run of this case is now in {}\n", output.set_aside());
  if (first)
    fmt::print("impinge {}: {} to t = {} s with {} particles on {} rank(s), output in {}\n", IMPINGE_VERSION,
               config.name, config.time.end, simulation.report().particles, ranks_of(comm), config.output.directory);
  if (first) print_warnings(config, report_scene(config, config));
  if constexpr (Dim == 3) write_scene(comm, config, simulation.particles());  // for pictures of the walls
  output.save(simulation, "running");
  return run(comm, config, simulation, observers, output);
}

template <int Dim>
std::shared_ptr<Simulation<Dim>> restored(MPI_Comm comm, const Case& config, const std::string& path) {
  std::int64_t particles = 0;
  on_first_rank(comm, [&] { particles = count_particles(path); });
  check_memory<Dim>(comm, config, sum_over_ranks(comm, particles));
  const Checkpoint<Dim> checkpoint = read_checkpoint<Dim>(comm, path);
  return std::shared_ptr<Simulation<Dim>>(new Simulation<Dim>(make_simulation<Dim>(comm, config, &checkpoint)));
}

template <int Dim>
bool go_on(MPI_Comm comm, const Case& config, Simulation<Dim>& simulation) {
  const StepReport& report = simulation.report();
  check_output(comm, config);
  Observers<Dim> observers = observers_of(comm, config, simulation);
  Output output(comm, files_of(config), observers.headers(), report.step);
  observers.go_on(output.last_row("sections"));
  if (rank_of(comm) == 0)
    fmt::print("impinge {}: {} from step {}, t = {:.6g} s, to t = {} s with {} particles on {} rank(s), output in {}\n",
               IMPINGE_VERSION, config.name, report.step, report.time, config.time.end, report.particles,
               ranks_of(comm), config.output.directory);
  return run(comm, config, simulation, observers, output);
}

/// The checkpoints in a directory, the last one first. Throws InputError where there are none or they are of several
/// cases. Collective.
std::vector<std::string> checkpoints_to_try(MPI_Comm comm, const std::string& directory) {
  std::vector<std::string> paths;
  std::string mistake;
  if (rank_of(comm) == 0) {
    try {
      paths = list_checkpoints(directory);
      std::set<std::string> names;
      for (const std::string& path : paths) names.insert(name_and_step(path).first);
      if (paths.empty()) mistake = "no checkpoint there";
      if (names.size() > 1) mistake = fmt::format("checkpoints of several cases: {}", fmt::join(names, ", "));
    } catch (const FileError& error) {
      mistake = error.what();
    }
  }
  mistake = broadcast(comm, mistake, 0);
  if (!mistake.empty()) throw InputError({fmt::format("--restart {}: {}", directory, mistake)});
  std::istringstream list(broadcast(comm, fmt::format("{}", fmt::join(paths, "\n")), 0));
  paths.clear();
  for (std::string path; std::getline(list, path);) paths.insert(paths.begin(), path);
  return paths;
}

/// The case text of a checkpoint. Throws FileError on all ranks. Collective.
NamedText case_of_checkpoint(MPI_Comm comm, const std::string& path) {
  std::string text, failure;
  if (rank_of(comm) == 0) {
    try {
      text = read_header(path).case_text;
    } catch (const FileError& error) {
      failure = error.what();
    }
  }
  failure = broadcast(comm, failure, 0);
  if (!failure.empty()) throw FileError(failure);
  return {path, broadcast(comm, text, 0)};
}

}  // namespace

std::vector<NamedText> load_case_files_on_first_rank(MPI_Comm comm, const std::string& path) {
  std::vector<NamedText> files;
  std::vector<std::string> mistakes;
  if (rank_of(comm) == 0) {
    try {
      files = load_case_files(path);
    } catch (const InputError& error) {
      mistakes = error.mistakes();
    }
  }
  if (any_rank(comm, !mistakes.empty())) throw InputError(mistakes);
  files.resize(static_cast<std::size_t>(sum_over_ranks(comm, static_cast<std::int64_t>(files.size()))));
  for (auto& [name, text] : files) {
    name = broadcast(comm, name, 0);
    text = broadcast(comm, text, 0);
  }
  return files;
}

void check_case(MPI_Comm comm, const Case& config) {
  with_dimension(config, [&](auto dimension) { check<dimension()>(comm, config); });
}

void plan_case(MPI_Comm comm, const Case& config, int ranks) {
  refuse_unused_options(comm, {});
  with_dimension(config, [&](auto dimension) {
    check_memory_of_plan<dimension()>(comm, config, ranks);
    const Plan plan = plan_run<dimension()>(comm, config, ranks);
    if (rank_of(comm) == 0) print_plan(config, plan);
  });
}

bool run_case(MPI_Comm comm, const Case& config) {
  return with_dimension(config, [&](auto dimension) { return start_run<dimension()>(comm, config); });
}

bool restart_case(MPI_Comm comm, const std::string& directory, const std::vector<std::string>& settings) {
  for (const std::string& path : checkpoints_to_try(comm, directory)) {
    std::function<bool()> continued_run;
    try {
      const Case config = parse_restart(case_of_checkpoint(comm, path), settings, directory);
      if (const std::string name = name_and_step(path).first; name != config.name)
        throw FileError(fmt::format("cannot read {}: it is of the case {}", path, config.name));
      with_dimension(config, [&](auto dimension) {
        const auto simulation = restored<dimension()>(comm, config, path);
        continued_run = [=] { return go_on(comm, config, *simulation); };
      });
    } catch (const FileError& error) {
      if (rank_of(comm) == 0) fmt::print(stderr, "impinge: {}\n", error.what());
      continue;
    }
    return continued_run();
  }
  throw InputError({fmt::format("--restart {}: no checkpoint there can be read", directory)});
}

}  // namespace impinge
