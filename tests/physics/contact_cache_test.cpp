#include "physics/contact_cache.h"

#include <array>

#include <gtest/gtest.h>

#include "physics/bullet_convert.h"

namespace aurasim::physics {
namespace {

using Row = std::array<double, core::kContactPointDoubles>;

Row numbered_row() {
  Row row;
  for (std::size_t i = 0; i < row.size(); ++i) row[i] = static_cast<double>(i) + 1;
  return row;
}

TEST(ContactCache, EveryColumnComesBack) {
  const Row row = numbered_row();
  Row again{};
  write_point(read_point(row.data()), again.data());
  EXPECT_EQ(again, row);
}

TEST(ContactCache, ColumnsAreWhereTheHeaderSays) {
  const Row row = numbered_row();
  const btManifoldPoint point = read_point(row.data());
  EXPECT_EQ(point.m_localPointA, btVector3(1, 2, 3));
  EXPECT_EQ(point.m_localPointB, btVector3(4, 5, 6));
  EXPECT_EQ(point.m_positionWorldOnB, btVector3(7, 8, 9));
  EXPECT_EQ(point.m_positionWorldOnA, btVector3(10, 11, 12));
  EXPECT_EQ(point.m_normalWorldOnB, btVector3(13, 14, 15));
  EXPECT_EQ(point.m_lateralFrictionDir1, btVector3(16, 17, 18));
  EXPECT_EQ(point.m_lateralFrictionDir2, btVector3(19, 20, 21));
  EXPECT_EQ(point.m_distance1, row[21]);
  EXPECT_EQ(point.m_combinedFriction, row[22]);
  EXPECT_EQ(point.m_combinedRollingFriction, row[23]);
  EXPECT_EQ(point.m_combinedSpinningFriction, row[24]);
  EXPECT_EQ(point.m_combinedRestitution, row[25]);
  EXPECT_EQ(point.m_contactPointFlags, row[26]);
  EXPECT_EQ(point.m_lifeTime, row[27]);
  EXPECT_EQ(point.m_appliedImpulse, row[28]);
  EXPECT_EQ(point.m_prevRHS, row[29]);
  EXPECT_EQ(point.m_appliedImpulseLateral1, row[30]);
  EXPECT_EQ(point.m_appliedImpulseLateral2, row[31]);
  EXPECT_EQ(point.m_contactMotion1, row[32]);
  EXPECT_EQ(point.m_contactMotion2, row[33]);
  EXPECT_EQ(point.m_contactCFM, row[34]);
  EXPECT_EQ(point.m_contactERP, row[35]);
  EXPECT_EQ(point.m_frictionCFM, row[36]);
  EXPECT_EQ(point.m_partId0, row[37]);
  EXPECT_EQ(point.m_partId1, row[38]);
  EXPECT_EQ(point.m_index0, row[39]);
  EXPECT_EQ(point.m_index1, row[40]);
  EXPECT_EQ(point.m_userPersistentData, nullptr);
}

/// Were a field added to Bullet's point, the cache would have to carry it. 3 of each vector's 4 numbers count.
TEST(ContactCache, HasAColumnForEveryNumberOfAPoint) {
  constexpr std::size_t kVectors = 7, kInts = 6, kPointers = 1;
  constexpr std::size_t kScalars = core::kContactPointDoubles - 3 * kVectors - kInts;
  constexpr std::size_t kSize =
      kVectors * sizeof(btVector3) + kScalars * sizeof(btScalar) + kInts * sizeof(int) + kPointers * sizeof(void*);
  EXPECT_LT(sizeof(btManifoldPoint) - kSize, 3 * sizeof(btScalar)) << "more than padding";
}

}  // namespace
}  // namespace aurasim::physics
