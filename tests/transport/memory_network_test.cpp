#include <algorithm>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "transport/memory_transport.h"

namespace aurasim::transport::testing {
namespace {

using core::RegionId;
using core::Step;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr RegionId kA{0}, kB{1}, kC{2};
constexpr std::uint64_t kSeed = 5;

/// Three regions in a row: A and C hear only B.
class MemoryNetworkTest : public ::testing::Test {
 protected:
  void connect(const Faults& faults) {
    network = std::make_unique<MemoryNetwork>(std::vector<std::vector<RegionId>>{{kB}, {kA, kC}, {kB}}, faults, kSeed);
  }
  void publish(RegionId from, Step stamp) {
    core::Outbox outbox;
    outbox.aura.source = from;
    outbox.aura.stamp = stamp;
    network->endpoint(from).send(outbox);
  }
  void send(RegionId from, RegionId to, std::uint64_t sequence) {
    core::Outbox outbox;
    outbox.aura.source = from;
    core::HandOff& hand_off = outbox.hand_offs.emplace_back();
    hand_off.source = from;
    hand_off.destination = to;
    hand_off.sequence = sequence;
    network->endpoint(from).send(outbox);
  }
  core::Inbox take(RegionId region) {
    core::Inbox inbox;
    network->endpoint(region).take(inbox);
    return inbox;
  }
  std::vector<Step> received(RegionId region) {
    std::vector<Step> stamps;
    for (const core::AuraBatch& batch : take(region).auras) stamps.push_back(batch.stamp);
    return stamps;
  }

  std::unique_ptr<MemoryNetwork> network;
};

Faults slow(double latency_s) {
  Faults faults;
  faults.latency_s = latency_s;
  return faults;
}

TEST_F(MemoryNetworkTest, ABatchReachesAllListenersAndNobodyElse) {
  connect(slow(0.1));
  publish(kB, 1);
  publish(kA, 2);
  network->advance_to(0.2);
  EXPECT_THAT(received(kA), ElementsAre(1));
  EXPECT_THAT(received(kB), ElementsAre(2));
  EXPECT_THAT(received(kC), ElementsAre(1));
}

TEST_F(MemoryNetworkTest, AMessageArrivesWhenItsTimeHasComeAndIsTakenOnce) {
  connect(slow(0.1));
  network->advance_to(1);
  publish(kA, 7);
  EXPECT_THAT(received(kB), IsEmpty());
  network->advance_to(1.09);
  EXPECT_THAT(received(kB), IsEmpty());
  network->advance_to(1.11);
  EXPECT_THAT(received(kB), ElementsAre(7));
  EXPECT_THAT(received(kB), IsEmpty());
  EXPECT_EQ(network->now_s(), 1.11);
}

TEST_F(MemoryNetworkTest, TheFrameTimeOfTheSenderCounts) {
  connect(slow(0.1));
  network->set_send_delay(0.5);
  publish(kA, 7);
  network->advance_to(0.55);
  EXPECT_THAT(received(kB), IsEmpty());
  network->advance_to(0.65);
  EXPECT_THAT(received(kB), ElementsAre(7));
}

TEST_F(MemoryNetworkTest, HandOffsReachOnlyTheirDestination) {
  connect(slow(0));
  send(kA, kC, 4);
  network->advance_to(0);
  const core::Inbox inbox = take(kC);
  ASSERT_EQ(inbox.hand_offs.size(), 1u);
  EXPECT_EQ(inbox.hand_offs[0].sequence, 4u);
  EXPECT_TRUE(take(kB).hand_offs.empty());
}

TEST_F(MemoryNetworkTest, TheSameSeedGivesTheSameRun) {
  Faults faults = slow(0.01);
  faults.jitter_s = 0.05;
  faults.loss = faults.duplicate = 0.25;
  faults.keep_order = false;
  const auto run = [&] {
    connect(faults);
    std::vector<Step> all;
    for (Step s = 0; s < 300; ++s) {
      network->advance_to(0.01 * static_cast<double>(s));
      publish(kA, s);
      for (const Step stamp : received(kB)) all.push_back(stamp);
    }
    return all;
  };
  const std::vector<Step> first = run();
  EXPECT_EQ(first, run());
  EXPECT_FALSE(std::is_sorted(first.begin(), first.end()));
}

TEST_F(MemoryNetworkTest, NothingIsLostHoweverBadTheLink) {
  Faults faults = slow(0.01);
  faults.jitter_s = 0.05;
  faults.loss = 0.5;
  connect(faults);
  for (Step s = 0; s < 500; ++s) publish(kA, s);
  network->advance_to(1000);
  std::vector<Step> all(500);
  for (Step s = 0; s < 500; ++s) all[static_cast<std::size_t>(s)] = s;
  EXPECT_EQ(received(kB), all);
}

TEST_F(MemoryNetworkTest, ACutHoldsMessagesUntilItEnds) {
  connect(slow(0.01));
  network->faults().cut(kA, kB, 1, 2);
  network->advance_to(1.5);
  publish(kA, 7);
  publish(kB, 8);
  network->advance_to(1.9);
  EXPECT_THAT(received(kB), IsEmpty());
  EXPECT_THAT(received(kA), IsEmpty());
  EXPECT_THAT(received(kC), ElementsAre(8));
  network->advance_to(2.1);
  EXPECT_THAT(received(kB), ElementsAre(7));
  EXPECT_THAT(received(kA), ElementsAre(8));
}

TEST_F(MemoryNetworkTest, ACrashSilencesARegion) {
  connect(slow(0.01));
  publish(kA, 1);
  network->crash(kB, 0.2);
  network->advance_to(1);
  publish(kB, 2);
  network->advance_to(2);
  EXPECT_THAT(received(kA), IsEmpty());
  EXPECT_THAT(received(kB), IsEmpty()) << "it takes nothing either";
}

TEST_F(MemoryNetworkTest, WhatWasSentBeforeTheCrashStillArrives) {
  connect(slow(0.1));
  publish(kB, 1);
  network->crash(kB, 0.2);
  network->advance_to(0.15);
  EXPECT_THAT(received(kA), ElementsAre(1));
}

TEST_F(MemoryNetworkTest, ACrashIsReportedAfterTheLeaseToThoseWhoListened) {
  connect(slow(0.01));
  network->advance_to(1);
  network->crash(kA, 0.2);
  network->advance_to(1.19);
  EXPECT_TRUE(take(kB).peers.empty());
  network->advance_to(1.21);
  const core::Inbox inbox = take(kB);
  ASSERT_EQ(inbox.peers.size(), 1u);
  EXPECT_EQ(inbox.peers[0].region, kA);
  EXPECT_EQ(inbox.peers[0].change, core::PeerChange::kLost);
  EXPECT_TRUE(take(kC).peers.empty());
}

}  // namespace
}  // namespace aurasim::transport::testing
