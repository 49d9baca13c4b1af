// How long a request may take: until its time-out, or until its client gives it up.
#pragma once

#include <algorithm>
#include <chrono>
#include <string>

#include "agent/problem.h"
#include "client/message.h"

namespace aurasim::agent {

class Patience {
 public:
  using Clock = std::chrono::steady_clock;

  /// `socket`: connection to the client. Any message there ends the wait.
  Patience(int socket, double seconds)
      : socket_(socket),
        deadline_(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                     std::chrono::duration<double>(std::min(std::max(seconds, 0.0), 1e8)))) {}

  bool is_over() const { return Clock::now() >= deadline_; }
  Clock::time_point deadline() const { return deadline_; }
  /// Throws Abandoned if the client has sent something, or Problem with text `what` once the time is over.
  void check(const std::string& what) const {
    if (client::is_readable(socket_, std::chrono::milliseconds(0))) throw Abandoned();
    if (is_over()) throw Problem(Kind::kTimedOut, what);
  }

 private:
  int socket_;
  Clock::time_point deadline_;
};

}  // namespace aurasim::agent
