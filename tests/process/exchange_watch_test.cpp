// When a node says that its exchanges are too long for coupled regions.
#include "process/exchange_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using core::RegionId;
using ::testing::HasSubstr;

class ExchangeWatchTest : public ::testing::Test {
 protected:
  /// Computes states for so long, each with ten exchanges, and returns what was said.
  std::vector<std::string> compute(ExchangeWatch::Clock::duration time, double exchange_s) {
    std::vector<std::string> said;
    const std::vector<double> seconds(10, exchange_s);
    for (const auto end = now_ + time; now_ < end; now_ += 20ms) {
      if (auto text = watch_.note(seconds, RegionId{2}, 8 * exchange_s, 0.3e-3, now_)) said.push_back(*text);
    }
    return said;
  }

  ExchangeWatch watch_;
  ExchangeWatch::Clock::time_point now_{100s};
};

TEST_F(ExchangeWatchTest, ShortExchangesAreNoMessage) { EXPECT_TRUE(compute(60s, 0.2e-3).empty()); }

TEST_F(ExchangeWatchTest, ABusyMomentIsNoMessage) {
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(compute(3s, 2e-3).empty());
    EXPECT_TRUE(compute(3s, 0.2e-3).empty());
  }
}

TEST_F(ExchangeWatchTest, LongExchangesAreSaidOnceWithTheRegionAndTheKey) {
  compute(10s, 0.2e-3);
  const std::vector<std::string> said = compute(60s, 2e-3);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_THAT(said[0], HasSubstr("takes 2 ms"));
  EXPECT_THAT(said[0], HasSubstr("more than 0.3 ms (exchange_limit)"));
  EXPECT_THAT(said[0], HasSubstr("longest for region 2"));
  EXPECT_THAT(said[0], HasSubstr("exchange: aura"));
}

}  // namespace
}  // namespace aurasim::process
