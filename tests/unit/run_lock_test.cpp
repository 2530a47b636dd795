// One owner of an output directory at a time.

#include "impinge/io/run_lock.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "impinge/core/errors.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;

class RunLocks : public testing::Test {
 protected:
  RunLocks() { fs::create_directories(directory_); }
  ~RunLocks() override { fs::remove_all(directory_); }

  std::string refusal() const {
    try {
      const RunLock lock(directory_, "case");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  std::string directory_ = (fs::temp_directory_path() / ("impinge_lock_" + std::to_string(getpid()))).string();
  std::string file_ = directory_ + "/case.lock";
};

TEST_F(RunLocks, HaveOneOwner) {
  {
    const RunLock lock(directory_, "case");
    EXPECT_NE(refusal().find("process " + std::to_string(getpid()) + " on "), std::string::npos) << refusal();
    const RunLock other(directory_, "other");  // of another run
  }
  EXPECT_TRUE(fs::is_empty(directory_));
  EXPECT_EQ(refusal(), "");
}

TEST_F(RunLocks, OfADeadProcessGiveWay) {
  const pid_t child = fork();
  if (child == 0) {
    new RunLock(directory_, "case");  // dies with it
    _exit(0);
  }
  siginfo_t info{};
  waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT);
  ASSERT_TRUE(fs::exists(file_));
  EXPECT_EQ(refusal(), "");  // though its parent has not heard of its end
  waitpid(child, nullptr, 0);
  EXPECT_EQ(refusal(), "");
}

TEST_F(RunLocks, OfALaterProcessWithTheSameNumberGiveWay) {
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  const std::string start = host + (' ' + std::to_string(getpid())) + " 1 - ";  // started with the machine
  std::ofstream(file_) << start << fs::read_symlink("/proc/self/ns/pid").string() << '\n';
  EXPECT_EQ(refusal(), "");
  // A number of another container's tells nothing: it may live.
  std::ofstream(file_) << start << "pid:[1]\n";
  EXPECT_NE(refusal().find("is writing this run"), std::string::npos);
  fs::last_write_time(file_, fs::file_time_type::clock::now() - std::chrono::minutes(3));
  EXPECT_EQ(refusal(), "");
}

TEST_F(RunLocks, ThatAnotherProcessHasTakenAreItsOwn) {
  {
    const RunLock lock(directory_, "case");
    lock.check();
    std::ofstream(directory_ + "/other") << "elsewhere 7 1 - -\n";
    fs::rename(directory_ + "/other", file_);
    try {
      lock.check();
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(error.what(),
                file_ + ": process 7 on elsewhere has taken this run over; this process writes nothing more");
    }
  }
  EXPECT_TRUE(fs::exists(file_));
  const RunLock lock(directory_, "another");
  fs::remove(directory_ + "/another.lock");
  EXPECT_THROW(lock.check(), std::runtime_error);
}

TEST_F(RunLocks, OfAnotherHostGiveWayWhereTheyAreOld) {
  std::ofstream(file_) << "elsewhere 1 1 4711\n";
  EXPECT_NE(refusal().find("process 1 on elsewhere, job 4711 is writing this run"), std::string::npos) << refusal();
  fs::last_write_time(file_, fs::file_time_type::clock::now() - std::chrono::minutes(3));
  EXPECT_EQ(refusal(), "");
}

TEST_F(RunLocks, OfNoProcessAreNoTrouble) {
  std::ofstream(file_) << std::string(100'000, 'x');
  const std::string refused = refusal();
  EXPECT_NE(refused.find("process 0 on xxx"), std::string::npos) << refused.substr(0, 200);
  EXPECT_LT(refused.size(), 5000u);
  fs::remove(file_);
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  EXPECT_NE(refusal().find("is writing this run"), std::string::npos);
}

TEST_F(RunLocks, ThatCannotBeWrittenAreToldOf) { EXPECT_THROW(RunLock(directory_ + "/nowhere", "case"), FileError); }

}  // namespace
}  // namespace impinge
