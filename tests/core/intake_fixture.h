// The intake of one node, region 0 of three columns that all listen to each other, and what tests feed it.
#pragma once

#include <optional>

#include <gtest/gtest.h>

#include "core/intake.h"
#include "core/letters.h"

namespace aurasim::core::testing {

class IntakeTest : public ::testing::Test {
 protected:
  void listen(SyncMode sync, int lookahead) {
    settings.sync = sync;
    settings.lookahead = lookahead;
    intake.emplace(settings, vicinity, departures);
  }

  /// Any message, as one of this run.
  template <class Message>
  Message ours(Message message) const {
    message.generation = settings.generation;
    if constexpr (requires { message.map_version; }) message.map_version = map.version();
    return message;
  }
  void receive(AuraBatch b) {
    inbox.auras.push_back(ours(std::move(b)));
    intake->accept(inbox);
  }
  void receive(HandOff h, std::uint64_t sequence) {
    h.sequence = sequence;
    inbox.hand_offs.push_back(ours(std::move(h)));
    intake->accept(inbox);
  }
  /// The next batch of `from`, which says that it has adopted the hand-offs of `source` up to `sequence`.
  void receive_adopted(std::uint32_t from, std::uint64_t sequence, std::uint32_t source = 0) {
    AuraBatch b = batch(from, intake->neighbours()[from - 1].received() + 1);
    b.adopted = {{region(source), sequence}};
    receive(b);
  }
  /// `from` has published all its batches up to `stamp`.
  void receive_until(std::uint32_t from, Step stamp) {
    for (Step s = intake->neighbours()[from - 1].received() + 1; s <= stamp; ++s) receive(batch(from, s));
  }
  void receive_all_until(Step stamp) {
    receive_until(1, stamp);
    receive_until(2, stamp);
  }
  void lose(std::uint32_t neighbour) {
    inbox.peers.push_back({region(neighbour), PeerChange::kLost});
    intake->accept(inbox);
  }
  void send(std::uint32_t to, Step stamp, std::initializer_list<BodyRecord> bodies) {
    departures.record(ours(hand_off(0, to, stamp, bodies)));
  }

  std::vector<Adoption> receive(Step n) { return intake->receive(n, violations); }
  static std::vector<std::uint64_t> ids_of(const std::vector<Adoption>& adoptions) {
    std::vector<std::uint64_t> ids;
    for (const Adoption& a : adoptions) {
      for (const BodyRecord& b : a.cluster.bodies) ids.push_back(value_of(b.id));
    }
    return ids;
  }
  /// The number up to which the hand-offs of region 1 have been adopted.
  std::uint64_t adopted_of_1() const {
    for (const HandOffMark& mark : intake->adopted()) {
      if (mark.region == region(1)) return mark.last_sequence;
    }
    return 0;
  }

  const RegionMap map = RegionMap::columns(3, 10);
  const Vicinity vicinity{map, region(0), 1e9};
  IntakeSettings settings{.generation = 4, .sync = SyncMode::kBounded, .lookahead = 2};
  DepartureLedger departures;
  ViolationLog violations;
  Inbox inbox;
  std::optional<Intake> intake{std::in_place, settings, vicinity, departures};
};

}  // namespace aurasim::core::testing
