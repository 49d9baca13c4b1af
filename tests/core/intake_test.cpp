// What takes effect when: the gate, lateness, copies, strangers and generations.
#include "core/intake.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/intake_fixture.h"
#include "core/random.h"

namespace aurasim::core::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using Gate = IntakeTest;
using Effect = IntakeTest;
using Copies = IntakeTest;
using Strangers = IntakeTest;

TEST_F(Gate, IsOpenForTheFirstStates) {
  listen(SyncMode::kBounded, 2);
  EXPECT_TRUE(intake->ready(1));
  EXPECT_FALSE(intake->ready(2));
}

TEST_F(Gate, WaitsForEveryNeighboursStampOfKStepsAgo) {
  listen(SyncMode::kBounded, 2);
  receive_until(1, 8);
  EXPECT_THAT(intake->missing(10), ElementsAre(region(2)));
  receive_until(2, 7);
  EXPECT_FALSE(intake->ready(10));
  receive_until(2, 8);
  EXPECT_TRUE(intake->ready(10));
  EXPECT_THAT(intake->missing(11), ElementsAre(region(1), region(2)));
}

TEST_F(Gate, WaitsForTheHandOffsOfKStepsAgo) {
  listen(SyncMode::kDeterministic, 1);
  receive_until(1, 4);
  receive_until(2, 9);
  AuraBatch b = batch(1, 5);
  b.hand_offs = {{region(0), 2}, {region(2), 7}};
  receive(b);
  EXPECT_TRUE(intake->ready(5));
  EXPECT_THAT(intake->missing(6), ElementsAre(region(1)));
  receive(hand_off(1, 0, 5, {record_of(2, 1)}), 2);
  EXPECT_FALSE(intake->ready(6)) << "the first one has not come";
  receive(hand_off(1, 0, 5, {record_of(1, 1)}), 1);
  EXPECT_TRUE(intake->ready(6));
}

/// A region that listens only later may have had no reader yet when the words went out.
TEST_F(Gate, OnlyRegionsThatPublishTheStateAreToSayAWordInIt) {
  const Vicinity near{map, region(0), 5};
  intake.emplace(settings, near, departures);
  intake->listen_to(region(2), 10);
  const auto say = [&](std::uint32_t from, Step stamp) {
    AuraBatch word = batch(from, stamp);
    word.word = 1;
    receive(word);
  };
  EXPECT_FALSE(intake->all_have_said(9, 1));
  say(1, 9);
  EXPECT_TRUE(intake->all_have_said(9, 1));
  say(1, 10);
  EXPECT_FALSE(intake->all_have_said(10, 1));
  say(2, 10);
  EXPECT_TRUE(intake->all_have_said(10, 1));
}

TEST_F(Gate, ANewerHandOffThatIsUnderWayKeepsNobodyWaiting) {
  listen(SyncMode::kBounded, 2);
  receive_all_until(7);
  AuraBatch b = batch(1, 8);
  b.hand_offs = {{region(0), 1}};
  receive(b);
  EXPECT_TRUE(intake->ready(9));
  receive_until(2, 8);
  EXPECT_FALSE(intake->ready(10));
}

TEST_F(Gate, IsAlwaysOpenWhenFreeRunning) {
  listen(SyncMode::kFreeRunning, 1);
  EXPECT_TRUE(intake->ready(100));
}

TEST_F(Gate, DoesNotWaitForTheDead) {
  listen(SyncMode::kBounded, 1);
  receive_until(1, 9);
  EXPECT_FALSE(intake->ready(10));
  lose(2);
  EXPECT_TRUE(intake->ready(10));
}

TEST_F(Effect, IsExactlyKStepsAfterTheStampInDeterministicMode) {
  for (const int lookahead : {1, 2, 3}) {
    listen(SyncMode::kDeterministic, lookahead);
    receive_all_until(20);
    receive(hand_off(1, 0, 10, {record_of(1, 1)}), 1);
    const Step due = 10 + lookahead;
    EXPECT_THAT(receive(due - 1), IsEmpty());
    EXPECT_EQ(intake->neighbours()[0].applied(), 9);
    const std::vector<Adoption> joined = receive(due);
    EXPECT_EQ(intake->neighbours()[0].applied(), 10);
    ASSERT_EQ(ids_of(joined), std::vector<std::uint64_t>{1});
    EXPECT_EQ(joined[0].stamp, 10);
    EXPECT_EQ(joined[0].source, region(1));
    EXPECT_THAT(receive(due + 1), IsEmpty());
  }
  EXPECT_EQ(violations.total(), 0u);
}

TEST_F(Effect, IsAsSoonAsPossibleInBoundedModeButNotBeforeTheStateAfterTheStamp) {
  listen(SyncMode::kBounded, 3);
  receive_all_until(20);
  receive(hand_off(1, 0, 10, {record_of(1, 1)}), 1);
  EXPECT_THAT(receive(10), IsEmpty());
  EXPECT_EQ(intake->neighbours()[0].applied(), 9);
  EXPECT_EQ(ids_of(receive(11)), std::vector<std::uint64_t>{1});
  EXPECT_EQ(intake->neighbours()[0].applied(), 10);
}

TEST_F(Effect, IsInOrderOfStampSourceAndNumberWhateverTheArrival) {
  Random random("orders");
  struct Sent {
    std::uint32_t source;
    Step stamp;
    std::uint64_t sequence;
  };
  std::vector<Sent> sent = {{1, 8, 1}, {1, 9, 2}, {1, 9, 3}, {2, 8, 1}, {2, 8, 2}, {2, 9, 3}};
  for (int run = 0; run < 50; ++run) {
    std::shuffle(sent.begin(), sent.end(), random.bits());
    listen(SyncMode::kDeterministic, 1);
    receive_all_until(9);
    for (const Sent& s : sent)
      receive(hand_off(s.source, 0, s.stamp, {record_of(100 * s.source + s.sequence, 1)}), s.sequence);
    EXPECT_THAT(ids_of(receive(10)), ElementsAre(101, 201, 202, 102, 103, 203));
  }
}

TEST_F(Effect, AMessageLaterThanKStepsIsAViolation) {
  listen(SyncMode::kFreeRunning, 2);
  receive_all_until(8);
  receive(10);
  EXPECT_EQ(violations.total(), 0u);
  receive(11);
  EXPECT_EQ(violations.count(ViolationKind::kLatency), 2u);
  EXPECT_EQ(violations.recent().back().value, 3);
  EXPECT_EQ(violations.recent().back().allowed, 2);
}

TEST_F(Effect, AHandOffLaterThanKStepsIsAViolationAndStillAdopted) {
  listen(SyncMode::kFreeRunning, 2);
  receive_all_until(10);
  receive(hand_off(1, 0, 7, {record_of(1, 1)}), 1);
  EXPECT_EQ(ids_of(receive(11)), std::vector<std::uint64_t>{1});
  EXPECT_EQ(violations.count(ViolationKind::kLatency), 1u);
}

TEST_F(Copies, OfBatchesAndHandOffsTakeNoEffect) {
  listen(SyncMode::kBounded, 1);
  receive(batch(1, 0));
  receive(batch(1, 0));
  receive(hand_off(1, 0, 0, {record_of(1, 1)}), 1);
  receive(hand_off(1, 0, 0, {record_of(1, 1)}), 1);
  EXPECT_EQ(ids_of(receive(1)), std::vector<std::uint64_t>{1});
  receive(hand_off(1, 0, 0, {record_of(1, 1)}), 1);
  EXPECT_THAT(receive(2), IsEmpty());
  EXPECT_EQ(intake->counters().copies, 3u);
  EXPECT_EQ(intake->counters().adopted, 1u);
}

TEST_F(Copies, AHandOffIsAcknowledgedWhenItIsAdoptedAndNotBefore) {
  listen(SyncMode::kDeterministic, 2);
  receive_all_until(9);
  receive(hand_off(1, 0, 5, {record_of(1, 1)}), 1);
  receive(hand_off(1, 0, 6, {record_of(2, 1)}), 2);
  receive(hand_off(1, 0, 5, {record_of(1, 1)}), 1);
  EXPECT_THAT(intake->adopted(), IsEmpty());
  receive(6);
  EXPECT_THAT(intake->adopted(), IsEmpty());
  receive(7);
  EXPECT_EQ(adopted_of_1(), 1u);
  receive(8);
  EXPECT_EQ(adopted_of_1(), 2u);
  receive(hand_off(1, 0, 5, {record_of(1, 1)}), 1);
  EXPECT_EQ(adopted_of_1(), 2u) << "also after a copy, whose sender may have missed it";
}

TEST_F(Copies, WhatFollowsALostHandOffIsNotAcknowledgedBeforeIt) {
  listen(SyncMode::kFreeRunning, 1);
  receive_all_until(9);
  receive(hand_off(1, 0, 5, {record_of(2, 1)}), 2);
  EXPECT_EQ(ids_of(receive(7)), std::vector<std::uint64_t>{2});
  EXPECT_EQ(adopted_of_1(), 0u);
  receive(hand_off(1, 0, 5, {record_of(1, 1)}), 1);
  EXPECT_EQ(ids_of(receive(8)), std::vector<std::uint64_t>{1});
  EXPECT_EQ(adopted_of_1(), 2u);
}

TEST_F(Copies, OnlyTheReceiverOfAHandOffSaysThatItIsAdopted) {
  listen(SyncMode::kBounded, 1);
  send(1, 3, {record_of(1, 1)});
  receive_adopted(2, 1);
  receive_adopted(1, 1, 2);
  receive_adopted(1, 0);
  EXPECT_EQ(open_bodies(departures), 1u);
  receive_adopted(1, 1);
  EXPECT_EQ(open_bodies(departures), 0u);
}

TEST_F(Strangers, OfAnEarlierGenerationAreRefused) {
  inbox.auras.push_back(ours(batch(1, 0)));
  inbox.auras.back().generation = settings.generation - 1;
  inbox.hand_offs.push_back(ours(hand_off(1, 0, 0, {record_of(1, 1)})));
  inbox.hand_offs.back().generation = settings.generation - 1;
  intake->accept(inbox);
  EXPECT_EQ(intake->counters().strangers, 2u);
  EXPECT_EQ(intake->neighbours()[0].received(), -1);
  EXPECT_TRUE(inbox.auras.empty());
  EXPECT_TRUE(inbox.hand_offs.empty());
}

TEST_F(Strangers, OfAnotherMapAreRefused) {
  inbox.auras.push_back(ours(batch(1, 0)));
  ++inbox.auras.back().map_version;
  inbox.hand_offs.push_back(ours(hand_off(1, 0, 0, {record_of(1, 1)})));
  ++inbox.hand_offs.back().map_version;
  intake->accept(inbox);
  EXPECT_EQ(intake->counters().strangers, 2u);
  EXPECT_EQ(intake->neighbours()[0].received(), -1);
}

TEST_F(Strangers, WhoAreNoNeighboursAreRefused) {
  receive(batch(7, 0));
  receive(batch(0, 0));
  receive(hand_off(7, 0, 0, {record_of(1, 1)}), 1);
  EXPECT_EQ(intake->counters().strangers, 3u);
}

TEST_F(Strangers, TheDeadAreNotHeardAnyMore) {
  receive_until(1, 3);
  receive(hand_off(1, 0, 3, {record_of(1, 1)}), 1);
  lose(1);
  receive(batch(1, 4));
  receive(hand_off(1, 0, 4, {record_of(2, 1)}), 2);
  EXPECT_EQ(intake->counters().strangers, 2u);
  EXPECT_THAT(receive(4), IsEmpty()) << "what came from the dead and has no effect yet never will have";
}

TEST_F(Strangers, TheDeadDoNotComeBack) {
  lose(2);
  inbox.peers.push_back({region(2), PeerChange::kJoined});
  intake->accept(inbox);
  EXPECT_THAT(intake->dead_regions(), ElementsAre(region(2)));
}

/// Where all others go back to an earlier state, or the run ends, nobody takes such bodies back. They stay in the
/// books.
TEST_F(Strangers, HandOffsToTheDeadStayOpen) {
  receive_all_until(5);
  send(2, 5, {record_of(1, 3)});
  lose(2);
  EXPECT_EQ(open_bodies(departures), 1u);
  EXPECT_THAT(receive(6), IsEmpty());
}

TEST_F(Strangers, MessagesToOthersAreIgnored) {
  receive(hand_off(1, 2, 0, {record_of(1, 1)}), 1);
  receive_until(1, 3);
  EXPECT_THAT(receive(4), IsEmpty());
}

TEST_F(Strangers, OfALaterGenerationStayInTheInboxInOrder) {
  for (const Step stamp : {0, 1, 2}) {
    inbox.auras.push_back(ours(batch(1, stamp)));
    inbox.auras.back().generation += 1;
    inbox.auras.push_back(ours(batch(2, stamp)));
  }
  inbox.hand_offs.push_back(ours(hand_off(1, 0, 0, {record_of(1, 1)})));
  inbox.hand_offs.back().generation += 1;
  intake->accept(inbox);
  ASSERT_EQ(inbox.auras.size(), 3u);
  for (Step stamp = 0; stamp < 3; ++stamp) {
    EXPECT_EQ(inbox.auras[static_cast<std::size_t>(stamp)].source, region(1));
    EXPECT_EQ(inbox.auras[static_cast<std::size_t>(stamp)].stamp, stamp);
  }
  EXPECT_EQ(inbox.hand_offs.size(), 1u);
  EXPECT_EQ(intake->neighbours()[1].received(), 2);
  EXPECT_EQ(intake->counters().strangers, 0u);
}

}  // namespace
}  // namespace aurasim::core::testing
