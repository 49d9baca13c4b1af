// Transport: how a node's messages leave and arrive. Each transport belongs to one region and is used by one thread.
// Messages arrive at least once and in any order. The protocol sorts them and drops copies.
#pragma once

#include <chrono>

#include "core/messages.h"

namespace aurasim::transport {

class Transport {
 public:
  virtual ~Transport() = default;

  /// Appends everything that has arrived to `inbox`.
  virtual void take(core::Inbox& inbox) = 0;

  /// Sends the step's aura batch to all listeners, and hand-offs and acknowledgements to their destinations.
  virtual void send(const core::Outbox& outbox) = 0;

  /// Returns as soon as something may have arrived, or at the time-out. Transports in virtual time return at once.
  virtual void wait_for_arrival(std::chrono::nanoseconds time_out) = 0;
};

}  // namespace aurasim::transport
