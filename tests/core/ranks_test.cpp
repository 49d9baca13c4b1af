// Who outranks whom, from when on, and what a node claims for itself.
#include "core/ranks.h"

#include <gtest/gtest.h>

namespace aurasim::core {
namespace {

constexpr RegionId kFirst{0}, kSecond{1}, kThird{2};
constexpr int kLookahead = 3;
constexpr Step kNotice = rank_notice(kLookahead);

RankClaims once(std::uint8_t weight, Step stamp) { return {{}, {weight, stamp}}; }

/// As node `self` sees them; the others have made `others`, in order of region from kFirst on.
Ranks seen_by(RegionId self, Step now, std::initializer_list<RankClaims> claims) {
  Ranks ranks(kLookahead);
  ranks.begin(now, self, *(claims.begin() + value_of(self)));
  std::uint32_t region = 0;
  for (const RankClaims& claim : claims) {
    if (RegionId{region} != self) ranks.add(RegionId{region}, claim);
    ++region;
  }
  return ranks;
}

TEST(Ranks, AreThoseOfTheRegionsWhereNobodyClaims) {
  const Ranks ranks = seen_by(kSecond, 100, {{}, {}, {}});
  EXPECT_TRUE(ranks.pulls(kFirst));
  EXPECT_FALSE(ranks.pulls(kSecond));
  EXPECT_FALSE(ranks.pulls(kThird));
  EXPECT_TRUE(ranks.outranks(kFirst, kThird));
  EXPECT_FALSE(ranks.changing());
}

TEST(Ranks, MoreWeightIsHigherAndOfEqualOnesTheOlderClaim) {
  const Step late = 1000;
  EXPECT_TRUE(seen_by(kFirst, late, {{}, once(1, 5), {}}).pulls(kSecond));
  EXPECT_FALSE(seen_by(kSecond, late, {{}, once(1, 5), {}}).pulls(kFirst));
  EXPECT_FALSE(seen_by(kFirst, late, {once(2, 9), once(1, 5), {}}).pulls(kSecond));
  EXPECT_TRUE(seen_by(kFirst, late, {once(1, 9), once(1, 5), {}}).pulls(kSecond));
  EXPECT_FALSE(seen_by(kFirst, late, {once(1, 5), once(1, 5), {}}).pulls(kSecond));
  EXPECT_FALSE(seen_by(kFirst, late, {once(0, 9), once(0, 5), {}}).pulls(kSecond)) << "as if nobody had claimed";
}

TEST(Ranks, TwoNodesNeverPullFromEachOther) {
  for (Step now = 90; now < 130 + kNotice; ++now) {
    for (const RankClaims& a : {once(2, 97), RankClaims{{2, 60}, {0, 99}}}) {
      for (const RankClaims& b : {once(1, 100), RankClaims{{3, 50}, {1, 110}}}) {
        EXPECT_FALSE(seen_by(kFirst, now, {a, b}).pulls(kSecond) && seen_by(kSecond, now, {a, b}).pulls(kFirst));
      }
    }
  }
}

TEST(Ranks, AClaimCountsAfterItsNoticeAndPullsWhenAllIsQuiet) {
  const Step made = 100, counts = made + kNotice;
  for (Step now = made; now < counts + 20; ++now) {
    const std::initializer_list<RankClaims> claims = {{}, once(1, made)};
    EXPECT_EQ(seen_by(kSecond, now, claims).pulls(kFirst), now < counts) << now;
    EXPECT_EQ(seen_by(kFirst, now, claims).pulls(kSecond), now >= counts + kLookahead - 1) << now;
  }
}

TEST(Ranks, AreChangingFromBeforeAClaimCountsUntilThePullsHaveTurned) {
  const Step counts = 100 + kNotice;
  for (Step now = 100; now < counts + 20; ++now) {
    const bool near = now >= counts - 4 * kLookahead - 1 && now < counts + kLookahead;
    EXPECT_EQ(seen_by(kFirst, now, {{}, once(1, 100), {}}).changing(), near) << now;
    EXPECT_EQ(seen_by(kThird, now, {{}, once(1, 100), {}}).changing(), near) << "of two others, " << now;
    EXPECT_FALSE(seen_by(kFirst, now, {once(1, 100), {}, {}}).changing()) << "it was the first already";
  }
}

TEST(Ranks, ChangeIsKnownToAllBeforeItMatters) {
  for (int k = 1; k < 10; ++k) EXPECT_LE(k, rank_notice(k) - 4 * k - 1 - k);
}

class Claimer : public ::testing::Test {
 protected:
  RankClaimer claimer_{kSecond, kLookahead, 0};
  std::uint8_t weight_after(Step now, std::size_t bodies) {
    claimer_.reconsider(now, bodies);
    return claimer_.claims().next.weight;
  }
};

TEST_F(Claimer, ClaimsNothingForSmallClusters) {
  EXPECT_EQ(weight_after(10, 255), 0);
  EXPECT_EQ(claimer_.claims().next.stamp, 0);
}

TEST_F(Claimer, ClaimsMoreForFourTimesAsMany) {
  EXPECT_EQ(weight_after(10, 256), 1);
  EXPECT_EQ(claimer_.claims().next.stamp, 10);
  EXPECT_EQ(weight_after(1000, 1023), 1);
  EXPECT_EQ(weight_after(1010, 1024), 2);
  EXPECT_EQ(claimer_.claims().held.weight, 1);
  EXPECT_EQ(claimer_.claims().held.stamp, 10);
}

TEST_F(Claimer, MakesOneChangeAtATime) {
  EXPECT_EQ(weight_after(0, 256), 1);
  EXPECT_EQ(weight_after(1, 100'000), 1) << "the first one does not count yet";
  EXPECT_EQ(weight_after(kNotice + 2 * kLookahead - 1, 100'000), 1);
  EXPECT_EQ(weight_after(kNotice + 2 * kLookahead, 100'000), 5);
}

TEST_F(Claimer, GivesUpOnlyWhatItHasNotHadForLong) {
  EXPECT_EQ(weight_after(0, 1024), 2);
  EXPECT_EQ(weight_after(200, 256), 2) << "nearly as large";
  EXPECT_EQ(weight_after(300, 10), 2);
  EXPECT_EQ(weight_after(440, 10), 2);
  EXPECT_EQ(weight_after(441, 10), 0);
}

}  // namespace
}  // namespace aurasim::core
