// When auras are published, and when hand-offs happen, seen from what the nodes of a small world publish.
#include <algorithm>
#include <optional>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/kinematic_world.h"
#include "core/letters.h"
#include "core/random.h"

namespace aurasim::core::testing {
namespace {

using ::testing::ElementsAre;

constexpr RegionId kWest{0};
constexpr RegionId kEast{1};
constexpr BodyId kBody{7};

class ProjectionTest : public ::testing::TestWithParam<int> {
 protected:
  ProjectionTest() {
    rules.kind = AuraKind::kTight;
    rules.lookahead = GetParam();
    rules.contact_margin_m = 0;
    rules.gravity = Vec3::Zero();
  }
  int k() const { return rules.lookahead; }

  void make_world(const RegionMap& map) { world.emplace(map, rules, shapes); }
  void place_at(BodyId id, const Vec3& p) { place_flying(id, p, Vec3::Zero()); }
  /// From `p` in state 0 with velocity `v`.
  void place_flying(BodyId id, const Vec3& p, const Vec3& v) {
    world->place(on_straight_line(id, ball, rules, p, 0, v, kSteps));
  }
  /// Starts at x, flies to the right for half of the steps, and back.
  void place_there_and_back(BodyId id, double x, double speed) {
    Traveller t = on_straight_line(id, ball, rules, Vec3(x, 0, 0), 0, Vec3(speed, 0, 0), kSteps);
    for (std::size_t i = 0; i < t.p_WB.size() / 2; ++i) t.p_WB[t.p_WB.size() - 1 - i] = t.p_WB[i];
    for (std::size_t n = t.v_WB.size() / 2; n < t.v_WB.size(); ++n) t.v_WB[n] = Vec3(-speed, 0, 0);
    world->place(std::move(t));
  }

  const AuraRecord* update_of(BodyId id, RegionId by) const {
    for (const AuraRecord& a : world->published(by).aura.updates) {
      if (a.id == id) return &a;
    }
    return nullptr;
  }
  bool deleted(BodyId id, RegionId by) const {
    const std::vector<BodyId>& deletes = world->published(by).aura.deletes;
    return std::find(deletes.begin(), deletes.end(), id) != deletes.end();
  }
  const HandOff* hand_off_of(RegionId by) const {
    return world->published(by).hand_offs.empty() ? nullptr : &world->published(by).hand_offs.front();
  }
  const ProjectionCounters& counters(RegionId by) const { return world->protocol(by).projection().counters(); }
  std::set<BodyId> known_to(RegionId listener) const {
    std::set<BodyId> ids;
    for (const Neighbour& neighbour : world->protocol(listener).intake().neighbours()) {
      for (const AuraRecord& a : neighbour.auras()) ids.insert(a.id);
    }
    return ids;
  }
  /// Steps until `by` hands something over; its stamp, or -1 if it never does.
  Step run_until_hand_off(RegionId by) {
    while (world->now() < kSteps) {
      world->step();
      if (hand_off_of(by)) return world->now();
    }
    return -1;
  }

  static constexpr Step kSteps = 120;
  AuraRules rules;
  RoundShapes shapes;
  PrototypeId ball = shapes.sphere(0.5);
  std::optional<KinematicWorld> world;
};

TEST_P(ProjectionTest, AnAuraIsCreatedInTheZoneUpdatedEachStepAndDeletedOnLeaving) {
  make_world(RegionMap::columns(2, 100));
  place_there_and_back(kBody, -25, 24);
  world->start();
  Step created = -1, gone = -1;
  while (world->now() < kSteps && gone < 0) {
    world->step();
    const bool published = update_of(kBody, kWest) != nullptr;
    if (published && created < 0) created = world->now();
    if (created >= 0 && !published) gone = world->now();
    EXPECT_EQ(deleted(kBody, kWest), gone >= 0);
    EXPECT_EQ(published, created >= 0 && gone < 0);
  }
  ASSERT_GT(created, 0);
  ASSERT_GT(gone, created);
  EXPECT_EQ(counters(kWest).created, 1u);
  EXPECT_EQ(counters(kWest).updated, static_cast<std::uint64_t>(gone - created - 1));
  EXPECT_EQ(counters(kWest).deleted, 1u);
  while (world->now() < gone + k()) world->step();
  EXPECT_TRUE(known_to(kEast).empty());
}

TEST_P(ProjectionTest, ABodyProjectsNoLaterThanTheTableAsks) {
  make_world(RegionMap::columns(2, 100));
  place_flying(kBody, Vec3(-20, 0, 0), Vec3(20, 0, 0));
  world->start();
  while (!update_of(kBody, kWest)) world->step();
  const AuraRecord& first = *update_of(kBody, kWest);
  const double before = first.pose.p_WB.x() + 0.5 - 20 * rules.step_s;  // its surface one state earlier
  const Aura& aura = world->protocol(kWest).aura();
  EXPECT_LT(before, -aura.zone(20, 1, 20, 0.5));
  EXPECT_LT(-first.pose.p_WB.x(), 100.0 / 2);
}

TEST_P(ProjectionTest, ASleepingBodyIsSilent) {
  make_world(RegionMap::columns(2, 100));
  place_at(kBody, Vec3(-1, 0, 0));
  world->start();
  world->run_steps(5);
  EXPECT_TRUE(update_of(kBody, kWest));
  world->set_awake(kBody, false);
  world->step();
  ASSERT_TRUE(update_of(kBody, kWest));
  EXPECT_EQ(update_of(kBody, kWest)->flags, kAuraAsleep);
  for (int i = 0; i < 20; ++i) {
    world->step();
    EXPECT_FALSE(update_of(kBody, kWest));
    EXPECT_FALSE(deleted(kBody, kWest));
    EXPECT_EQ(world->published(kWest).aura.stamp, world->now()) << "the batch is sent all the same";
  }
  EXPECT_THAT(known_to(kEast), ElementsAre(kBody));
  world->set_awake(kBody, true);
  world->step();
  ASSERT_TRUE(update_of(kBody, kWest));
  EXPECT_EQ(update_of(kBody, kWest)->flags, 0);
}

TEST_P(ProjectionTest, ABodyFarFromEveryBoundaryIsItsHostsAlone) {
  make_world(RegionMap::columns(2, 100));
  place_at(kBody, Vec3(-40, 0, 0));
  world->start();
  world->run_steps(10);
  EXPECT_EQ(counters(kWest).created, 0u);
  EXPECT_EQ(world->protocol(kWest).find(kBody)->phase, Phase::kHostRegion);
}

TEST_P(ProjectionTest, ABodyOnACornerIsSeenByAllThreeNeighbours) {
  make_world(RegionMap::grid(2, 2, 100, 100));
  place_at(kBody, Vec3(0.1, 0.1, 0));
  world->start();
  ASSERT_EQ(world->host(kBody), RegionId{3});
  world->run_steps(k());
  for (const std::uint32_t listener : {0u, 1u, 2u}) EXPECT_THAT(known_to(RegionId{listener}), ElementsAre(kBody));
}

TEST_P(ProjectionTest, ABodyWhereThreeBricksMeetIsSeenByBothOthers) {
  make_world(RegionMap::brick(2, 2, 100, 100));
  place_at(kBody, Vec3(0.1, -0.1, 0));
  world->start();
  ASSERT_EQ(world->host(kBody), RegionId{1});
  world->run_steps(k());
  EXPECT_THAT(known_to(RegionId{0}), ElementsAre(kBody));
  EXPECT_THAT(known_to(RegionId{2}), ElementsAre(kBody));
}

constexpr RegionId kMiddle{1};
constexpr RegionId kRight{2};

TEST_P(ProjectionTest, ABodyNearOneNeighbourIsNotTheOthersBusiness) {
  make_world(RegionMap::columns(3, 100));
  place_at(BodyId{1}, Vec3(-49, 0, 0));
  place_at(BodyId{2}, Vec3(49, 0, 0));
  world->start();
  world->run_steps(k());
  ASSERT_EQ(world->host(BodyId{1}), kMiddle);
  EXPECT_EQ(update_of(BodyId{1}, kMiddle)->audience, audience_of(kWest));
  EXPECT_EQ(update_of(BodyId{2}, kMiddle)->audience, audience_of(kRight));
  EXPECT_THAT(known_to(kWest), ElementsAre(BodyId{1}));
  EXPECT_THAT(known_to(kRight), ElementsAre(BodyId{2}));
}

TEST_P(ProjectionTest, ABodyOutsideItsRegionIsKnownToAllListeners) {
  make_world(RegionMap::columns(3, 100));
  place_flying(kBody, Vec3(-50.6, 0, 0), Vec3(12, 0, 0));
  world->start();
  while (world->protocol(kWest).find(kBody)->phase != Phase::kBoundaryTraversed) world->step();
  EXPECT_EQ(update_of(kBody, kWest)->audience, kAllListeners);
  world->run_steps(k());
  EXPECT_TRUE(known_to(kRight).contains(kBody)) << "it may host bodies over the middle region, too";
}

/// There the owner of the place compares the bodies that others host over it.
TEST_P(ProjectionTest, WhereStatesAreCheckedABodyOutsideItsRegionGoesToThoseInWhoseZoneItIs) {
  rules.redo = true;
  make_world(RegionMap::columns(3, 100));
  place_flying(kBody, Vec3(-50.6, 0, 0), Vec3(12, 0, 0));
  world->start();
  while (world->protocol(kWest).find(kBody)->phase != Phase::kBoundaryTraversed) world->step();
  EXPECT_EQ(update_of(kBody, kWest)->audience, audience_of(kMiddle));
}

TEST_P(ProjectionTest, ASleepingBodyIsPublishedAgainForARegionWhoseBodyComesNear) {
  make_world(RegionMap::columns(3, 100));
  place_at(BodyId{3}, Vec3(0, 0, 0));  // at home in the middle
  world->start();
  const double zone_m = world->protocol(kMiddle).aura().zone(rules.top_speed_m_s, 2, rules.top_speed_m_s, 0.5);
  world.reset();
  make_world(RegionMap::columns(3, 100));
  const double x = 50 - 0.5 - zone_m - 0.1;  // a little too far from the border
  place_at(kBody, Vec3(x, 0, 0));
  place_flying(BodyId{8}, Vec3(73.5, 0, 0), Vec3(-12, 0, 0));
  world->start();
  world->set_awake(kBody, false);
  world->run_steps(3);
  EXPECT_FALSE(update_of(kBody, kMiddle));
  while (world->now() < kSteps - 1 && !update_of(kBody, kMiddle)) world->step();
  ASSERT_TRUE(update_of(kBody, kMiddle));
  EXPECT_EQ(update_of(kBody, kMiddle)->audience, audience_of(kRight));
  EXPECT_GT(std::abs(50 - x) - 0.5, zone_m) << "announced because of the other body, not of the border";
  world->run_steps(k());
  EXPECT_TRUE(known_to(kRight).contains(kBody));
  EXPECT_FALSE(known_to(kWest).contains(kBody));
}

TEST_P(ProjectionTest, ABodyGoesHomeAfterAnIslandOf2KPlus1Steps) {
  make_world(RegionMap::columns(2, 100));
  place_flying(kBody, Vec3(-2.01, 0, 0), Vec3(6, 0, 0));
  world->start();
  Step outside = -1;
  while (outside < 0) {
    world->step();
    const Phase phase = world->protocol(kWest).find(kBody)->phase;
    if (phase == Phase::kBoundaryTraversed) outside = world->now();
  }
  EXPECT_GE(-2.01 + 0.1 * static_cast<double>(outside), 0.5) << "wholly outside: its bounding sphere is";
  EXPECT_LT(-2.01 + 0.1 * static_cast<double>(outside - 1), 0.5);
  EXPECT_EQ(run_until_hand_off(kWest), outside + 2 * k() + 1);
  EXPECT_EQ(hand_off_of(kWest)->reason, HandOffReason::kBoundaryTraversal);
  EXPECT_EQ(hand_off_of(kWest)->destination, kEast);
}

TEST_P(ProjectionTest, AHandOffRaisesTheEpochByOneAndIsAdoptedKStepsLater) {
  make_world(RegionMap::columns(2, 100));
  place_flying(kBody, Vec3(-2, 0, 0), Vec3(6, 0, 0));
  world->start();
  const Step sent = run_until_hand_off(kWest);
  EXPECT_EQ(hand_off_of(kWest)->sequence, 1u);
  ASSERT_EQ(hand_off_of(kWest)->cluster.bodies.size(), 1u);
  EXPECT_EQ(hand_off_of(kWest)->cluster.bodies[0].epoch, 1u);
  ASSERT_EQ(world->published(kWest).aura.hand_offs.size(), 1u);
  EXPECT_EQ(world->published(kWest).aura.hand_offs[0].last_sequence, 1u);
  EXPECT_EQ(world->published(kWest).aura.hand_offs[0].region, kEast);
  for (int i = 1; i < k(); ++i) {
    world->step();
    EXPECT_EQ(world->host(kBody), std::nullopt);
  }
  world->step();
  EXPECT_EQ(world->now(), sent + k());
  EXPECT_EQ(world->host(kBody), kEast);
  EXPECT_EQ(world->epoch(kBody), 1u);
  EXPECT_EQ(open_bodies(world->protocol(kWest).departures()), 1u) << "kept until acknowledged";
  world->run_steps(k());
  EXPECT_EQ(open_bodies(world->protocol(kWest).departures()), 0u);
}

TEST_P(ProjectionTest, ABodySentAwayStaysAsAGhostFor2KSteps) {
  make_world(RegionMap::columns(2, 100));
  place_flying(kBody, Vec3(-2, 0, 0), Vec3(6, 0, 0));
  world->start();
  const Step sent = run_until_hand_off(kWest);
  const AuraRecord* ghost = update_of(kBody, kWest);
  ASSERT_TRUE(ghost);
  EXPECT_EQ(ghost->flags & kAuraGhost, kAuraGhost);
  EXPECT_EQ(ghost->host, kEast);
  EXPECT_EQ(ghost->epoch, 1u);
  EXPECT_EQ(world->protocol(kWest).projection().ghosts().size(), 1u);
  while (world->now() < sent + 2 * k() - 1) {
    world->step();
    EXPECT_FALSE(deleted(kBody, kWest));
    EXPECT_EQ(world->protocol(kWest).projection().ghosts().size(), 1u);
  }
  world->step();
  EXPECT_TRUE(deleted(kBody, kWest));
  EXPECT_TRUE(world->protocol(kWest).projection().ghosts().empty());
  EXPECT_EQ(counters(kWest).created, 1u);
  EXPECT_EQ(counters(kWest).deleted, 1u);
}

TEST_P(ProjectionTest, AHitSendsTheWholeClusterToTheLowerRegion) {
  make_world(RegionMap::columns(2, 100));
  place_flying(BodyId{1}, Vec3(-32, 0, 0), Vec3(24, 0, 0));
  place_at(BodyId{2}, Vec3(3, 0, 0));
  place_at(BodyId{3}, Vec3(4, 0, 0));
  place_at(BodyId{4}, Vec3(45, 0, 0));
  world->start();
  ASSERT_EQ(world->host(BodyId{2}), kEast);
  ASSERT_GT(run_until_hand_off(kEast), 0);
  const HandOff& sent = *hand_off_of(kEast);
  EXPECT_EQ(sent.reason, HandOffReason::kAuraCollision);
  EXPECT_EQ(sent.destination, kWest);
  ASSERT_EQ(sent.cluster.bodies.size(), 2u);
  EXPECT_EQ(sent.cluster.bodies[0].id, BodyId{2});
  EXPECT_EQ(sent.cluster.bodies[1].id, BodyId{3});
  world->run_steps(k());
  EXPECT_EQ(world->host(BodyId{2}), kWest);
  EXPECT_EQ(world->host(BodyId{1}), kWest);
  EXPECT_EQ(world->host(BodyId{4}), kEast);
}

TEST_P(ProjectionTest, TheNaiveControlSaysNothingAndSendsABodyWhereItsCentreIs) {
  rules.kind = AuraKind::kNone;
  make_world(RegionMap::columns(2, 100));
  place_flying(kBody, Vec3(-1.05, 0, 0), Vec3(6, 0, 0));
  world->start();
  EXPECT_EQ(run_until_hand_off(kWest), 11);
  EXPECT_FALSE(update_of(kBody, kWest));
  EXPECT_EQ(counters(kWest).created, 0u);
  world->run_steps(k());
  EXPECT_EQ(world->host(kBody), kEast);
  EXPECT_EQ(world->broken(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Lookahead, ProjectionTest, ::testing::Values(1, 2, 3));

}  // namespace
}  // namespace aurasim::core::testing
