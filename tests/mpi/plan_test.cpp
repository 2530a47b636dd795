// A plan for N ranks, made on one process, is what a run on N ranks has.

#include "impinge/programs/plan.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <fstream>
#include <numeric>
#include <set>

#include "gather.hpp"
#include "impinge/cases/make_simulation.hpp"
#include "impinge/core/memory.hpp"
#include "impinge/programs/memory_check.hpp"
#include "shipped_case.hpp"

namespace impinge {
namespace {

const MPI_Comm comm = MPI_COMM_WORLD;

/// What this rank has at the start of a run.
template <int Dim>
void expect_plan_of_this_rank(const Case& config, MPI_Comm planners) {
  const Plan plan = plan_run<Dim>(planners, config, ranks_of(comm));
  ASSERT_EQ(plan.ranks.size(), static_cast<std::size_t>(ranks_of(comm)));
  const RankPlan& here = plan.ranks[static_cast<std::size_t>(rank_of(comm))];

  const auto simulation = make_simulation<Dim>(comm, config);
  const Particles<Dim>& particles = simulation.particles();
  const auto has_row = [&](int i) {
    const ParticleType type = particles.type[static_cast<std::size_t>(i)];
    return type == ParticleType::fluid || type == ParticleType::wall;
  };
  const std::vector<int> owned = gather(comm, std::vector<int>{particles.owned});
  std::vector<PetscInt> row_end(owned.size());
  std::partial_sum(owned.begin(), owned.end(), row_end.begin());
  std::int64_t rows = 0;
  std::int64_t received = 0;
  std::set<std::ptrdiff_t> senders;
  const std::span<const PetscInt> rows_with_halo = simulation.decomposition().rows();
  for (int i = 0; i < static_cast<int>(rows_with_halo.size()); ++i) {
    if (i < particles.owned) {
      rows += has_row(i);
      continue;
    }
    const PetscInt row = rows_with_halo[static_cast<std::size_t>(i)];
    const auto sender = std::upper_bound(row_end.begin(), row_end.end(), row) - row_end.begin();
    senders.insert(sender);
    if (sender != rank_of(comm)) ++received;
  }
  senders.erase(rank_of(comm));
  EXPECT_EQ(here.owned, particles.owned);
  EXPECT_EQ(here.rows, rows);
  EXPECT_EQ(here.halo, static_cast<std::int64_t>(rows_with_halo.size()) - particles.owned);
  EXPECT_EQ(here.received, received);
  EXPECT_EQ(here.neighbours, static_cast<std::int64_t>(senders.size()));
  EXPECT_EQ(plan.cells, simulation.decomposition().cells().count());

  std::int64_t most = 0;
  std::int64_t sum = 0;
  for (const RankPlan& rank : plan.ranks) {
    most = std::max(most, rank.work);
    sum += rank.work;
  }
  EXPECT_DOUBLE_EQ(static_cast<double>(most * ranks_of(comm)) / static_cast<double>(sum), simulation.imbalance());
}

TEST(Plan, IsWhatARunHas) {
  for (const char* start : {"impact", "steady"})
    expect_plan_of_this_rank<2>(shipped_case("jet60-quick.toml", {fmt::format("jet.start={}", start)}), MPI_COMM_SELF);
  expect_plan_of_this_rank<2>(shipped_case("hydrostatic.toml"), MPI_COMM_SELF);
  expect_plan_of_this_rank<2>(shipped_case("shear-wave.toml"), MPI_COMM_SELF);
  expect_plan_of_this_rank<3>(shipped_case("hydrostatic-3d.toml"), MPI_COMM_SELF);
  expect_plan_of_this_rank<2>(shipped_case("shear-wave.toml", {"parallel.partitioner=curve"}), MPI_COMM_SELF);
  expect_plan_of_this_rank<3>(shipped_case("hydrostatic-3d.toml", {"parallel.partitioner=curve"}), MPI_COMM_SELF);
}

// Nothing is as long as the cells of the domain, and none of it depends on the others.
TEST(Plan, OfASmallDropInALargeHallIsSmall) {
  const auto drop = [](const char* domain) {
    return parse_case({{"case.toml", fmt::format(R"(geometry = "scene"
dimension = 3
particles.spacing = 0.01
time = {{end = 1.0, dt = 1e-3}}
fluid.region = [{{shape = "sphere", center = [0, 0, 0], radius = 0.05}}]
domain = {}
)",
                                                 domain)}});
  };
  const Case hall = drop("{low = [-100, -100, -100], high = [100, 100, 100]}");
  const Plan plan = plan_run<3>(comm, hall, 3);
  EXPECT_GT(plan.cells, 100'000'000'000);
  EXPECT_LT(plan.occupied, 1000);
  auto simulation = make_simulation<3>(comm, hall);
  for (int step = 0; step < 3; ++step) simulation.step();
  EXPECT_LT(simulation.bytes(), 20'000'000);
  EXPECT_EQ(simulation.report().lost, 0);
}

// With the same particles everywhere, a cut by the curve is as even as cells can make it.
TEST(Plan, CurveBalancesAsMetisDoes) {
  const auto imbalance = [](const char* partitioner) {
    const Plan plan =
        plan_run<2>(comm,
                    shipped_case("hydrostatic.toml",
                                 {"particles.spacing=1e-3", fmt::format("parallel.partitioner={}", partitioner)}),
                    40);
    std::int64_t most = 0, sum = 0;
    for (const RankPlan& rank : plan.ranks) {
      most = std::max(most, rank.work);
      sum += rank.work;
    }
    return 40.0 * static_cast<double>(most) / static_cast<double>(sum);
  };
  EXPECT_LT(imbalance("curve"), imbalance("metis") + 0.02);
}

TEST(Plan, IsTheSameOnEveryNumberOfProcesses) { expect_plan_of_this_rank<2>(shipped_case("jet60-quick.toml"), comm); }

TEST(Plan, HoldsEveryParticleOnceWhereRanksAreMany) {
  const Case config = shipped_case("jet60-quick.toml");
  const auto simulation = make_simulation<2>(MPI_COMM_SELF, config);
  for (const char* partitioner : {"metis", "ptscotch", "curve"}) {
    for (const int ranks : {1, 16, 1000}) {
      const Plan plan = plan_run<2>(
          comm, shipped_case("jet60-quick.toml", {fmt::format("parallel.partitioner={}", partitioner)}), ranks);
      std::int64_t owned = 0;
      std::int64_t occupied = 0;
      for (const RankPlan& rank : plan.ranks) {
        owned += rank.owned;
        occupied += rank.nodes;
        EXPECT_LT(rank.neighbours, ranks);
        EXPECT_EQ(rank.received > 0, rank.neighbours > 0);
      }
      EXPECT_EQ(owned, simulation.report().particles);
      EXPECT_EQ(occupied, plan.occupied);
      EXPECT_EQ(plan.ranks.size(), static_cast<std::size_t>(ranks));
    }
  }
}

// PETSc counts what it sends. A plan is an upper bound.
TEST(Plan, BoundsTheTrafficOfAStep) {
  for (const char* scheme : {"consistent", "paper"}) {
    for (const char* viscosity : {"0", "1e-4"}) {
      for (const char* distance : {"0", "0.8"}) {
        const Case config = shipped_case("jet60-quick.toml", {"jet.start=steady", fmt::format("scheme={}", scheme),
                                                              fmt::format("fluid.viscosity={}", viscosity),
                                                              fmt::format("collision.distance={}", distance)});
        const Plan plan = plan_run<2>(MPI_COMM_SELF, config, ranks_of(comm));
        auto simulation = make_simulation<2>(comm, config);
        simulation.step();
        double planned = 0.0;
        const double before = petsc_isend_len;
        for (int step = 0; step < 4; ++step) {
          simulation.step();
          for (const RankPlan& rank : plan.ranks)  // three products and a preconditioner more than iterations
            planned += rank.step_bytes + (simulation.report().pressure.iterations + 3) * rank.iteration_bytes;
        }
        const double sent = sum_over_ranks(comm, petsc_isend_len - before);
        if (rank_of(comm) == 0) fmt::print("  sent {:.0f}, planned {:.0f} bytes\n", sent, planned);
        EXPECT_LE(sent, 1.05 * planned + 100.0);
        EXPECT_GE(sent, 0.7 * planned);
      }
    }
  }
}

template <int Dim>
void expect_memory(const Case& config) {
  auto simulation = make_simulation<Dim>(comm, config);
  for (int step = 0; step < 3; ++step) simulation.step();
  const Plan plan = plan_run<Dim>(comm, config, ranks_of(comm));
  const double ratio =
      plan.ranks[static_cast<std::size_t>(rank_of(comm))].memory / static_cast<double>(simulation.bytes());
  if (rank_of(comm) == 0) fmt::print("  planned over held memory {:.3f}\n", ratio);
  EXPECT_GT(ratio, 0.6);
  EXPECT_LT(ratio, 1.4);
}

TEST(Plan, EstimatesTheMemoryOfARun) {
  expect_memory<2>(shipped_case("jet60-quick.toml", {"jet.start=steady"}));
  expect_memory<3>(shipped_case("hydrostatic-3d.toml", {"tank.size=[0.4, 0.4, 0.5]", "tank.fluid_height=0.4"}));
}

// By the limit of its process the first rank has room for its particles, but not for the graph of the cells.
TEST(Plan, TheGraphOfARunCountsWhereItIsPartitioned) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "AddressSanitizer reserves addresses by the terabyte";
#endif
  const Case config = shipped_case("hydrostatic.toml", {"particles.spacing=2e-4"});
  const MemoryNeed need = memory_need<2>(config, ranks_of(comm));
  EXPECT_EQ(need.graph > 0.0, ranks_of(comm) > 1);
  rlimit before{};
  getrlimit(RLIMIT_AS, &before);
  std::string status;
  std::getline(std::ifstream("/proc/self/status"), status, '\0');
  const auto limited = [&](double bytes) {
    const rlimit limit{static_cast<rlim_t>(1024.0 * number_behind("VmSize", status) + bytes), before.rlim_max};
    setrlimit(RLIMIT_AS, &limit);
    bool fits = true;
    try {
      check_memory<2>(comm, config);
    } catch (const InputError&) {
      fits = false;
    }
    setrlimit(RLIMIT_AS, &before);
    return fits;
  };
  EXPECT_EQ(limited(need.rank + 0.7 * need.graph - 1e6), false);
  EXPECT_EQ(limited(need.rank + 1.3 * need.graph + 1e6), true);
}

}  // namespace
}  // namespace impinge
