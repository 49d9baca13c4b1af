// Between a node and its network in memory: what the wire would refuse arrives as a refusal, as with DDS.
#pragma once

#include "messages/wire_bytes.h"
#include "transport/transport.h"

namespace aurasim::test {

class WireCheck final : public transport::Transport {
 public:
  explicit WireCheck(transport::Transport& network) : network_(network) {}

  void take(core::Inbox& inbox) override {
    core::Inbox arrived;
    network_.take(arrived);
    for (core::AuraBatch& batch : arrived.auras) {
      auto decoded = coder_.aura(coder_.of(batch), {});
      if (const auto* error = std::get_if<messages::WireError>(&decoded)) {
        inbox.refusals.push_back(
            {batch.source, batch.generation, batch.stamp, core::MessageKind::kAura, name_of(*error)});
      } else {
        inbox.auras.push_back(std::get<core::AuraBatch>(std::move(decoded)));
      }
    }
    for (core::HandOff& hand_off : arrived.hand_offs) {
      auto decoded = coder_.hand_off(coder_.of(hand_off), {});
      if (const auto* error = std::get_if<messages::WireError>(&decoded)) {
        inbox.refusals.push_back(
            {hand_off.source, hand_off.generation, hand_off.stamp, core::MessageKind::kHandOff, name_of(*error)});
      } else {
        inbox.hand_offs.push_back(std::get<core::HandOff>(std::move(decoded)));
      }
    }
    inbox.acks.insert(inbox.acks.end(), arrived.acks.begin(), arrived.acks.end());
    inbox.peers.insert(inbox.peers.end(), arrived.peers.begin(), arrived.peers.end());
  }
  void send(const core::Outbox& outbox) override { network_.send(outbox); }
  void wait_for_arrival(std::chrono::nanoseconds time_out) override { network_.wait_for_arrival(time_out); }

 private:
  transport::Transport& network_;
  messages::WireBytes coder_;
};

}  // namespace aurasim::test
