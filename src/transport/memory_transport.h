// A network inside one process, in virtual time: many nodes run inside one test, thousands of times faster than real
// time. Faults come from a FaultModel (faulty_transport.h).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <variant>
#include <vector>

#include "transport/faulty_transport.h"
#include "transport/transport.h"

namespace aurasim::transport {

class MemoryNetwork {
 public:
  /// `listeners[r]`: the regions that receive region r's aura batches, until it names others (Outbox::listeners). All
  /// times are seconds of virtual time.
  MemoryNetwork(std::vector<std::vector<core::RegionId>> listeners, const Faults& faults, std::uint64_t seed);
  ~MemoryNetwork();

  /// The transport of one region. Valid as long as the network.
  Transport& endpoint(core::RegionId region);

  /// Sets the time. Messages that arrive until `now_s` can then be taken.
  void advance_to(double now_s);
  double now_s() const { return now_s_; }
  /// Time at which the next message arrives; infinite if none is under way.
  double next_arrival_s() const;

  /// Delays the departure of all later messages by this time (the sender's frame time).
  void set_send_delay(double delay_s) { send_delay_s_ = delay_s; }
  double send_delay_s() const { return send_delay_s_; }

  /// Ends the process of a region: it sends and takes nothing more. Messages that are on the link still arrive, those
  /// before the link are lost. The other regions receive its death `lease_s` later.
  void crash(core::RegionId region, double lease_s);

  FaultModel& faults() { return faults_; }

 private:
  class Endpoint;
  using Message = std::variant<core::AuraBatch, core::HandOff, core::PeerEvent>;

  void post(core::RegionId from, core::RegionId to, const Message& message);
  void send(core::RegionId from, const core::Outbox& outbox);

  std::vector<std::vector<core::RegionId>> listeners_;
  FaultModel faults_;
  std::vector<std::unique_ptr<Endpoint>> endpoints_;
  struct Delivery {
    core::RegionId to;
    Message message;
  };
  std::multimap<double, Delivery> in_flight_;  ///< by time of arrival
  double now_s_ = 0;
  double send_delay_s_ = 0;
};

}  // namespace aurasim::transport
