// Many bodies on random walks over borders and corners: what must hold whatever they do.
#include <cstdio>
#include <map>
#include <optional>
#include <set>

#include <gtest/gtest.h>

#include "core/kinematic_world.h"
#include "core/letters.h"
#include "core/random.h"

namespace aurasim::core::testing {
namespace {

struct Walk {
  AuraKind kind;
  int lookahead;
};

/// What a region has published: nothing may be taken back that was not published.
class Listener {
 public:
  void receive(const AuraBatch& batch) {
    for (const BodyId id : batch.deletes) unmatched_deletes += received_.erase(id) == 0;
    for (const AuraRecord& update : batch.updates) received_.insert(update.id);
    std::set<BodyId> once;
    for (const AuraRecord& update : batch.updates) published_twice += !once.insert(update.id).second;
    for (const BodyId id : batch.deletes) published_twice += !once.insert(id).second;
  }
  const std::set<BodyId>& received() const { return received_; }

  int unmatched_deletes = 0;
  int published_twice = 0;

 private:
  std::set<BodyId> received_;
};

class RandomWalk : public ::testing::TestWithParam<Walk> {
 protected:
  static constexpr Step kSteps = 300;
  static constexpr int kBodies = 40;

  RandomWalk() {
    rules.kind = GetParam().kind;
    rules.lookahead = GetParam().lookahead;
    rules.substeps = 2;
    rules.gravity = Vec3::Zero();
    rules.contact_margin_m = 0;
    world.emplace(RegionMap::grid(2, 2, 60, 60), rules, shapes);
    for (std::uint64_t i = 0; i < kBodies; ++i) world->place(wanderer(BodyId{i}));
    world->watch_all();
    world->start();
  }

  /// Turns to another direction every now and then, and comes back to the corner.
  Traveller wanderer(BodyId id) {
    Traveller t;
    t.id = id;
    t.prototype = random.chance(0.2) ? big : ball;
    Vec3 p = Vec3(1, 1, 0.1).cwiseProduct(random.in_box(12)) + Vec3(0, 0, 60.0 * random.below(3));
    Vec3 v = Vec3::Zero();
    const double home_z = p.z();
    const double h = rules.step_s / rules.substeps;
    t.p_WB.push_back(p);
    t.v_WB.push_back(v);
    for (Step n = 1; n <= kSteps; ++n) {
      if (random.chance(0.03)) v = random.between(0, 30) * Vec3(1, 1, 0.1).cwiseProduct(random.direction());
      if ((p - Vec3(0, 0, home_z)).norm() > 15) v = 20 * (Vec3(0, 0, home_z) - p).normalized();
      for (int s = 0; s < rules.substeps; ++s) t.p_WB.push_back(p += v * h);
      t.v_WB.push_back(v);
    }
    return t;
  }

  AuraRules rules;
  RoundShapes shapes;
  PrototypeId ball = shapes.sphere(0.4);
  PrototypeId big = shapes.sphere(1.2);
  Random random{"walks"};
  std::optional<KinematicWorld> world;
};

TEST_P(RandomWalk, NothingIsDeletedThatWasNotCreated) {
  std::map<std::uint32_t, Listener> listeners;
  for (Step n = 0;; ++n) {
    for (std::uint32_t r = 0; r < 4; ++r) listeners[r].receive(world->published(RegionId{r}).aura);
    if (n == kSteps) break;
    world->step();
  }
  std::uint64_t created = 0;
  for (std::uint32_t r = 0; r < 4; ++r) {
    EXPECT_EQ(listeners[r].unmatched_deletes, 0) << "region " << r;
    EXPECT_EQ(listeners[r].published_twice, 0) << "region " << r;
    const Projection& projection = world->protocol(RegionId{r}).projection();
    created += projection.counters().created;
    EXPECT_EQ(listeners[r].received().size(), projection.projecting() + projection.ghosts().size()) << "region " << r;
  }
  EXPECT_GT(created, 50u);
}

TEST_P(RandomWalk, HitsSendOnlyToLowerRegionsAndHomewardOnlyToOthers) {
  int hits = 0, homeward = 0;
  for (Step n = 0; n < kSteps; ++n) {
    world->step();
    for (std::uint32_t r = 0; r < 4; ++r) {
      for (const HandOff& h : world->published(RegionId{r}).hand_offs) {
        EXPECT_NE(h.destination, RegionId{r});
        if (h.reason == HandOffReason::kAuraCollision) {
          EXPECT_LT(h.destination, RegionId{r});
          ++hits;
        } else {
          ++homeward;
        }
      }
    }
  }
  std::printf("[  counts  ] %d by hits, %d homeward\n", hits, homeward);
  EXPECT_GT(hits, 3);
  EXPECT_GT(homeward, 3);
}

TEST_P(RandomWalk, EveryBodyHasOneHostOrIsUnderWayAndEpochsRiseByOne) {
  for (Step n = 0; n < kSteps; ++n) {
    world->step();
    ASSERT_EQ(world->broken(), 0u) << "in state " << n;
    std::size_t hosted = 0, under_way = 0;
    for (std::uint32_t r = 0; r < 4; ++r) {
      for (std::uint64_t i = 0; i < kBodies; ++i) {
        const Track* track = world->protocol(RegionId{r}).find(BodyId{i});
        hosted += track && track->phase != Phase::kSent;
      }
    }
    for (std::uint64_t i = 0; i < kBodies; ++i) under_way += !world->host(BodyId{i}).has_value();
    ASSERT_EQ(hosted + under_way, static_cast<std::size_t>(kBodies)) << "in state " << n;
  }
}

TEST_P(RandomWalk, EveryHandOffIsAcknowledged) {
  world->run_steps(kSteps);
  std::size_t sent = 0, open = 0;
  for (std::uint32_t r = 0; r < 4; ++r) {
    sent += world->protocol(RegionId{r}).counters().handed_over;
    open += open_bodies(world->protocol(RegionId{r}).departures());
    EXPECT_EQ(world->protocol(RegionId{r}).intake().counters().strangers, 0u);
  }
  EXPECT_EQ(sent, world->hand_offs());
  EXPECT_LT(open, 40u) << "only those of the last 2K steps";
}

INSTANTIATE_TEST_SUITE_P(All, RandomWalk,
                         ::testing::Values(Walk{AuraKind::kTight, 1}, Walk{AuraKind::kTight, 2},
                                           Walk{AuraKind::kSwept, 1}, Walk{AuraKind::kSwept, 2},
                                           Walk{AuraKind::kSwept, 3}),
                         [](const auto& info) {
                           char name[16];
                           std::snprintf(name, sizeof name, "%sK%d",
                                         info.param.kind == AuraKind::kTight ? "Tight" : "Swept", info.param.lookahead);
                           return std::string(name);
                         });

}  // namespace
}  // namespace aurasim::core::testing
