// Regions that talk over DDS and a network that is made worse, by settings and by the files in qos/impaired/.
#include <algorithm>
#include <thread>
#include <vector>

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dds/domain.h"
#include "dds/impairment_properties.h"
#include "dds/wire_transport.h"
#include "transport_fixture.h"

namespace aurasim::dds {
namespace {

using testing::Peer;
using testing::take_until;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

Settings impaired_settings(const ImpairmentOverrides& impairment, std::uint64_t stream) {
  Settings settings = testing::settings_for(own_domain());
  settings.impairment = impairment;
  settings.impairment_stream = stream;
  return settings;
}

/// Region 0 sends to region 1.
struct Pair {
  explicit Pair(const ImpairmentOverrides& impairment)
      : Pair(impaired_settings(impairment, 1), impaired_settings(impairment, 2)) {}
  Pair(const Settings& of_from, const Settings& of_to) : from(of_from, 0, {1}), to(of_to, 1, {0}) {
    std::jthread other([&] { from.transport.wait_until_matched(testing::kDeadline); });
    to.transport.wait_until_matched(testing::kDeadline);
  }

  /// Shortest time from sending to having a batch.
  std::chrono::nanoseconds fastest(int rounds) {
    auto shortest = Clock::duration::max();
    for (int i = 0; i < rounds; ++i) {
      const std::size_t there = to.inbox.auras.size();
      const auto sent = Clock::now();
      from.send_batch(i);
      EXPECT_TRUE(take_until(to, [&] { return to.inbox.auras.size() > there; }));
      shortest = std::min(shortest, Clock::now() - sent);
    }
    return shortest;
  }

  Peer from, to;
};

double milliseconds(std::chrono::nanoseconds time) { return std::chrono::duration<double, std::milli>(time).count(); }

TEST(ImpairedRegions, HearEachOtherAsLateAsAskedFor) {
  for (const double delay_ms : {0.0, 2.0, 8.0, 16.0}) {
    Pair pair({.delay_s = delay_ms / 1e3});
    double fastest_ms = milliseconds(pair.fastest(60));
    // A machine that is busy with something else adds to it; it cannot take away.
    for (int again = 0; again < 4 && fastest_ms > delay_ms + 2; ++again) {
      fastest_ms = std::min(fastest_ms, milliseconds(pair.fastest(60)));
    }
    EXPECT_GE(fastest_ms, delay_ms);
    EXPECT_LT(fastest_ms, delay_ms + 10) << "the delay is there once";
  }
}

TEST(ImpairedRegions, MissNothingAndKeepTheOrderThoughDatagramsAreLost) {
  Pair pair({.delay_s = 0.002, .jitter_s = 0.001, .loss = 0.2, .reorder = true, .seed = 5});
  constexpr std::size_t kSteps = 500;
  for (std::size_t step = 0; step < kSteps; ++step) pair.from.send_batch(static_cast<core::Step>(step));
  ASSERT_TRUE(take_until(pair.to, [&] { return pair.to.inbox.auras.size() >= kSteps; }));
  EXPECT_EQ(pair.to.inbox.auras.size(), kSteps);
  for (std::size_t i = 0; i < kSteps; ++i) EXPECT_EQ(pair.to.inbox.auras[i].stamp, static_cast<core::Step>(i));
  const ImpairmentCounters counters = pair.from.participant.impairment().value().datagrams;
  EXPECT_GT(counters.lost, kSteps / 10) << "or this test shows nothing";
  EXPECT_GT(counters.passed, 0U) << "discovery is spared";
}

/// More than a thousand parts, of which a tenth is lost each time: sent again as a whole it does not arrive in a
/// minute.
TEST(ImpairedRegions, SendAgainOfALargeSampleWhatIsLostOfIt) {
  Settings settings = impaired_settings({.loss = 0.1, .seed = 5}, 1);
  settings.profiles = std::filesystem::path(AURASIM_SOURCE_DIR) / "qos/hosts.xml";  // datagrams of 1400 bytes
  settings.interfaces = {"127.0.0.1"};
  Pair pair(settings, settings);
  const auto sent = [&] {
    const ImpairmentCounters counters = pair.from.participant.impairment().value().datagrams;
    return counters.lost + counters.delayed + counters.passed;
  };
  pair.fastest(5);
  const std::uint64_t before = sent();
  pair.from.send_batch(5, 20'000);
  ASSERT_TRUE(take_until(pair.to, [&] { return pair.to.inbox.auras.size() >= 6; }));
  EXPECT_LT(sent() - before, 3000U);
  EXPECT_EQ(pair.to.inbox.auras.back().updates.size(), 20'000U);
}

TEST(ImpairedRegions, MeetThoughDiscoverySuffers) {
  Pair pair({.delay_s = 0.005, .loss = 0.1, .discovery = true});
  EXPECT_EQ(pair.from.participant.impairment().value().datagrams.passed, 0U);
}

TEST(ImpairedRegions, LeaveTheTransportAloneWhenNothingIsImpaired) {
  const Domain plain(testing::settings_for(own_domain()));
  EXPECT_EQ(plain.delay_line(), nullptr);
  Settings settings = impaired_settings({.reorder = true, .seed = 3}, 1);
  EXPECT_FALSE(Participant(settings).impairment());
}

Settings shipped(const std::string& name) { return testing::settings_for(own_domain(), "impaired/" + name); }

TEST(ImpairedProfiles, ImpairByAFileAlone) {
  Participant participant(shipped("wan_16ms_jitter_loss.xml"));
  ASSERT_TRUE(participant.impairment());
  const Impairment impairment = participant.impairment()->impairment;
  EXPECT_EQ(impairment.delay_s, 0.016);
  EXPECT_EQ(impairment.jitter_s, 0.005);
  EXPECT_EQ(impairment.loss, 0.01);
  EXPECT_FALSE(impairment.reorder);
  EXPECT_FALSE(impairment.discovery);
}

TEST(ImpairedProfiles, GiveWayToSettings) {
  Settings settings = shipped("lan_8ms.xml");
  settings.impairment.delay_s = 0.001;
  settings.impairment.loss = 0.5;
  const Participant changed(settings);
  ASSERT_TRUE(changed.impairment());
  EXPECT_EQ(changed.impairment()->impairment.delay_s, 0.001);
  EXPECT_EQ(changed.impairment()->impairment.loss, 0.5);
  settings.impairment = {.delay_s = 0.0};
  EXPECT_FALSE(Participant(settings).impairment());
}

TEST(ImpairedProfiles, AreAllGoodAndStayOnLoopback) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(AURASIM_SOURCE_DIR "/qos/impaired")) {
    Domain domain(shipped(entry.path().filename()));
    ASSERT_NE(domain.delay_line(), nullptr) << entry.path();
    EXPECT_TRUE(domain.delay_line()->impairment().any());
    const auto transports = domain.participant().get_qos().transport();
    EXPECT_FALSE(transports.use_builtin_transports);
    ASSERT_EQ(transports.user_transports.size(), 1U);
    const auto impaired = std::dynamic_pointer_cast<WireTransportDescriptor>(transports.user_transports[0]);
    ASSERT_NE(impaired, nullptr);
    const auto udp =
        std::dynamic_pointer_cast<eprosima::fastdds::rtps::UDPv4TransportDescriptor>(impaired->low_level_descriptor);
    EXPECT_THAT(udp->interfaceWhiteList, ::testing::ElementsAre("127.0.0.1"));
    ++count;
  }
  EXPECT_EQ(count, 4);
}

TEST(ImpairedProfiles, CarryARun) {
  Settings settings = shipped("lan_8ms.xml");
  Peer a(settings, 0, {1}), b(settings, 1, {0});
  std::jthread other([&] { a.transport.wait_until_matched(testing::kDeadline); });
  b.transport.wait_until_matched(testing::kDeadline);
  other.join();
  const auto sent = Clock::now();
  a.send_batch(1);
  ASSERT_TRUE(take_until(b, [&] { return !b.inbox.auras.empty(); }));
  EXPECT_GE(Clock::now() - sent, 8ms);
}

}  // namespace
}  // namespace aurasim::dds
