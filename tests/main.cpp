// Runs the tests on every rank; a failure on one rank is a failure of all.

#include <gtest/gtest.h>

#include <cstdio>

#include "impinge/io/hdf5_file.hpp"
#include "impinge/parallel/exchange.hpp"

namespace {

/// Reports the failures of a rank and nothing else.
class FailurePrinter : public testing::EmptyTestEventListener {
 public:
  explicit FailurePrinter(int rank) : rank_(rank) {}

 private:
  void OnTestStart(const testing::TestInfo& test) override { test_ = &test; }

  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (!result.failed()) return;
    std::printf("%s:%d: rank %d, %s.%s\n%s\n", result.file_name() ? result.file_name() : "?", result.line_number(),
                rank_, test_ ? test_->test_suite_name() : "?", test_ ? test_->name() : "?", result.message());
    std::fflush(stdout);
  }

  const testing::TestInfo* test_ = nullptr;
  int rank_;
};

}  // namespace

int main(int argc, char** argv) {
  impinge::prepare_file_access();
  MPI_Init(&argc, &argv);
  testing::InitGoogleTest(&argc, argv);
  const int rank = impinge::rank_of(MPI_COMM_WORLD);
  // The other ranks may be waiting for one that throws: let it end the job.
  if (impinge::ranks_of(MPI_COMM_WORLD) > 1) GTEST_FLAG_SET(catch_exceptions, false);
  if (rank > 0) {
    auto& listeners = testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new FailurePrinter(rank));
  }
  int failed = 0;
  {
    const impinge::PetscSession session(argv[0], {argv + 1, argv + argc});
    failed = RUN_ALL_TESTS();
  }
  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  MPI_Finalize();
  return failed;
}
