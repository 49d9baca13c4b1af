// Coupled worlds look at bodies that sleep far from borders as seldom as other worlds do, and know them as well.
#include <algorithm>

#include <gtest/gtest.h>

#include "physics/coupled_worlds.h"
#include "physics/goes_back.h"

namespace aurasim::physics::testing {
namespace {

using core::BodyRecord;
using core::RegionMap;
using core::Vec3;

Settings settings_of_columns() {
  Settings settings;
  settings.solver = Solver::kSoftStep;
  settings.continuous = true;
  settings.block_m = 2;
  settings.top_speed_m_s = 20;
  return settings;
}

/// Stacks of two boxes that fall asleep, 1.2 m apart, over the border of two columns.
std::vector<BodyRecord> boxes() {
  std::vector<BodyRecord> bodies;
  for (int i = 0; i < 400; ++i) {
    const Vec3 p(1.2 * (i / 2 % 20 - 9.5), 1.2 * (i / 40 - 4.5), 0.45 + 0.9 * (i % 2));
    bodies.push_back(body(bodies.size() + 1, kBox, p));
  }
  return bodies;
}

BodyRecord thrown(std::uint64_t id, const Vec3& p_WB, const Vec3& v_WB, core::Step birth) {
  BodyRecord ball = body(id, kSphere, p_WB, v_WB);
  ball.birth = birth;
  return ball;
}

struct Columns {
  explicit Columns(std::vector<BodyRecord> some)
      : scene(scene_of_all_shapes()), bodies(std::move(some)), worlds(scene, settings_of_columns(), map, bodies) {}

  core::Scene scene;
  RegionMap map = RegionMap::columns(2, 24);
  std::vector<BodyRecord> bodies;
  CoupledWorlds worlds;
};

/// The snapshot, the hash, and the copy that shares what has not changed say what all records say.
void expect_whole(RegionWorld& world, std::size_t& shared, std::size_t& kept) {
  core::ChangedState copy;
  world.copy_all(copy);
  if (copy.before) ++shared;
  const core::ClusterState is = core::whole(copy), wanted = world.peek_all();
  ASSERT_EQ(ids_of(is.bodies), ids_of(wanted.bodies));
  ASSERT_EQ(different(is.bodies, wanted.bodies), std::vector<std::uint64_t>{});
  ASSERT_TRUE(same_rows(is, wanted));
  ASSERT_EQ(world.hash_sum(), hash_sum(world.records()));

  const core::Snapshot& shown = world.snapshot();
  if (shown.goes_on) ++kept;
  ASSERT_EQ(shown.bodies.size(), wanted.bodies.size());
  std::size_t awake = 0;
  for (std::size_t i = 0; i < shown.bodies.size(); ++i) {
    ASSERT_EQ(shown.bodies[i].id, wanted.bodies[i].id);
    ASSERT_EQ(shown.bodies[i].pose.p_WB, wanted.bodies[i].p_WB);
    ASSERT_EQ(shown.bodies[i].v_WB, wanted.bodies[i].v_WB);
    awake += shown.bodies[i].birth <= shown.step && shown.bodies[i].awake ? 1 : 0;
  }
  ASSERT_EQ(shown.awake, awake);
  std::vector<core::Contact> contacts;
  const auto place_of = [&](core::ObjectRef ref) {
    const auto found =
        std::ranges::find(wanted.bodies, ref, [](const BodyRecord& body) { return core::ref_of(body.id); });
    return static_cast<std::uint32_t>(found - wanted.bodies.begin());
  };
  for (const core::ManifoldRecord& manifold : wanted.manifolds) {
    if (manifold.object0 < 0 || manifold.object1 < 0) continue;
    const auto [a, b] = std::minmax({place_of(manifold.object0), place_of(manifold.object1)});
    if (b < wanted.bodies.size()) contacts.push_back({a, b});
  }
  const auto pair_of = [](const core::Contact& contact) { return std::pair(contact.a, contact.b); };
  std::ranges::sort(contacts, {}, pair_of);
  ASSERT_TRUE(std::ranges::equal(contacts, shown.contacts, {}, pair_of, pair_of));
}

TEST(CoupledSleepers, AreKnownAsWellAsWhenAllAreLookedAt) {
  std::vector<BodyRecord> bodies = boxes();
  bodies.push_back(thrown(1000, {-9, 0.2, 3}, {12, 0, -2}, 230));
  bodies.push_back(thrown(1001, {9, -2, 4}, {-9, 1, -3}, 260));
  bodies.push_back(thrown(1002, {-8, 3, 1}, {15, 0.5, 0}, 300));
  Columns columns(bodies);
  RegionWorld one(columns.scene, settings_of_columns());
  one.add(bodies);
  std::size_t shared = 0, kept = 0;
  for (int i = 0; i < 420; ++i) {
    one.step();
    columns.worlds.step();
    ASSERT_EQ(different(columns.worlds.records(), one.records()), std::vector<std::uint64_t>{}) << "state " << i + 1;
    if (i < 100) continue;  // all are awake
    for (std::size_t region = 0; region < 2; ++region) {
      expect_whole(columns.worlds[region], shared, kept);
      if (::testing::Test::HasFatalFailure()) FAIL() << "region " << region << ", state " << i + 1;
    }
  }
  EXPECT_GT(shared, 100U);
  EXPECT_GT(kept, 100U);
}

TEST(CoupledSleepers, AreNotLookedAtInEachStep) {
  std::vector<BodyRecord> bodies = boxes();
  bodies.push_back(body(1000, kSphere, {0, 8, 0.5}, {1, 0, 0}));
  Columns columns(bodies);
  for (int i = 0; i < 250; ++i) columns.worlds.step();
  int kept = 0;
  for (int i = 0; i < 20; ++i) {
    columns.worlds.step();
    for (std::size_t region = 0; region < 2; ++region) {
      const core::Snapshot& shown = columns.worlds[region].snapshot();
      EXPECT_LE(shown.awake, 1U);
      if (!shown.goes_on) continue;
      EXPECT_LE(shown.changed.size(), 2U);
      ++kept;
    }
  }
  EXPECT_GT(kept, 30);
}

}  // namespace
}  // namespace aurasim::physics::testing
