// Which datagrams are lost and when the others leave: in virtual time, with no thread and no socket.
#include "dds/impairment.h"

#include <algorithm>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dds/impairment_properties.h"
#include "dds/settings.h"

namespace aurasim::dds {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using namespace std::chrono_literals;
using Fate = ImpairedLink::Fate;
using Time = ImpairedLink::Time;

constexpr std::uint64_t kHere = 1;
constexpr std::uint64_t kThere = 2;

/// The lateness of `count` datagrams offered `apart` from each other; nothing for those that do not leave.
std::vector<std::optional<Time>> lateness(const Impairment& impairment, int count, Time apart = 20ms,
                                          std::uint64_t stream = 1) {
  ImpairedLink link(impairment, stream);
  std::vector<std::optional<Time>> late;
  for (int i = 0; i < count; ++i) {
    const auto [fate, due] = link.offer(i * apart, kHere, 100);
    late.push_back(fate == Fate::kWaits ? std::optional(due - i * apart) : std::nullopt);
    if (fate == Fate::kWaits) link.leave(100);
  }
  return late;
}

/// How many datagrams would leave before one that was offered earlier.
int overtaken(const Impairment& impairment) {
  ImpairedLink link(impairment, 1);
  Time last{0};
  int count = 0;
  for (int i = 0; i < 1000; ++i) {
    const Time due = link.offer(i * 1ms, kHere, 100).due;
    count += due < last;
    last = std::max(due, last);
  }
  return count;
}

int lost(const Impairment& impairment, std::uint64_t stream = 1) {
  ImpairedLink link(impairment, stream);
  for (int i = 0; i < 10'000; ++i) link.offer(i * 1ms, kHere, 100);
  return static_cast<int>(link.counters().lost);
}

TEST(ImpairedLink, IsNotThereWhenNothingIsAskedFor) {
  EXPECT_FALSE(Impairment{}.any());
  EXPECT_FALSE((Impairment{.reorder = true, .discovery = true, .seed = 7}).any());
  EXPECT_TRUE(Impairment{.delay_s = 0.001}.any());
  EXPECT_TRUE(Impairment{.jitter_s = 0.001}.any());
  EXPECT_TRUE(Impairment{.loss = 0.001}.any());
  EXPECT_TRUE(Impairment{.bandwidth_B_s = 1}.any());
}

TEST(ImpairedLink, DelaysEachByTheSame) {
  for (const auto& late : lateness({.delay_s = 0.008}, 100)) EXPECT_EQ(late, 8ms);
}

TEST(ImpairedLink, JittersEvenlyAroundTheDelay) {
  const auto late = lateness({.delay_s = 0.016, .jitter_s = 0.005}, 10'000);
  Time sum{0};
  for (const auto& one : late) {
    ASSERT_TRUE(one);
    EXPECT_GE(*one, 11ms);
    EXPECT_LE(*one, 21ms);
    sum += *one;
  }
  EXPECT_GT(*std::ranges::max_element(late), 20'900us);
  EXPECT_LT(*std::ranges::min_element(late), 11'100us);
  EXPECT_NEAR(static_cast<double>((sum / 10'000).count()), 16e6, 0.1e6);
}

TEST(ImpairedLink, IsNeverEarly) {
  for (const auto& late : lateness({.delay_s = 0.001, .jitter_s = 0.005}, 1000)) EXPECT_GE(late, 0ns);
}

TEST(ImpairedLink, KeepsTheOrderUnlessToldOtherwise) {
  EXPECT_EQ(overtaken({.delay_s = 0.016, .jitter_s = 0.005}), 0);
  EXPECT_GT(overtaken({.delay_s = 0.016, .jitter_s = 0.005, .reorder = true}), 100);
}

TEST(ImpairedLink, KeepsTheOrderPerDestination) {
  ImpairedLink link({.delay_s = 0.01, .jitter_s = 0.01}, 1);
  Time here{0};
  while (here < 19ms) here = link.offer(0ns, kHere, 100).due;  // whoever follows there is as late
  EXPECT_GE(link.offer(0ns, kHere, 100).due, here);
  int earlier = 0;
  for (std::uint64_t elsewhere = kThere; elsewhere < kThere + 100; ++elsewhere) {
    earlier += link.offer(0ns, elsewhere, 100).due < here;
  }
  EXPECT_GT(earlier, 50);
}

TEST(ImpairedLink, LosesTheShareThatItShould) {
  EXPECT_EQ(lost({.loss = 0}), 0);
  EXPECT_NEAR(lost({.loss = 0.1}), 1000, 100);
  EXPECT_NEAR(lost({.delay_s = 0.008, .loss = 0.5}), 5000, 200);
  EXPECT_EQ(lost({.loss = 1}), 10'000);
}

TEST(ImpairedLink, LetsWhatIsOnlyAtRiskLeaveAtOnce) {
  ImpairedLink link({.loss = 0.5}, 1);
  for (int i = 0; i < 100; ++i)
    EXPECT_THAT(link.offer(0ns, kHere, 1).fate, ::testing::AnyOf(Fate::kLeavesNow, Fate::kLost));
  EXPECT_EQ(link.counters().passed + link.counters().lost, 100U);
  EXPECT_EQ(link.counters().queued, 0U);
}

TEST(ImpairedLink, SendsNoFasterThanItsBandwidth) {
  ImpairedLink link({.delay_s = 0.002, .bandwidth_B_s = 1e6}, 1);
  EXPECT_EQ(link.offer(0ms, kHere, 1000).due, 3ms);   // 1 ms to send, 2 ms to fly
  EXPECT_EQ(link.offer(0ms, kThere, 1000).due, 4ms);  // one link for all destinations
  EXPECT_EQ(link.offer(1ms, kHere, 5000).due, 9ms);
  EXPECT_EQ(link.offer(100ms, kHere, 1000).due, 103ms);  // an idle link saves nothing up
}

TEST(ImpairedLink, DropsWhatDoesNotFitAnyMore) {
  ImpairedLink link({.delay_s = 1}, 1);
  const std::size_t half = ImpairedLink::kMostQueuedBytes / 2;
  EXPECT_EQ(link.offer(0ns, kHere, half).fate, Fate::kWaits);
  EXPECT_EQ(link.offer(0ns, kHere, half).fate, Fate::kWaits);
  EXPECT_EQ(link.offer(0ns, kHere, 1).fate, Fate::kOverflows);
  EXPECT_EQ(link.counters().overflowed, 1U);
  EXPECT_EQ(link.counters().queued, 2U);
  link.leave(half);
  EXPECT_EQ(link.offer(0ns, kHere, 1).fate, Fate::kWaits);
  EXPECT_EQ(link.counters().delayed, 3U);
  EXPECT_EQ(link.counters().queued_bytes, half + 1);
}

TEST(ImpairedLink, DoesTheSameAgainWithTheSameSeed) {
  const Impairment bad{.delay_s = 0.016, .jitter_s = 0.005, .loss = 0.1, .seed = 42};
  Impairment other = bad;
  other.seed = 43;
  EXPECT_EQ(lateness(bad, 1000), lateness(bad, 1000));
  EXPECT_NE(lateness(bad, 1000), lateness(other, 1000));
}

TEST(ImpairedLink, DoesSomethingElseForEachNode) {
  const Impairment bad{.delay_s = 0.016, .jitter_s = 0.005, .loss = 0.1, .seed = 42};
  EXPECT_NE(lateness(bad, 1000, 20ms, 1), lateness(bad, 1000, 20ms, 2));
}

TEST(MetatrafficPorts, AreTheMulticastOneAndEverySecondOfTheDomain) {
  const MetatrafficPorts ports{.servers = {11811}};
  EXPECT_TRUE(ports.is_discovery(true, 7400));
  EXPECT_TRUE(ports.is_discovery(false, 7410));
  EXPECT_FALSE(ports.is_discovery(false, 7411));
  EXPECT_TRUE(ports.is_discovery(false, 7648));
  EXPECT_FALSE(ports.is_discovery(false, 7660)) << "of the next domain";
  EXPECT_TRUE(ports.is_discovery(false, 11811));
  EXPECT_FALSE(ports.is_discovery(false, 11812));
}

TEST(ImpairmentOverrides, WinFieldByField) {
  const Impairment profile{.delay_s = 0.008, .loss = 0.1, .seed = 3};
  const Impairment both = ImpairmentOverrides{.delay_s = 0.0, .jitter_s = 0.005}.over(profile);
  EXPECT_EQ(both.delay_s, 0);
  EXPECT_EQ(both.jitter_s, 0.005);
  EXPECT_EQ(both.loss, 0.1);
  EXPECT_EQ(both.seed, 3U);
}

Impairment from(const std::string& name, const std::string& value) {
  eprosima::fastrtps::rtps::PropertyPolicy policy;
  policy.properties().emplace_back("some.other.property", "left alone");
  policy.properties().emplace_back("aurasim.impair." + name, value);
  return impairment_in(policy, "bad.xml");
}

std::string error_of(const std::string& name, const std::string& value) {
  try {
    from(name, value);
  } catch (const DdsError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ImpairmentProperties, AreReadByName) {
  EXPECT_EQ(from("delay", "0.008").delay_s, 0.008);
  EXPECT_EQ(from("jitter", "0.005").jitter_s, 0.005);
  EXPECT_EQ(from("loss", "0.1").loss, 0.1);
  EXPECT_EQ(from("bandwidth", "1e6").bandwidth_B_s, 1e6);
  EXPECT_TRUE(from("reorder", "true").reorder);
  EXPECT_TRUE(from("discovery", "true").discovery);
  EXPECT_EQ(from("seed", "9").seed, 9U);
}

TEST(ImpairmentProperties, ThatCannotBeUsedAreNamedWithWhatIsAllowed) {
  EXPECT_EQ(error_of("delay", "8 ms"), "bad.xml: aurasim.impair.delay: found \"8 ms\", allowed: a number from 0 to 10");
  EXPECT_EQ(error_of("loss", "1.5"), "bad.xml: aurasim.impair.loss: found \"1.5\", allowed: a number from 0 to 1");
  EXPECT_THAT(error_of("loss", "nan"), HasSubstr("allowed: a number"));
  EXPECT_THAT(error_of("jitter", "-1"), HasSubstr("allowed: a number"));
  EXPECT_THAT(error_of("seed", "1.5"), HasSubstr("allowed: an integer"));
  EXPECT_THAT(error_of("reorder", "yes"), HasSubstr("found \"yes\", allowed: true, false"));
  EXPECT_THAT(error_of("dealy", "0"), AllOf(HasSubstr("bad.xml: aurasim.impair.dealy: unknown"), HasSubstr("delay,")));
}

}  // namespace
}  // namespace aurasim::dds
