// Who outranks whom, from when on, and what a node claims for itself.
#include "core/ranks.h"

#include <gtest/gtest.h>

#include "core/horizon.h"

namespace aurasim::core {
namespace {

constexpr RegionId kFirst{0}, kSecond{1}, kThird{2};
constexpr int kLookahead = 3;
constexpr Step kNotice = horizon::rank_notice(kLookahead);

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
  EXPECT_TRUE(seen_by(kFirst, late, {{}, once(2, 5), {}}).pulls(kSecond));
  EXPECT_FALSE(seen_by(kSecond, late, {{}, once(2, 5), {}}).pulls(kFirst));
  EXPECT_FALSE(seen_by(kFirst, late, {once(3, 9), once(2, 5), {}}).pulls(kSecond));
  EXPECT_TRUE(seen_by(kFirst, late, {once(2, 9), once(2, 5), {}}).pulls(kSecond));
  EXPECT_FALSE(seen_by(kFirst, late, {once(2, 5), once(2, 5), {}}).pulls(kSecond));
  EXPECT_FALSE(seen_by(kFirst, late, {once(RankClaim::kNothing, 9), {}, {}}).pulls(kSecond)) << "as if it had not";
}

TEST(Ranks, WhoeverYieldsIsBelowThoseWhoClaimNothing) {
  const RankClaims back = once(RankClaim::kYields, 5);
  EXPECT_TRUE(seen_by(kFirst, 1000, {back, {}, {}}).pulls(kThird));
  EXPECT_FALSE(seen_by(kSecond, 1000, {back, {}, {}}).pulls(kFirst));
  EXPECT_TRUE(seen_by(kSecond, 1000, {back, once(RankClaim::kYields, 3), {}}).pulls(kFirst)) << "both do";
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
    const std::initializer_list<RankClaims> claims = {{}, once(2, made)};
    EXPECT_EQ(seen_by(kSecond, now, claims).pulls(kFirst), now < counts) << now;
    EXPECT_EQ(seen_by(kFirst, now, claims).pulls(kSecond), now >= counts + kLookahead - 1) << now;
  }
}

TEST(Ranks, AreChangingFromBeforeAClaimCountsUntilThePullsHaveTurned) {
  const Step counts = 100 + kNotice;
  for (Step now = 100; now < counts + 20; ++now) {
    const bool near = now >= counts - 4 * kLookahead - 1 && now < counts + kLookahead;
    EXPECT_EQ(seen_by(kFirst, now, {{}, once(2, 100), {}}).changing(), near) << now;
    EXPECT_EQ(seen_by(kThird, now, {{}, once(2, 100), {}}).changing(), near) << "of two others, " << now;
    EXPECT_FALSE(seen_by(kFirst, now, {once(2, 100), {}, {}}).changing()) << "it was the first already";
  }
}

TEST(Ranks, ChangeIsKnownToAllBeforeItMatters) {
  for (int k = 1; k < 10; ++k) EXPECT_LE(k, horizon::rank_notice(k) - horizon::before_ranks_change(k) - k);
}

class Claimer : public ::testing::Test {
 protected:
  using LargeClusters = RankClaimer::LargeClusters;
  static constexpr std::uint8_t kNothing = RankClaim::kNothing, kYields = RankClaim::kYields;
  RankClaimer claimer_{kSecond, kLookahead, 0}, near_sighted_{kSecond, 1, 0};
  RankClaims of_first_;
  std::uint8_t weight_after(Step now, const LargeClusters& large) { return weight_after(claimer_, now, large); }
  std::uint8_t weight_after(RankClaimer& claimer, Step now, const LargeClusters& large) const {
    claimer.reconsider(now, large, seen_by(kSecond, now, {of_first_, claimer.claims()}));
    return claimer.claims().next.weight;
  }
  /// Guests that stay from one step to another, where K = 1.
  std::uint8_t weight_with_guests(Step first, Step last, const LargeClusters& large) {
    for (Step now = first; now < last; ++now) weight_after(near_sighted_, now, large);
    return weight_after(near_sighted_, last, large);
  }
};

TEST_F(Claimer, ClaimsNothingForSmallClusters) {
  EXPECT_EQ(weight_after(10, {255, 0}), kNothing);
  EXPECT_EQ(claimer_.claims().next.stamp, 0);
}

TEST_F(Claimer, ClaimsMoreForTwiceAsMany) {
  EXPECT_EQ(weight_after(10, {256, 0}), kNothing + 1);
  EXPECT_EQ(claimer_.claims().next.stamp, 10);
  EXPECT_EQ(weight_after(1000, {511, 0}), kNothing + 1);
  EXPECT_EQ(weight_after(1010, {512, 0}), kNothing + 2);
  EXPECT_EQ(claimer_.claims().held.weight, kNothing + 1);
  EXPECT_EQ(claimer_.claims().held.stamp, 10);
}

TEST_F(Claimer, MakesOneChangeAtATime) {
  EXPECT_EQ(weight_after(0, {256, 0}), 2);
  EXPECT_EQ(weight_after(1, {5'000, 0}), 2) << "the first one does not count yet";
  EXPECT_EQ(weight_after(kNotice + 2 * kLookahead - 1, {5'000, 0}), 2);
  EXPECT_EQ(weight_after(kNotice + 2 * kLookahead, {5'000, 0}), 6);
}

TEST_F(Claimer, TakesTheFirstPlaceOnlyWithMuchMore) {
  of_first_ = once(3, 5);
  EXPECT_EQ(weight_after(100, {2047, 0}), kNothing) << "2 to 4 times as many";
  EXPECT_EQ(weight_after(110, {2048, 0}), 5);
  of_first_ = once(7, 120);
  EXPECT_EQ(weight_after(200, {10'000, 0}), 5) << "the other one has taken it back";
}

TEST_F(Claimer, SaysOnTheFirstPlaceHowMuchItHas) {
  of_first_ = once(3, 50);
  EXPECT_EQ(weight_after(100, {2048, 0}), 5);
  EXPECT_EQ(weight_after(200, {4096, 0}), 6);
}

TEST_F(Claimer, GivesUpOnlyWhatItHasNotHadForLong) {
  EXPECT_EQ(weight_after(0, {1024, 0}), 4);
  EXPECT_EQ(weight_after(1000, {256, 0}), 4) << "nearly as large";
  EXPECT_EQ(weight_after(1300, {10, 0}), 4);
  EXPECT_EQ(weight_after(2200, {10, 0}), 4);
  EXPECT_EQ(weight_after(2201, {10, 0}), kNothing);
}

TEST_F(Claimer, YieldsWhenGuestsStay) {
  EXPECT_EQ(weight_with_guests(0, 99, {1400, 0}), 4);
  EXPECT_EQ(weight_with_guests(100, 105, {1400, 1400}), 4) << "they may go by themselves";
  EXPECT_EQ(weight_with_guests(106, 107, {1400, 255}), 4) << "as most of them did";
  EXPECT_EQ(weight_with_guests(108, 116, {1400, 1400}), 4);
  EXPECT_EQ(weight_with_guests(117, 117, {1400, 1400}), kYields);
  EXPECT_EQ(weight_with_guests(118, 300, {1400, 1400}), kYields);
}

TEST_F(Claimer, ThatHasYieldedWaitsUntilTheOtherHasClaimed) {
  EXPECT_EQ(weight_with_guests(0, 99, {1400, 0}), 4);
  EXPECT_EQ(weight_with_guests(100, 150, {1400, 1400}), kYields);
  EXPECT_EQ(weight_with_guests(151, 200, {1400, 0}), kYields);
  of_first_ = once(4, 198);
  EXPECT_EQ(weight_with_guests(201, 201, {1400, 0}), kNothing) << "it has no more than the other";
}

TEST_F(Claimer, DoesNotYieldWhereKIsLarger) {
  for (Step now = 0; now < 100; ++now) EXPECT_EQ(weight_after(now, {1400, now < 50 ? 0u : 1400u}), 4) << now;
}

TEST_F(Claimer, ThatHasYieldedDoesNotWaitForEver) {
  EXPECT_EQ(weight_with_guests(0, 99, {1400, 0}), 4);
  EXPECT_EQ(weight_with_guests(100, 150, {1400, 1400}), kYields);
  EXPECT_EQ(weight_with_guests(151, 270, {10, 0}), kYields);
  EXPECT_EQ(weight_with_guests(271, 271, {10, 0}), kNothing);
}

}  // namespace
}  // namespace aurasim::core
