#include "impinge/programs/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "impinge/method/costs.hpp"
#include "impinge/method/pressure/two_level.hpp"
#include "impinge/parallel/decomposition.hpp"
#include "impinge/scenes/scenes.hpp"

namespace impinge {
namespace {

// Particles of each cell, of all ranks.
struct CellCounts {
  std::vector<int> work, particles, rows;
};

template <int Dim>
CellCounts count_particles(MPI_Comm comm, const CellGrid<Dim>& cells, const Scene<Dim>& scene) {
  const auto n_cells = static_cast<std::size_t>(cells.count());
  CellCounts counts{std::vector<int>(n_cells), std::vector<int>(n_cells), std::vector<int>(n_cells)};
  // One piece after the other, so that the particles are never all in memory.
  constexpr std::int64_t of_a_piece = 100'000;
  const int pieces = static_cast<int>(scene.next_id / of_a_piece / ranks_of(comm)) + 1;
  for (int piece = 0; piece < pieces; ++piece) {
    Particles<Dim> particles;
    scene.fill(rank_of(comm) * pieces + piece, ranks_of(comm) * pieces, particles);
    add_work<Dim>(cells, particles, counts.work);
    for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
      const int at = cells.cell(cells.wrapped(particles.position[i]));
      if (at < 0) continue;
      const ParticleType type = particles.type[i];
      ++counts.particles[static_cast<std::size_t>(at)];
      counts.rows[static_cast<std::size_t>(at)] += type == ParticleType::fluid || type == ParticleType::wall;
    }
  }
  for (auto* values : {&counts.work, &counts.particles, &counts.rows})
    MPI_Allreduce(MPI_IN_PLACE, values->data(), cells.count(), MPI_INT, MPI_SUM, comm);
  return counts;
}

template <int Dim>
void count_halo(const CellGrid<Dim>& cells, std::span<const int> owner, const CellCounts& counts, Plan& plan) {
  std::vector<std::pair<int, int>> exchanges;  // (receiver, sender)
  std::vector<HaloTarget<Dim>> targets;
  for (int cell = 0; cell < cells.count(); ++cell) {
    const auto c = static_cast<std::size_t>(cell);
    if (counts.particles[c] == 0) continue;
    targets.clear();
    append_halo_targets<Dim>(cells, owner, cell, targets);
    for (const auto& target : targets) {
      RankPlan& receiver = plan.ranks[static_cast<std::size_t>(target.rank)];
      receiver.halo += counts.particles[c];
      if (target.rank == owner[c]) continue;
      receiver.received += counts.particles[c];
      exchanges.emplace_back(target.rank, owner[c]);
    }
  }
  std::sort(exchanges.begin(), exchanges.end());
  exchanges.erase(std::unique(exchanges.begin(), exchanges.end()), exchanges.end());
  for (const auto& [receiver, sender] : exchanges) ++plan.ranks[static_cast<std::size_t>(receiver)].neighbours;
}

// A rank has the coarse values of its cells and of those around them.
template <int Dim>
void count_node_copies(const CellGrid<Dim>& cells, std::span<const int> owner, Plan& plan) {
  std::vector<int> users;
  for (int cell = 0; cell < cells.count(); ++cell) {
    users.assign(1, owner[static_cast<std::size_t>(cell)]);
    for_cells_around(cells, cell, TwoLevelPreconditioner<Dim>::node_reach, [&](int near, const Vector<Dim>&) {
      const int user = owner[static_cast<std::size_t>(near)];
      if (std::find(users.begin(), users.end(), user) != users.end()) return;
      users.push_back(user);
      ++plan.ranks[static_cast<std::size_t>(user)].node_copies;
    });
  }
}

}  // namespace

template <int Dim>
Plan plan_run(MPI_Comm comm, const Case& config, int ranks) {
  const Scene<Dim> scene = make_scene<Dim>(config, config);
  const CellGrid<Dim> cells(scene.bounds, scene.periodic, least_cell_edge(config));
  constexpr double of_a_cell = 2e-7, patience = 1.0;  // measured with few particles in each; what needs no word [s]
  if (const double seconds = of_a_cell * cells.count(); seconds > patience && rank_of(comm) == 0)
    fmt::print(stderr, "impinge: planning {} background cells takes some {:.2g} s\n", cells.count(), seconds);
  const CellCounts counts = count_particles<Dim>(comm, cells, scene);
  // One process partitions: PTScotch waits for ever where three are to make more than three parts.
  std::vector<int> owner(counts.work.size());
  if (rank_of(comm) == 0)
    owner = distribute_cells<Dim>(MPI_COMM_SELF, cells, counts.work, ranks, config.parallel.partitioner);
  MPI_Bcast(owner.data(), cells.count(), MPI_INT, 0, comm);

  Plan plan;
  plan.cells = cells.count();
  plan.ranks.resize(static_cast<std::size_t>(ranks));
  for (std::size_t cell = 0; cell < owner.size(); ++cell) {
    RankPlan& rank = plan.ranks[static_cast<std::size_t>(owner[cell])];
    rank.work += counts.work[cell];
    rank.owned += counts.particles[cell];
    rank.rows += counts.rows[cell];
    rank.nodes += counts.particles[cell] > 0;
    plan.occupied += counts.particles[cell] > 0;
  }
  count_halo<Dim>(cells, owner, counts, plan);
  count_node_copies<Dim>(cells, owner, plan);

  const UnitCosts costs = unit_costs<Dim>(config);
  for (RankPlan& rank : plan.ranks) {
    rank.field_bytes = static_cast<double>(rank.received) * sizeof(double);
    rank.step_bytes = static_cast<double>(rank.received) * costs.halo_traffic;
    rank.iteration_bytes = static_cast<double>(rank.received + 2 * rank.node_copies) * sizeof(double);
    rank.memory = static_cast<double>(rank.owned + rank.halo) * costs.particle_memory +
                  static_cast<double>(rank.rows) * costs.row_memory +
                  static_cast<double>(plan.cells) * costs.cell_memory;
  }
  return plan;
}

template Plan plan_run<2>(MPI_Comm, const Case&, int);
template Plan plan_run<3>(MPI_Comm, const Case&, int);

}  // namespace impinge
