// The inner loops of a step on one rank, by Google Benchmark (its options: --benchmark_filter=REGEX, ...), on jittered
// blocks of fluid whose uppermost row has p = 0.

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <random>

#include "cloud.hpp"
#include "impinge/method/operators.hpp"
#include "impinge/method/pressure/two_level.hpp"
#include "impinge/parallel/decomposition.hpp"

namespace impinge {
namespace {

constexpr double near_radius = 2.1;
constexpr double far_radius = 4.01;

/// A block of n particles along each axis, with all that the loops read and write. Unit spacing.
template <int Dim>
class Block {
 public:
  explicit Block(int n)
      : particles(make_cloud<Dim>(cube(n), 0.1)),
        domain(MPI_COMM_SELF, box(n), {}, far_radius, Partitioner::metis),
        search(domain.sorting_cells(), Decomposition<Dim>::cell_parts, KernelType::non_singular, near_radius,
               far_radius),
        solver(MPI_COMM_SELF, 1e-6),
        two_level(MPI_COMM_SELF, domain.cells()),
        near_sums(lattice_sums<Dim>(KernelType::non_singular, near_radius)),
        far_sums(lattice_sums<Dim>(KernelType::non_singular, far_radius)) {
    domain.partition(particles);
    domain.migrate(particles);
    domain.build_halo(particles);
    search.search(particles);
    for (const auto& position : particles.position)
      role.push_back(position[Dim - 1] > n - 1 ? PressureRole::zero : PressureRole::unknown);
    source = particles.pressure;
    gradient.resize(source.size());
    assemble();
    two_level.set_owners(domain.owners());
    update();
    petsc_check(MatCreateVecs(solver.matrix(), x.address(), y.address()));
    petsc_check(VecSet(x, 1.0));
    petsc_check(PCCreate(MPI_COMM_SELF, &preconditioner));
    petsc_check(PCSetType(preconditioner, PCSHELL));
    petsc_check(PCSetOperators(preconditioner, solver.matrix(), solver.matrix()));
    two_level.attach(preconditioner);
  }
  ~Block() { PCDestroy(&preconditioner); }

  void assemble() {
    solver.assemble({.for_rows =
                         [&](const auto& use) {
                           search.for_far_rows([&](int i, const PairRow& row) { use(i, {row, 0.0}); });
                         },
                     .role = role,
                     .row = domain.rows(),
                     .source = source,
                     .laplacian_factor = 2.0 * Dim / (far_sums.number_density * far_sums.lambda),
                     .n0 = far_sums.number_density,
                     .usual_pairs = far_sums.neighbours},
                    domain.halo());
  }

  void update() { two_level.update(solver.rows(), role, particles.position, domain.halo(), 0); }

  Particles<Dim> particles;
  Decomposition<Dim> domain;
  NeighbourSearch<Dim> search;
  PressureSolver solver;
  TwoLevelPreconditioner<Dim> two_level;
  LatticeSums near_sums, far_sums;
  std::vector<PressureRole> role;
  std::vector<double> source;
  std::vector<Vector<Dim>> gradient;
  PC preconditioner = nullptr;
  PetscVector x, y;

 private:
  static std::array<int, Dim> cube(int n) {
    std::array<int, Dim> extent;
    extent.fill(n);
    return extent;
  }

  static Box<Dim> box(int n) {
    Box<Dim> result;
    for (int k = 0; k < Dim; ++k) result.high[k] = n;
    return result;
  }
};

/// Registers a benchmark of action(), and reports its time per item too.
template <class Action>
void add(const std::string& name, double items, Action action) {
  benchmark::RegisterBenchmark(name.c_str(), [items, action](benchmark::State& state) mutable {
    for (auto _ : state) {
      action();
      benchmark::ClobberMemory();
    }
    state.counters["s/item"] =
        benchmark::Counter(items, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  })->Unit(benchmark::kMicrosecond);
}

template <class Kernel>
void add_kernel(const char* name) {
  std::mt19937 random(42);
  std::uniform_real_distribution<double> uniform(0.5, 1.2 * far_radius);
  std::vector<double> distance(4096);
  for (double& r : distance) r = uniform(random);
  add(fmt::format("kernel/{}", name), static_cast<double>(distance.size()),
      [distance, weight = std::vector<double>(distance.size())]() mutable {
        for (std::size_t k = 0; k < distance.size(); ++k) weight[k] = Kernel::weight(distance[k], far_radius);
        benchmark::DoNotOptimize(weight.data());
      });
}

template <int Dim>
void add_loops(Block<Dim>& block) {
  const int n = block.particles.owned;
  const auto add_loop = [&](const char* name, auto action) { add(fmt::format("{}D/{}/{}", Dim, n, name), n, action); };
  add_loop("near_pairs", [&block] { block.search.search(block.particles); });
  add_loop("far_pairs", [&block] {
    std::size_t pairs = 0;
    block.search.for_far_rows([&](int, const PairRow& row) { pairs += row.index.size(); });
    benchmark::DoNotOptimize(pairs);
  });
  add_loop("number_density", [&block] { number_density(block.search.near(), block.particles.number_density); });
  add_loop("divergence", [&block, n] {
    for (int i = 0; i < n; ++i)
      benchmark::DoNotOptimize(divergence<Dim>(block.search.near(), block.particles.position, block.particles.velocity,
                                               block.near_sums.number_density, i));
  });
  add_loop("gradient", [&block, n, no_wall = std::vector<Vector<Dim>>(block.particles.type.size())] {
    for (int i = 0; i < n; ++i)
      block.gradient[static_cast<std::size_t>(i)] =
          pressure_gradient<Dim>(block.search.near(), block.particles.position, block.particles.pressure,
                                 block.particles.type, no_wall, block.near_sums.number_density, i);
  });
  add_loop("product", [&block] { petsc_check(MatMult(block.solver.matrix(), block.x, block.y)); });
  add_loop("two_level_apply", [&block] { petsc_check(PCApply(block.preconditioner, block.x, block.y)); });
  add_loop("two_level_set_up", [&block] {
    block.two_level.expire();
    block.update();
  });
  add_loop("assembly", [&block] { block.assemble(); });
}

/// What one of many ranks computes of a partition by the curve: it knows the work of some cells in a row. The sums over
/// the ranks are not in it.
void add_cut(int n_cells, int parts) {
  const CellGrid<3> cells({{}, {{256.0, 256.0, 256.0}}}, {}, 1.0);
  std::vector<CellWork> work;
  for (int k = 0; k < n_cells; ++k) work.push_back({1'000'000 + k, 60});
  add(fmt::format("cut/{}_cells/{}_parts", n_cells, parts), parts, [=] {
    const Cut cut = distribute_cells<3>(MPI_COMM_SELF, cells, work, parts, Partitioner::curve);
    benchmark::DoNotOptimize(cut.segments.data());
  });
}

}  // namespace
}  // namespace impinge

int main(int argc, char** argv) {
  using namespace impinge;
  MPI_Init(&argc, &argv);
  benchmark::Initialize(&argc, argv);
  if (!benchmark::ReportUnrecognizedArguments(argc, argv)) {
    const PetscSession session(argv[0], {});
    Block<2> flat(180), large_flat(560);
    Block<3> cube(32), large_cube(46);
    add_kernel<NonSingularKernel>("non_singular");
    add_kernel<SingularKernel>("singular");
    add_loops(flat);
    add_loops(large_flat);
    add_loops(cube);
    add_loops(large_cube);
    add_cut(3700, 1000);
    add_cut(370, 10'000);
    benchmark::RunSpecifiedBenchmarks();
  }
  MPI_Finalize();
}
