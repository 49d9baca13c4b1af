// Orders of clients on whole simulated clusters: every node applies each one in the state that it names, so a run with
// orders has the bits of the same run in one world.
#include <algorithm>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "cluster/checked_run.h"
#include "cluster/scenes.h"

namespace aurasim::test {
namespace {

using core::BodyId;
using core::Vec3;

constexpr core::Step kOrderSteps = 240;
constexpr core::Step kFirst = 60;  ///< long enough for orders to have gone round

struct Cut {
  const char* name;
  int rows;
  int columns;
};

constexpr Cut kCuts[] = {{"TwoColumns", 1, 2}, {"TwoByTwo", 2, 2}, {"ThreeByThree", 3, 3}, {"SixColumns", 1, 6}};

ClusterOptions options_for(const Cut& cut, int seed) {
  ClusterOptions options;
  options.map =
      core::RegionMap::grid(static_cast<std::size_t>(cut.rows), static_cast<std::size_t>(cut.columns), kCell, kCell);
  options.seed = static_cast<std::uint64_t>(seed);
  options.sync = core::SyncMode::kDeterministic;
  options.aura.lookahead = 1 + seed % 3;
  options.aura.top_speed_m_s = 40;
  options.network.loss = 0.05;
  options.network.duplicate = 0.05;
  options.network.latency_s = 0.004 * (seed % 4);
  options.network.jitter_s = 0.006;
  options.neighbour_distance_m = 18;  // in six columns, orders have to be passed on twice
  return options;
}

Vec3 somewhere(std::mt19937_64& random, double z) {
  std::uniform_real_distribution<double> place(-2 * kCell, 2 * kCell);
  const double x = place(random);
  return {x, place(random), z};
}

/// Kicks, removals, new bodies of new kinds and a wall that comes and goes, all over the place.
std::vector<std::pair<core::Step, core::Action>> orders_for(const core::Scene& scene, int seed) {
  std::mt19937_64 random(static_cast<std::uint64_t>(seed));
  std::uniform_int_distribution<std::size_t> any(0, scene.bodies.size() - 1);
  std::uniform_int_distribution<core::Step> when(kFirst, kOrderSteps - 60);
  const auto shape = static_cast<std::uint32_t>(scene.shapes.size());
  const core::PrototypeId brick{static_cast<std::uint32_t>(scene.prototypes.size())};
  const core::StaticId wall{static_cast<std::uint32_t>(scene.statics.size())};
  std::vector<std::pair<core::Step, core::Action>> orders = {
      {0, core::DefineShape{core::Box{{0.3, 0.2, 0.4}}}},
      {0, core::DefinePrototype{shape, 2.5}},
      {0, core::DefineShape{core::Box{{3, 0.2, 2}}}},
      {kFirst, core::AddStatic{wall, shape + 1, {{0, 0.5, 2}, core::Quat::Identity()}}},
      {kOrderSteps - 80, core::RemoveStatic{wall}}};
  for (int i = 0; i < 12; ++i) {
    const BodyId id = scene.bodies[any(random)].id;
    orders.push_back({when(random), core::Impulse{id, somewhere(random, 4) / 4, {}}});
    orders.push_back({when(random), core::SetVelocity{scene.bodies[any(random)].id, somewhere(random, 6) / 3, {}}});
    orders.push_back({when(random), core::Spawn{BodyId{core::kFirstClientBody + static_cast<std::uint64_t>(i)},
                                                brick,
                                                {somewhere(random, 3 + i), core::Quat::Identity()},
                                                somewhere(random, 1) / 4,
                                                Vec3::Zero()}});
  }
  for (int i = 0; i < 5; ++i) orders.push_back({when(random), core::RemoveBody{scene.bodies[any(random)].id}});
  return orders;
}

class OrdersCluster : public testing::TestWithParam<std::size_t> {
 protected:
  Cut cut_ = kCuts[GetParam()];
};

TEST_P(OrdersCluster, HaveTheSameEffectAsInOneWorld) {
  std::uint64_t hand_offs = 0;
  for (int seed = 1; seed <= 4; ++seed) {
    const core::Scene scene = thrown_bodies(60, 4 * kCell, 2 * kCell, 8, static_cast<std::uint64_t>(seed));
    ClusterOptions options = options_for(cut_, seed);
    options.orders = orders_for(scene, seed);
    const Outcome o = CheckedRun(scene, options).run(kOrderSteps);
    const Outcome central = run_central(scene, options, kOrderSteps);
    EXPECT_EQ(first_difference(o, central), kOrderSteps + 1) << "seed " << seed;
    EXPECT_EQ(o.applied, central.applied);
    EXPECT_GE(o.applied, 30u);
    EXPECT_EQ(o.removed, central.removed);
    EXPECT_GE(o.removed, 3u);
    EXPECT_EQ(o.late + o.missed + o.lost + o.doubled + o.thrashed + o.severed + o.bad_phases, 0u);
    hand_offs += o.hand_offs;
  }
  EXPECT_GT(hand_offs, 0u);
}

/// The rule above can fail: an order changes what comes after it, and nothing before.
TEST(Orders, AKickChangesTheStatesFromItsOwnOn) {
  const core::Scene scene = thrown_bodies(10, kCell, kCell, 8, 1);
  ClusterOptions options = options_for(kCuts[0], 1);
  const Outcome quiet = run_central(scene, options, 120);
  options.orders = {{80, core::Impulse{scene.bodies[0].id, {0, 0, 5}, {}}}};
  const Outcome kicked = run_central(scene, options, 120);
  EXPECT_EQ(first_difference(quiet, kicked), 80);
}

/// A body at rest that will be kicked towards a border is announced as fast: nothing is late, no promise is broken.
/// Two that stand apart are kicked towards each other so hard that they touch before anybody who sees them move could
/// bring them together. States are not checked.
TEST(Orders, AKickIsForeseenByTheNeighbours) {
  for (const double gap_m : {1.0, 2.0, 3.0}) {
    core::Scene scene = thrown_bodies(0, kCell, kCell, 0, 1);
    for (const double side : {-1.0, 1.0}) {
      core::InitialBody body;
      body.id = BodyId{side < 0 ? 1u : 2u};
      body.pose.p_WB = {side * (0.5 + gap_m / 2), 0, 0.5};
      scene.bodies.push_back(body);
    }
    ClusterOptions options = options_for(kCuts[0], 1);
    options.orders = {{150, core::SetVelocity{BodyId{1}, {39, 0, 0}, {}}},
                      {150, core::SetVelocity{BodyId{2}, {-39, 0, 0}, {}}}};
    const Outcome o = CheckedRun(scene, options).run(kOrderSteps);
    EXPECT_EQ(o.applied, 2u);
    EXPECT_EQ(o.late + o.missed, 0u) << "gap " << gap_m << " m";
    EXPECT_EQ(o.contacts.size(), 1u) << "gap " << gap_m << " m";
    EXPECT_GT(o.hand_offs, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(Cuts, OrdersCluster, testing::Range<std::size_t>(0, std::size(kCuts)),
                         [](const auto& param) { return std::string(kCuts[param.param].name); });

}  // namespace
}  // namespace aurasim::test
