#pragma once
// What the program `impinge` does with a case.

#include <mpi.h>

#include <string>
#include <vector>

#include "impinge/cases/case.hpp"

namespace impinge {

/// load_case_files on rank 0, the texts on all ranks. Collective; throws InputError on all ranks.
std::vector<NamedText> load_case_files_on_first_rank(MPI_Comm comm, const std::string& path);

/// Sets the case up without running it; prints particles, memory, balance, the scene and the limits of dt; writes and
/// draws the scene, in the place of what an earlier call has written. Collective. Throws InputError where a run could
/// not be or could not write, FileError.
void check_case(MPI_Comm comm, const Case& config);

/// Decomposes the case's initial state for `ranks` ranks, whatever the size of `comm`, and prints what each would own
/// and exchange. Collective; throws InputError for PETSc options that nothing uses.
void plan_case(MPI_Comm comm, const Case& config, int ranks);

/// Runs the case to its end, with progress on the terminal and files in the output directory. Collective. Throws
/// SolveError after the last state has been written, InputError also for PETSc options that nothing uses, FileError.
/// Returns false where a signal ended the run before, with a checkpoint.
bool run_case(MPI_Comm comm, const Case& config);

/// Goes on from the last checkpoint in `directory` that can be read, with `settings` over its case; tells about others.
/// Otherwise as run_case. Throws InputError where there is none.
bool restart_case(MPI_Comm comm, const std::string& directory, const std::vector<std::string>& settings);

}  // namespace impinge
