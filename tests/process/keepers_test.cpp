// Which regions keep copies of a region's parts.
#include "process/keepers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using core::RegionId;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<RegionId> keepers(std::uint32_t region, const std::vector<std::uint16_t>& hosts) {
  std::map<RegionId, std::uint16_t> by_region;
  for (std::uint32_t r = 0; r < hosts.size(); ++r) by_region[RegionId{r}] = hosts[r];
  return keepers_of(RegionId{region}, static_cast<std::uint32_t>(hosts.size()), by_region);
}

TEST(Keepers, AreTheNextRegionAndOneHalfTheRingAway) {
  EXPECT_THAT(keepers(2, {1, 2, 3, 4}), ElementsAre(RegionId{3}, RegionId{0}));
  EXPECT_THAT(keepers(1, {1, 2, 3, 4, 5, 6}), ElementsAre(RegionId{2}, RegionId{4}));
}

TEST(Keepers, SurviveANetworkInHalves) {
  for (const std::uint32_t side : {0b0011U, 0b0101U, 0b1001U}) {
    const auto is_on_side = [&](RegionId region) { return ((side >> core::value_of(region)) & 1U) != 0; };
    for (std::uint32_t region = 0; region < 4; ++region) {
      const std::vector<RegionId> by = keepers(region, {1, 2, 3, 4});
      const bool here = is_on_side(by[0]) || is_on_side(by[1]) || is_on_side(RegionId{region});
      const bool there = !is_on_side(by[0]) || !is_on_side(by[1]) || !is_on_side(RegionId{region});
      EXPECT_TRUE(here && there) << "region " << region << ", side " << side;
    }
  }
}

TEST(Keepers, AreOnOtherHosts) {
  EXPECT_THAT(keepers(0, {1, 1, 2, 2}), ElementsAre(RegionId{2}, RegionId{3})) << "no third host: another than its own";
  EXPECT_THAT(keepers(0, {1, 1, 2, 3}), ElementsAre(RegionId{2}, RegionId{3}));
  EXPECT_THAT(keepers(0, {1, 2, 2, 2, 3, 1}), ElementsAre(RegionId{1}, RegionId{4})) << "a third one, if there is one";
}

TEST(Keepers, OnOneHostAreOtherRegions) {
  EXPECT_THAT(keepers(3, {7, 7, 7, 7}), ElementsAre(RegionId{0}, RegionId{1}));
  EXPECT_THAT(keepers(0, {7, 7}), ElementsAre(RegionId{1}));
  EXPECT_THAT(keepers(0, {7}), IsEmpty());
}

}  // namespace
}  // namespace aurasim::process
