// Signals: noted, the second SIGINT ends the process.

#include "impinge/programs/stop_signals.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace impinge {
namespace {

/// How a process ends that runs `action` and then exits with its result.
template <class Action>
int status_after(Action action) {
  const pid_t child = fork();
  if (child == 0) _exit(action());
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

TEST(StopSignals, AreNoted) {
  for (const int signal : {SIGTERM, SIGINT, SIGUSR1, SIGUSR2, SIGHUP, SIGQUIT, SIGXCPU, SIGALRM, SIGPIPE}) {
    const int status = status_after([&] {
      const StopSignals signals;
      if (StopSignals::received() != 0) return 1;
      raise(signal);
      return StopSignals::received() == signal ? 0 : 2;
    });
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << signal_name(signal);
  }
}

TEST(StopSignals, ASecondSigintEndsAtOnce) {
  const int status = status_after([] {
    const StopSignals signals;
    raise(SIGINT);
    raise(SIGINT);
    return 0;
  });
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT);
}

TEST(StopSignals, StayIgnoredWhereTheyWere) {
  const int status = status_after([] {
    std::signal(SIGHUP, SIG_IGN);
    const StopSignals signals;
    raise(SIGHUP);
    return StopSignals::received();
  });
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

TEST(StopSignals, AreNotThoseOfACrash) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS}) {
    const int status = status_after([&] {
      const StopSignals signals;
      std::signal(signal, SIG_DFL);
      raise(signal);
      return 0;
    });
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal);
  }
}

TEST(StopSignals, AreAsBeforeAtTheEnd) {
  const int status = status_after([] {
    std::signal(SIGTERM, SIG_DFL);
    { const StopSignals signals; }
    raise(SIGTERM);
    return 0;
  });
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
}

}  // namespace
}  // namespace impinge
