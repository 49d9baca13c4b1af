#include "cli/stop_signal.h"

#include <csignal>

#include <unistd.h>

namespace aurasim::cli {
namespace {

constexpr unsigned kSecondsAlone = 30;

volatile std::sig_atomic_t requested = 0;
pid_t parent = 0;

void request(int) {
  requested = requested + 1;
  if (::getppid() != parent) ::alarm(kSecondsAlone);
}

}  // namespace

void catch_stop_signals() {
  parent = ::getppid();
  struct sigaction action = {};
  action.sa_handler = request;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction before = {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool stop_requested() { return requested != 0; }

int stop_requests() { return requested; }

}  // namespace aurasim::cli
