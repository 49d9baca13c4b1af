#include "cli/stop_signal.h"

#include <csignal>

namespace aurasim::cli {
namespace {

volatile std::sig_atomic_t requested = 0;

void request(int) { requested = requested + 1; }

}  // namespace

void catch_stop_signals() {
  struct sigaction action = {};
  action.sa_handler = request;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool stop_requested() { return requested != 0; }

int stop_requests() { return requested; }

}  // namespace aurasim::cli
