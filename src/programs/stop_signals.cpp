#include "impinge/programs/stop_signals.hpp"

#include <algorithm>
#include <array>

namespace impinge {
namespace {

struct StopSignal {
  int number;
  const char* name;
};

// Signals by which a user, a terminal or a batch system ends a program; not those of a crash.
constexpr std::array stop_signals{
    StopSignal{SIGTERM, "SIGTERM"}, StopSignal{SIGINT, "SIGINT"},   StopSignal{SIGUSR1, "SIGUSR1"},
    StopSignal{SIGUSR2, "SIGUSR2"}, StopSignal{SIGHUP, "SIGHUP"},   StopSignal{SIGQUIT, "SIGQUIT"},
    StopSignal{SIGXCPU, "SIGXCPU"}, StopSignal{SIGALRM, "SIGALRM"}, StopSignal{SIGPIPE, "SIGPIPE"}};

volatile std::sig_atomic_t noted = 0;

extern "C" void note(int signal) { noted = signal; }

}  // namespace

StopSignals::StopSignals() : before_(stop_signals.size()) {
  noted = 0;
  for (std::size_t k = 0; k < stop_signals.size(); ++k) {
    const int signal = stop_signals[k].number;
    sigaction(signal, nullptr, &before_[k]);
    if (before_[k].sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = note;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    if (signal == SIGINT) action.sa_flags |= SA_RESETHAND;
    sigaction(signal, &action, nullptr);
  }
}

StopSignals::~StopSignals() {
  for (std::size_t k = 0; k < stop_signals.size(); ++k) sigaction(stop_signals[k].number, &before_[k], nullptr);
}

int StopSignals::received() { return noted; }

const char* signal_name(int signal) {
  const auto found = std::ranges::find(stop_signals, signal, &StopSignal::number);
  return found == stop_signals.end() ? "a signal" : found->name;
}

}  // namespace impinge
