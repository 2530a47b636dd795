// Snapshots: what is written on any number of ranks is read on any other; damaged files are refused.

#include "impinge/io/snapshot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>

#include "impinge/io/run_directory.hpp"
#include "impinge/parallel/exchange.hpp"
#include "shared_directory.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;

/// Particle k of a made-up state, wall or fluid, all fields different.
template <int Dim>
ParticleRecord<Dim> made_up(std::int64_t k) {
  const auto x = static_cast<double>(k);
  ParticleRecord<Dim> record{};
  for (int axis = 0; axis < Dim; ++axis) {
    record.position[axis] = x + 0.1 * axis;
    record.velocity[axis] = -x - 0.2 * axis;
  }
  record.pressure = 1.0 / (1.0 + x);
  record.pressure_impulse = 2.0 * x;
  record.id = 1'000'000'000'000 + k;
  record.type = static_cast<ParticleType>(k % 4);
  return record;
}

/// `count` particles shared out unevenly: the last rank has none where there is more than one.
template <int Dim>
Particles<Dim> made_up_share(int count, MPI_Comm comm) {
  Particles<Dim> particles;
  const int filled = std::max(ranks_of(comm) - 1, 1);
  for (int k = 0; k < count; ++k)
    if (std::min(k * k / count, count - 1) * filled / count == rank_of(comm)) particles.append(made_up<Dim>(k));
  for (std::size_t i = 0; i < particles.id.size(); ++i) {
    particles.number_density[i] = 0.5 * particles.pressure[i];
    particles.free_surface[i] = particles.id[i] % 2 == 0;
  }
  return particles;
}

template <int Dim>
void round_trip(const std::string& file) {
  const int count = 101;
  SnapshotHeader written{.dimension = Dim,
                         .step = 42,
                         .time = 0.125,
                         .dt = 1e-3,
                         .window_begin = 0.1,
                         .window_end = 0.125,
                         .status = "running",
                         .message = "",
                         .case_text = "name = \"x\"\n",
                         .code_version = {}};
  write_snapshot(MPI_COMM_WORLD, file, made_up_share<Dim>(count, MPI_COMM_WORLD), written);
  EXPECT_FALSE(fs::exists(file + ".partial"));

  for (const bool alone : {false, true}) {
    const MPI_Comm comm = alone ? MPI_COMM_SELF : MPI_COMM_WORLD;
    Particles<Dim> particles;
    const SnapshotHeader header = read_snapshot(comm, file, particles);
    EXPECT_EQ(header.step, 42);
    EXPECT_EQ(header.time, 0.125);
    EXPECT_EQ(header.dt, 1e-3);
    EXPECT_EQ(header.window_begin, 0.1);
    EXPECT_EQ(header.window_end, 0.125);
    EXPECT_EQ(header.status, "running");
    EXPECT_EQ(header.message, "");
    EXPECT_EQ(header.case_text, written.case_text);
    EXPECT_EQ(header.code_version, "impinge " IMPINGE_VERSION);
    EXPECT_EQ(sum_over_ranks(comm, static_cast<std::int64_t>(particles.owned)), count);
    EXPECT_LE(std::abs(particles.owned - count / ranks_of(comm)), 1);
    std::int64_t id_sum = 0;
    for (int i = 0; i < particles.owned; ++i) {
      const auto self = static_cast<std::size_t>(i);
      const ParticleRecord<Dim> expected = made_up<Dim>(particles.id[self] - 1'000'000'000'000);
      const ParticleRecord<Dim> found = particles.record(i);
      EXPECT_EQ(found.position, expected.position);
      EXPECT_EQ(found.velocity, expected.velocity);
      EXPECT_EQ(found.pressure, expected.pressure);
      EXPECT_EQ(found.pressure_impulse, expected.pressure_impulse);
      EXPECT_EQ(found.type, expected.type);
      EXPECT_EQ(particles.number_density[self], 0.5 * expected.pressure);
      EXPECT_EQ(particles.free_surface[self], expected.id % 2 == 0 ? 1 : 0);
      id_sum += found.id - 1'000'000'000'000;
    }
    EXPECT_EQ(sum_over_ranks(comm, id_sum), count * (count - 1) / 2);
  }
}

TEST_F(SharedDirectory, ReadsBackWhatAnyNumberOfRanksWrote) {
  round_trip<2>(path("two_00000042.vtkhdf"));
  round_trip<3>(path("three_00000042.vtkhdf"));
}

TEST_F(SharedDirectory, KeepsStatesThatAreNotNumbers) {
  Particles<2> particles = made_up_share<2>(10, MPI_COMM_WORLD);
  for (auto& velocity : particles.velocity) velocity[0] = std::numeric_limits<double>::quiet_NaN();
  const std::string file = path("broken_00000001.vtkhdf");
  write_snapshot(MPI_COMM_WORLD, file, particles,
                 {.status = "failed", .message = "why", .case_text = "", .code_version = {}});
  const SnapshotHeader header = read_snapshot(MPI_COMM_WORLD, file, particles);
  EXPECT_EQ(header.status, "failed");
  EXPECT_EQ(header.message, "why");
  for (int i = 0; i < particles.owned; ++i) EXPECT_TRUE(std::isnan(particles.velocity[static_cast<std::size_t>(i)][0]));
}

TEST_F(SharedDirectory, NamesTheFileThatCannotBeWritten) {
  const std::string file = path("missing/x_00000001.vtkhdf");
  const std::string failure =
      failure_of([&] { write_snapshot(MPI_COMM_WORLD, file, made_up_share<2>(10, MPI_COMM_WORLD), {}); });
  EXPECT_NE(failure.find("cannot write " + file), std::string::npos) << failure;
  EXPECT_NE(failure.find("o such file or directory"), std::string::npos) << failure;
}

TEST_F(SharedDirectory, RefusesWhatIsNoSnapshot) {
  Particles<2> particles;
  Particles<3> particles3;
  const auto failure = [&](const std::string& file) {
    return failure_of([&] { read_snapshot(MPI_COMM_WORLD, file, particles); });
  };
  EXPECT_NE(failure(path("none.vtkhdf")).find("no such file"), std::string::npos);

  const std::string whole = path("x_00000001.vtkhdf");
  write_snapshot(MPI_COMM_WORLD, whole, made_up_share<2>(1000, MPI_COMM_WORLD), SnapshotHeader{});
  EXPECT_NE(failure_of([&] { read_snapshot(MPI_COMM_WORLD, whole, particles3); }).find("it has 2 dimensions, not 3"),
            std::string::npos);

  const std::string cut = path("cut.vtkhdf");
  const std::string text = path("text.vtkhdf");
  if (rank_of(MPI_COMM_WORLD) == 0) {
    fs::copy_file(whole, cut);
    fs::resize_file(cut, fs::file_size(cut) / 2);
    std::ofstream(text) << "not HDF5";
  }
  MPI_Barrier(MPI_COMM_WORLD);
  for (const std::string& file : {cut, text}) EXPECT_EQ(failure(file).find("cannot read " + file), 0u) << failure(file);
}

TEST_F(SharedDirectory, ListsSnapshotsByStep) {
  if (rank_of(MPI_COMM_WORLD) > 0) return;
  for (const char* name :
       {"a_00000010.vtkhdf", "a_00000002.vtkhdf", "a_b_00000001.vtkhdf", "a_00000003.vtkhdf.partial", "a_3.vtkhdf",
        "a_123456789.vtkhdf", "a_history.csv", "a_00000004.checkpoint", "a_00000005.checkpoint.partial"})
    std::ofstream(path(name)) << "";
  const auto names = [&](const std::string& name) {
    std::vector<std::string> found;
    for (const std::string& file : list_snapshots(path_, name)) found.push_back(fs::path(file).filename());
    return found;
  };
  EXPECT_EQ(names("a"), (std::vector<std::string>{"a_00000002.vtkhdf", "a_00000010.vtkhdf", "a_123456789.vtkhdf"}));
  EXPECT_EQ(names("").size(), 4u);
  EXPECT_EQ(snapshot_path("out", "a", 10), "out/a_00000010.vtkhdf");
  EXPECT_EQ(list_checkpoints(path_), std::vector{path("a_00000004.checkpoint")});
  EXPECT_EQ(list_partial_files(path_, "a"),
            (std::vector{path("a_00000003.vtkhdf.partial"), path("a_00000005.checkpoint.partial")}));
  EXPECT_EQ(list_partial_files(path_, "b").size(), 0u);
  EXPECT_EQ(checkpoint_path("out", "a", 10), "out/a_00000010.checkpoint");
  EXPECT_EQ(name_and_step("out/a_b_00000010.checkpoint"), std::pair(std::string("a_b"), std::int64_t{10}));
  EXPECT_THROW(name_and_step("a_history.csv"), FileError);
  EXPECT_THROW(list_snapshots(path("nowhere")), FileError);
}

}  // namespace
}  // namespace impinge
