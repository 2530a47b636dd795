// Checkpoints: a simulation that goes on from one is bitwise the one that never stopped; damaged files are refused.

#include "impinge/method/checkpoint.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "gather.hpp"
#include "impinge/cases/make_simulation.hpp"
#include "impinge/io/checkpoint_file.hpp"
#include "impinge/io/hdf5_file.hpp"
#include "impinge/io/run_directory.hpp"
#include "region_cases.hpp"
#include "shared_directory.hpp"
#include "shipped_case.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;

constexpr const char* tight = "pressure.tolerance=1e-12";

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b, int count) {
  return count == 0 || std::memcmp(a.data(), b.data(), sizeof(T) * static_cast<std::size_t>(count)) == 0;
}

template <int Dim>
void expect_the_same_state(const Simulation<Dim>& a, const Simulation<Dim>& b) {
  const Particles<Dim>& left = a.particles();
  const Particles<Dim>& right = b.particles();
  ASSERT_EQ(left.owned, right.owned);
  EXPECT_TRUE(same_bits(left.id, right.id, left.owned));
  EXPECT_TRUE(same_bits(left.type, right.type, left.owned));
  EXPECT_TRUE(same_bits(left.position, right.position, left.owned));
  EXPECT_TRUE(same_bits(left.velocity, right.velocity, left.owned));
  EXPECT_TRUE(same_bits(left.pressure, right.pressure, left.owned));
  EXPECT_TRUE(same_bits(left.pressure_impulse, right.pressure_impulse, left.owned));
  EXPECT_TRUE(same_bits(left.number_density, right.number_density, left.owned));
  EXPECT_TRUE(same_bits(left.free_surface, right.free_surface, left.owned));
  EXPECT_EQ(a.checkpoint().numbers, b.checkpoint().numbers);
  EXPECT_EQ(a.decomposition().owners().segments(), b.decomposition().owners().segments());
}

template <int Dim>
void write(MPI_Comm comm, const std::string& path, const Simulation<Dim>& simulation) {
  write_checkpoint(comm, path, simulation.checkpoint(),
                   {.dimension = Dim,
                    .step = simulation.report().step,
                    .time = simulation.report().time,
                    .status = "running",
                    .message = "",
                    .case_text = "",
                    .code_version = {}});
}

template <int Dim>
double farthest(const Simulation<Dim>& a, MPI_Comm comm_a, const Simulation<Dim>& b, MPI_Comm comm_b) {
  const auto left = gather_by_id(comm_a, a.particles(), a.particles().position);
  const auto right = gather_by_id(comm_b, b.particles(), b.particles().position);
  EXPECT_EQ(left.size(), right.size());
  double distance = 0.0;
  for (const auto& [id, position] : left) distance = std::max(distance, norm(position - right.at(id)));
  return distance;
}

class Restart : public SharedDirectory {
 protected:
  /// Goes on from several steps, on as many ranks and on one.
  template <int Dim>
  void expect_the_same_run(const Case& config, int steps) {
    auto whole = make_simulation<Dim>(MPI_COMM_WORLD, config);
    std::vector<std::string> files;
    for (int step = 0; step <= steps; ++step) {
      if (step > 0) whole.step();
      if (step == 0 || step == 1 || step == steps / 2 || step == steps - 3 || step == steps) {
        files.push_back(checkpoint_path(path_, "x", step));
        write(MPI_COMM_WORLD, files.back(), whole);
        EXPECT_FALSE(fs::exists(files.back() + ".partial"));
      }
    }
    for (const std::string& file : files) {
      SCOPED_TRACE(file);
      const auto from = read_checkpoint<Dim>(MPI_COMM_WORLD, file);
      auto again = make_simulation<Dim>(MPI_COMM_WORLD, config, &from);
      while (again.report().step < steps) again.step();
      expect_the_same_state(again, whole);
    }
    if (ranks_of(MPI_COMM_WORLD) == 1) return;
    const auto from = read_checkpoint<Dim>(MPI_COMM_SELF, files[2]);
    auto alone = make_simulation<Dim>(MPI_COMM_SELF, config, &from);
    while (alone.report().step < steps) alone.step();
    EXPECT_LT(farthest(alone, MPI_COMM_SELF, whole, MPI_COMM_WORLD), 1e-8 * config.particles.spacing);
  }
};

Case jet_case(std::vector<std::string> settings) {
  settings.insert(settings.begin(), {"jet.width=0.4", "particles.spacing=0.04", "time.dt=1.6e-3"});
  return shipped_case("jet.toml", settings);
}

TEST_F(Restart, ContinuesAJetOfEveryScheme) {
  for (const char* scheme : {"scheme=consistent", "scheme=paper"}) {
    SCOPED_TRACE(scheme);
    expect_the_same_run<2>(jet_case({scheme, tight, "output.average_start=0.01"}), 40);
  }
}

TEST_F(Restart, ContinuesWhereThePartitionChanges) {
  for (const char* partitioner : {"parallel.partitioner=metis", "parallel.partitioner=curve"})
    expect_the_same_run<2>(
        jet_case({tight, "parallel.imbalance=1.0", "time.dt=8e-3", "jet.inlet_distance=1.5", partitioner}), 60);
}

// A rolling tank with a cylinder and a plate in it.
TEST_F(Restart, ContinuesBetweenWallsThatMove) {
  expect_the_same_run<2>(parse_case({{"case.toml", R"(geometry = "scene"
particles.spacing = 0.02
fluid.gravity = [0, -9.81]
time = {end = 1.0, dt = 2e-3}
pressure.tolerance = 1e-12
[[wall]]
shape = "box"
low = [-0.4, 0]
high = [0.4, 0.6]
wet = "inside"
motion = "roll"
[[wall]]
shape = "circle"
center = [0.15, 0.12]
radius = 0.07
motion = "roll"
[[wall]]
shape = "polyline"
points = [[-0.2, 0], [-0.15, 0.2]]
motion = "roll"
[[motion]]
name = "roll"
type = "harmonic"
angle = 12
frequency = 1.2
[[fluid.region]]
shape = "box"
low = [-0.4, 0]
high = [0.4, 0.3]
)"}}),
                         60);
}

// In space: a drum that turns about its axis, a ball that it carries along, and a round jet into it.
TEST_F(Restart, ContinuesBetweenSurfacesThatMove) {
  expect_the_same_run<3>(parse_case({{"case.toml", R"(geometry = "scene"
dimension = 3
particles.spacing = 0.07
fluid.gravity = [0, 0, -9.81]
time = {end = 1.0, dt = 4e-3}
pressure.tolerance = 1e-12
domain = {low = [-0.65, -0.65, -0.2], high = [0.65, 0.65, 1.4]}
[[wall]]
shape = "cylinder"
begin = [0, 0, 0]
end = [0, 0, 1.2]
radius = 0.4
wet = "inside"
motion = "turn"
[[wall]]
shape = "sphere"
center = [0.15, 0, 0.2]
radius = 0.12
motion = "turn"
[[motion]]
name = "turn"
type = "harmonic"
axis = [0, 0, 2]
angle = 30
frequency = 1.2
[[inlet]]
section = "circle"
center = [0, 0, 0.9]
direction = [0, 0, -1]
radius = 0.12
speed = 1.0
[[outlet]]
shape = "box"
low = [-0.5, -0.5, 0.4]
high = [-0.2, 0.5, 0.6]
[[fluid.region]]
shape = "cylinder"
begin = [0, 0, 0]
end = [0, 0, 0.35]
radius = 0.4
)"}}),
                         10);
}

// The first inlet stops and the second starts in between; the outlet swallows a part of what falls.
TEST_F(Restart, ContinuesInletsAndOutletsOfAScene) {
  const Case config = parse_case({{"case.toml", R"(geometry = "scene"
particles.spacing = 0.05
fluid.gravity = [0, -9.81]
time = {end = 1.0, dt = 5e-3}
pressure.tolerance = 1e-12
domain = {low = [-1, -1], high = [3, 1.5]}
[[inlet]]
center = [0, 1]
direction = [2, -1]
width = 0.33
times = [0, 0.3]
speeds = [1, 4]
stop = 0.2
[[inlet]]
center = [2, 1]
direction = [-1, -0.2]
width = 0.2
speed = 2
start = 0.1
[[outlet]]
name = "drain"
shape = "circle"
center = [0.3, 0.8]
radius = 0.2
)"}});
  expect_the_same_run<2>(config, 60);
  auto simulation = make_simulation<2>(MPI_COMM_WORLD, config);
  while (simulation.report().step < 60) simulation.step();
  const StepReport& report = simulation.report();
  EXPECT_EQ(report.in - report.out - report.lost - report.fluid, 0);
  EXPECT_EQ(simulation.outlets().at(0).out, report.out);
  EXPECT_GT(report.time, 0.2);
  EXPECT_GT(report.out, 20);
}

TEST_F(Restart, ContinuesTanks) {
  expect_the_same_run<2>(shipped_case("hydrostatic.toml", {tight}), 30);
  expect_the_same_run<2>(shipped_case("hydrostatic.toml", {tight, "fluid.viscosity=1e-3", "time.dt=1e-4"}), 15);
  expect_the_same_run<3>(shipped_case("hydrostatic-3d.toml", {tight}), 6);
}

TEST_F(Restart, ContinuesRegionsUnderForcesInSpaceAndTime) {
  expect_the_same_run<2>(drops_case(), 40);
  expect_the_same_run<2>(column_case(), 60);
  expect_the_same_run<3>(sphere_case(), 6);
}

// Fluid has left the bounds before and after.
TEST_F(Restart, ContinuesWhereFluidIsLost) {
  const Case config = column_case({"tank.size=[1.0, 0.4]", "pressure.tolerance=1e-6"});
  auto whole = make_simulation<2>(MPI_COMM_WORLD, config);
  while (whole.report().lost == 0 && whole.report().time < 2.0) whole.step();
  ASSERT_GT(whole.report().lost, 0);
  write(MPI_COMM_WORLD, path("x.checkpoint"), whole);
  const std::int64_t before = whole.report().lost;
  for (int step = 0; step < 200; ++step) whole.step();
  EXPECT_GT(whole.report().lost, before);
  const auto from = read_checkpoint<2>(MPI_COMM_WORLD, path("x.checkpoint"));
  auto again = make_simulation<2>(MPI_COMM_WORLD, config, &from);
  for (int step = 0; step < 200; ++step) again.step();
  expect_the_same_state(again, whole);
}

TEST_F(Restart, ContinuesWithAnEmptyRank) {
  expect_the_same_run<2>(shipped_case("hydrostatic.toml", {tight, "tank.size=[0.05,0.06]", "tank.fluid_height=0.03"}),
                         20);
}

TEST_F(Restart, ContinuesAPeriodicViscousFlow) { expect_the_same_run<2>(shipped_case("shear-wave.toml", {tight}), 20); }

TEST_F(Restart, ContinuesWithAnyPreconditioner) {
  petsc_check(PetscOptionsSetValue(nullptr, "-ppe_pc_type", "hypre"));
  expect_the_same_run<2>(jet_case({tight}), 15);
  petsc_check(PetscOptionsClearValue(nullptr, "-ppe_pc_type"));
}

TEST_F(Restart, RefusesWhatIsNoCheckpoint) {
  const Case config = jet_case({});
  auto simulation = make_simulation<2>(MPI_COMM_WORLD, config);
  const std::string whole = path("x_00000000.checkpoint");
  write(MPI_COMM_WORLD, whole, simulation);
  const std::string snapshot = path("x_00000000.vtkhdf");
  write_snapshot(MPI_COMM_WORLD, snapshot, simulation.particles(),
                 {.status = "", .message = "", .case_text = "", .code_version = {}});
  const std::string cut = path("cut.checkpoint");
  const std::string text = path("text.checkpoint");
  if (rank_of(MPI_COMM_WORLD) == 0) {
    fs::copy_file(whole, cut);
    fs::resize_file(cut, fs::file_size(cut) / 2);
    std::ofstream(text) << "not HDF5";
  }
  MPI_Barrier(MPI_COMM_WORLD);
  const auto failure = [&](const std::string& file) {
    return failure_of([&] { read_checkpoint<2>(MPI_COMM_WORLD, file); });
  };
  EXPECT_EQ(failure(whole), "");
  for (const std::string& file : {cut, text, snapshot, path("none")})
    EXPECT_TRUE(failure(file).starts_with("cannot read " + file + ": ")) << failure(file);
  EXPECT_NE(failure(cut).find("truncated"), std::string::npos) << failure(cut);
  EXPECT_NE(failure(snapshot).find("a snapshot, not a checkpoint"), std::string::npos) << failure(snapshot);
  EXPECT_NE(failure_of([&] { read_checkpoint<3>(MPI_COMM_WORLD, whole); }).find("it has 2 dimensions, not 3"),
            std::string::npos);

  const auto from = read_checkpoint<2>(MPI_COMM_WORLD, whole);
  const Case other = jet_case({"kernel.laplacian_radius=6.0"});
  EXPECT_NE(failure_of([&] { make_simulation<2>(MPI_COMM_WORLD, other, &from); }).find("background cells"),
            std::string::npos);
}

TEST_F(Restart, RefusesWallParticlesThatAreOnNoWall) {
  const Case config = parse_case({{"case.toml", R"(geometry = "scene"
particles.spacing = 0.1
time = {end = 1.0, dt = 0.02}
fluid.region = [{shape = "box", low = [0, 0], high = [1, 0.4]}]
wall = [{shape = "box", low = [0, 0], high = [1, 1], wet = "inside", motion = "heave"}]
motion = [{name = "heave", type = "harmonic", amplitude = [0, 0.05], frequency = 2.0}]
)"}});
  auto simulation = make_simulation<2>(MPI_COMM_WORLD, config);
  simulation.step();
  Checkpoint<2> state = simulation.checkpoint();
  const auto failure = [&] { return failure_of([&] { make_simulation<2>(MPI_COMM_WORLD, config, &state); }); };
  EXPECT_EQ(failure(), "");
  for (std::size_t i = 0; i < state.particles.type.size(); ++i)
    if (state.particles.type[i] == ParticleType::fluid) state.particles.type[i] = ParticleType::wall;
  EXPECT_EQ(failure(), "a wall particle of the checkpoint is on no wall");
}

// Checksums match: someone has made these files.
TEST_F(Restart, RefusesWhatNoRunHasSaved) {
  const Case config = jet_case({});
  auto simulation = make_simulation<2>(MPI_COMM_WORLD, config);
  for (int step = 0; step < 3; ++step) simulation.step();
  const int rank = rank_of(MPI_COMM_WORLD), ranks = ranks_of(MPI_COMM_WORLD);
  const Checkpoint<2> sound = simulation.checkpoint();
  const auto nodes = sum_over_ranks(MPI_COMM_WORLD, static_cast<std::int64_t>(sound.coarse.cell.size()));
  ASSERT_GT(nodes, 0);
  const auto failure_after = [&](const auto& change) {
    Checkpoint<2> state = sound;
    change(state);
    write_checkpoint(MPI_COMM_WORLD, path("x.checkpoint"), state,
                     {.dimension = 2, .status = "running", .message = "", .case_text = "", .code_version = {}});
    return failure_of([&] {
      const auto from = read_checkpoint<2>(MPI_COMM_WORLD, path("x.checkpoint"));
      make_simulation<2>(MPI_COMM_WORLD, config, &from);
    });
  };
  EXPECT_EQ(failure_after([](auto&) {}), "");

  const double infinite = std::numeric_limits<double>::infinity();
  for (const auto& [name, value] :
       std::initializer_list<std::pair<const char*, double>>{{"limit", 6.0},
                                                             {"limit", -1.0},
                                                             {"step", 0.5},
                                                             {"step", -1.0},
                                                             {"next_id", 1e300},
                                                             {"lost", 1e19},
                                                             {"outlet_1_out", -1e207},
                                                             {"iterations", 3e9},
                                                             {"coarse_age", -1.0},
                                                             {"coarse_fresh_iterations", 1e10}}) {
    const std::string failure = failure_after([&](auto& state) { state.numbers[name] = value; });
    EXPECT_TRUE(failure.ends_with(fmt::format(": {} = {} is out of range", name, value))) << failure;
  }
  for (const char* name : {"time", "dt", "free_dt", "max_speed"}) {
    const std::string failure = failure_after([&](auto& state) { state.numbers.at(name) = -1.0; });
    EXPECT_TRUE(failure.ends_with(fmt::format("{} = -1 is negative", name))) << failure;
  }
  for (const auto& [name, unused] : sound.numbers) {
    const std::string failure = failure_after([&](auto& state) { state.numbers.at(name) = infinite; });
    EXPECT_TRUE(failure.ends_with(name + " is not a finite number")) << failure;
    EXPECT_EQ(failure_after([&](auto& state) { state.numbers.erase(name); }), "the checkpoint has no " + name);
  }
  for (const double row : {1e300, 0.0, -1e300})  // rows without end; one too many; none any more
    EXPECT_EQ(failure_after([&](auto& state) { state.numbers.at("inlet_1_last_row") = row; }),
              "the checkpoint's inlet is elsewhere");

  for (const int owner : {-1, ranks}) {
    const std::string failure = failure_after([&](auto& state) { state.segments.back().rank = owner; });
    EXPECT_TRUE(failure.ends_with("a cell's owner is no rank")) << failure;
  }
  for (const std::int64_t first : {-1, 1}) {
    const std::string failure = failure_after([&](auto& state) { state.segments.front().first = first; });
    EXPECT_TRUE(failure.ends_with("the cells' owners are in no order")) << failure;
  }
  {
    const std::string failure = failure_after([&](auto& state) { state.segments.push_back(state.segments.back()); });
    EXPECT_TRUE(failure.ends_with("the cells' owners are in no order")) << failure;
  }
  EXPECT_TRUE(failure_after([&](auto& state) { state.segments.clear(); }).ends_with("are incomplete"));
  const auto on_last_rank = [&](const auto& change) {
    return failure_after([&](auto& state) {
      if (rank == ranks - 1) change(state);
    });
  };
  for (const double place : {infinite, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_TRUE(on_last_rank([&](auto& state) { state.particles.position[1][0] = place; }).ends_with("not finite"));
    EXPECT_TRUE(on_last_rank([&](auto& state) { state.searched_position[1][1] = place; }).ends_with("not finite"));
  }
  const auto expect_no_matrix = [&](const auto& change) {
    const std::string failure = on_last_rank([&](auto& state) { change(state.coarse); });
    EXPECT_TRUE(failure.ends_with("the coarse matrix is none")) << failure;
  };
  for (const std::int64_t cell : {std::int64_t{-1}, std::numeric_limits<std::int64_t>::max()}) {
    const std::string failure =
        on_last_rank([&](auto& state) { (cell < 0 ? state.coarse.cell.front() : state.coarse.cell.back()) = cell; });
    EXPECT_EQ(failure, "the checkpoint has rows of the coarse matrix on ranks that do not own their cells");
  }
  expect_no_matrix([&](auto& coarse) { std::swap(coarse.cell[0], coarse.cell[1]); });
  expect_no_matrix([&](auto& coarse) { coarse.column.back() = nodes; });
  expect_no_matrix([&](auto& coarse) { coarse.column.back() = -1; });
  expect_no_matrix([&](auto& coarse) { ++coarse.length.back(); });
  expect_no_matrix([&](auto& coarse) { coarse.value.front() = infinite; });
  expect_no_matrix([&](auto& coarse) {  // without a diagonal
    for (double& value : coarse.value) value = std::min(value, 0.0);
  });
  expect_no_matrix([&](auto& coarse) {
    coarse.length[0] += coarse.length[1] + 1;
    coarse.length[1] = -1;
  });
}

TEST_F(Restart, RefusesPartsThatDoNotMakeTheWhole) {
  const Case config = jet_case({});
  auto simulation = make_simulation<2>(MPI_COMM_WORLD, config);
  for (int step = 0; step < 3; ++step) simulation.step();
  write(MPI_COMM_WORLD, path("x.checkpoint"), simulation);
  constexpr std::int64_t large = std::int64_t{1} << 62;
  for (const char* name : {"/VTKHDF/NumberOfPoints", "/checkpoint/coarse_rows", "/checkpoint/coarse_entries"}) {
    for (const std::int64_t shift : {1'000'000, 0}) {
      SCOPED_TRACE(fmt::format("{} {}", name, shift));
      if (rank_of(MPI_COMM_WORLD) == 0) {
        fs::copy_file(path("x.checkpoint"), path("y.checkpoint"), fs::copy_options::overwrite_existing);
        const hid_t file = H5Fopen(path("y.checkpoint").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
        std::vector<std::int64_t> parts(static_cast<std::size_t>(ranks_of(MPI_COMM_WORLD)));
        const hid_t old = H5Dopen2(file, name, H5P_DEFAULT);
        H5Dread(old, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, parts.data());
        H5Dclose(old);
        // Their sum stays the same, where there are two; or overflows.
        parts.front() += shift;
        parts.back() -= parts.size() > 1 ? shift : 0;
        if (shift == 0) parts.assign(parts.size(), large);
        Hdf5Writer writer(MPI_COMM_SELF, path("parts.h5"), true);
        writer.dataset("/parts", parts);
        writer.finish();
        const hid_t from = H5Fopen(path("parts.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
        H5Ldelete(file, name, H5P_DEFAULT);
        H5Ocopy(from, "/parts", file, name, H5P_DEFAULT, H5P_DEFAULT);
        H5Fclose(from);
        H5Fclose(file);
      }
      MPI_Barrier(MPI_COMM_WORLD);
      const std::string failure = failure_of([&] { read_checkpoint<2>(MPI_COMM_WORLD, path("y.checkpoint")); });
      EXPECT_TRUE(failure.ends_with("do not make the whole")) << failure;
      MPI_Barrier(MPI_COMM_WORLD);
    }
  }
}

// A byte that changed anywhere is noticed, or it stands in a gap between what is read.
TEST_F(Restart, NoticesEveryChangedByte) {
  const Case config = jet_case({});
  auto simulation = make_simulation<2>(MPI_COMM_WORLD, config);
  for (int step = 0; step < 3; ++step) simulation.step();
  const std::string whole = path("x_00000003.checkpoint");
  write(MPI_COMM_WORLD, whole, simulation);
  if (rank_of(MPI_COMM_WORLD) > 0) return;

  std::string bytes;
  {
    std::ifstream file(whole, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(file), {});
  }
  const auto expected = read_checkpoint<2>(MPI_COMM_SELF, whole);
  const std::string changed = path("changed.checkpoint");
  int noticed = 0;
  constexpr std::size_t places = 400;
  for (std::size_t k = 0; k < places; ++k) {
    std::string copy = bytes;
    char& byte = copy[k * bytes.size() / places];
    byte = static_cast<char>(byte ^ 0x10);
    std::ofstream(changed, std::ios::binary) << copy;
    try {
      read_header(changed);
      const auto found = read_checkpoint<2>(MPI_COMM_SELF, changed);
      ASSERT_EQ(found.numbers, expected.numbers) << k;
      ASSERT_EQ(found.particles.position, expected.particles.position) << k;
      ASSERT_EQ(found.particles.velocity, expected.particles.velocity) << k;
      ASSERT_EQ(found.particles.pressure, expected.particles.pressure) << k;
      ASSERT_EQ(found.particles.type, expected.particles.type) << k;
      ASSERT_EQ(found.particles.id, expected.particles.id) << k;
      ASSERT_EQ(found.searched_position, expected.searched_position) << k;
    } catch (const FileError&) {
      ++noticed;
    }
  }
  std::printf("  %d of %zu changed bytes noticed, the others are not read\n", noticed, places);
  EXPECT_GT(noticed, static_cast<int>(places / 2));
}

}  // namespace
}  // namespace impinge
