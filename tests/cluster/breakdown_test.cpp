// Bodies that no world can bear, and messages that no node can use, in whole simulated clusters: said by name, the same
// on one node and on many, and nobody waits for ever.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cluster/checked_run.h"
#include "cluster/scenes.h"

namespace aurasim::test {
namespace {

using core::BodyId;
using core::RegionId;
using core::Vec3;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr core::Step kBreakdownSteps = 160;

class BreakdownInACluster : public testing::TestWithParam<core::SyncMode> {
 protected:
  BreakdownInACluster() {
    options_.map = core::RegionMap::grid(2, 2, kCell, kCell);
    options_.sync = GetParam();
    options_.aura.top_speed_m_s = 40;
    options_.neighbour_distance_m = 1e9;
    options_.bandwidth_B_s = lab::kUnlimited_B_s;
  }
  /// A spawn of a prototype of the scene that nobody has looked at.
  void spawn(core::Step at_step, const Vec3& p_WB, const Vec3& v_WB, const Vec3& w_WB = Vec3::Zero()) {
    const BodyId id{core::kFirstClientBody + options_.orders.size()};
    options_.orders.push_back(
        {at_step, core::Spawn{id, core::PrototypeId{0}, {p_WB, core::Quat::Identity()}, v_WB, w_WB}});
  }

  core::Scene scene_ = thrown_bodies(40, 4 * kCell, 4 * kCell, 4, 1);
  ClusterOptions options_;
};

TEST_P(BreakdownInACluster, ABodyOutOfAllBoundsIsTakenOutInTheSameStateOnOneNodeAndOnFour) {
  spawn(80, {3, 3, 30}, {2e6, 0, 0});
  spawn(90, {-3, 3, 40}, {0, 0, 0}, {0, 0, 2e6});
  const Outcome four = CheckedRun(scene_, options_).run(kBreakdownSteps);
  const Outcome one = run_central(scene_, options_, kBreakdownSteps);
  ASSERT_EQ(four.broken_bodies.size(), one.broken_bodies.size());
  ASSERT_GE(one.broken_bodies.size(), 1u);
  for (std::size_t i = 0; i < one.broken_bodies.size(); ++i) {
    EXPECT_EQ(four.broken_bodies[i].body, one.broken_bodies[i].body);
    EXPECT_EQ(four.broken_bodies[i].step, one.broken_bodies[i].step);
    EXPECT_FALSE(one.broken_bodies[i].fault.empty());
  }
  EXPECT_THAT(four.dead, IsEmpty());
  EXPECT_EQ(four.lost + four.doubled, 0u);
}

/// The kick that made neighbours wait for each other for ever.
TEST_P(BreakdownInACluster, ASpinThatNoWorldCanBearIsDeclined) {
  options_.orders.push_back({80, core::SetVelocity{scene_.bodies[0].id, {0, 0, 0}, Vec3(1e6, 1e6, 1e6)}});
  options_.orders.push_back({80, core::Impulse{scene_.bodies[1].id, {1e7, 0, 0}, Vec3(100, 100, 100)}});
  std::size_t declined = 0;
  CheckedRun cluster(scene_, options_);
  cluster.on_state = [&](node::Node&, const node::StepReport& report, double) { declined += report.declined.size(); };
  const Outcome o = cluster.run(kBreakdownSteps);
  EXPECT_EQ(declined, 2u);
  EXPECT_EQ(o.applied, 0u);
  EXPECT_THAT(o.dead, IsEmpty());
}

/// An aura that is no number: whoever says it is held for dead, and the others go on.
TEST_P(BreakdownInACluster, WhoSendsWhatNobodyCanUseIsHeldForDead) {
  options_.orders.push_back({80, core::Spawn{BodyId{core::kFirstClientBody},
                                             core::PrototypeId{0},
                                             {{0.5, 0.5, 30}, core::Quat::Identity()},
                                             {1e300, 0, 0},  // more than any world can bear
                                             {0, 0, 0}}});
  std::vector<core::Refusal> refusals;
  CheckedRun cluster(scene_, options_);
  cluster.on_state = [&](node::Node& node, const node::StepReport&, double) {
    for (const core::Refusal& refusal : node.protocol().intake().refusals()) refusals.push_back(refusal);
  };
  const Outcome o = cluster.run(kBreakdownSteps);
  ASSERT_EQ(o.dead.size(), 1u);
  ASSERT_FALSE(refusals.empty());
  EXPECT_EQ(refusals[0].source, o.dead[0]);
  EXPECT_EQ(refusals[0].why, "range");
  EXPECT_EQ(o.lost + o.doubled, 0u);
}

INSTANTIATE_TEST_SUITE_P(Modes, BreakdownInACluster,
                         testing::Values(core::SyncMode::kBounded, core::SyncMode::kDeterministic),
                         [](const auto& param) {
                           return std::string(param.param == core::SyncMode::kBounded ? "Bounded" : "Deterministic");
                         });

}  // namespace
}  // namespace aurasim::test
