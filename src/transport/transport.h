// How a node's messages leave and arrive. One transport belongs to one region; it is used by one thread.
// Delivery is at least once and in any order between messages: the protocol sorts, and drops copies.
#pragma once

#include <chrono>

#include "core/messages.h"

namespace aurasim::transport {

class Transport {
 public:
  virtual ~Transport() = default;

  /// Appends everything that has arrived to `inbox`.
  virtual void take(core::Inbox& inbox) = 0;

  /// Sends the step's aura batch to every neighbour and hand-offs and acks to their destinations.
  virtual void send(const core::Outbox& outbox) = 0;

  /// Returns as soon as something may have arrived, or at the time-out. Virtual-time transports return at once.
  virtual void wait_for_arrival(std::chrono::nanoseconds time_out) = 0;
};

}  // namespace aurasim::transport
