#include "impinge/programs/memory_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "impinge/core/communicator.hpp"
#include "impinge/core/errors.hpp"
#include "impinge/core/memory.hpp"
#include "impinge/method/costs.hpp"
#include "impinge/parallel/decomposition.hpp"
#include "impinge/scenes/scenes.hpp"

namespace impinge {
namespace {

constexpr double libraries = 40e6;           // measured without a case [bytes]
constexpr double with_preconditioner = 1.5;  // over the arrays: measured 1.5 in 2D, 1.05 in 3D
constexpr double plan_of_a_cell = 100.0;     // with particles; measured [bytes]

/// Owned particles of a scene, and those with a row of the matrix.
struct Counts {
  double particles = 0.0, rows = 0.0;
};

/// Equal pieces of the scene, spread evenly over it, stand for the whole.
template <int Dim>
Counts count(const Scene<Dim>& scene) {
  constexpr std::int64_t of_a_piece = 1024, most_pieces = 256;
  const std::int64_t pieces = scene.next_id / of_a_piece + 1;
  const std::int64_t tried = std::min(pieces, most_pieces);
  Counts counts;
  for (std::int64_t k = 0; k < tried; ++k) {
    Particles<Dim> particles;
    scene.fill(static_cast<int>((2 * k + 1) * pieces / (2 * tried)), static_cast<int>(pieces), particles);
    counts.particles += static_cast<double>(particles.owned);
    counts.rows += static_cast<double>(std::ranges::count_if(
        particles.type, [](ParticleType type) { return type == ParticleType::fluid || type == ParticleType::wall; }));
  }
  const double scale = static_cast<double>(pieces) / static_cast<double>(tried);
  return {scale * counts.particles, scale * counts.rows};
}

/// Throws InputError where an axis has more background cells than they have numbers for.
template <int Dim>
void check_extent(const Scene<Dim>& scene, const Case& config) {
  constexpr int most = CellGrid<Dim>::most_extent;
  for (int k = 0; k < Dim; ++k)
    if (const double cells = (scene.bounds.high[k] - scene.bounds.low[k]) / least_cell_edge(config); cells > most)
      throw InputError(
          {fmt::format("{}: particles.spacing = {}: makes some {:.2g} background cells along an axis; "
                       "allowed: at most {}",
                       config.spacing_place, number_text(config.particles.spacing), cells, most)});
}

/// Background cells with particles.
template <int Dim>
double occupied_cells(double particles, const Case& config) {
  return particles / std::pow(config.kernel.cell_edge(), Dim);
}

/// The graph of the cells with particles, where it is partitioned [bytes].
template <int Dim>
double graph_of(const Counts& counts, const Case& config, int ranks) {
  const double work = counts.particles + 3.0 * counts.rows;  // see work_of
  if (ranks == 1 || chosen_partitioner(config.parallel.partitioner, ranks, work) == Partitioner::curve) return 0.0;
  return occupied_cells<Dim>(counts.particles, config) * graph_memory(static_cast<int>(std::pow(3.0, Dim)) - 1);
}

/// The ranks of this node. Collective.
Communicator ranks_of_node(MPI_Comm comm) {
  MPI_Comm node = MPI_COMM_NULL;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
  return Communicator(node);
}

/// What the ranks need over what is free, of the rank or the node where that is most; `need`: of this rank [bytes].
/// Collective.
double load(MPI_Comm comm, double need) {
  const Communicator node = ranks_of_node(comm);
  const double of_node = sum_over_ranks(node, need) / free_memory_of_node();
  return max_over_ranks(comm, std::max(of_node, need / free_memory_of_process()));
}

[[noreturn]] void refuse(const Case& config, double particles, double need, double free, double spacing,
                         const char* instead) {
  throw InputError(
      {fmt::format("{}: particles.spacing = {}: not enough memory: some {:.3g} particles need {} on a rank, {} are "
                   "free for it; allowed: from about {:.2g} (m) on{}",
                   config.spacing_place, number_text(config.particles.spacing), particles, bytes_text(need),
                   bytes_text(free), spacing, instead)});
}

}  // namespace

template <int Dim>
MemoryNeed memory_need(const Case& config, int ranks, std::int64_t particles) {
  const Scene<Dim> scene = make_scene<Dim>(config, config);
  check_extent(scene, config);
  const UnitCosts costs = unit_costs<Dim>(config);
  const Counts counts =
      particles > 0 ? Counts{static_cast<double>(particles), static_cast<double>(particles)} : count(scene);
  const double owned = counts.particles / ranks;
  // Around a cube of the owned ones.
  const double halo = std::pow(std::pow(owned, 1.0 / Dim) + 2.0 * config.kernel.largest(), Dim) - owned;
  return {.particles = counts.particles,
          .rank = (owned + halo) * costs.particle_memory + counts.rows / ranks * costs.row_memory + libraries,
          .graph = graph_of<Dim>(counts, config, ranks)};
}

double free_memory(MPI_Comm comm) {
  const Communicator node = ranks_of_node(comm);
  const double share = free_memory_of_node() / ranks_of(node);
  return -max_over_ranks(comm, -std::min(share, free_memory_of_process()));
}

template <int Dim>
void check_memory(MPI_Comm comm, const Case& config, std::int64_t particles) {
  const MemoryNeed need = memory_need<Dim>(config, ranks_of(comm), particles);
  const bool partitions = rank_of(comm) == 0 || config.parallel.partitioner == Partitioner::ptscotch;
  const double used = load(comm, need.rank + (partitions ? need.graph : 0.0));
  const double free = free_memory(comm);
  if (used > 1.0)
    refuse(config, need.particles, need.rank + need.graph, free, config.particles.spacing * std::pow(used, 1.0 / Dim),
           ", or more nodes (--plan)");
  if (with_preconditioner * used > 1.0 && rank_of(comm) == 0)
    fmt::print(stderr, "impinge: warning: memory may run out: {} to {} are needed on a rank, {} are free for it\n",
               bytes_text(need.rank + need.graph), bytes_text(with_preconditioner * need.rank + need.graph),
               bytes_text(free));
}

template <int Dim>
void check_memory_of_plan(MPI_Comm comm, const Case& config, int ranks) {
  const Scene<Dim> scene = make_scene<Dim>(config, config);
  check_extent(scene, config);
  const Counts counts = count(scene);
  const double particles = counts.particles;
  const double need =
      occupied_cells<Dim>(particles, config) * plan_of_a_cell + graph_of<Dim>(counts, config, ranks) + libraries;
  const double free = free_memory(comm);
  if (need > free)
    refuse(config, particles, need, free, config.particles.spacing * std::pow(need / free, 1.0 / Dim),
           ", or fewer processes");
}

#define IMPINGE_INSTANTIATE(Dim)                                        \
  template MemoryNeed memory_need<Dim>(const Case&, int, std::int64_t); \
  template void check_memory<Dim>(MPI_Comm, const Case&, std::int64_t); \
  template void check_memory_of_plan<Dim>(MPI_Comm, const Case&, int);
IMPINGE_INSTANTIATE(2)
IMPINGE_INSTANTIATE(3)
#undef IMPINGE_INSTANTIATE

}  // namespace impinge
