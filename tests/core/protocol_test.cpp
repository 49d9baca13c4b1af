// One node, given by hand what it hosts and receives.
#include "core/protocol.h"

#include <algorithm>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/horizon.h"
#include "core/protocol_fixture.h"

namespace aurasim::core::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST_F(ProtocolTest, ABatchIsPublishedForEveryStateEvenAnEmptyOne) {
  start(0);
  const AuraBatch& published = protocol->outbox().aura;
  EXPECT_EQ(published.stamp, 0);
  EXPECT_TRUE(published.full);
  EXPECT_EQ(published.generation, 3u);
  EXPECT_EQ(published.source, region(0));
  EXPECT_EQ(published.map_version, map->version());
  pass_step();
  EXPECT_EQ(protocol->outbox().aura.stamp, 1);
  EXPECT_FALSE(protocol->outbox().aura.full);
}

TEST_F(ProtocolTest, TopSpeedAndRadiusGoWithEveryBatch) {
  host(1, Vec3(-50, 0, 0), Vec3(12, 0, 0));
  host(2, Vec3(-50, 50, 0)).prototype = large;
  start(0);
  EXPECT_GE(protocol->outbox().aura.top_speed_m_s, 12);
  EXPECT_LT(protocol->outbox().aura.top_speed_m_s, 12.2);
  EXPECT_EQ(protocol->outbox().aura.top_radius_m, 4);
}

TEST_F(ProtocolTest, ABodyNearALargeForeignOneProjectsFromFurtherAway) {
  host(1, Vec3(-4, 0, 0));
  start(0);
  AuraBatch b = batch(1, 0);
  receive(b);
  receive_next();
  observe();
  EXPECT_THAT(protocol->outbox().aura.updates, IsEmpty());
  b = batch(1, 1);
  b.top_radius_m = 4;
  receive(b);
  receive_next();
  observe();
  EXPECT_EQ(protocol->outbox().aura.updates.size(), 1u);
}

TEST_F(ProtocolTest, ABodyNearAForeignOneProjectsWhereverItIs) {
  settings.aura.kind = AuraKind::kTight;
  host(1, Vec3(-40, 0, 0));
  start(0);
  receive_batch_of_1({foreign(9, Vec3(-38.9, 0, 0))});
  receive_next();
  observe();
  ASSERT_EQ(protocol->outbox().aura.updates.size(), 1u);
  EXPECT_EQ(protocol->outbox().aura.updates[0].id, body(1));
}

TEST_F(ProtocolTest, AStaleArrivalIsRefusedAndAcknowledged) {
  host(1, Vec3(-50, 0, 0)).epoch = 2;
  start(0);
  receive_batch_of_1();
  receive(hand_off(1, 0, 0, {record_of(1, 2), record_of(5, 1)}), 1);
  const Changes& changes = receive_next();
  ASSERT_EQ(changes.adoptions.size(), 1u);
  ASSERT_EQ(changes.adoptions[0].cluster.bodies.size(), 1u);
  EXPECT_EQ(changes.adoptions[0].cluster.bodies[0].id, body(5));
  EXPECT_THAT(changes.let_go, IsEmpty());
  EXPECT_EQ(protocol->counters().stale_arrivals, 1u);
  observe();
  ASSERT_EQ(protocol->outbox().aura.adopted.size(), 1u);
  EXPECT_EQ(protocol->outbox().aura.adopted[0].region, region(1));
  EXPECT_EQ(protocol->outbox().aura.adopted[0].last_sequence, 1u);
}

TEST_F(ProtocolTest, AnArrivalWithAHigherEpochReplacesTheBodyHere) {
  host(1, Vec3(-50, 0, 0)).epoch = 2;
  start(0);
  receive_batch_of_1();
  receive(hand_off(1, 0, 0, {record_of(1, 3)}), 1);
  const Changes& changes = receive_next();
  EXPECT_EQ(changes.adoptions.size(), 1u);
  EXPECT_THAT(changes.let_go, ElementsAre(body(1)));
}

/// Otherwise the node with the lower epoch might never receive the other's aura, and keep its copy.
TEST_F(ProtocolTest, ABodyThatAnotherNodeHostsTooIsAnnouncedToAll) {
  host(1, Vec3(-80, 0, 0)).epoch = 1;
  start(0);
  EXPECT_THAT(protocol->outbox().aura.updates, IsEmpty()) << "far from the border";
  receive_batch_of_1({foreign(1, Vec3(-80, 0, 0))});
  receive_next();
  observe();
  ASSERT_EQ(protocol->outbox().aura.updates.size(), 1u);
  EXPECT_EQ(protocol->outbox().aura.updates[0].audience, kAllListeners);
}

/// A dead node compares nothing over its region, so those who host bodies there have to know of each other.
TEST_F(ProtocolTest, ABodyOverADeadRegionIsAnnouncedToAll) {
  settings.aura.redo = true;
  host(1, Vec3(20, 0, 0)).epoch = 1;
  start(0);
  receive_batch_of_1();
  ASSERT_EQ(protocol->outbox().aura.updates.size(), 1u);
  EXPECT_EQ(protocol->outbox().aura.updates[0].audience, audience_of(RegionId{1}));
  inbox.peers.push_back({region(1), PeerChange::kLost});
  protocol->accept(inbox);
  receive_next();
  observe();
  ASSERT_EQ(protocol->outbox().aura.updates.size(), 1u);
  EXPECT_EQ(protocol->outbox().aura.updates[0].audience, kAllListeners);
}

TEST_F(ProtocolTest, WhereStatesAreCheckedABodyThatFliesAwayFromTheBorderIsNotAnnounced) {
  const auto announced = [this](bool checked) {
    snapshot.bodies.clear();
    now = 0;
    settings.aura.redo = checked;
    host(1, Vec3(-2.2, 0, 0), Vec3(20, 0, 0));
    host(2, Vec3(-2.2, 30, 0), Vec3(-20, 0, 0));
    start(0);
    pass_step();
    std::vector<BodyId> ids;
    for (const AuraRecord& update : protocol->outbox().aura.updates) ids.push_back(update.id);
    return ids;
  };
  EXPECT_THAT(announced(true), ElementsAre(body(1)));
  EXPECT_THAT(announced(false), ElementsAre(body(1), body(2)));
}

TEST_F(ProtocolTest, ABodyThatAnotherNodeOwnsUnderAHigherEpochIsLetGo) {
  host(1, Vec3(-50, 0, 0)).epoch = 2;
  host(2, Vec3(-50, 9, 0)).epoch = 2;
  start(0);
  receive_batch_of_1({foreign(1, Vec3(1, 0, 0), 3), foreign(2, Vec3(1, 9, 0), 2)});
  EXPECT_THAT(receive_next().let_go, ElementsAre(body(1)));
  EXPECT_EQ(protocol->counters().let_go, 1u);
}

TEST_F(ProtocolTest, AnotherNodesGhostOfABodyOfOursDoesNotTakeItAway) {
  host(1, Vec3(-50, 0, 0)).epoch = 2;
  start(0);
  AuraRecord ghost = foreign(1, Vec3(-50, 0, 0), 3, 0);
  ghost.flags = kAuraGhost;
  receive_batch_of_1({ghost});
  EXPECT_THAT(receive_next().let_go, IsEmpty());
}

TEST_F(ProtocolTest, AnAuraOfALowerRegionPullsAndOneOfAHigherDoesNot) {
  host(1, Vec3(0, 0, 0));
  start(1, RegionMap::columns(3, 10));
  for (const std::uint32_t from : {0u, 2u}) {
    AuraBatch b = batch(from, 0);
    b.updates = {foreign(9, Vec3(0, 0.9, 0), 0, from)};
    if (from == 0) b.updates.clear();
    receive(b);
  }
  receive_next();
  EXPECT_THAT(observe(), IsEmpty());
  AuraBatch b = batch(0, 1);
  b.updates = {foreign(8, Vec3(0, -0.9, 0), 0, 0)};
  receive(b);
  receive_next();
  const std::vector<Departure>& departures = observe();
  ASSERT_EQ(departures.size(), 1u);
  EXPECT_EQ(departures[0].destination, region(0));
  EXPECT_EQ(departures[0].reason, HandOffReason::kAuraCollision);
}

/// In one message, of up to 32 bodies.
TEST_F(ProtocolTest, ClustersThatLeaveForOneRegionTogetherAreOneHandOff) {
  AuraBatch sent = batch(0, 0);
  for (std::uint32_t i = 0; i < 40; ++i) {
    host(i, Vec3(0.45, 20.0 * i, 0));
    sent.updates.push_back(foreign(100 + i, Vec3(-0.45, 20.0 * i, 0), 0, 0));
  }
  start(1);
  receive(std::move(sent));
  receive_next();
  const std::vector<Departure>& departures = observe();
  ASSERT_EQ(departures.size(), 2u);
  EXPECT_EQ(departures[0].bodies.size(), 32u);
  EXPECT_EQ(departures[1].bodies.size(), 8u);
  EXPECT_EQ(protocol->outbox().hand_offs.size(), 2u);
}

TEST_F(ProtocolTest, ARegionThatPullsNothingFromHereIsComparedWithBodiesThatAreOutsideOnly) {
  settings.aura.redo = true;
  const auto pairs = [this](double x) {
    snapshot.bodies.clear();
    now = 0;
    host(1, Vec3(x, 0, 0));
    start(0);
    receive_batch_of_1({foreign(2, Vec3(x + 0.9, 0, 0))});
    receive_next();
    observe();
    return protocol->matching().pairs().size();
  };
  EXPECT_EQ(pairs(-0.45), 0u);
  EXPECT_EQ(pairs(5), 1u);
}

TEST_F(ProtocolTest, TheLowestOfSeveralRegionsPulls) {
  host(1, Vec3(10, 0, 0));
  start(2, RegionMap::columns(3, 10));
  for (const std::uint32_t from : {0u, 1u}) {
    AuraBatch b = batch(from, 0);
    b.updates = {foreign(9 + from, Vec3(10, from ? 0.9 : -0.9, 0), 0, from)};
    receive(b);
  }
  receive_next();
  ASSERT_EQ(observe().size(), 1u);
  EXPECT_EQ(protocol->outbox().hand_offs[0].destination, region(0));
}

TEST_F(ProtocolTest, TheDeadPullNobody) {
  host(1, Vec3(0, 0, 0));
  start(1, RegionMap::columns(2, 10));
  AuraBatch b = batch(0, 0);
  b.updates = {foreign(9, Vec3(0, 0.9, 0), 0, 0)};
  receive(b);
  inbox.peers.push_back({region(0), PeerChange::kLost});
  protocol->accept(inbox);
  receive_next();
  EXPECT_THAT(observe(), IsEmpty());
}

/// A live node may still announce a body that it has sent to the dead one.
TEST_F(ProtocolTest, TheDeadPullNobodyByAGhost) {
  host(1, Vec3(0, 0, 0));
  start(1, RegionMap::columns(3, 10));
  AuraBatch b = batch(2, 0);
  b.updates = {foreign(9, Vec3(0, 0.9, 0), 0, 0)};
  b.updates[0].flags = kAuraGhost;
  receive(b);
  inbox.peers.push_back({region(0), PeerChange::kLost});
  protocol->accept(inbox);
  receive_next();
  EXPECT_THAT(observe(), IsEmpty());
}

TEST_F(ProtocolTest, ABatchIsFullWhenARegionListensAnew) {
  settings.neighbour_distance_m = 1;
  start(0, RegionMap::columns(3, 10));
  AuraBatch b = batch(1, 0);
  b.introductions = {{region(0), region(2)}};
  receive(b);
  const Step since = horizon::introduction(settings.aura.lookahead);
  while (now < since) {
    receive_next();
    observe();
    EXPECT_EQ(protocol->outbox().aura.full, now == since) << now;
  }
  EXPECT_EQ(protocol->outbox().listeners.size(), 2U);
}

TEST_F(ProtocolTest, AnUnacknowledgedHandOffIsSentAgain) {
  settings.resend_after_steps = 7;
  host(1, Vec3(5, 0, 0));
  start(0);
  while (now < 4) pass_step();
  ASSERT_EQ(protocol->counters().handed_over, 1u);
  const Step sent = protocol->departures().open().front().stamp;
  while (now < sent + 20) {
    pass_step();
    EXPECT_EQ(protocol->outbox().hand_offs.size(), (now - sent) % 7 == 0 ? 1u : 0u) << "state " << now;
  }
}

TEST_F(ProtocolTest, ABodyBeyondAllWhoListenIsAViolation) {
  settings.neighbour_distance_m = 0;
  BodyState& far = host(1, Vec3(-10, 0, 0), Vec3(1, 0, 0));
  far.pose.p_WB.x() = 12;
  start(0, RegionMap::columns(3, 10));
  EXPECT_EQ(protocol->violations().count(ViolationKind::kSpan), 1u);
}

TEST_F(ProtocolTest, ABodyFasterThanPromisedIsAViolationCountedOnceAndAWarningInEveryStep) {
  host(1, Vec3(-50, 0, 0), Vec3(33, 0, 0));
  start(0);
  pass_step();
  EXPECT_EQ(protocol->violations().count(ViolationKind::kSpeed), 1u);
  EXPECT_EQ(protocol->last_violation_step(), 1) << "it goes on: what it spoils is found long after it began";
  EXPECT_EQ(protocol->outbox().aura.violations, 2u) << "it is published";
  snapshot.bodies[0].v_WB = Vec3(1, 0, 0);
  pass_step();
  EXPECT_EQ(protocol->last_violation_step(), 1);
  snapshot.bodies[0].v_WB = Vec3(40, 0, 0);
  pass_step();
  EXPECT_EQ(protocol->violations().count(ViolationKind::kSpeed), 2u);
  EXPECT_EQ(protocol->outbox().aura.violations, 3u);
}

TEST_F(ProtocolTest, ABodyThatIsNotWhereItsAuraSaidIsAViolation) {
  host(1, Vec3(-0.5, 0, 0));
  start(0);
  for (int i = 0; i < 10; ++i) pass_step();
  EXPECT_EQ(protocol->violations().count(ViolationKind::kPromise), 0u);
  snapshot.bodies[0].pose.p_WB.y() += 1;
  for (int i = 0; i < 4; ++i) pass_step();
  EXPECT_GE(protocol->violations().count(ViolationKind::kPromise), 1u);
}

TEST_F(ProtocolTest, ASlowFrameIsAViolation) {
  start(0);
  protocol->report_frame(5, settings.aura.frame_s);
  EXPECT_EQ(protocol->violations().total(), 0u);
  protocol->report_frame(6, 1.1 * settings.aura.frame_s);
  EXPECT_EQ(protocol->violations().count(ViolationKind::kFrame), 1u);
}

TEST_F(ProtocolTest, ANeighboursViolationIsReceived) {
  start(0);
  for (int i = 0; i < 5; ++i) pass_step();
  EXPECT_LT(protocol->last_violation_step(), 0);
  AuraBatch b = batch(1, 5);
  b.violations = 1;
  receive(b);
  receive_next();
  EXPECT_EQ(protocol->last_violation_step(), 5);
}

class AssignHosts : public ProtocolTest {
 protected:
  std::vector<RegionId> assign(const RegionMap& layout) {
    return assign_hosts(layout, settings.aura, shapes, snapshot);
  }
};

TEST_F(AssignHosts, ABodyIsHostedWhereItsCentreIs) {
  host(1, Vec3(-5, 0, 0));
  host(2, Vec3(5, 0, 0));
  EXPECT_THAT(assign(RegionMap::columns(2, 100)), ElementsAre(region(0), region(1)));
}

TEST_F(AssignHosts, ATowerOnABorderStartsOnOneNode) {
  for (int i = 0; i < 6; ++i) host(static_cast<std::uint64_t>(i), Vec3(i % 2 ? 0.01 : -0.01, 0, 1.0 * i));
  for (const RegionId assigned : assign(RegionMap::columns(2, 100))) EXPECT_EQ(assigned, region(0));
}

TEST_F(AssignHosts, BodiesInContactStartOnTheLowestRegionOfTheirs) {
  host(1, Vec3(5, 0, 0));
  host(2, Vec3(-15, 0, 0));
  snapshot.contacts = {{0, 1}};
  EXPECT_THAT(assign(RegionMap::columns(4, 10)), ElementsAre(region(0), region(0)));
}

TEST_F(AssignHosts, BodiesThatMeetBeforeAnybodyHearsOfAnybodyStartTogether) {
  host(1, Vec3(-1, 0, 0), Vec3(30, 0, 0));
  host(2, Vec3(1, 0, 0), Vec3(-30, 0, 0));
  EXPECT_THAT(assign(RegionMap::columns(2, 100)), ElementsAre(region(0), region(0)));
}

TEST_F(AssignHosts, TheNaiveControlAsksOnlyForThePlace) {
  settings.aura.kind = AuraKind::kNone;
  host(1, Vec3(-0.1, 0, 0));
  host(2, Vec3(0.1, 0, 0));
  EXPECT_THAT(assign(RegionMap::columns(2, 100)), ElementsAre(region(0), region(1)));
}

}  // namespace
}  // namespace aurasim::core::testing
