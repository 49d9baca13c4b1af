#include "transport/memory_transport.h"

#include <limits>

namespace aurasim::transport {

class MemoryNetwork::Endpoint : public Transport {
 public:
  Endpoint(MemoryNetwork& network, core::RegionId region) : network_(network), region_(region) {}

  void take(core::Inbox& inbox) override {
    if (crashed_) return;
    for (Message& message : arrived_) {
      std::visit([&](auto& m) { append(inbox, std::move(m)); }, message);
    }
    arrived_.clear();
  }
  void send(const core::Outbox& outbox) override {
    if (!crashed_) network_.send(region_, outbox);
  }
  void wait_for_arrival(std::chrono::nanoseconds) override {}

  void arrive(Message message) { arrived_.push_back(std::move(message)); }
  void crash() { crashed_ = true; }

 private:
  static void append(core::Inbox& inbox, core::AuraBatch m) { inbox.auras.push_back(std::move(m)); }
  static void append(core::Inbox& inbox, core::HandOff m) { inbox.hand_offs.push_back(std::move(m)); }
  static void append(core::Inbox& inbox, core::PeerEvent m) { inbox.peers.push_back(m); }

  MemoryNetwork& network_;
  core::RegionId region_;
  bool crashed_ = false;
  std::vector<Message> arrived_;
};

MemoryNetwork::MemoryNetwork(std::vector<std::vector<core::RegionId>> listeners, const Faults& faults,
                             std::uint64_t seed)
    : listeners_(std::move(listeners)), faults_(faults, seed) {
  for (std::uint32_t r = 0; r < listeners_.size(); ++r) {
    endpoints_.push_back(std::make_unique<Endpoint>(*this, core::RegionId{r}));
  }
}

MemoryNetwork::~MemoryNetwork() = default;

Transport& MemoryNetwork::endpoint(core::RegionId region) { return *endpoints_.at(core::value_of(region)); }

void MemoryNetwork::advance_to(double now_s) {
  now_s_ = now_s;
  while (!in_flight_.empty() && in_flight_.begin()->first <= now_s) {
    Delivery& delivery = in_flight_.begin()->second;
    endpoints_.at(core::value_of(delivery.to))->arrive(std::move(delivery.message));
    in_flight_.erase(in_flight_.begin());
  }
}

double MemoryNetwork::next_arrival_s() const {
  return in_flight_.empty() ? std::numeric_limits<double>::infinity() : in_flight_.begin()->first;
}

void MemoryNetwork::post(core::RegionId from, core::RegionId to, const Message& message) {
  for (const double arrival : faults_.arrivals(from, to, now_s_ + send_delay_s_)) {
    in_flight_.emplace(arrival, Delivery{to, message});
  }
}

void MemoryNetwork::send(core::RegionId from, const core::Outbox& outbox) {
  std::vector<core::RegionId>& listeners = listeners_.at(core::value_of(from));
  if (!outbox.listeners.empty()) listeners = outbox.listeners;
  for (const core::RegionId to : listeners) post(from, to, outbox.aura);
  for (const core::HandOff& hand_off : outbox.hand_offs) post(from, hand_off.destination, hand_off);
}

void MemoryNetwork::crash(core::RegionId region, double lease_s) {
  endpoints_.at(core::value_of(region))->crash();
  for (const core::RegionId to : listeners_.at(core::value_of(region))) {
    in_flight_.emplace(now_s_ + lease_s, Delivery{to, core::PeerEvent{region, core::PeerChange::kLost}});
  }
}

}  // namespace aurasim::transport
