// What a step of a case costs, as JSON on the terminal:
//   mpirun -n RANKS step_bench CASE.toml [--set key=value ...] [-petsc_option [value] ...]
// with its own options in the manner of PETSc's:
//   -bench_warm_up N   steps before those that are measured, default 10
//   -bench_steps N     steps that are measured, default 30 (a coarse matrix lives for 10)
//   -bench_cold        each measured step solves from zero with a new coarse matrix

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "impinge/cases/make_simulation.hpp"
#include "impinge/programs/command_line.hpp"
#include "impinge/programs/run.hpp"

namespace impinge {
namespace {

int option(const char* name, int otherwise) {
  PetscInt value = otherwise;
  petsc_check(PetscOptionsGetInt(nullptr, nullptr, name, &value, nullptr));
  return static_cast<int>(value);
}

/// Seconds that the slowest rank needs for an action that all start together; median of several times.
template <class Action>
double median_seconds(MPI_Comm comm, int times, Action&& action) {
  std::vector<double> seconds;
  for (int k = 0; k < times; ++k) {
    MPI_Barrier(comm);
    const double start = MPI_Wtime();
    action();
    seconds.push_back(max_over_ranks(comm, MPI_Wtime() - start));
  }
  std::ranges::nth_element(seconds, seconds.begin() + times / 2);
  return seconds[static_cast<std::size_t>(times / 2)];
}

/// Bandwidth of all ranks together [bytes/s]: a = b + s c on arrays beyond every cache, counted as STREAM does.
double triad_bandwidth(MPI_Comm comm) {
  constexpr std::size_t length = 8'000'000;
  std::vector<double> a(length, 0.0), b(length, 1.0), c(length, 2.0);
  const double seconds = median_seconds(comm, 11, [&] {
    for (std::size_t i = 0; i < length; ++i) a[i] = b[i] + 3.0 * c[i];
  });
  if (a[length / 2] != 7.0) throw std::logic_error("the triad is wrong");
  return 3.0 * sizeof(double) * length * ranks_of(comm) / seconds;
}

/// Seconds of a product with the matrix.
double product_seconds(MPI_Comm comm, Mat matrix) {
  PetscVector x, y;
  petsc_check(MatCreateVecs(matrix, x.address(), y.address()));
  petsc_check(VecSet(x, 1.0));
  return median_seconds(comm, 51, [&] { petsc_check(MatMult(matrix, x, y)); });
}

/// Bytes that a product must move: values and columns, row starts, and both vectors once.
double product_bytes(Mat matrix) {
  MatInfo info;
  PetscInt rows = 0;
  petsc_check(MatGetInfo(matrix, MAT_GLOBAL_SUM, &info));
  petsc_check(MatGetSize(matrix, &rows, nullptr));
  return info.nz_used * (sizeof(double) + sizeof(PetscInt)) +
         static_cast<double>(rows) * (2 * sizeof(double) + sizeof(PetscInt));
}

/// Memory of this process [bytes], an entry of /proc/self/status: VmRSS now, VmHWM at its peak.
double process_bytes(const std::string& entry) {
  std::ifstream status("/proc/self/status");
  std::string word;
  double kilobytes = 0.0;
  while (status >> word)
    if (word == entry + ":" && status >> kilobytes) return 1024.0 * kilobytes;
  throw std::runtime_error(fmt::format("/proc/self/status has no {}", entry));
}

/// What PETSc's log has counted on this rank: seconds, messages sent or received, their bytes, reductions.
using Count = std::array<double, 4>;

Count phase_count(const char* name) {
  PetscLogStage stage = -1;
  petsc_check(PetscLogStageGetId(name, &stage));
#if PETSC_VERSION_LT(3, 20, 0)
  PetscStageLog log = nullptr;
  petsc_check(PetscLogGetStageLog(&log));
  const PetscEventPerfInfo info = log->stageInfo[stage].perfInfo;
#else
  PetscEventPerfInfo info;
  petsc_check(PetscLogStageGetPerfInfo(stage, &info));
#endif
  return {info.time, info.numMessages, info.messageLength, info.numReductions};
}

std::array<Count, phase_names.size()> phase_counts() {
  std::array<Count, phase_names.size()> counts;
  std::ranges::transform(phase_names, counts.begin(), phase_count);
  return counts;
}

template <int Dim>
nlohmann::ordered_json measure(MPI_Comm comm, const Case& config) {
  const int warm_up = option("-bench_warm_up", 10);
  const int steps = option("-bench_steps", 30);
  PetscBool cold = PETSC_FALSE;
  petsc_check(PetscOptionsHasName(nullptr, nullptr, "-bench_cold", &cold));
  petsc_check(PetscLogDefaultBegin());

  const double bytes_before = sum_over_ranks(comm, process_bytes("VmRSS"));
  auto simulation = make_simulation<Dim>(comm, config);
  for (int k = 0; k < warm_up; ++k) simulation.step();

  auto counts = phase_counts();
  for (Count& count : counts)
    for (double& value : count) value = -value;
  int iterations = 0;
  MPI_Barrier(comm);
  const double start = MPI_Wtime();
  for (int k = 0; k < steps; ++k) {
    if (cold) simulation.forget_pressure();
    simulation.step();
    iterations += simulation.report().pressure.iterations;
  }
  const double step_seconds = max_over_ranks(comm, MPI_Wtime() - start) / steps;
  const auto counts_after = phase_counts();
  const double peak_bytes = sum_over_ranks(comm, process_bytes("VmHWM"));
  const double own_bytes = sum_over_ranks(comm, static_cast<double>(simulation.bytes()));

  // Means over steps and ranks.
  Count total{};
  nlohmann::ordered_json shares;
  std::array<double, phase_names.size()> seconds;
  for (std::size_t phase = 0; phase < counts.size(); ++phase) {
    for (std::size_t k = 0; k < total.size(); ++k) {
      double& value = counts[phase][k];
      value = sum_over_ranks(comm, value + counts_after[phase][k]) / steps / ranks_of(comm);
      total[k] += value;
    }
    seconds[phase] = counts[phase][0];
    shares[phase_names[phase]] = seconds[phase] / step_seconds;
  }
  const auto seconds_of = [&](std::string_view name) {
    return seconds[static_cast<std::size_t>(std::ranges::find(phase_names, name) - phase_names.begin())];
  };

  // The unit of cost is a product with the whole matrix, whatever half of it the solver stores.
  const PetscMatrix matrix = simulation.pressure_solver().whole_matrix(simulation.decomposition().rows());
  const double product = product_seconds(comm, matrix);
  const double solver_product = product_seconds(comm, simulation.pressure_solver().matrix());
  const double bandwidth = triad_bandwidth(comm);
  const auto particles = static_cast<double>(simulation.report().particles);
  return {
      {"ranks", ranks_of(comm)},
      {"particles", simulation.report().particles},
      {"fluid", simulation.report().fluid},
      {"steps", steps},
      {"us_per_particle_step", 1e6 * step_seconds / particles},
      {"us_per_fluid_particle_step", 1e6 * step_seconds / static_cast<double>(simulation.report().fluid)},
      {"step_in_matmults", step_seconds / product},
      {"iterations", static_cast<double>(iterations) / steps},
      {"assembly_in_matmults", seconds_of("PPE assembly") / product},
      {"set_up_in_matmults", seconds_of("PPE set-up") / product},
      {"solve_in_matmults", seconds_of("PPE solve") / product},
      {"matmult_ms", 1e3 * product},
      {"solver_product_in_matmults", solver_product / product},
      {"matmult_stream_bound_ms", 1e3 * product_bytes(matrix) / bandwidth},
      {"triad_gb_per_s", 1e-9 * bandwidth},
      {"share", shares},
      {"own_bytes_per_particle", own_bytes / particles},
      {"peak_bytes_per_particle", peak_bytes / particles},
      {"peak_bytes_per_particle_over_start", (peak_bytes - bytes_before) / particles},
      // A message counts where it is sent and where it is received.
      {"messages_per_rank_step", 0.5 * total[1]},
      {"kb_per_rank_step", 1e-3 * 0.5 * total[2]},
      {"reductions_per_step", total[3]},
      {"halo_over_owned",
       sum_over_ranks(comm, static_cast<double>(simulation.decomposition().rows().size())) / particles - 1.0},
  };
}

int run_program(int argc, char** argv) {
  const MPI_Comm comm = MPI_COMM_WORLD;
  const bool first = rank_of(comm) == 0;
  try {
    const CommandLine line = parse_command_line({argv + 1, argv + argc});
    const PetscSession session(argv[0], line.petsc_arguments);
    const Case config = parse_case(load_case_files_on_first_rank(comm, line.case_path), line.settings);
    const auto result = config.dimension == 3 ? measure<3>(comm, config) : measure<2>(comm, config);
    if (first) fmt::print("{}\n", result.dump(2));
    return 0;
  } catch (const InputError& error) {
    if (first)
      for (const std::string& mistake : error.mistakes()) fmt::print(stderr, "step_bench: {}\n", mistake);
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "step_bench: rank {}: {}\n", rank_of(comm), error.what());
    std::fflush(nullptr);
    MPI_Abort(comm, 1);
    return 1;
  }
}

}  // namespace
}  // namespace impinge

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  const int code = impinge::run_program(argc, argv);
  MPI_Finalize();
  return code;
}
