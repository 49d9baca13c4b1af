// Ten thousand hand-offs at random times, and nothing happens: a tower of 20 slabs that falls and a stack of 5 boxes
// at rest go to and fro between two worlds, in every state that they pass through.
#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "physics/scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyId;
using core::BodyRecord;
using core::Vec3;

constexpr int kHandOffs = 10'000;
constexpr int kSwitchingSteps = 900;

core::Scene scene_of_slabs() { return scene_of(core::Box{{0.5, 0.5, 0.25}}); }

/// Each one shifted by `lean_m` against that below.
std::vector<BodyRecord> pile_up(std::uint64_t first_id, int count, double x, double lean_m) {
  std::vector<BodyRecord> bodies;
  for (int i = 0; i < count; ++i) {
    bodies.push_back(body(first_id + static_cast<std::uint64_t>(i), 0, {x + lean_m * i, 0, 0.25 + 0.5 * i}));
  }
  return bodies;
}

/// Of bodies of 1 kg, about the origin. Summed in the order of ids, so equal bodies give equal bits.
struct Momentum {
  Vec3 linear = Vec3::Zero();
  Vec3 angular = Vec3::Zero();
};

Momentum momentum_of(std::span<const BodyRecord> bodies) {
  const double x = 1.0 / 3;  // of a box of 0.5, 0.5, 0.25: m (b^2 + c^2) / 3
  const Vec3 inertia(x * (0.25 + 0.0625), x * (0.25 + 0.0625), x * 0.5);
  Momentum sum;
  for (const BodyRecord& body : bodies) {
    sum.linear += body.v_WB;
    sum.angular += body.p_WB.cross(body.v_WB);
    sum.angular += body.R_WB * inertia.cwiseProduct(body.R_WB.transpose() * body.w_WB);
  }
  return sum;
}

double largest_speed(std::span<const BodyRecord> bodies) {
  double speed = 0;
  for (const BodyRecord& body : bodies) speed = std::max(speed, body.v_WB.norm());
  return speed;
}

class Switching : public ::testing::TestWithParam<int> {
 protected:
  Switching() {
    const std::vector<BodyRecord> tower = pile_up(1, 20, 0, 0.06);  // leans too far to stand
    piles = {ids_of(tower), {}};
    const std::vector<BodyRecord> stack = pile_up(101, 5, 30, 0);
    piles[1] = ids_of(stack);
    for (const auto& bodies : {tower, stack}) {
      untouched.add(bodies);
      worlds[0].add(bodies);
    }
  }

  void hand_over(const std::vector<BodyId>& ids) {
    const std::size_t from = worlds[0].contains(ids[0]) ? 0 : 1;
    const core::ClusterState before = worlds[from].peek(ids);
    worlds[1 - from].adopt(worlds[from].release(ids), worlds[from].step_number());
    const core::ClusterState after = worlds[1 - from].peek(ids);
    const Momentum had = momentum_of(before.bodies);
    const Momentum has = momentum_of(after.bodies);
    ASSERT_EQ(has.linear, had.linear);
    ASSERT_EQ(has.angular, had.angular);
    ASSERT_EQ(after.points, before.points);
    ++hand_offs;
  }

  core::Scene scene = scene_of_slabs();
  std::mt19937_64 random{static_cast<std::uint64_t>(GetParam())};
  RegionWorld untouched{scene, Settings{}};
  std::array<RegionWorld, 2> worlds = {RegionWorld{scene, Settings{}}, RegionWorld{scene, Settings{}}};
  std::array<std::vector<BodyId>, 2> piles;
  int hand_offs = 0;
};

TEST_P(Switching, TenThousandTimesChangesNoBitAndAddsNoSpeed) {
  double top = 0;
  double top_untouched = 0;
  for (int step = 1; step <= kSwitchingSteps; ++step) {
    const int wanted = static_cast<int>(static_cast<long>(kHandOffs) * step / kSwitchingSteps);
    while (hand_offs < wanted) ASSERT_NO_FATAL_FAILURE(hand_over(piles[random() % 2])) << "before state " << step;
    untouched.step();
    for (RegionWorld& world : worlds) world.step();
    const std::uint64_t hash = hash_sum(worlds[0].records()) + hash_sum(worlds[1].records());
    ASSERT_EQ(hash, hash_sum(untouched.records())) << "state " << step << ", after " << hand_offs << " hand-offs";
    top = std::max({top, largest_speed(worlds[0].records()), largest_speed(worlds[1].records())});
    top_untouched = std::max(top_untouched, largest_speed(untouched.records()));
  }
  EXPECT_EQ(hand_offs, kHandOffs);
  EXPECT_EQ(top, top_untouched);
  EXPECT_GT(top, 3) << "the tower has come down";
  EXPECT_EQ(worlds[0].severed_contacts() + worlds[1].severed_contacts(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Switching, ::testing::Range(1, 4));

}  // namespace
}  // namespace aurasim::physics::testing
