// Part of every program of a build with sanitizers: silences what the libraries leak.

#include <mpi.h>
#include <sanitizer/lsan_interface.h>

extern "C" {

int MPI_Init(int* argc, char*** argv) {
  const __lsan::ScopedDisabler disabler;
  return PMPI_Init(argc, argv);
}

// Open MPI unloads its modules at the end; a leak of an unloaded one could not be told from others.
int dlclose(void*) { return 0; }

/// Open MPI with what it is made of; HDF5, which keeps the memory of an object whose header it cannot read; assimp,
/// which keeps that of a surface it gives up.
const char* __lsan_default_suppressions() {
  return "leak:libmpi.so\n"
         "leak:libopen-rte.so\n"
         "leak:libopen-pal.so\n"
         "leak:libpmix.so\n"
         "leak:libmca_\n"
         "leak:/openmpi/lib/\n"
         "leak:libhdf5_openmpi.so\n"
         "leak:libassimp.so\n";
}

/// HDF5 asks for as much memory as a damaged file says, and does without.
const char* __asan_default_options() { return "allocator_may_return_null=1"; }
const char* __lsan_default_options() { return "print_suppressions=0"; }
const char* __ubsan_default_options() { return "print_stacktrace=1"; }
}
