#include "lab/wire_post.h"

#include <algorithm>
#include <utility>

#include "messages/wire_bytes.h"

namespace aurasim::lab {
namespace {

/// Number of states whose messages are kept. Nodes wait for each other, so none is further behind.
constexpr core::Step kStatesKept = 200;
/// Number of redos whose messages are kept. Several redos may follow each other while a message is under way.
constexpr std::uint32_t kRedosKept = 16;

template <class Map>
void forget_before(Map& kept, std::uint32_t redo, core::Step step) {
  std::erase_if(kept, [&](const auto& entry) {
    return std::get<0>(entry.first) + kRedosKept < redo || std::get<1>(entry.first) < step;
  });
}

/// Adds the message to the inbox's list, or its refusal if it could not be decoded. `envelope`: what is known of it.
template <class Message>
void arrive(messages::Decoded<Message> decoded, const Message& envelope, core::MessageKind kind,
            std::vector<Message>& list, core::Inbox& inbox) {
  if (const auto* error = std::get_if<messages::WireError>(&decoded)) {
    inbox.refusals.push_back({envelope.source, envelope.generation, envelope.stamp, kind, messages::name_of(*error)});
  } else {
    list.push_back(std::get<Message>(std::move(decoded)));
  }
}

}  // namespace

class WirePost::Endpoint : public transport::Transport {
 public:
  Endpoint(WirePost& post, core::RegionId region, double block_m)
      : post_(post), network_(post.network_.endpoint(region)), region_(region) {
    expected_.block_m = block_m;
  }

  void take(core::Inbox& inbox) override {
    core::Inbox arrived;
    network_.take(arrived);
    for (const core::AuraBatch& envelope : arrived.auras) {
      const Kept& kept = post_.kept_.at(core::value_of(envelope.source));
      arrive(coder_.aura(kept.auras.at({envelope.redo, envelope.stamp, envelope.word}), expected_), envelope,
             core::MessageKind::kAura, inbox.auras, inbox);
    }
    for (const core::HandOff& envelope : arrived.hand_offs) {
      const Kept& kept = post_.kept_.at(core::value_of(envelope.source));
      const Bytes& bytes = kept.hand_offs.at({envelope.redo, envelope.stamp, envelope.destination, envelope.sequence});
      arrive(coder_.hand_off(bytes, expected_), envelope, core::MessageKind::kHandOff, inbox.hand_offs, inbox);
    }
    inbox.peers.insert(inbox.peers.end(), arrived.peers.begin(), arrived.peers.end());
  }

  /// The network carries envelopes only; the bytes stay here. A step's messages leave together, when the link has sent
  /// the last of them.
  void send(const core::Outbox& outbox) override {
    core::Outbox envelopes;
    envelopes.listeners = outbox.listeners;
    envelopes.expected = outbox.expected;
    forget_old(outbox.aura);
    std::size_t bytes = 0;
    for (const core::HandOff& hand_off : outbox.hand_offs) bytes += put_away(hand_off, envelopes);
    bytes += put_away(outbox.aura, outbox.listeners.size(), envelopes);
    transport::MemoryNetwork& network = post_.network_;
    const double usual_delay_s = network.send_delay_s();
    const double begin_s = std::max(free_s_, network.now_s() + usual_delay_s);
    free_s_ = begin_s + static_cast<double>(bytes) / post_.bandwidth_B_s_;
    network.set_send_delay(free_s_ - network.now_s());
    network_.send(envelopes);
    network.set_send_delay(usual_delay_s);
  }

  void wait_for_arrival(std::chrono::nanoseconds) override {}

  const Traffic& traffic() const { return traffic_; }
  double backlog_s() const { return std::max(0.0, free_s_ - post_.network_.now_s()); }

 private:
  /// Bytes that `copies` of a message put on the link.
  std::size_t count(std::size_t bytes, std::size_t copies) {
    traffic_.link_bytes += copies * bytes;
    traffic_.messages += copies;
    traffic_.datagrams += copies * ((bytes + kDatagramBytes - 1) / kDatagramBytes);
    return copies * bytes;
  }

  Kept& kept() { return post_.kept_.at(core::value_of(region_)); }

  void forget_old(const core::AuraBatch& now) {
    forget_before(kept().auras, now.redo, now.stamp - kStatesKept);
    forget_before(kept().hand_offs, now.redo, now.stamp - kStatesKept);
  }

  std::size_t put_away(const core::AuraBatch& batch, std::size_t copies, core::Outbox& envelopes) {
    envelopes.aura.source = batch.source;
    envelopes.aura.generation = batch.generation;
    envelopes.aura.redo = batch.redo;
    envelopes.aura.stamp = batch.stamp;
    envelopes.aura.word = batch.word;
    const Bytes& bytes = kept().auras[{batch.redo, batch.stamp, batch.word}] = coder_.of(batch);
    traffic_.aura_bytes += bytes.size();
    traffic_.aura_updates += batch.updates.size();
    return count(bytes.size(), copies);
  }

  std::size_t put_away(const core::HandOff& hand_off, core::Outbox& envelopes) {
    core::HandOff& envelope = envelopes.hand_offs.emplace_back();
    envelope.source = hand_off.source;
    envelope.generation = hand_off.generation;
    envelope.destination = hand_off.destination;
    envelope.redo = hand_off.redo;
    envelope.stamp = hand_off.stamp;
    envelope.sequence = hand_off.sequence;
    const HandOffKey key{hand_off.redo, hand_off.stamp, hand_off.destination, hand_off.sequence};
    const Bytes& bytes = kept().hand_offs[key] = coder_.of(hand_off);
    ++traffic_.hand_offs;
    traffic_.handed_over += hand_off.cluster.bodies.size();
    traffic_.hand_off_bytes += bytes.size();
    return count(bytes.size(), 1);
  }

  WirePost& post_;
  transport::Transport& network_;
  core::RegionId region_;
  messages::WireBytes coder_;
  messages::Expected expected_;
  Traffic traffic_;
  double free_s_ = 0;  ///< when the link has sent what it was given
};

WirePost::WirePost(transport::MemoryNetwork& network, std::size_t regions, double bandwidth_B_s, double block_m)
    : network_(network), bandwidth_B_s_(bandwidth_B_s), kept_(regions) {
  for (std::uint32_t r = 0; r < regions; ++r) {
    endpoints_.push_back(std::make_unique<Endpoint>(*this, core::RegionId{r}, block_m));
  }
}

WirePost::~WirePost() = default;

transport::Transport& WirePost::endpoint(core::RegionId region) { return *endpoints_.at(core::value_of(region)); }

const Traffic& WirePost::traffic(core::RegionId region) const {
  return endpoints_.at(core::value_of(region))->traffic();
}

double WirePost::backlog_s(core::RegionId region) const { return endpoints_.at(core::value_of(region))->backlog_s(); }

}  // namespace aurasim::lab
