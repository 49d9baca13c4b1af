// Things that fall asleep and wake over many blocks.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "physics/joint_scenes.h"

namespace aurasim::physics::testing {

using core::BodyId;
using core::BodyRecord;
using core::Vec3;

inline constexpr double kSide = 4, kOneBlock = 1e5;
inline constexpr int kAsleep = 2;

/// Kinds of bodies. The hammer is a small ball of 1000 kg, the plank has 20 kg, the others have 1.
enum Thing { kCube, kBall, kHammer, kPlank, kWatchman };

inline core::Scene scene_of_things() {
  core::Scene scene = scene_of(core::Box{{0.5, 0.5, 0.5}});
  scene.materials[0].rolling_friction = scene.materials[0].spinning_friction = 0;
  scene.materials[0].linear_damping = scene.materials[0].angular_damping = 0;
  const auto add = [&scene](const core::Shape& shape, double mass_kg) {
    scene.shapes.push_back({"thing " + std::to_string(scene.shapes.size()), shape});
    core::Prototype& kind = scene.prototypes.emplace_back();
    kind.shape = static_cast<std::uint32_t>(scene.shapes.size() - 1);
    kind.mass_kg = mass_kg;
  };
  add(core::Sphere{0.5}, 1);
  add(core::Sphere{0.3}, 1000);
  add(core::Box{{10, 0.5, 0.1}}, 20);
  add(core::Box{{0.5, 0.5, 0.5}}, 1);
  scene.prototypes[kWatchman].can_sleep = false;
  return scene;
}

class Sleep : public ::testing::Test {
 protected:
  Sleep() { make_world(kSide); }

  /// An empty world, which follows the scene.
  void make_world(double side_m, int threads = 1) {
    Settings settings;
    settings.solver = Solver::kSoftStep;
    settings.continuous = true;
    settings.block_m = side_m;
    settings.threads = threads;
    world.emplace(scene, settings);
  }
  void place(std::uint64_t id, int kind, const Vec3& p_WB, const Vec3& v_WB = Vec3::Zero()) {
    const BodyRecord record = body(id, kind, p_WB, v_WB);
    world->add({&record, 1});
  }
  /// Cubes with the ids 0, 1, 2 ... that touch, along x: three in block 0, then four in each block.
  void place_row(int cubes) {
    for (int i = 0; i < cubes; ++i) place(static_cast<std::uint64_t>(i), kCube, {1.5 + i, 2, 0.5});
  }
  void order(const core::Action& action) {
    core::Order order;
    order.request = ++orders_;
    order.at_step = world->step_number() + 1;
    order.action = action;
    world->schedule(order);
  }
  bool sleeps(std::uint64_t id) { return record_of(id).activation_state == kAsleep; }
  const BodyRecord& record_of(std::uint64_t id) {
    return *std::ranges::find(world->records(), BodyId{id}, &BodyRecord::id);
  }
  std::size_t sleepers() {
    return static_cast<std::size_t>(std::ranges::count(world->records(), kAsleep, &BodyRecord::activation_state));
  }
  /// Steps until all bodies sleep but so many; the number of steps.
  int fall_asleep(int most_steps, std::size_t but = 0) {
    for (int n = 1; n <= most_steps; ++n) {
      world->step();
      if (sleepers() + but == world->records().size()) return n;
    }
    ADD_FAILURE() << sleepers() << " of " << world->records().size() << " sleep after " << most_steps << " steps";
    return most_steps;
  }
  /// For each of the bodies with the ids 0, 1, 2 ...: number of the step in which it wakes; 0: it sleeps on.
  std::vector<int> wake_times(int bodies, int steps) {
    std::vector<int> woken(static_cast<std::size_t>(bodies), 0);
    for (int n = 1; n <= steps; ++n) {
      world->step();
      for (std::size_t id = 0; id < woken.size(); ++id) {
        if (woken[id] == 0 && !sleeps(id)) woken[id] = n;
      }
    }
    return woken;
  }
  /// If all wake, nothing falls.
  void expect_rests_on_something() {
    std::vector<BodyRecord> awake(world->records().begin(), world->records().end());
    for (BodyRecord& record : awake) record.activation_state = 1, record.deactivation_time = 0;
    make_world(kOneBlock);
    world->add(awake);
    run(*world, 60);
    for (const BodyRecord& before : awake) {
      EXPECT_GT(record_of(core::value_of(before.id)).p_WB.z(), before.p_WB.z() - 0.05) << core::value_of(before.id);
    }
  }

  core::Scene scene = scene_of_things();
  std::optional<RegionWorld> world;

 private:
  std::uint64_t orders_ = 0;
};

/// A plank that lies on pillars in five blocks, with cubes on it.
class Plank : public Sleep {
 protected:
  static constexpr std::uint64_t kPlank_ = 100;

  Plank() {
    for (std::uint64_t i = 0; i < 5; ++i) {
      const double x = 2 + 4 * static_cast<double>(i);
      place(i, kCube, {x, 2, 0.5});
      place(10 + i, kCube, {x + 0.3, 2, 1.7});
      place(20 + i, kCube, {x + 0.3, 2, 2.7});
    }
    place(kPlank_, kPlank, {10, 2, 1.1});
    fall_asleep(300);
  }
};

}  // namespace aurasim::physics::testing
