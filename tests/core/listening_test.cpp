// Two regions that are introduced listen to each other from the same state on, and until the same state.
#include "core/listening.h"

#include <algorithm>
#include <array>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "core/horizon.h"

namespace aurasim::core::testing {
namespace {

constexpr RegionId kOne{0}, kOther{3}, kBetween{1};
constexpr Introduction kPair{kOne, kOther};

/// One of two regions of a row of four that are not near each other.
class Side {
 public:
  Side(RegionId self, int lookahead, Step start, std::span<const Listened> earlier = {})
      : vicinity_(map_, self, 0),
        intake_({.lookahead = lookahead, .start = start}, vicinity_, departures_),
        listening(vicinity_, intake_, lookahead, start, earlier, true) {
    listening.add(earlier);
  }
  void receive(Step stamp, RegionId by = kBetween) {
    const Neighbour::Introduced introduced{stamp, kPair, by};
    listening.receive({&introduced, 1});
  }
  bool hears(RegionId other) const { return vicinity_.is_neighbour(other); }

 private:
  RegionMap map_ = RegionMap::columns(4, 10);
  Vicinity vicinity_;
  DepartureLedger departures_;
  Intake intake_;

 public:
  Listening listening;
};

TEST(Listening, EndsSomeTimeAfterTheLastIntroduction) {
  constexpr int kK = 2;
  Side side(kOne, kK, 0);
  for (Step now = 1; now < 400; ++now) {
    if (now >= 10 + kK && now <= 100 + kK) side.receive(now - kK);
    side.listening.begin(now);
    const Step begin = 10 + horizon::introduction(kK), end = 100 + horizon::listening(kK) + kK;
    EXPECT_EQ(side.hears(kOther), now >= begin && now < end) << now;
  }
}

TEST(Listening, NeverEndsBetweenRegionsNearEachOther) {
  Side side(kOne, 2, 0);
  for (Step now = 1; now < 1000; ++now) side.listening.begin(now);
  EXPECT_TRUE(side.hears(kBetween));
}

/// A region whose batch may be the last hands nothing over that has to be acknowledged.
TEST(Listening, IsKnownToStayUntilWhatIsHandedOverHasBeenAcknowledged) {
  constexpr int kK = 3;
  const Listened from_start{kOther, 0, {}};
  Side side(kOne, kK, 0, {&from_start, 1});
  std::vector<Step> stays;
  Step end = 0;
  for (Step now = 1; now < 400; ++now) {
    side.listening.begin(now);
    if (side.hears(kOther) && side.listening.stays(kOther, now)) stays.push_back(now);
    if (!side.hears(kOther) && end == 0) end = now;
  }
  ASSERT_GT(end, 0);
  ASSERT_FALSE(stays.empty());
  EXPECT_LT(stays.back() + kK, end) << "the batch that acknowledges it is published before";
  EXPECT_TRUE(side.listening.stays(kBetween, 10'000)) << "near";
}

/// Introductions of several others, which each side receives when it likes, at most K states late.
class Agreement : public ::testing::TestWithParam<int> {};

TEST_P(Agreement, BothSidesListenInTheSameStates) {
  std::mt19937 random(static_cast<unsigned>(GetParam()));
  const auto up_to = [&](int most) { return std::uniform_int_distribution<int>(0, most)(random); };
  const int K = 1 + up_to(5);
  std::array<Side, 2> sides{Side(kOne, K, 0), Side(kOther, K, 0)};
  std::array<std::multimap<Step, Step>, 2> to_come;  // stamps, by the state that receives them
  int changes = 0;
  bool listened = false;
  constexpr Step kStates = 1500, kBack = 20;
  for (Step now = 1; now < kStates; ++now) {
    const bool is_time = (now / 200) % 2 == 0 && up_to(20) == 0;
    for (std::size_t i = 0; i < 2; ++i) {
      if (is_time) to_come[i].emplace(now + 1 + up_to(K - 1), now);
      for (auto it = to_come[i].begin(); it != to_come[i].end() && it->first <= now; it = to_come[i].erase(it)) {
        sides[i].receive(it->second);
      }
      sides[i].listening.begin(now);
    }
    const bool listens = sides[0].hears(kOther);
    ASSERT_EQ(listens, sides[1].hears(kOne)) << "state " << now << ", K = " << K;
    changes += listens != listened;
    listened = listens;
    // A redo puts each side back when it knows of it, some states after the state that it names.
    if (now <= kBack) continue;
    const Step then = now - kBack;
    const auto others = [&](const Side& side, RegionId other) {
      const std::vector<Listened> all = side.listening.agreed(then, then - 40);
      return std::ranges::any_of(all, [other](const Listened& who) { return who.region == other; });
    };
    ASSERT_EQ(others(sides[0], kOther), others(sides[1], kOne)) << "state " << now << ", K = " << K;
  }
  EXPECT_GE(changes, 2) << "or nothing was tested";
}

/// A side answers the same of a state whenever it is asked, so it does not matter which side is further.
TEST_P(Agreement, DoesNotDependOnWhenItIsAsked) {
  std::mt19937 random(static_cast<unsigned>(GetParam()));
  const auto up_to = [&](int most) { return std::uniform_int_distribution<int>(0, most)(random); };
  const int K = 1 + up_to(5);
  Side side(kOne, K, 0);
  std::map<Step, bool> asked_first;
  constexpr Step kLater = 12;
  for (Step now = 1; now < 1500; ++now) {
    if ((now / 200) % 2 == 0 && now > K && up_to(20) == 0) side.receive(now - K);
    side.listening.begin(now);
    const auto hears_in = [&](Step then) {
      const std::vector<Listened> all = side.listening.agreed(then, then - 30);
      return std::ranges::any_of(all, [](const Listened& who) { return who.region == kOther; });
    };
    asked_first[now] = hears_in(now);
    if (now <= kLater) continue;
    ASSERT_EQ(hears_in(now - kLater), asked_first[now - kLater]) << "of state " << now - kLater << ", K = " << K;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, Agreement, ::testing::Range(0, 40));

}  // namespace
}  // namespace aurasim::core::testing
