#include "host/stop_signal.h"

#include <csignal>

#include <unistd.h>

namespace aurasim::host {
namespace {

constexpr unsigned kSecondsAlone = 30;

volatile std::sig_atomic_t requested = 0;
volatile std::sig_atomic_t leaves = 0;
pid_t parent = 0;
bool needs_parent = false;

bool is_alone() { return ::getppid() != parent; }

void request(int) {
  requested = requested + 1;
  if (is_alone()) ::alarm(kSecondsAlone);
}

void request_leave(int signal) {
  if (leaves != 0 || (needs_parent && is_alone())) return request(signal);
  leaves = 1;
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

void let_sigterm_ask_to_leave(bool ends_with_parent) {
  needs_parent = ends_with_parent;
  struct sigaction action = {};
  action.sa_handler = request_leave;
  sigaction(SIGTERM, &action, nullptr);
}

bool asked_to_leave() { return leaves != 0; }

bool stop_requested() { return requested != 0; }

int stop_requests() { return requested; }

}  // namespace aurasim::host
