#include "impinge/programs/core_check.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>

#include "impinge/core/mpi.hpp"

namespace impinge {
namespace {

// Processes beside `ranks` that want a core now and did so in the last minute.
int other_processes(int ranks) {
  double load = 0.0;
  std::ifstream("/proc/loadavg") >> load;
  std::ifstream statistics("/proc/stat");
  int running = 0;
  for (std::string word; statistics >> word;)
    if (word == "procs_running") statistics >> running;
  return std::max(std::min(running - ranks, static_cast<int>(std::lround(load))), 0);
}

}  // namespace

std::string core_warning(int ranks, int cores, int others) {
  const int free = std::max(cores - others, 1);
  if (ranks <= free) return "";
  const std::string in_use = others > 0 ? fmt::format(", {} of them in use", std::min(others, cores)) : "";
  return fmt::format(
      "{} ranks share a node with {} cores{}: ranks that wait keep a core busy, and all become slow; start "
      "{}, or set OMPI_MCA_mpi_yield_when_idle=1",
      ranks, cores, in_use, free);
}

void check_cores(MPI_Comm comm) {
  if (ranks_of(comm) == 1 || std::getenv("OMPI_MCA_mpi_yield_when_idle") != nullptr) return;
  MPI_Comm node = MPI_COMM_NULL;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
  const int ranks = ranks_of(node);
  MPI_Comm_free(&node);
  if (rank_of(comm) != 0) return;
  const std::string warning =
      core_warning(ranks, static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN)), other_processes(ranks));
  if (!warning.empty()) fmt::print(stderr, "impinge: warning: {}\n", warning);
}

}  // namespace impinge
