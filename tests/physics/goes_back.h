// A world in which all that can happen to bodies does, for tests of what must not show afterwards.
#pragma once

#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "physics/joint_scenes.h"

namespace aurasim::physics::testing {

/// Name of a test with a solver, and whether fast bodies stop at obstacles.
inline std::string solver_name(const ::testing::TestParamInfo<std::tuple<Solver, bool>>& info) {
  const auto& [solver, is_continuous] = info.param;
  return std::string(solver == Solver::kSoftStep ? "SoftStep" : "SequentialImpulse") +
         (is_continuous ? "Continuous" : "");
}

/// Piles and creatures of all shapes and joints beside and upon each other, and a belt where the solver knows one.
class GoesBack {
 public:
  GoesBack(const Settings& settings_in, int seed)
      : settings(settings_in), random(static_cast<std::uint64_t>(seed)), scene(make_scene(seed)), world(make_world()) {
    std::vector<core::BodyRecord> bodies = initial_records(scene);
    for (int i = 0; i < 3; ++i) {
      const std::vector<core::BodyRecord> more =
          pile(random, 1000 + 100 * static_cast<std::uint64_t>(i), 9, 3.0 * i, 0);
      bodies.insert(bodies.end(), more.begin(), more.end());
    }
    world.add(bodies);
  }

  void run_on(int states) {
    for (int i = 0; i < states; ++i) {
      if (random() % 12 == 0) announce_birth();
      if (random() % 12 == 0) order_something();
      world.step();
      after_step();
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
      after_step();
    }
    for (int i = 0; i < quiet; ++i) {
      world.step();
      after_step();
    }
  }

  /// A new world in which nothing has happened yet but that the same was ordered.
  RegionWorld make_world() {
    RegionWorld made(scene, settings);
    for (const core::Order& order : orders) made.schedule(order);
    for (const core::Setpoints& said : setpoints) made.controls().recall(said);
    made.watch_contacts(true);
    return made;
  }

  void hand_over() {
    std::vector<core::BodyId> leaving;
    for (const core::BodyState& body : world.snapshot().bodies) {
      if (pick(20) == 0) leaving.push_back(body.id);
    }
    handed_over_ = world.release(leaving);
    handed_over_in_ = world.step_number();
  }
  /// Adopts what was handed over last, with the contacts that it had.
  void take_back() {
    const auto is_here = [this](const core::BodyRecord& body) { return world.contains(body.id); };
    if (handed_over_in_ > world.step_number() || std::ranges::any_of(handed_over_.bodies, is_here)) return;
    world.adopt(std::exchange(handed_over_, {}), handed_over_in_);
    ++taken_back;
  }
  std::uint64_t pick(std::uint64_t count) { return random() % count; }

  std::function<void()> after_step = [] {};
  int taken_back = 0;
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
      core::StaticBody belt;
      belt.name = "belt";
      belt.shape = made.prototypes[kBox].shape;
      belt.pose.p_WB = {3, 3, 0};
      belt.path = core::StaticPath{{{0.5, {core::Vec3(0, 0, 0.4), core::Quat::Identity()}}, {1, {}}}, true, true};
      belt.belt_S = {0.5, 0, 0};
      made.statics.push_back(belt);
    }
    return made;
  }

  core::Vec3 somewhere() { return {uniform(random, -1, 9), uniform(random, -1, 1), uniform(random, 1, 5)}; }
  core::Step soon() { return world.step_number() + 1 + static_cast<core::Step>(pick(40)); }
  core::BodyId some_body() {
    const std::vector<core::BodyState>& all = world.snapshot().bodies;
    return all[pick(all.size())].id;
  }
  core::BodyRecord newcomer() { return body(next_id_++, static_cast<int>(pick(kKinds)), somewhere(), {1, 0, -2}); }

  void announce_birth() {
    core::BodyRecord record = newcomer();
    record.birth = soon();
    world.add({&record, 1});
  }
  void take_in() {
    const core::BodyRecord record = newcomer();
    world.add({&record, 1});
  }
  /// Another body with the same id.
  void replace() {
    const core::BodyId id = some_body();
    core::BodyRecord record = world.release({&id, 1}).bodies[0];
    record.prototype = core::PrototypeId{static_cast<std::uint32_t>((value_of(record.prototype) + 1) % kKinds)};
    world.add({&record, 1});
  }
  void order_something() {
    const core::Step at = soon();
    switch (pick(8)) {
      case 0:
        return order(at, core::RemoveBody{some_body()});
      case 1:
        return order_static(at);
      case 2:
        return order(at, core::SetVelocity{some_body(), {0, 0, 3}, core::Vec3(1, 2, 3)});
      default:
        return order(at, core::Impulse{some_body(), {uniform(random, -4, 4), 0, uniform(random, 0, 6)}, {}});
    }
  }
  void order(core::Step at, core::Action action) {
    orders.push_back({orders.size() + 1, 0, at, std::move(action)});
    world.schedule(orders.back());
  }
  /// A block comes and goes.
  void order_static(core::Step at) {
    core::StaticBody block;
    block.name = "block";
    block.shape = scene.prototypes[kBox].shape;
    block.pose.p_WB = {uniform(random, -1, 9), uniform(random, -1, 1), 0.3};
    const core::StaticId id{static_cast<std::uint32_t>(scene.statics.size())};
    scene.statics.push_back(block);
    order(at, core::AddStatic{id, block.shape, block.pose});
    order(at + 1 + static_cast<core::Step>(pick(60)), core::RemoveStatic{id});
  }
  void say_something() {
    core::Setpoints said{core::kRecordedClient, setpoints.size() + 1, 0, soon(), {}, {}};
    said.bodies.push_back({some_body(), core::Quantity::kForce, core::Vec3(0, 2, 15)});
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
  core::ClusterState handed_over_;
  core::Step handed_over_in_ = 0;
};

/// Contacts and joints, to the last bit.
inline bool same_rows(const core::ClusterState& a, const core::ClusterState& b) {
  const auto same_manifold = [](const core::ManifoldRecord& x, const core::ManifoldRecord& y) {
    return x.object0 == y.object0 && x.object1 == y.object1 && x.point_count == y.point_count;
  };
  const auto same_joint = [](const core::JointRecord& x, const core::JointRecord& y) {
    return x.id == y.id && x.value_count == y.value_count;
  };
  return std::ranges::equal(a.manifolds, b.manifolds, same_manifold) && a.points == b.points &&
         std::ranges::equal(a.joints, b.joints, same_joint) && a.joint_values == b.joint_values;
}

}  // namespace aurasim::physics::testing
