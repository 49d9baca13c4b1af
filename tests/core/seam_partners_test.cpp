#include "core/seam_partners.h"

#include <gtest/gtest.h>

namespace aurasim::core {
namespace {

constexpr RegionId kColumn0{0}, kColumn1{1}, kColumn2{2}, kColumn3{3};

TEST(SeamPartners, AreNearEachOther) {
  const BlockOwners owners(RegionMap::columns(4, 16), 16, 1);
  const SeamPartners partners(owners);
  EXPECT_TRUE(partners.are_partners(kColumn0, kColumn1));
  EXPECT_FALSE(partners.are_partners(kColumn0, kColumn2));
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
  EXPECT_FALSE(BlockOwners(RegionMap::columns(4, 16), 16, reach_m, 6).are_near(kColumn0, kColumn2));
  EXPECT_TRUE(BlockOwners(RegionMap::columns(4, 16), 16, reach_m, 8).are_near(kColumn0, kColumn2));
}

TEST(SeamPartners, AreAllThatPairsConnectForOneStep) {
  const BlockOwners owners(RegionMap::columns(5, 16), 16, 1);
  SeamPartners partners(owners);
  const std::vector<Introduction> pairs = {{kColumn0, kColumn2}, {kColumn2, RegionId{4}}};
  partners.begin(pairs);
  EXPECT_TRUE(partners.are_partners(kColumn0, RegionId{4}));
  EXPECT_TRUE(partners.are_partners(RegionId{4}, kColumn0));
  EXPECT_FALSE(partners.are_partners(kColumn0, kColumn3));
  partners.begin({});
  EXPECT_FALSE(partners.are_partners(kColumn0, kColumn2));
}

/// Around a corner of four regions, a chain of contacts may go from one to another by way of a third.
TEST(SeamPartners, ShareChainsOnlyAroundACornerWithAThirdOrWherePairsSay) {
  const BlockOwners row(RegionMap::columns(3, 16), 16, 1), grid(RegionMap::grid(2, 3, 16, 16), 16, 1);
  SeamPartners in_row(row);
  EXPECT_FALSE(in_row.may_share_chains(kColumn0, kColumn1));
  const std::vector<Introduction> pairs = {{kColumn0, kColumn1}};
  in_row.begin(pairs);
  EXPECT_TRUE(in_row.may_share_chains(kColumn0, kColumn1));
  EXPECT_FALSE(in_row.may_share_chains(kColumn1, kColumn2));
  const SeamPartners in_grid(grid);
  EXPECT_TRUE(in_grid.may_share_chains(RegionId{0}, RegionId{1}));
  EXPECT_TRUE(in_grid.may_share_chains(RegionId{0}, RegionId{4}));
  EXPECT_FALSE(in_grid.may_share_chains(RegionId{0}, RegionId{5}));
}

}  // namespace
}  // namespace aurasim::core
