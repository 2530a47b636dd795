// impinge: runs a case.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mpi.h>
#include <petscsys.h>

#include <cstdio>
#include <new>

#include "impinge/cases/case.hpp"
#include "impinge/core/errors.hpp"
#include "impinge/core/petsc.hpp"
#include "impinge/io/hdf5_file.hpp"
#include "impinge/method/simulation.hpp"
#include "impinge/parallel/exchange.hpp"
#include "impinge/programs/command_line.hpp"
#include "impinge/programs/run.hpp"
#include "impinge/programs/standard_streams.hpp"

namespace {

enum ExitCode { done = 0, broken = 1, wrong_input = 2, failed_solve = 3, stopped = 4 };

/// Prints what --help, --version, --describe, --schema or --new ask for; false for any other command line. MPI need not
/// work.
bool print_text(int argc, char** argv) {
  try {
    const std::string text = impinge::parse_command_line({argv + 1, argv + argc}).text;
    if (impinge::launched_process().rank == 0) fmt::print("{}", text);
    return !text.empty();
  } catch (const impinge::InputError&) {
    return false;  // run_program tells it, on one rank
  }
}

/// Throws FileError where a launcher has started several processes, but each is alone: it is not of this MPI.
void refuse_lone_processes(MPI_Comm comm) {
  using namespace impinge;
  const LaunchedProcess launched = launched_process();
  if (ranks_of(comm) > 1 || launched.processes == 1) return;
  char version[MPI_MAX_LIBRARY_VERSION_STRING];
  int length = 0;
  MPI_Get_library_version(version, &length);
  const std::string_view text(version, static_cast<std::size_t>(length));
  throw FileError(
      fmt::format("process {} of {} ({}) is alone for its MPI ({}): each would run the whole case; start it "
                  "with the mpirun or srun of that MPI",
                  launched.rank, launched.processes, launched.variable, text.substr(0, text.find(','))));
}

/// What main does between MPI_Init and MPI_Finalize. Errors that all ranks share are told by rank 0; an error of one
/// rank ends the job at once, for the others may be waiting for it.
int run_program(int argc, char** argv) {
  using namespace impinge;
  const MPI_Comm comm = MPI_COMM_WORLD;
  const bool first = rank_of(comm) == 0;
  try {
    refuse_lone_processes(comm);
    const CommandLine line = parse_command_line({argv + 1, argv + argc});
    const PetscSession session(argv[0], line.petsc_arguments);
    if (const auto& others = session.options_from_elsewhere(); first && !others.empty())
      fmt::print("PETSc options from PETSC_OPTIONS or .petscrc: {}\n", fmt::join(others, " "));
    if (!line.restart_directory.empty())
      return restart_case(comm, line.restart_directory, line.settings) ? done : stopped;
    const Case config = parse_case(load_case_files_on_first_rank(comm, line.case_path), line.settings);
    if (line.check) {
      check_case(comm, config);
    } else if (line.plan_ranks > 0) {
      plan_case(comm, config, line.plan_ranks);
    } else {
      return run_case(comm, config) ? done : stopped;
    }
    return flush_output("impinge") ? done : broken;
  } catch (const InputError& error) {
    if (first)
      for (const std::string& mistake : error.mistakes()) fmt::print(stderr, "impinge: {}\n", mistake);
    return wrong_input;
  } catch (const SolveError& error) {
    if (first) fmt::print(stderr, "impinge: the run failed at {}\n", error.what());
    return failed_solve;
  } catch (const FileError& error) {
    if (first) fmt::print(stderr, "impinge: {}\n", error.what());
    return broken;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "impinge: rank {}: out of memory; --check and --plan tell what the case needs\n", rank_of(comm));
    std::fflush(nullptr);
    MPI_Abort(comm, broken);
    return broken;
  } catch (const std::exception& error) {
    fmt::print(stderr, "impinge: rank {}: {}\n", rank_of(comm), error.what());
    std::fflush(nullptr);
    MPI_Abort(comm, broken);
    return broken;
  }
}

}  // namespace

int main(int argc, char** argv) {
  impinge::prepare_streams();
  if (print_text(argc, argv)) return impinge::flush_output("impinge") ? done : broken;
  impinge::prepare_file_access();
  MPI_Init(&argc, &argv);
  const int code = run_program(argc, argv);
  impinge::flush_output("impinge");  // a run is done without it, too
  MPI_Finalize();
  return code;
}
