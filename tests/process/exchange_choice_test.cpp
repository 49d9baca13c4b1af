// What `exchange: auto` means, from the round trips that the lead has measured.
#include "process/exchange_choice.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using config::Exchange;
using core::RegionId;
using Clock = RoundTripBook::Clock;
using ::testing::HasSubstr;

/// A lead that asks over links with given round trips.
class ExchangeChoiceTest : public ::testing::Test {
 protected:
  struct Link {
    Clock::duration round_trip{};
    int loses_each = 0;  ///< each so many-th question gets no answer; 0: all are answered
    Clock::duration absent_for{};
  };

  /// Asks until the book is complete, or for a minute.
  RoundTrip measure(const std::vector<Link>& links) {
    RoundTripBook book(links.size() + 1);
    std::vector<std::tuple<Clock::time_point, RegionId, std::uint32_t>> answers;
    for (; !book.is_complete(now_) && now_ < kBegin + 60s; now_ += 50us) {
      std::erase_if(answers, [&](const auto& answer) {
        const auto& [at, region, number] = answer;
        if (at > now_) return false;
        book.note_answer(region, number, now_);
        return true;
      });
      for (const auto& [region, number] : book.take_due(now_)) {
        ++questions_;
        const Link& link = links[core::value_of(region) - 1];
        const bool is_lost = link.loses_each != 0 && number % static_cast<std::uint32_t>(link.loses_each) == 0;
        if (!is_lost && now_ >= kBegin + link.absent_for) answers.emplace_back(now_ + link.round_trip, region, number);
      }
    }
    EXPECT_TRUE(book.is_complete(now_));
    return book.slowest();
  }

  static constexpr Clock::time_point kBegin{100s};
  Clock::time_point now_ = kBegin;
  std::size_t questions_ = 0;
};

TEST_F(ExchangeChoiceTest, ShortRoundTripsMeanCoupledAndOneLongOneMeansAura) {
  const RoundTrip near = measure({{100us}, {200us}, {150us}});
  EXPECT_EQ(near.region, RegionId{2});
  EXPECT_NEAR(near.quartile_s, 200e-6, 60e-6);
  EXPECT_EQ(near.lost, 0);
  EXPECT_EQ(choose_exchange(near, 0.3e-3), Exchange::kCoupled);
  const RoundTrip far = measure({{100us}, {200us}, {5ms}});
  EXPECT_EQ(far.region, RegionId{3});
  EXPECT_EQ(choose_exchange(far, 0.3e-3), Exchange::kAura);
}

TEST_F(ExchangeChoiceTest, ALinkThatLosesMessagesMeansAura) {
  const RoundTrip sound = measure({{100us, 0}}), lossy = measure({{100us, 4}});
  EXPECT_EQ(choose_exchange(sound, 0.3e-3), Exchange::kCoupled);
  EXPECT_NEAR(lossy.lost, 0.25, 0.06);
  EXPECT_EQ(choose_exchange(lossy, 0.3e-3), Exchange::kAura);
}

TEST_F(ExchangeChoiceTest, ANodeThatComesLateHasLostNothing) {
  const RoundTrip late = measure({{100us, 0, 3s}});
  EXPECT_GE(now_, kBegin + 3s);
  EXPECT_EQ(late.lost, 0);
  EXPECT_NEAR(late.quartile_s, 100e-6, 60e-6);
}

TEST_F(ExchangeChoiceTest, ALinkSlowerThanTheLeadsPatienceIsMeasuredAllTheSame) {
  const RoundTrip slow = measure({{90ms}});
  EXPECT_NEAR(slow.quartile_s, 0.09, 0.001);
  EXPECT_EQ(choose_exchange(slow, 0.3e-3), Exchange::kAura);
}

TEST_F(ExchangeChoiceTest, QuestionsAreFew) {
  measure({{100us}, {100us}});
  EXPECT_LE(questions_, 2 * (RoundTripBook::kQuestions + 1));
}

TEST_F(ExchangeChoiceTest, TheLogNamesTheSlowestLinkAndTheKey) {
  const RoundTrip far{RegionId{3}, 0.005, 0.1};
  EXPECT_THAT(words_of_choice(Exchange::kAura, far, 0.000245),
              HasSubstr("means aura: the slowest round trip, to region 3, takes 5 ms, and 10% of the messages"));
  EXPECT_THAT(words_of_choice(Exchange::kAura, far, 0.000245), HasSubstr("up to 0.245 ms (exchange_limit)"));
}

TEST_F(ExchangeChoiceTest, TheLogSaysHowFarBordersAreMovedAndHowNotTo) {
  config::Launch launch;
  launch.regions = core::RegionMap::columns(8, 40);
  launch.physics.block_m = 16;
  EXPECT_EQ(words_of_moved_borders(launch),
            "coupled regions consist of whole blocks of 16 m: borders are moved by up to 8 m; physics.block: 10 moves "
            "none");
  launch.physics.block_m = 10;
  EXPECT_EQ(words_of_moved_borders(launch), "");
}

TEST_F(ExchangeChoiceTest, ANodeThatComesLaterTakesWhatLiveNodesOfItsRunUse) {
  std::map<RegionId, messages::SeenStatus> nodes;
  const auto add = [&](std::uint32_t region, messages::ExchangeInUse exchange, std::uint64_t agreement, bool lost) {
    messages::SeenStatus& seen = nodes[RegionId{region}];
    seen.status.exchange = exchange;
    seen.status.agreement = agreement;
    seen.lost = lost;
  };
  add(0, messages::ExchangeInUse::kCoupled, 7, true);
  add(1, messages::ExchangeInUse::kCoupled, 8, false);
  add(2, messages::ExchangeInUse::kNotChosen, 7, false);
  EXPECT_EQ(chosen_by_others(nodes, 7), messages::ExchangeInUse::kNotChosen)
      << "one is lost, one is of another run, and one has not chosen";
  add(3, messages::ExchangeInUse::kAura, 7, false);
  EXPECT_EQ(chosen_by_others(nodes, 7), messages::ExchangeInUse::kAura);
}

}  // namespace
}  // namespace aurasim::process
