#pragma once
// The signals that ask a run to stop after its step.

#include <array>
#include <csignal>

namespace impinge {

/// While it lives, SIGTERM, SIGINT and SIGUSR1 are noted; a second SIGINT ends the process. One at a time. Not
/// collective: a signal may reach some ranks only.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  /// The last signal noted, 0 if there was none.
  static int received();

 private:
  static constexpr std::array signals_{SIGTERM, SIGINT, SIGUSR1};
  std::array<struct sigaction, signals_.size()> before_{};
};

/// "SIGTERM".
const char* signal_name(int signal);

}  // namespace impinge
