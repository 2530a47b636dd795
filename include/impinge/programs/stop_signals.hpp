#pragma once
// The signals that ask a run to stop after its step.

#include <csignal>
#include <vector>

namespace impinge {

/// While it lives, SIGTERM, SIGINT, SIGUSR1, SIGUSR2, SIGHUP, SIGQUIT, SIGXCPU, SIGALRM and SIGPIPE are noted, but for
/// those that were ignored before (nohup); a second SIGINT ends the process. One at a time. Not collective: a signal
/// may reach some ranks only.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  /// The last signal noted, 0 if there was none.
  static int received();

 private:
  std::vector<struct sigaction> before_;
};

/// "SIGTERM".
const char* signal_name(int signal);

}  // namespace impinge
