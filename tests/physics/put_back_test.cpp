// A world that goes back keeps the bodies, pairs and joints that it has (simulation_put_back.cpp), and nothing of what
// happened since: from then on it has the bits of a world made anew, whatever came, left, broke, slept or was ordered
// in between.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "physics/joint_scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyId;
using core::BodyRecord;
using core::ClusterState;
using core::Step;
using core::Vec3;

/// Number of worlds with the soft step and with Bullet's solver, which takes four times as long.
constexpr int kSoftSeeds = 3, kOtherSeeds = 2;
constexpr int kRounds = 5;  ///< times that each world goes back
constexpr int kCompared = 200;

/// Piles and creatures of all shapes and joints beside and upon each other, and a belt where the solver knows one.
class GoesBack {
 public:
  GoesBack(const Settings& settings_in, int seed)
      : settings(settings_in), random(static_cast<std::uint64_t>(seed)), scene(make_scene(seed)), world(make_world()) {
    std::vector<BodyRecord> bodies = initial_records(scene);
    for (int i = 0; i < 3; ++i) {
      const std::vector<BodyRecord> more = pile(random, 1000 + 100 * static_cast<std::uint64_t>(i), 9, 3.0 * i, 0);
      bodies.insert(bodies.end(), more.begin(), more.end());
    }
    world.add(bodies);
  }

  void run_on(int states) {
    for (int i = 0; i < states; ++i) {
      if (random() % 12 == 0) announce_birth();
      if (random() % 12 == 0) order_something();
      world.step();
    }
  }

  /// States that a redo undoes: some in which much happens, then `quiet` ones, in which bodies may fall asleep.
  void run_astray(int states, int quiet) {
    for (int i = 0; i < states; ++i) {
      switch (random() % 12) {
        case 0:
          hand_over();
          break;
        case 1:
          take_in();
          break;
        case 2:
          replace();
          break;
        case 3:
          announce_birth();
          break;
        case 4:
          order_something();
          break;
        case 5:
          say_something();
          break;
        default:
          break;
      }
      world.step();
    }
    for (int i = 0; i < quiet; ++i) world.step();
  }

  /// A new world in which nothing has happened yet but that the same was ordered.
  RegionWorld make_world() {
    RegionWorld made(scene, settings);
    for (const core::Order& order : orders) made.schedule(order);
    for (const core::Setpoints& said : setpoints) made.controls().recall(said);
    made.watch_contacts(true);
    return made;
  }

  std::uint64_t pick(std::uint64_t count) { return random() % count; }

  const Settings settings;
  std::mt19937_64 random;
  std::vector<core::Order> orders;
  std::vector<core::Setpoints> setpoints;
  core::Scene scene;
  RegionWorld world;

 private:
  core::Scene make_scene(int seed) {
    core::Scene made = scene_of_all_shapes(seed % 2 == 0 ? Ground::kPlane : Ground::kMesh);
    for (int i = 0; i < 2; ++i) place_creature(made, 4.0 * i, {1.0 - i, 0.5, -1});
    place_machine(made, 8);
    for (core::JointSpec& joint : made.joints) {
      if (random() % 2 == 0) joint.break_impulse = uniform(random, 0.2, 1);
    }
    if (settings.looks_once()) {
      core::StaticBody& belt = made.statics.emplace_back();
      belt.name = "belt";
      belt.shape = made.prototypes[kBox].shape;
      belt.pose.p_WB = {3, 3, 0};
      belt.path = core::StaticPath{{{0.5, {Vec3(0, 0, 0.4), core::Quat::Identity()}}, {1, {}}}, true, true};
      belt.belt_S = {0.5, 0, 0};
    }
    return made;
  }

  Vec3 somewhere() { return {uniform(random, -1, 9), uniform(random, -1, 1), uniform(random, 1, 5)}; }
  Step soon() { return world.step_number() + 1 + static_cast<Step>(pick(40)); }
  BodyId some_body() {
    const std::vector<core::BodyState>& all = world.snapshot().bodies;
    return all[pick(all.size())].id;
  }
  BodyRecord newcomer() { return body(next_id_++, static_cast<int>(pick(kKinds)), somewhere(), {1, 0, -2}); }

  void announce_birth() {
    BodyRecord record = newcomer();
    record.birth = soon();
    world.add({&record, 1});
  }
  void take_in() {
    const BodyRecord record = newcomer();
    world.add({&record, 1});
  }
  void hand_over() {
    std::vector<BodyId> leaving;
    for (const core::BodyState& body : world.snapshot().bodies) {
      if (pick(20) == 0) leaving.push_back(body.id);
    }
    world.release(leaving);
  }
  /// Another body with the same id.
  void replace() {
    const BodyId id = some_body();
    BodyRecord record = world.release({&id, 1}).bodies[0];
    record.prototype = core::PrototypeId{static_cast<std::uint32_t>((value_of(record.prototype) + 1) % kKinds)};
    world.add({&record, 1});
  }
  void order_something() {
    const Step at = soon();
    switch (pick(8)) {
      case 0:
        return order(at, core::RemoveBody{some_body()});
      case 1:
        return order_static(at);
      case 2:
        return order(at, core::SetVelocity{some_body(), {0, 0, 3}, Vec3(1, 2, 3)});
      default:
        return order(at, core::Impulse{some_body(), {uniform(random, -4, 4), 0, uniform(random, 0, 6)}, {}});
    }
  }
  void order(Step at, core::Action action) {
    orders.push_back({orders.size() + 1, 0, at, std::move(action)});
    world.schedule(orders.back());
  }
  /// A block comes and goes.
  void order_static(Step at) {
    core::StaticBody& block = scene.statics.emplace_back();
    block.name = "block";
    block.shape = scene.prototypes[kBox].shape;
    block.pose.p_WB = {uniform(random, -1, 9), uniform(random, -1, 1), 0.3};
    const core::StaticId id{static_cast<std::uint32_t>(scene.statics.size() - 1)};
    order(at, core::AddStatic{id, block.shape, block.pose});
    order(at + 1 + static_cast<Step>(pick(60)), core::RemoveStatic{id});
  }
  void say_something() {
    core::Setpoints said{core::kRecordedClient, setpoints.size() + 1, 0, soon(), {}, {}};
    said.bodies.push_back({some_body(), core::Quantity::kForce, Vec3(0, 2, 15)});
    const auto joint = static_cast<std::uint32_t>(pick(scene.joints.size()));
    said.joints.push_back({core::JointId{joint}, core::JointDrive{.speed = 6, .damping = 1}});
    setpoints.push_back(said);
    world.controls().recall(said);
    for (core::BodySetpoint& body : said.bodies) body.value.reset();
    for (core::JointSetpoint& of : said.joints) of.drive.reset();
    said.sequence = setpoints.size() + 1;
    said.at_step += 30;
    setpoints.push_back(said);
    world.controls().recall(said);
  }

  std::uint64_t next_id_ = 5000;
};

bool same_rows(const ClusterState& a, const ClusterState& b) {
  const auto same_manifold = [](const core::ManifoldRecord& x, const core::ManifoldRecord& y) {
    return x.object0 == y.object0 && x.object1 == y.object1 && x.point_count == y.point_count;
  };
  const auto same_joint = [](const core::JointRecord& x, const core::JointRecord& y) {
    return x.id == y.id && x.value_count == y.value_count;
  };
  return std::ranges::equal(a.manifolds, b.manifolds, same_manifold) && a.points == b.points &&
         std::ranges::equal(a.joints, b.joints, same_joint) && a.joint_values == b.joint_values;
}

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
                         [](const auto& info) {
                           const bool is_soft = std::get<0>(info.param) == Solver::kSoftStep;
                           return std::string(is_soft ? "SoftStep" : "SequentialImpulse") +
                                  (std::get<1>(info.param) ? "Continuous" : "");
                         });

}  // namespace
}  // namespace aurasim::physics::testing
