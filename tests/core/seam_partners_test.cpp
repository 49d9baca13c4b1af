#include "core/seam_partners.h"

#include <gtest/gtest.h>

namespace aurasim::core {
namespace {

constexpr RegionId kWest{0}, kMiddle{1}, kEast{2}, kFarEast{3};

TEST(SeamPartners, AreNearEachOther) {
  const BlockOwners owners(RegionMap::columns(4, 16), 16, 1);
  const SeamPartners partners(owners);
  EXPECT_TRUE(partners.are_partners(kWest, kMiddle));
  EXPECT_FALSE(partners.are_partners(kWest, kEast));
}

TEST(SeamPartners, OfAGridAreDiagonalNeighboursToo) {
  const BlockOwners owners(RegionMap::grid(2, 3, 16, 16), 16, 1);
  const SeamPartners partners(owners);
  EXPECT_TRUE(partners.are_partners(RegionId{0}, RegionId{4}));
  EXPECT_FALSE(partners.are_partners(RegionId{0}, RegionId{5}));
}

/// Columns of 16 m, so those to both sides of one are 16 m apart.
TEST(SeamPartners, AreMoreWhereBodiesMayBeFast) {
  const double reach_m = 1;
  EXPECT_FALSE(BlockOwners(RegionMap::columns(4, 16), 16, reach_m, 6).are_near(kWest, kEast));
  EXPECT_TRUE(BlockOwners(RegionMap::columns(4, 16), 16, reach_m, 8).are_near(kWest, kEast));
}

TEST(SeamPartners, AreAllThatPairsConnectForOneStep) {
  const BlockOwners owners(RegionMap::columns(5, 16), 16, 1);
  SeamPartners partners(owners);
  const std::vector<Introduction> pairs = {{kWest, kEast}, {kEast, RegionId{4}}};
  partners.begin(pairs);
  EXPECT_TRUE(partners.are_partners(kWest, RegionId{4}));
  EXPECT_TRUE(partners.are_partners(RegionId{4}, kWest));
  EXPECT_FALSE(partners.are_partners(kWest, kFarEast));
  partners.begin({});
  EXPECT_FALSE(partners.are_partners(kWest, kEast));
}

}  // namespace
}  // namespace aurasim::core
