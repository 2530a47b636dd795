#include "impinge/programs/stop_signals.hpp"

namespace impinge {
namespace {

volatile std::sig_atomic_t noted = 0;

extern "C" void note(int signal) { noted = signal; }

}  // namespace

StopSignals::StopSignals() {
  noted = 0;
  for (std::size_t k = 0; k < signals_.size(); ++k) {
    struct sigaction action {};
    action.sa_handler = note;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    if (signals_[k] == SIGINT) action.sa_flags |= SA_RESETHAND;
    sigaction(signals_[k], &action, &before_[k]);
  }
}

StopSignals::~StopSignals() {
  for (std::size_t k = 0; k < signals_.size(); ++k) sigaction(signals_[k], &before_[k], nullptr);
}

int StopSignals::received() { return noted; }

const char* signal_name(int signal) {
  switch (signal) {
    case SIGTERM:
      return "SIGTERM";
    case SIGINT:
      return "SIGINT";
    case SIGUSR1:
      return "SIGUSR1";
    default:
      return "a signal";
  }
}

}  // namespace impinge
