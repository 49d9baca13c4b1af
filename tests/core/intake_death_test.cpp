// What becomes of bodies that were under way to a region that died.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/intake_fixture.h"

namespace aurasim::core::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using Death = IntakeTest;

TEST_F(Death, IsToldToTheOthers) {
  EXPECT_THAT(publish().aura.dead, IsEmpty());
  lose(2);
  EXPECT_THAT(intake->dead_regions(), ElementsAre(region(2)));
  EXPECT_THAT(publish().aura.dead, ElementsAre(region(2)));
}

TEST_F(Death, WhomOneNeighbourHoldsForDeadIsDead) {
  receive_death(1, 2);
  EXPECT_THAT(intake->dead_regions(), ElementsAre(region(2)));
  EXPECT_FALSE(intake->fenced());
}

TEST_F(Death, WhoIsHeldForDeadItselfIsFenced) {
  receive_death(1, 0);
  EXPECT_TRUE(intake->fenced());
  EXPECT_THAT(intake->dead_regions(), IsEmpty());
}

TEST_F(Death, TheWordOfTheDeadDoesNotCount) {
  lose(1);
  inbox.auras.push_back(ours(batch(1, 0)));
  inbox.auras.back().dead = {region(2), region(0)};
  intake->accept(inbox);
  EXPECT_THAT(intake->dead_regions(), ElementsAre(region(1)));
  EXPECT_FALSE(intake->fenced());
}

TEST_F(Death, IsForGood) {
  lose(2);
  inbox.peers.push_back({region(2), PeerChange::kJoined});
  intake->accept(inbox);
  EXPECT_THAT(intake->dead_regions(), ElementsAre(region(2)));
}

TEST_F(Death, BodiesUnderWayComeBackOnlyWhenEveryLiveNeighbourKnows) {
  receive_all_until(5);
  send(2, 5, {record_of(1, 3)});
  lose(2);
  EXPECT_EQ(open_bodies(departures), 0u);
  EXPECT_EQ(intake->to_reclaim().size(), 1u);
  EXPECT_THAT(receive(6), IsEmpty());
  receive(batch(1, 6));
  EXPECT_THAT(receive(7), IsEmpty());
  receive_death(1, 2);
  const std::vector<Adoption> back = receive(8);
  EXPECT_EQ(ids_of(back), std::vector<std::uint64_t>{1});
  EXPECT_TRUE(back[0].reclaimed);
  EXPECT_EQ(back[0].stamp, 5);
  EXPECT_EQ(back[0].cluster.bodies[0].epoch, 4u) << "the highest epoch owns";
  EXPECT_EQ(intake->counters().reclaimed, 1u);
  EXPECT_TRUE(intake->to_reclaim().empty());
  EXPECT_THAT(receive(9), IsEmpty());
}

TEST_F(Death, BodiesComeBackAtOnceWhenNobodyElseIsAlive) {
  receive_all_until(5);
  send(2, 5, {record_of(1, 3)});
  lose(1);
  lose(2);
  EXPECT_EQ(ids_of(receive(6)), std::vector<std::uint64_t>{1});
}

TEST_F(Death, WhatWasAdoptedBeforeTheDeathDoesNotComeBack) {
  receive_all_until(5);
  send(2, 5, {record_of(1, 3)});
  receive_ack(2, 1);
  lose(2);
  receive_death(1, 2);
  EXPECT_THAT(receive(7), IsEmpty());
}

TEST_F(Death, WhatANeighbourClaimsDoesNotComeBack) {
  receive_all_until(5);
  send(2, 5, {record_of(1, 3), record_of(2, 1)});
  lose(2);
  receive_death(1, 2, {{body(1), 4}});
  EXPECT_EQ(ids_of(receive(7)), std::vector<std::uint64_t>{2});
}

TEST_F(Death, AnOlderClaimDoesNotCount) {
  receive_all_until(5);
  send(2, 5, {record_of(1, 3)});
  lose(2);
  receive_death(1, 2, {{body(1), 3}});
  EXPECT_EQ(ids_of(receive(7)), std::vector<std::uint64_t>{1});
}

TEST_F(Death, WhatCameBackFromTheDeadByItselfIsNotTakenBackAgain) {
  receive_all_until(5);
  send(2, 5, {record_of(1, 3)});
  receive(hand_off(2, 0, 5, {record_of(1, 4)}), 1);
  EXPECT_EQ(ids_of(receive(6)), std::vector<std::uint64_t>{1});
  lose(2);
  receive_death(1, 2);
  EXPECT_THAT(receive(7), IsEmpty());
}

TEST_F(Death, ThoseAdoptedFromTheDeadAreClaimed) {
  receive_all_until(5);
  receive(hand_off(2, 0, 5, {record_of(1, 4)}), 1);
  receive(6);
  EXPECT_THAT(publish().aura.claims, IsEmpty());
  lose(2);
  for (int i = 0; i < 2; ++i) {
    const std::vector<BodyEpoch> claims = publish().aura.claims;
    ASSERT_EQ(claims.size(), 1u) << "claims are repeated";
    EXPECT_EQ(claims[0].id, body(1));
    EXPECT_EQ(claims[0].epoch, 4u);
  }
}

TEST_F(Death, AReclaimedBodyIsClaimedFromThenOn) {
  receive_all_until(5);
  send(2, 5, {record_of(1, 3)});
  lose(2);
  receive_death(1, 2);
  receive(7);
  const std::vector<BodyEpoch> claims = publish().aura.claims;
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].epoch, 4u);
}

TEST_F(Death, AContactBetweenAReclaimedBodyAndOneThatStaysAwayIsForgotten) {
  receive_all_until(5);
  HandOff h = ours(hand_off(0, 2, 5, {record_of(1, 3), record_of(2, 3), record_of(3, 3)}));
  h.cluster.manifolds = {{.object0 = ref_of(body(1)), .object1 = ref_of(body(2))},
                         {.object0 = ref_of(body(2)), .object1 = ref_of(body(3))},
                         {.object0 = ref_of(body(3)), .object1 = ref_of(StaticId{0})}};
  departures.record(h);
  lose(2);
  receive_death(1, 2, {{body(1), 5}});
  const std::vector<Adoption> back = receive(7);
  EXPECT_THAT(ids_of(back), ElementsAre(2, 3));
  ASSERT_EQ(back[0].cluster.manifolds.size(), 2u);
  EXPECT_EQ(back[0].cluster.manifolds[0].object1, ref_of(body(3)));
}

}  // namespace
}  // namespace aurasim::core::testing
