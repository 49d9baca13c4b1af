#include "dds/mesh_cache.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::dds {
namespace {

using ::testing::ElementsAre;

core::TriangleMesh mesh_of(std::size_t points) {
  core::TriangleMesh mesh;
  mesh.points.resize(points, core::Vec3::Zero());
  return mesh;
}

TEST(MeshCache, WhatHasNotBeenMadeIntoAShapeIsKept) {
  MeshCache cache({2, 1 << 20});
  EXPECT_TRUE(cache.add(1, mesh_of(3)));
  EXPECT_TRUE(cache.add(2, mesh_of(3)));
  EXPECT_FALSE(cache.add(3, mesh_of(3)));
  EXPECT_THAT(cache.hashes(), ElementsAre(1, 2));
}

TEST(MeshCache, WhatHasMakesRoomOldestFirst) {
  MeshCache cache({2, 1 << 20});
  cache.add(2, mesh_of(3));
  cache.add(1, mesh_of(3));
  cache.release_all();
  EXPECT_TRUE(cache.add(3, mesh_of(3)));
  EXPECT_THAT(cache.hashes(), ElementsAre(1, 3));
}

TEST(MeshCache, IsNotEmptiedBeforeItIsFull) {
  MeshCache cache({10, 1 << 20});
  cache.add(1, mesh_of(3));
  cache.release(1);
  cache.add(2, mesh_of(3));
  EXPECT_NE(cache.find(1), nullptr);
}

TEST(MeshCache, WhatIsAskedForAgainIsKept) {
  MeshCache cache({1, 1 << 20});
  cache.add(1, mesh_of(3));
  cache.release(1);
  cache.retain(1);
  EXPECT_FALSE(cache.add(2, mesh_of(3)));
  cache.release(1);
  EXPECT_TRUE(cache.add(2, mesh_of(3)));
}

TEST(MeshCache, BytesCount) {
  MeshCache cache({10, 100 * sizeof(core::Vec3)});
  EXPECT_FALSE(cache.add(1, mesh_of(101)));
  EXPECT_TRUE(cache.add(2, mesh_of(60)));
  EXPECT_FALSE(cache.add(3, mesh_of(60)));
  cache.release(2);
  EXPECT_TRUE(cache.add(3, mesh_of(60)));
  EXPECT_EQ(cache.find(2), nullptr);
}

TEST(MeshCache, WhoBringsTooMuchLosesTheOldestOfItsOwn) {
  constexpr std::uint64_t kOne = 1, kOther = 2;
  MeshCache cache({10, 1 << 20, 2, 1 << 20});
  cache.add(1, mesh_of(3), kOther);
  cache.add(2, mesh_of(3), kOne);
  cache.add(3, mesh_of(3), kOne);
  EXPECT_TRUE(cache.add(4, mesh_of(3), kOne));
  EXPECT_THAT(cache.hashes(), ElementsAre(1, 3, 4));
  cache.retain(3);
  EXPECT_TRUE(cache.add(5, mesh_of(3), kOne));
  EXPECT_THAT(cache.hashes(), ElementsAre(1, 3, 5)) << "somebody has asked for the third";
  cache.release(3);
  EXPECT_TRUE(cache.add(6, mesh_of(3), kOne));
  EXPECT_THAT(cache.hashes(), ElementsAre(1, 3, 5, 6)) << "what has been made into a shape does not count";
}

TEST(MeshCache, BytesOfASourceCount) {
  MeshCache cache({10, 1 << 20, 10, 100 * sizeof(core::Vec3)});
  EXPECT_FALSE(cache.add(1, mesh_of(101)));
  EXPECT_TRUE(cache.add(2, mesh_of(60)));
  EXPECT_TRUE(cache.add(3, mesh_of(60)));
  EXPECT_THAT(cache.hashes(), ElementsAre(3));
}

TEST(MeshCache, TheSameMeshTakesItsRoomOnce) {
  MeshCache cache({10, 100 * sizeof(core::Vec3)});
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(cache.add(7, mesh_of(60)));
}

}  // namespace
}  // namespace aurasim::dds
