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

namespace {

enum ExitCode { done = 0, broken = 1, wrong_input = 2, failed_solve = 3, stopped = 4 };

/// What main does between MPI_Init and MPI_Finalize. Errors that all ranks share are told by rank 0; an error of one
/// rank ends the job at once, for the others may be waiting for it.
int run_program(int argc, char** argv) {
  using namespace impinge;
  const MPI_Comm comm = MPI_COMM_WORLD;
  const bool first = rank_of(comm) == 0;
  try {
    const CommandLine line = parse_command_line({argv + 1, argv + argc});
    if (!line.text.empty()) {
      if (first) fmt::print("{}", line.text);
      return done;
    }
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
    return done;
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
  impinge::prepare_file_access();
  MPI_Init(&argc, &argv);
  const int code = run_program(argc, argv);
  MPI_Finalize();
  return code;
}
