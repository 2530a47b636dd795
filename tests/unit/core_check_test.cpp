#include "impinge/programs/core_check.hpp"

#include <gtest/gtest.h>

namespace impinge {
namespace {

TEST(CoreCheck, WarnsWhereRanksOutnumberFreeCores) {
  EXPECT_EQ(core_warning(2, 2, 0), "");
  EXPECT_EQ(core_warning(2, 8, 6), "");
  EXPECT_EQ(core_warning(4, 2, 0),
            "4 ranks share a node with 2 cores: ranks that wait keep a core busy, and all become slow; start 2, or set "
            "OMPI_MCA_mpi_yield_when_idle=1");
  EXPECT_EQ(
      core_warning(4, 4, 2),
      "4 ranks share a node with 4 cores, 2 of them in use: ranks that wait keep a core busy, and all become slow; "
      "start 2, or set OMPI_MCA_mpi_yield_when_idle=1");
  // Beside too many others one rank is the best of all.
  EXPECT_TRUE(core_warning(2, 2, 9).ends_with("start 1, or set OMPI_MCA_mpi_yield_when_idle=1"));
  EXPECT_EQ(core_warning(1, 2, 9), "");
}

}  // namespace
}  // namespace impinge
