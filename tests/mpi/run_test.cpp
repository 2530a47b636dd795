// Whole runs: any number of ranks computes what one rank computes.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "gather.hpp"
#include "impinge/cases/make_simulation.hpp"
#include "region_cases.hpp"
#include "shipped_case.hpp"

namespace impinge {
namespace {

constexpr const char* tight = "pressure.tolerance=1e-12";

/// The 60 degree jet at H/dp = 10.
Case jet_case(const std::vector<std::string>& settings = {}) {
  std::vector<std::string> all{tight};
  all.insert(all.end(), settings.begin(), settings.end());
  return parse_case({{"jet.toml", R"(geometry = "jet"
particles.spacing = 0.04
time = {end = 10.0, dt = 1.6e-3}
jet = {width = 0.4, speed = 1.0, angle = 60.0}
pressure.gamma = 0.01
)"}},
                    all);
}

/// What the comparison looks at, by id.
template <int Dim>
struct State {
  std::map<std::int64_t, Vector<Dim>> position;
  std::map<std::int64_t, double> number_density;
  std::map<std::int64_t, std::uint8_t> free_surface;
  std::map<std::int64_t, ParticleType> type;

  State(MPI_Comm comm, const Particles<Dim>& particles)
      : position(gather_by_id(comm, particles, particles.position)),
        number_density(gather_by_id(comm, particles, particles.number_density)),
        free_surface(gather_by_id(comm, particles, particles.free_surface)),
        type(gather_by_id(comm, particles, particles.type)) {}
};

template <int Dim>
void expect_the_same_run(const Case& config, int steps) {
  const double spacing = config.particles.spacing;
  auto here = make_simulation<Dim>(MPI_COMM_WORLD, config);
  auto alone = make_simulation<Dim>(MPI_COMM_SELF, config);
  {
    const State<Dim> shared(MPI_COMM_WORLD, here.particles()), single(MPI_COMM_SELF, alone.particles());
    EXPECT_EQ(shared.position, single.position);
    EXPECT_EQ(shared.number_density, single.number_density);
    EXPECT_EQ(shared.free_surface, single.free_surface);
    EXPECT_EQ(shared.type, single.type);
  }
  for (int step = 1; step <= steps; ++step) {
    here.step();
    alone.step();
    const StepReport& report = here.report();
    EXPECT_EQ(report.step, step);
    EXPECT_EQ(report.in, report.out + report.fluid) << "step " << step;
    EXPECT_EQ(report.lost, 0);
    EXPECT_EQ(report.in, alone.report().in) << "step " << step;
    EXPECT_EQ(report.out, alone.report().out) << "step " << step;
    EXPECT_EQ(report.particles, alone.report().particles) << "step " << step;
  }
  EXPECT_NEAR(here.report().time, alone.report().time, 1e-8 * alone.report().dt);
  const State<Dim> shared(MPI_COMM_WORLD, here.particles()), single(MPI_COMM_SELF, alone.particles());
  EXPECT_EQ(shared.type, single.type);
  ASSERT_EQ(shared.position.size(), single.position.size());
  double farthest = 0.0;
  for (const auto& [id, position] : single.position)
    farthest = std::max(farthest, norm(shared.position.at(id) - position) / spacing);
  EXPECT_LT(farthest, 1e-8);
  testing::Test::RecordProperty("farthest_dp", fmt::format("{:.2e}", farthest));
  if (rank_of(MPI_COMM_WORLD) == 0)
    fmt::print("  largest difference of a position after {} steps: {:.2e} dp; kinetic energy {:.6g} J, out {}\n", steps,
               farthest, here.report().kinetic_energy, here.report().out);
}

class RunOfScheme : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, RunOfScheme, testing::Values("scheme=consistent", "scheme=paper"),
                         [](const auto& test) { return test.param.substr(test.param.find('=') + 1); });

TEST_P(RunOfScheme, ImpactingJetIsThatOfASingleRank) { expect_the_same_run<2>(jet_case({GetParam()}), 100); }

TEST_P(RunOfScheme, SteadyJetIsThatOfASingleRank) {
  expect_the_same_run<2>(jet_case({GetParam(), "jet.start=\"steady\""}), 100);
}

TEST_P(RunOfScheme, TankIsThatOfASingleRank) {
  expect_the_same_run<2>(shipped_case("hydrostatic.toml", {tight, GetParam()}), 100);
}

TEST_P(RunOfScheme, TankInThreeDimensionsIsThatOfASingleRank) {
  expect_the_same_run<3>(shipped_case("hydrostatic-3d.toml", {tight, GetParam()}), 5);
}

TEST(Run, OfRegionsUnderACentralForceIsThatOfASingleRank) { expect_the_same_run<2>(drops_case(), 60); }

TEST(Run, OfAColumnUnderGravityInTimeIsThatOfASingleRank) { expect_the_same_run<2>(column_case(), 60); }

TEST(Run, OfASphereUnderACentralForceIsThatOfASingleRank) { expect_the_same_run<3>(sphere_case(), 15); }

TEST(Run, GoesOnWhereFluidLeavesATankWithAnExactBalance) {
  auto simulation = make_simulation<2>(MPI_COMM_WORLD, column_case({"tank.size=[1.0, 0.4]"}));
  while (simulation.report().time < 1.2) {
    simulation.step();
    const StepReport& report = simulation.report();
    ASSERT_EQ(report.in, report.out + report.lost + report.fluid) << "step " << report.step;
  }
  EXPECT_GT(simulation.report().lost, 0);
  EXPECT_LT(simulation.report().lost, simulation.report().in);
}

TEST(Run, EndsWhereFluidLeavesATankIfItIsToldTo) {
  const Case config = column_case({"tank.size=[1.0, 0.4]", "domain.outside=error"});
  auto simulation = make_simulation<2>(MPI_COMM_WORLD, config);
  std::string end = "none";
  try {
    while (simulation.report().time < 1.2) simulation.step();
  } catch (const SolveError& error) {
    EXPECT_EQ(error.phase(), Phase::redistribute);
    end = error.what();
  }
  EXPECT_NE(end.find("left the domain other than by an outlet"), std::string::npos) << end;
}

TEST(Run, IsThatOfASingleRankWithPTScotch) {
  expect_the_same_run<2>(jet_case({"parallel.partitioner=\"ptscotch\""}), 30);
  expect_the_same_run<2>(jet_case({"parallel.partitioner=\"curve\""}), 30);
}

TEST(Run, IsThatOfASingleRankWithTheSingularKernel) {
  expect_the_same_run<2>(jet_case({"scheme=paper", "kernel.type=\"singular\""}), 30);
}

TEST(Run, IsThatOfASingleRankWhereItIsRepartitioned) {
  const Case config = jet_case({"parallel.imbalance=1.0", "time.dt=8e-3", "jet.inlet_distance=1.5"});
  // That it happens: wall particles do not move, so only a new partition changes their owners.
  auto simulation = make_simulation<2>(MPI_COMM_WORLD, config);
  const auto own_walls = [&] {
    std::set<std::int64_t> ids;
    const auto& particles = simulation.particles();
    for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
      if (particles.type[i] == ParticleType::wall) ids.insert(particles.id[i]);
    return ids;
  };
  const auto at_start = own_walls();
  for (int step = 0; step < 100; ++step) simulation.step();
  EXPECT_EQ(any_rank(MPI_COMM_WORLD, own_walls() != at_start), ranks_of(MPI_COMM_WORLD) > 1);

  expect_the_same_run<2>(config, 100);
}

TEST(Run, ShearWaveIsThatOfASingleRank) { expect_the_same_run<2>(shipped_case("shear-wave.toml", {tight}), 20); }

// Particles enter and leave; nothing is lost on the way.
TEST(Run, BalancesParticlesAtTheInletAndTheOutlets) {
  const Case config = jet_case({"plate.begin=-0.4", "plate.end=0.6", "pressure.tolerance=1e-6"});
  auto simulation = make_simulation<2>(MPI_COMM_WORLD, config);
  const std::int64_t at_start = simulation.report().in;
  EXPECT_EQ(simulation.report().fluid, at_start);
  while (simulation.report().time < 0.8) {
    simulation.step();
    ASSERT_EQ(simulation.report().in, simulation.report().out + simulation.report().fluid);
  }
  EXPECT_NEAR(static_cast<double>(simulation.report().in - at_start), 0.8 / 0.04 * 10, 10.0);
  EXPECT_GT(simulation.report().out, 50);
  const auto ids = gather_by_id(MPI_COMM_WORLD, simulation.particles(), simulation.particles().id);
  EXPECT_EQ(static_cast<std::int64_t>(ids.size()), simulation.report().particles);
}

TEST(Run, StepIsBoundedByTheCourantNumberAndGrowsSlowly) {
  auto simulation = make_simulation<2>(MPI_COMM_WORLD, jet_case({"time.dt=1e-2", "time.cfl=0.1"}));
  const StepReport& report = simulation.report();
  simulation.step();
  EXPECT_EQ(report.limit, StepLimit::growth);
  EXPECT_NEAR(report.dt, 0.05 * 0.04 / 1.0, 1e-12);
  for (int step = 1; step < 20; ++step) {
    const double last = report.dt;
    const double largest = 0.1 * 0.04 / report.max_speed;
    simulation.step();
    EXPECT_NEAR(report.dt, std::min(largest, 1.1 * last), 1e-12);
  }
  EXPECT_EQ(report.limit, StepLimit::cfl);
  auto slow = make_simulation<2>(MPI_COMM_WORLD, jet_case({"time.dt=1e-3"}));
  slow.step();
  EXPECT_EQ(slow.report().limit, StepLimit::case_dt);
  EXPECT_EQ(slow.report().dt, 1e-3);
}

/// The failure of a run, on every rank.
SolveError failure_of(const Case& config) {
  auto simulation = make_simulation<2>(MPI_COMM_WORLD, config);
  try {
    for (int step = 0; step < 50; ++step) simulation.step();
  } catch (const SolveError& error) {
    return error;
  }
  return {-1, Phase::totals, "no failure"};
}

TEST(Run, EndsWhereTheSpeedPassesItsBound) {
  const SolveError error = failure_of(jet_case({"time.max_speed=1.2"}));
  EXPECT_EQ(error.phase(), Phase::correct);
  EXPECT_GT(error.step(), 0);
  EXPECT_NE(std::string(error.what()).find("time.max_speed"), std::string::npos) << error.what();
}

TEST(Run, EndsWhereThePressureDoesNotConverge) {
  petsc_check(PetscOptionsSetValue(nullptr, "-ppe_ksp_max_it", "1"));
  const SolveError error = failure_of(jet_case());
  petsc_check(PetscOptionsClearValue(nullptr, "-ppe_ksp_max_it"));
  EXPECT_EQ(error.phase(), Phase::solve);
  EXPECT_NE(std::string(error.what()).find("DIVERGED_ITS"), std::string::npos) << error.what();
}

int failures_to_come = 0;

/// While it lives, the preconditioner is Jacobi's, but gives nothing but NaN where failures_to_come says so.
class FlakyPreconditioner {
 public:
  FlakyPreconditioner() {
    petsc_check(PCRegister("flaky", [](PC preconditioner) -> PetscErrorCode {
      if (failures_to_come == 0) return PCSetType(preconditioner, PCJACOBI);
      --failures_to_come;
      PetscCall(PCSetType(preconditioner, PCSHELL));
      return PCShellSetApply(preconditioner,
                             [](PC, ::Vec, ::Vec result) -> PetscErrorCode { return VecSet(result, std::nan("")); });
    }));
    petsc_check(PetscOptionsSetValue(nullptr, "-ppe_pc_type", "flaky"));
  }
  ~FlakyPreconditioner() {
    failures_to_come = 0;
    PetscOptionsClearValue(nullptr, "-ppe_pc_type");
  }
};

TEST(Run, RepeatsAFailedSolveFromZeroThenTheStepWithHalfItsDt) {
  const FlakyPreconditioner flaky;
  auto simulation = make_simulation<2>(MPI_COMM_WORLD, jet_case());
  for (int step = 0; step < 12; ++step) simulation.step();
  EXPECT_EQ(simulation.report().cold_solves, 0);
  EXPECT_EQ(simulation.report().halvings, 0);
  Checkpoint<2> before = simulation.checkpoint();

  for (const int failures : {1, 2, 5, 9}) {
    auto retried = make_simulation<2>(MPI_COMM_WORLD, jet_case(), &before);
    failures_to_come = failures;
    retried.step();
    const int halvings = failures / 2;
    EXPECT_EQ(failures_to_come, 0);
    EXPECT_EQ(retried.report().step, 13);
    EXPECT_EQ(retried.report().halvings, halvings);
    EXPECT_EQ(retried.report().cold_solves, (failures + 1) / 2);
    EXPECT_EQ(retried.report().limit == StepLimit::retry, halvings > 0);
    if (failures % 2 == 0) {  // the step that succeeded was not cold: it is one that had this dt from the start
      Checkpoint<2> fresh = before;
      fresh.numbers["coarse_age"] = 0.0;
      auto small =
          make_simulation<2>(MPI_COMM_WORLD, jet_case({fmt::format("time.dt={}", retried.report().dt)}), &fresh);
      small.step();
      EXPECT_EQ(small.particles().position, retried.particles().position);
      EXPECT_EQ(small.particles().velocity, retried.particles().velocity);
      EXPECT_EQ(small.particles().pressure, retried.particles().pressure);
    }
    const double dt = retried.report().dt;
    retried.step();
    EXPECT_EQ(retried.report().cold_solves, 0);
    EXPECT_EQ(retried.report().halvings, 0);
    EXPECT_LE(retried.report().dt, 1.1 * dt);
  }

  failures_to_come = 10;
  EXPECT_THROW(simulation.step(), SolveError);
  EXPECT_EQ(simulation.report().halvings, 4);
  EXPECT_EQ(simulation.report().cold_solves, 5);
}

// A coarse matrix that turned bad: the fresh one of the second solve is good.
TEST(Run, OutlivesABadCoarseMatrix) {
  auto simulation = make_simulation<2>(MPI_COMM_WORLD, jet_case());
  for (int step = 0; step < 12; ++step) simulation.step();
  Checkpoint<2> state = simulation.checkpoint();
  for (double& value : state.coarse.value) value = -value;
  auto retried = make_simulation<2>(MPI_COMM_WORLD, jet_case(), &state);
  simulation.step();
  retried.step();
  EXPECT_EQ(retried.report().cold_solves, 1);
  EXPECT_EQ(retried.report().halvings, 0);
  EXPECT_NEAR(retried.report().max_pressure, simulation.report().max_pressure, 1e-8 * retried.report().max_pressure);
}

/// How the step ends after `spoil` changed a fluid particle of some rank, and how many particles are lost.
template <class Spoil>
std::pair<std::string, std::int64_t> end_of_step_after(Spoil&& spoil, const Case& config = jet_case()) {
  auto simulation = make_simulation<2>(MPI_COMM_WORLD, config);
  simulation.step();
  Checkpoint<2> state = simulation.checkpoint();
  auto& type = state.particles.type;
  const auto fluid = static_cast<std::size_t>(std::find(type.begin(), type.end(), ParticleType::fluid) - type.begin());
  const int self = rank_of(MPI_COMM_WORLD);
  if (max_over_ranks(MPI_COMM_WORLD, fluid < type.size() ? self : -1) == self) spoil(state.particles, fluid);
  auto spoilt = make_simulation<2>(MPI_COMM_WORLD, config, &state);
  try {
    spoilt.step();
  } catch (const SolveError& error) {
    return {error.what(), spoilt.report().lost};
  }
  const StepReport& report = spoilt.report();
  EXPECT_EQ(report.in, report.out + report.lost + report.fluid);
  return {"no failure", report.lost};
}

TEST(Run, EndsInTheStepWhereAVelocityIsNotANumber) {
  const auto [end, lost] =
      end_of_step_after([](auto& particles, std::size_t i) { particles.velocity[i][0] = std::nan(""); });
  EXPECT_EQ(end, "step 2, phase Redistribute: a position is not a number");
  EXPECT_EQ(lost, 0);
}

/// A block of fluid without walls.
Case open_case(const std::vector<std::string>& settings = {}) {
  return parse_case({{"open.toml", R"(geometry = "scene"
particles.spacing = 0.1
time = {end = 1.0, dt = 1e-2}
[[fluid.region]]
shape = "box"
low = [0, 0]
high = [1, 1]
velocity = [1, 0]
)"}},
                    settings);
}

TEST(Run, RemovesAndCountsAParticleThatLeavesTheBounds) {
  const auto [end, lost] =
      end_of_step_after([](auto& particles, std::size_t i) { particles.position[i][1] = -1e9; }, open_case());
  EXPECT_EQ(end, "no failure");
  EXPECT_EQ(lost, 1);
}

TEST(Run, EndsWhereAParticleLeavesTheBoundsIfItIsToldTo) {
  const auto [end, lost] = end_of_step_after([](auto& particles, std::size_t i) { particles.position[i][1] = -1e9; },
                                             open_case({"domain.outside=error"}));
  EXPECT_EQ(end, "step 2, phase Redistribute: 1 particle(s) left the domain other than by an outlet");
  EXPECT_EQ(lost, 1);
}

}  // namespace
}  // namespace impinge
