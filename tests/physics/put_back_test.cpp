// A world that goes back keeps the bodies, pairs and joints that it has (simulation_put_back.cpp), and nothing of what
// happened since: from then on it has the bits of a world made anew, whatever came, left, broke, slept or was ordered
// in between.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "physics/goes_back.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyId;
using core::BodyRecord;
using core::ClusterState;
using core::Step;

/// Number of worlds with the soft step and with Bullet's solver, which takes four times as long.
constexpr int kSoftSeeds = 3, kOtherSeeds = 2;
constexpr int kRounds = 5;  ///< times that each world goes back
constexpr int kCompared = 200;

bool same_collisions(const std::vector<Collision>& a, const std::vector<Collision>& b) {
  return std::ranges::equal(a, b, [](const Collision& x, const Collision& y) {
    return x.step == y.step && x.a == y.a && x.b == y.b && x.penetration_m == y.penetration_m &&
           x.relative_speed_m_s == y.relative_speed_m_s && x.p_W == y.p_W;
  });
}

/// Bullet's solvers sum the impulses of several manifolds of one pair in no order, hence the rounding.
bool same_impulses(const std::vector<core::ContactImpulse>& a, const std::vector<core::ContactImpulse>& b) {
  return std::ranges::equal(a, b, [](const core::ContactImpulse& x, const core::ContactImpulse& y) {
    return x.a == y.a && x.b == y.b && x.p_W.isApprox(y.p_W, 1e-5) && x.normal_W.isApprox(y.normal_W, 1e-5) &&
           std::abs(x.impulse_Ns - y.impulse_Ns) <= 1e-5 * y.impulse_Ns;
  });
}

void expect_same(RegionWorld& world, RegionWorld& anew) {
  ASSERT_EQ(world.records().size(), anew.records().size());
  ASSERT_EQ(different(world.records(), anew.records()), std::vector<std::uint64_t>());
  const ClusterState is = world.peek_all(), wanted = anew.peek_all();
  ASSERT_TRUE(same_rows(is, wanted));
  const auto same_names = [](const BodyRecord& a, const BodyRecord& b) {
    return a.id == b.id && a.epoch == b.epoch && a.birth == b.birth && a.prototype == b.prototype;
  };
  ASSERT_TRUE(std::ranges::equal(is.bodies, wanted.bodies, same_names));
  ASSERT_TRUE(same_collisions(world.collisions(), anew.collisions()));
  ASSERT_EQ(world.take_removed().size(), anew.take_removed().size());
}

class PutBack : public ::testing::TestWithParam<std::tuple<Solver, bool>> {
 protected:
  static Settings settings() {
    Settings settings;
    settings.solver = std::get<0>(GetParam());
    settings.continuous = std::get<1>(GetParam());
    settings.block_m = 5;
    return settings;
  }

  /// Counts what is in the state to which a world goes back, and differs from the one that it leaves.
  void note(const ClusterState& then, const ClusterState& now) {
    const auto born_here = [&](const BodyRecord& body) {
      return std::ranges::binary_search(now.bodies, body.id, {}, &BodyRecord::id);
    };
    gone += std::ranges::count_if(then.bodies, [&](const BodyRecord& body) { return !born_here(body); });
    sleepers += std::ranges::count(then.bodies, 2, &BodyRecord::activation_state);
    points += then.points.size() / core::kContactPointDoubles;
    const auto broken = [](const ClusterState& state) {
      return std::ranges::count_if(state.joints, [&](const auto& j) { return state.joint_values[j.first_value] != 0; });
    };
    if (broken(now) > broken(then)) ++mended;
  }

  std::ptrdiff_t gone = 0, sleepers = 0, mended = 0;
  std::size_t points = 0, collisions = 0;
};

TEST_P(PutBack, GoesOnWithTheBitsOfAWorldMadeAnew) {
  const int seeds = settings().looks_once() ? kSoftSeeds : kOtherSeeds;
  for (int seed = 0; seed < seeds; ++seed) {
    GoesBack run(settings(), seed);
    for (int round = 0; round < kRounds; ++round) {
      run.run_on(5 + static_cast<int>(run.pick(60)));
      ClusterState then = run.world.peek_all();
      for (BodyRecord& body : then.bodies) body.epoch += 7;
      const Step step = run.world.step_number();
      run.run_astray(1 + static_cast<int>(run.pick(40)), round % 2 == 0 ? 0 : 250);
      note(then, run.world.peek_all());

      RegionWorld anew = run.make_world();
      for (RegionWorld* world : {&run.world, &anew}) world->put_back(step, then);
      for (int i = 0; i <= kCompared; ++i) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed << ", round " << round << ", " << i << " states later");
        ASSERT_EQ(run.world.step_number(), anew.step_number());
        ASSERT_NO_FATAL_FAILURE(expect_same(run.world, anew));
        ASSERT_TRUE(i == 0 || same_impulses(run.world.contact_impulses(), anew.contact_impulses()));
        collisions += anew.collisions().size();
        run.world.step();
        anew.step();
      }
    }
  }
  EXPECT_GT(gone, 50);
  EXPECT_GT(sleepers, 100);
  EXPECT_GT(mended, 1);
  EXPECT_GT(points, 1000u);
  EXPECT_GT(collisions, 500u);
}

/// The second box sleeps on the first, later on the third. A fourth one falls on it where it slept first.
TEST_P(PutBack, ASleeperForgetsOnWhichPileItSleptLater) {
  const core::Scene scene = scene_of_all_shapes();
  RegionWorld world(scene, settings()), anew(scene, settings());
  std::vector<BodyRecord> boxes = stack(1, 2, 0, 0);
  boxes.push_back(stack(3, 1, 5, 0)[0]);
  const BodyRecord falls = body(4, kBox, {0, 0, 6});
  world.add(boxes);
  run(world, 400);
  world.add({&falls, 1});
  run(world, 10);
  const ClusterState then = world.peek_all();
  ASSERT_EQ(std::ranges::count(then.bodies, 2, &BodyRecord::activation_state), 3);

  const BodyId leaving[] = {BodyId{2}, BodyId{4}};
  BodyRecord moved = world.release(leaving).bodies[0];
  moved.p_WB.x() += 5;
  moved.activation_state = 1;
  world.add({&moved, 1});
  run(world, 400);
  ASSERT_EQ(std::ranges::count(world.peek_all().bodies, 2, &BodyRecord::activation_state), 3);

  for (RegionWorld* each : {&world, &anew}) each->put_back(410, then);
  std::ptrdiff_t awake = 0;
  for (int i = 0; i < kCompared; ++i) {
    world.step(), anew.step();
    ASSERT_NO_FATAL_FAILURE(expect_same(world, anew)) << i;
    awake = std::max(awake, 4 - std::ranges::count(anew.records(), 2, &BodyRecord::activation_state));
  }
  EXPECT_EQ(awake, 3) << "it has fallen on the pile";
}

INSTANTIATE_TEST_SUITE_P(Solvers, PutBack,
                         ::testing::Combine(::testing::Values(Solver::kSequentialImpulse, Solver::kSoftStep),
                                            ::testing::Bool()),
                         solver_name);

}  // namespace
}  // namespace aurasim::physics::testing
