// Jointed bodies that change worlds at random times, some of them late, take the path of those that stay.
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <gtest/gtest.h>

#include "physics/joint_scenes.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyId;
using core::BodyRecord;
using core::ClusterState;
using core::Step;
using core::Vec3;

core::Scene scene_of_creatures(std::vector<std::vector<BodyId>>& creatures) {
  core::Scene scene = scene_of_all_shapes();
  for (int i = 0; i < 3; ++i) creatures.push_back(place_creature(scene, 30.0 * i, {2.0 - i, 1, -1}));
  // And one that hangs from the world.
  creatures.push_back(place_creature(scene, 90, {0, 0, 0}));
  add_joint(scene, core::BallJoint{}, value_of(creatures.back()[3]), {}, {90, 0.5, 5});
  creatures.push_back(place_machine(scene, 120));
  return scene;
}

struct CreatureTravels {
  ClusterState cluster;
  Step stamp = 0;
};

class JointHandOff : public ::testing::TestWithParam<int> {
 protected:
  JointHandOff() {
    central.add(initial_records(scene));
    for (const auto& ids : creatures) put_in(worlds[random() % 2], ids);
  }

  void put_in(RegionWorld& world, const std::vector<BodyId>& ids) {
    std::vector<BodyRecord> records;
    for (const BodyId id : ids) records.push_back(core::initial_record(*core::find_body(scene, id)));
    std::reverse(records.begin(), records.end());
    for (const BodyRecord& record : records) world.add(std::span(&record, 1));
  }

  int host_of(std::size_t creature) { return worlds[0].contains(creatures[creature][0]) ? 0 : 1; }

  void step_all() {
    central.step();
    for (RegionWorld& world : worlds) world.step();
  }

  std::vector<std::uint64_t> that_differ() {
    auto result = different(worlds[0].records(), central.records());
    for (const auto id : different(worlds[1].records(), central.records())) result.push_back(id);
    return result;
  }

  /// A hand-off of each creature in one of 20 steps, up to two steps late. Says in which state bits first differ.
  Step run_random(Step steps, const std::function<void(ClusterState&)>& spoil = {}) {
    std::vector<std::optional<CreatureTravels>> travels(creatures.size());
    std::vector<Step> arrival(creatures.size());
    std::vector<int> to(creatures.size());
    for (Step now = 0; now < steps; ++now) {
      for (std::size_t i = 0; i < creatures.size(); ++i) {
        if (!travels[i] && random() % 20 == 0) {
          to[i] = 1 - host_of(i);
          travels[i] = CreatureTravels{worlds[1 - to[i]].release(creatures[i]), now};
          arrival[i] = now + static_cast<Step>(random() % 3);
          if (spoil) spoil(travels[i]->cluster);
          ++hand_offs;
        }
        if (travels[i] && arrival[i] == now) {
          worlds[to[i]].adopt(travels[i]->cluster, travels[i]->stamp);
          travels[i].reset();
        }
      }
      step_all();
      if (!that_differ().empty()) return now + 1;
    }
    return 0;
  }

  std::mt19937_64 random{static_cast<std::uint64_t>(GetParam())};
  std::vector<std::vector<BodyId>> creatures;
  core::Scene scene = scene_of_creatures(creatures);
  RegionWorld central{scene, Settings{}};
  RegionWorld worlds[2] = {RegionWorld{scene, Settings{}}, RegionWorld{scene, Settings{}}};
  int hand_offs = 0;
};

TEST_P(JointHandOff, ChangesNoBit) {
  EXPECT_EQ(run_random(1200), 0) << "after " << hand_offs << " hand-offs";
  EXPECT_GT(hand_offs, 150);
  EXPECT_EQ(worlds[0].severed_contacts() + worlds[1].severed_contacts(), 0u);
  std::vector<BodyId> all;
  for (const auto& ids : creatures) all.insert(all.end(), ids.begin(), ids.end());
  const ClusterState state = central.peek(all);
  int broken = 0;
  for (const core::JointRecord& joint : state.joints) broken += state.joint_values[joint.first_value] != 0;
  EXPECT_GT(broken, 0) << "or the next test could not fail";
  EXPECT_LT(broken, static_cast<int>(state.joints.size()) / 2);
}

/// As if they had been set while the world ran, on the hinges and sliders of machine and creatures.
void drive_anew(ClusterState& all, const core::Scene& scene) {
  ClusterState driven = all;
  driven.joint_values.clear();
  for (core::JointRecord& record : driven.joints) {
    const core::JointKind& kind = scene.joints[value_of(record.id)].kind;
    const bool is_driven =
        std::holds_alternative<core::HingeJoint>(kind) || std::holds_alternative<core::SliderJoint>(kind);
    std::vector<double> values(all.joint_values.begin() + record.first_value,
                               all.joint_values.begin() + record.first_value + record.value_count);
    if (is_driven) {
      values.resize(4, 0);
      values.insert(values.end(), {7, 1, 30, 2, 0.5, -1});
    }
    record.first_value = static_cast<std::uint32_t>(driven.joint_values.size());
    record.value_count = static_cast<std::uint32_t>(values.size());
    driven.joint_values.insert(driven.joint_values.end(), values.begin(), values.end());
  }
  all = std::move(driven);
}

TEST_P(JointHandOff, DrivesThatWereSetOnTheWayGoWithTheirBodies) {
  for (RegionWorld* world : {&central, &worlds[0], &worlds[1]}) {
    ClusterState all = world->peek_all();
    drive_anew(all, scene);
    world->put_back(0, all);
  }
  EXPECT_EQ(run_random(400), 0) << "after " << hand_offs << " hand-offs";
  EXPECT_GT(hand_offs, 50);
  const ClusterState state = central.peek(creatures.back());
  EXPECT_EQ(std::ranges::count(state.joints, 10u, &core::JointRecord::value_count), 4);
}

TEST_P(JointHandOff, WithoutTheirValuesBrokenJointsWouldMend) {
  EXPECT_GT(run_random(1200,
                       [](ClusterState& cluster) {
                         cluster.joints.clear();
                         cluster.joint_values.clear();
                       }),
            0);
}

TEST_P(JointHandOff, ValuesOfAnotherLengthOrOfAJointThatIsNotHereAreIgnored) {
  EXPECT_EQ(run_random(30,
                       [](ClusterState& cluster) {
                         cluster.joints.push_back({core::JointId{999}, 0, 2});
                         cluster.joints.push_back({core::JointId{1}, 0, 1});
                         cluster.joints.push_back({core::JointId{1}, 0xffff'ffff, 2});
                       }),
            0);
}

TEST_P(JointHandOff, ChangesNoBitOfTheSoftStepEither) {
  Settings soft;
  soft.solver = Solver::kSoftStep;
  central = RegionWorld(scene, soft);
  for (RegionWorld& world : worlds) world = RegionWorld(scene, soft);
  central.add(initial_records(scene));
  for (const auto& ids : creatures) put_in(worlds[random() % 2], ids);
  EXPECT_EQ(run_random(600), 0) << "after " << hand_offs << " hand-offs";
}

INSTANTIATE_TEST_SUITE_P(Seeds, JointHandOff, ::testing::Range(1, 7));

TEST(JointOrder, IsThatOfTheJointsAndNotThatOfInsertion) {
  std::vector<std::vector<BodyId>> creatures;
  const core::Scene scene = scene_of_creatures(creatures);
  RegionWorld forward{scene, Settings{}}, backward{scene, Settings{}};
  std::vector<BodyRecord> records = initial_records(scene);
  forward.add(records);
  std::reverse(records.begin(), records.end());
  for (const BodyRecord& record : records) backward.add(std::span(&record, 1));
  for (int i = 0; i < 400; ++i) {
    run(forward, 1);
    run(backward, 1);
    ASSERT_EQ(different(forward.records(), backward.records()), std::vector<std::uint64_t>()) << "in state " << i + 1;
  }
}

TEST(CutJoint, IsCountedAndMadeAgainWhenBothBodiesMeet) {
  core::Scene scene = scene_of_all_shapes();
  place_body(scene, kBox, {0, 0, 5});
  place_body(scene, kBox, {2, 0, 5});
  add_joint(scene, core::BallJoint{}, 0, 1, {1, 0, 5});
  RegionWorld first{scene, Settings{}}, second{scene, Settings{}};
  first.add(initial_records(scene));
  const std::vector<BodyId> one = {BodyId{1}};
  second.adopt(first.release(one), 0);
  EXPECT_EQ(first.severed_contacts(), 1u);
  EXPECT_TRUE(first.snapshot().joints.empty());
  first.adopt(second.release(one), 0);
  EXPECT_EQ(second.severed_contacts(), 0u);
  EXPECT_EQ(first.snapshot().joints.size(), 1u);
}

TEST(BrokenJoint, IsKnownToBothBodiesWhereverTheyGo) {
  core::Scene scene = scene_of_all_shapes();
  place_body(scene, kBox, {0, 0, 5});
  place_body(scene, kBox, {2, 0, 5}).v_WB = {5, 0, 0};
  add_joint(scene, core::BallJoint{}, 0, 1, {1, 0, 5}).break_impulse = 0.1;
  for (const std::uint64_t goer : {0u, 1u}) {
    RegionWorld first{scene, Settings{}}, second{scene, Settings{}};
    first.add(initial_records(scene));
    run(first, 1);
    run(second, 1);
    EXPECT_TRUE(first.snapshot().joints.empty()) << "broken";
    second.adopt(first.release(std::vector{BodyId{goer}}), 1);
    second.adopt(first.release(std::vector{BodyId{1 - goer}}), 1);
    EXPECT_EQ(first.severed_contacts() + second.severed_contacts(), 0u);
    EXPECT_TRUE(second.snapshot().joints.empty()) << "and stays so";
  }
}

}  // namespace
}  // namespace aurasim::physics::testing
