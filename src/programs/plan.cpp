#include "impinge/programs/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <numeric>
#include <utility>

#include "impinge/method/costs.hpp"
#include "impinge/method/pressure/coarse_solver.hpp"
#include "impinge/method/pressure/two_level.hpp"
#include "impinge/parallel/decomposition.hpp"
#include "impinge/scenes/scenes.hpp"

namespace impinge {
namespace {

// Particles of a cell, of all ranks or of some.
struct CellCount {
  std::int64_t key;
  int particles, rows;
};

void merge(std::vector<CellCount>& counts) {
  merge_keys(counts, [](CellCount& to, const CellCount& from) {
    to.particles += from.particles;
    to.rows += from.rows;
  });
}

// On rank 0.
template <int Dim>
std::vector<CellCount> count_particles(MPI_Comm comm, const CellGrid<Dim>& cells, const CellCurve<Dim>& curve,
                                       const Scene<Dim>& scene) {
  std::vector<CellCount> counts;
  std::size_t merged = 0;
  // One piece after the other, so that the particles are never all in memory.
  constexpr std::int64_t of_a_piece = 100'000;
  const int pieces = static_cast<int>(scene.next_id / of_a_piece / ranks_of(comm)) + 1;
  for (int piece = 0; piece < pieces; ++piece) {
    Particles<Dim> particles;
    scene.fill(rank_of(comm) * pieces + piece, ranks_of(comm) * pieces, particles);
    std::int64_t last = -1;
    for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
      const std::int64_t cell = cells.cell(cells.wrapped(particles.position[i]));
      if (cell < 0) continue;
      if (cell != last) counts.push_back({curve.key(cells.coordinates(cell)), 0, 0});
      last = cell;
      ++counts.back().particles;
      counts.back().rows += has_row(particles.type[i]);
    }
    if (constexpr std::size_t few = 1 << 22; counts.size() > 2 * merged + few || piece + 1 == pieces) {
      merge(counts);
      merged = counts.size();
    }
  }
  std::vector<std::pair<int, CellCount>> sends;
  if (ranks_of(comm) == 1) return counts;
  for (const CellCount& count : counts) sends.emplace_back(0, count);
  counts = exchange_items(comm, std::span<const std::pair<int, CellCount>>(sends));
  merge(counts);
  return counts;
}

// Particles and coarse values that each rank receives, as if each cell with particles had a coarse row.
template <int Dim>
void count_copies(const CellGrid<Dim>& cells, const CellOwners<Dim>& owner, std::span<const CellCount> counts,
                  Plan& plan) {
  std::vector<std::pair<int, int>> exchanges;  // (receiver, sender)
  const auto make_distinct = [&] {
    std::ranges::sort(exchanges);
    exchanges.erase(std::unique(exchanges.begin(), exchanges.end()), exchanges.end());
  };
  constexpr int reach = TwoLevelPreconditioner<Dim>::node_reach;
  const CoarseBlocks blocks =
      CoarseBlocks::of(plan.occupied, static_cast<int>(plan.ranks.size()), CoarseSolver::default_rows_per_rank(Dim));
  std::vector<std::int64_t> next_row(plan.ranks.size());  // by rank, and on a rank by key
  std::transform_exclusive_scan(plan.ranks.begin(), plan.ranks.end(), next_row.begin(), std::int64_t{0}, std::plus{},
                                [](const RankPlan& rank) { return rank.nodes; });
  std::vector<HaloTarget<Dim>> targets;
  std::vector<int> users;
  std::size_t distinct = 0;
  for (const CellCount& count : counts) {
    Vector<Dim> shift;
    const std::int64_t cell = cells.wrapped_cell(owner.curve().coordinates(count.key), shift);
    const int self = owner(cell);
    targets.clear();
    append_halo_targets<Dim>(cells, owner, cell, targets);
    for (const auto& target : targets) {
      RankPlan& receiver = plan.ranks[static_cast<std::size_t>(target.rank)];
      receiver.halo += count.particles;
      if (target.rank == self) continue;
      receiver.received += count.particles;
      exchanges.emplace_back(target.rank, self);
    }
    if (exchanges.size() > 2 * distinct + 1'000'000) {
      make_distinct();
      distinct = exchanges.size();
    }
    users.assign(1, self);
    for_cells_around(cells, cell, reach, [&](std::int64_t near, const Vector<Dim>&) {
      const int user = owner(near);
      if (std::ranges::find(users, user) == users.end()) users.push_back(user);
    });
    const int solver = blocks.rank_of_row(next_row[static_cast<std::size_t>(self)]++);
    for (const int user : users) {
      if (user == solver) continue;
      ++plan.ranks[static_cast<std::size_t>(user)].coarse_values;
      ++plan.ranks[static_cast<std::size_t>(solver)].coarse_values;
    }
  }
  make_distinct();
  for (const auto& [receiver, sender] : exchanges) ++plan.ranks[static_cast<std::size_t>(receiver)].neighbours;
}

// The plan of one process, without the costs.
template <int Dim>
Plan plan_of(const CellGrid<Dim>& cells, std::span<const CellCount> counts, int ranks, Partitioner partitioner) {
  std::vector<CellWork> work;
  work.reserve(counts.size());
  for (const CellCount& count : counts) work.push_back({count.key, work_of(count.particles, count.rows)});
  Plan plan;
  plan.occupied = static_cast<std::int64_t>(counts.size());
  const CellOwners<Dim> owner(cells, distribute_cells<Dim>(MPI_COMM_SELF, cells, work, ranks, partitioner).segments);
  work = {};
  plan.segments = static_cast<std::int64_t>(owner.segments().size());
  plan.ranks.resize(static_cast<std::size_t>(ranks));
  auto segment = owner.segments().begin();
  for (const CellCount& count : counts) {
    while (segment + 1 != owner.segments().end() && (segment + 1)->first <= count.key) ++segment;
    RankPlan& rank = plan.ranks[static_cast<std::size_t>(segment->rank)];
    rank.work += work_of(count.particles, count.rows);
    rank.owned += count.particles;
    rank.rows += count.rows;
    ++rank.nodes;
  }
  count_copies<Dim>(cells, owner, counts, plan);
  return plan;
}

}  // namespace

template <int Dim>
Plan plan_run(MPI_Comm comm, const Case& config, int ranks) {
  const Scene<Dim> scene = make_scene<Dim>(config, config);
  const CellGrid<Dim> cells(scene.bounds, scene.periodic, least_cell_edge(config));
  constexpr double of_a_particle = 3e-7, patience = 1.0;  // measured; what needs no word [s]
  if (const double seconds = of_a_particle * static_cast<double>(scene.next_id);
      seconds > patience && rank_of(comm) == 0)
    fmt::print(stderr, "impinge: planning {:.2g} particles takes some {:.2g} s\n", static_cast<double>(scene.next_id),
               seconds);
  const CellCurve<Dim> curve(cells);
  std::vector<CellCount> counts = count_particles<Dim>(comm, cells, curve, scene);
  // One process partitions: PTScotch waits for ever where three are to make more than three parts.
  Plan plan;
  if (rank_of(comm) == 0) plan = plan_of<Dim>(cells, counts, ranks, config.parallel.partitioner);
  plan.ranks.resize(static_cast<std::size_t>(ranks));
  MPI_Datatype rank_plan;
  MPI_Type_contiguous(sizeof(RankPlan), MPI_BYTE, &rank_plan);
  MPI_Type_commit(&rank_plan);
  MPI_Bcast(plan.ranks.data(), ranks, rank_plan, 0, comm);
  MPI_Type_free(&rank_plan);
  for (std::int64_t* number : {&plan.occupied, &plan.segments}) MPI_Bcast(number, 1, MPI_INT64_T, 0, comm);
  double work = 0.0;
  for (const RankPlan& rank : plan.ranks) work += static_cast<double>(rank.work);
  plan.partitioner = chosen_partitioner(config.parallel.partitioner, ranks, work);
  plan.key_bits = curve.bits();
  plan.cells = cells.count();

  const UnitCosts costs = unit_costs<Dim>(config);
  for (RankPlan& rank : plan.ranks) {
    rank.field_bytes = static_cast<double>(rank.received) * sizeof(double);
    rank.step_bytes = static_cast<double>(rank.received) * costs.halo_traffic;
    rank.iteration_bytes = static_cast<double>(rank.received + rank.coarse_values) * sizeof(double);
    rank.memory = static_cast<double>(rank.owned + rank.halo) * costs.particle_memory +
                  static_cast<double>(rank.rows) * costs.row_memory + static_cast<double>(plan.table_bytes());
  }
  return plan;
}

template Plan plan_run<2>(MPI_Comm, const Case&, int);
template Plan plan_run<3>(MPI_Comm, const Case&, int);

}  // namespace impinge
