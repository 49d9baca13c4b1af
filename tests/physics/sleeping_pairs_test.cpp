// Contacts of sleepers are packed. It must never show.
#include <bit>
#include <cmath>
#include <random>
#include <vector>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <gtest/gtest.h>

#include "physics/contact_cache.h"
#include "physics/joint_scenes.h"
#include "physics/packed_contacts.h"

namespace aurasim::physics::testing {
namespace {

btTransform random_pose(std::mt19937_64& random) {
  const auto any = [&random] { return static_cast<btScalar>(uniform(random, -1, 1)); };
  return btTransform(btQuaternion(any(), any(), any(), any()).normalized(), btVector3(any(), any(), any()) * 100);
}

/// Numbers of all kinds, and often those that a contact of bodies at rest has.
ContactRow random_row(std::mt19937_64& random, const btCollisionObject& a, const btCollisionObject& b) {
  const auto number = [&random]() -> double {
    switch (random() % 8) {
      case 0:
        return 0;
      case 1:
        return -0.0;
      case 2:
        return std::nan("");
      case 3:
        return static_cast<double>(static_cast<float>(uniform(random, -1, 1)));
      default:
        return uniform(random, -1e3, 1e3);
    }
  };
  ContactRow row;
  for (double& column : row) column = number();
  for (const std::size_t whole : {26, 27, 37, 38, 39, 40}) {
    row[whole] = static_cast<double>(static_cast<int>(random() % 2000) - 1);
  }
  if (random() % 2 == 0) {
    const auto vector = [&row](std::size_t at) { return btVector3(row[at], row[at + 1], row[at + 2]); };
    const btVector3 on_b = b.getWorldTransform()(vector(3)), on_a = a.getWorldTransform()(vector(0));
    const btVector3 normal = b.getWorldTransform().getBasis() * vector(15);
    for (int axis = 0; axis < 3; ++axis) {
      const auto column = static_cast<std::size_t>(axis);
      row[6 + column] = on_b[axis], row[9 + column] = on_a[axis], row[12 + column] = normal[axis];
    }
  }
  return row;
}

void expect_same_bits(const ContactRow& row, const ContactRow& other) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(row[i]), std::bit_cast<std::uint64_t>(other[i])) << "column " << i;
  }
}

TEST(PackedContacts, EveryBitComesBack) {
  std::mt19937_64 random(1);
  btBoxShape box(btVector3(1, 1, 1));
  for (int n = 0; n < 500; ++n) {
    btCollisionObject a, b;
    for (btCollisionObject* object : {&a, &b}) {
      object->setCollisionShape(&box);
      object->setWorldTransform(random_pose(random));
      object->setCollisionFlags(random() % 2 == 0 ? btCollisionObject::CF_STATIC_OBJECT : 0);
    }
    btPersistentManifold manifold(&a, &b, 0, 1, 1);
    std::vector<ContactRow> rows;
    for (std::uint64_t count = 1 + random() % 4; count > 0; --count) {
      rows.push_back(random_row(random, a, b));
      manifold.addManifoldPoint(read_point(rows.back().data()));
    }
    PackedBytes bytes = {1, 2, 3};
    pack_points(manifold, bytes);
    PackedPoints packed(bytes.data() + 3, a, b);
    for (const ContactRow& row : rows) expect_same_bits(packed.next(), row);
    EXPECT_EQ(packed.end(), bytes.data() + bytes.size());
  }
}

/// In a world that is put back in each state, no pair has slept for long enough to be packed. Such a world reports some
/// collisions twice, so they are not compared.
TEST(SleepingPairs, ThatArePackedGoOnAsIfTheyWereNot) {
  for (int seed = 0; seed < 8; ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    core::Scene scene = scene_of_all_shapes(seed % 2 == 0 ? Ground::kPlane : Ground::kMesh);
    const std::vector<core::BodyRecord> bodies = piles_of_all_shapes(scene, random);
    Settings settings;
    settings.solver = Solver::kSoftStep;
    settings.continuous = true;
    settings.block_m = seed % 4 < 2 ? core::kUsualBlock_m : 2;
    settings.threads = 1 + seed % 3;
    RegionWorld packs(scene, settings), never(scene, settings);
    packs.add(bodies);
    run(packs, 500);
    never.put_back(packs.step_number(), packs.peek_all());
    for (core::Step n = 501; n <= 900; ++n) {
      if (n % 80 == 0) {
        const core::Vec3 J_W(uniform(random, -4, 4), uniform(random, -4, 4), uniform(random, 0, 6));
        const core::Order order{static_cast<std::uint64_t>(n), 0, n,
                                core::Impulse{core::BodyId{random() % bodies.size()}, J_W}};
        for (RegionWorld* world : {&packs, &never}) world->schedule(order);
      }
      packs.step();
      never.step();
      ASSERT_TRUE(different(packs.records(), never.records()).empty()) << "seed " << seed << ", state " << n;
      const core::ClusterState of_packs = packs.peek_all(), of_never = never.peek_all();
      ASSERT_EQ(of_packs.points, of_never.points) << "seed " << seed << ", state " << n;
      ASSERT_EQ(of_packs.manifolds.size(), of_never.manifolds.size());
      never.put_back(n, of_never);
    }
  }
}

}  // namespace
}  // namespace aurasim::physics::testing
