// What a case needs of the memory, and what the system says is free.

#include "impinge/core/memory.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "impinge/cases/make_simulation.hpp"
#include "impinge/programs/memory_check.hpp"
#include "shipped_case.hpp"

namespace impinge {
namespace {

TEST(Memory, NumbersAreFoundBehindTheirNames) {
  constexpr const char* info = "MemTotal:       16 kB\nMemAvailable:    7 kB\nfile_mapped 3\nfile 5\n";
  EXPECT_EQ(number_behind("MemAvailable", info), 7.0);
  EXPECT_EQ(number_behind("MemTotal", info), 16.0);
  EXPECT_EQ(number_behind("file", info), 5.0);
  EXPECT_EQ(number_behind("", "123\n"), 123.0);
  for (const char* text : {"", "max\n", "\n", "Swap"}) EXPECT_EQ(number_behind("", text), HUGE_VAL);
  EXPECT_EQ(number_behind("Mem", info), HUGE_VAL);
  EXPECT_EQ(number_behind("file", "file"), HUGE_VAL);
}

TEST(Memory, OfThisMachineIsKnown) {
  EXPECT_GT(free_memory_of_node(), 1e6);
  EXPECT_LT(free_memory_of_node(), 1e15);
  EXPECT_GT(free_memory_of_process(), 1e6);
  EXPECT_GT(free_memory(MPI_COMM_SELF), 1e6);
}

TEST(Memory, HasTheUnitOfItsSize) {
  EXPECT_EQ(bytes_text(0.0), "0 MB");
  EXPECT_EQ(bytes_text(3.8e8), "380 MB");
  EXPECT_EQ(bytes_text(1.254e9), "1.25 GB");
  EXPECT_EQ(bytes_text(2.3e14), "2.3e+05 GB");
  EXPECT_EQ(bytes_text(HUGE_VAL), "any memory");
}

template <int Dim>
void expect_count(const Case& config, double error) {
  Particles<Dim> particles;
  make_scene<Dim>(config, config).fill(0, 1, particles);
  EXPECT_NEAR(memory_need<Dim>(config, 1).particles / particles.owned, 1.0, error);
}

template <int Dim>
void expect_need(const Case& config) {
  expect_count<Dim>(config, 0.0);
  const auto simulation = make_simulation<Dim>(MPI_COMM_SELF, config);
  const MemoryNeed need = memory_need<Dim>(config, 1);
  EXPECT_GT(need.rank, static_cast<double>(simulation.bytes()));
  EXPECT_LT(memory_need<Dim>(config, 4).rank, need.rank);
  EXPECT_GT(memory_need<Dim>(config, 1, 2 * simulation.report().particles).rank, need.rank);
}

TEST(Memory, NeedIsCountedForFewParticlesAndSampledForMany) {
  expect_need<2>(shipped_case("jet60-quick.toml", {"jet.start=steady"}));
  expect_need<2>(shipped_case("shear-wave.toml"));
  expect_need<3>(shipped_case("hydrostatic-3d.toml"));
  expect_count<2>(shipped_case("hydrostatic.toml", {"particles.spacing=2e-4"}), 0.02);
  expect_count<2>(shipped_case("drop/drop.toml", {"particles.spacing=2e-3"}), 0.02);
}

TEST(Memory, NeedIsRefusedWhereTheCellsAreTooManyToCount) {
  try {
    memory_need<2>(shipped_case("jet60-quick.toml", {"plate.begin=-1e8"}), 1);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what())
                  .find("particles.spacing = 0.02: makes some 1.7e+09 background cells along an axis; allowed: at "
                        "most 536870912"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace impinge
