// Two regions that talk over loopback, and a stranger who knows how one of them speaks.
#include <set>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "datagram_recorder.h"
#include "datagram_samples.h"
#include "dds/domain.h"
#include "dds/guarding.h"
#include "rtps/datagram_check.h"
#include "run_endpoints.h"

namespace aurasim::dds {
namespace {

using namespace testing;  // NOLINT: samples
using Clock = std::chrono::steady_clock;

class GuardedRegions : public ::testing::Test {
 protected:
  GuardedRegions() : socket_(::socket(AF_INET, SOCK_DGRAM, 0)), a_(own_domain(), 0, {1}), b_(own_domain(), 1, {0}) {}
  ~GuardedRegions() override { ::close(socket_); }

  /// Both speak and listen until `condition` holds.
  template <class Condition>
  bool talk_until(Condition condition) {
    return holds_in_time([&] {
      ++step_;
      a_.say(step_);
      b_.say(step_);
      a_.listen();
      b_.listen();
      return condition();
    });
  }
  /// What b's writers, but for the built-in ones, have sent heartbeats with.
  const std::set<std::uint32_t>& writers_of_b() {
    rtps::Findings findings;
    for (const Bytes& bytes : recorded_datagrams()) {
      if (rtps::check_datagram(bytes, findings)) continue;
      for (const rtps::Claim& claim : findings.claims) {
        if (claim.kind != rtps::Claim::Kind::kHeartbeat || rtps::is_built_in(claim.guid.entity)) continue;
        if (claim.guid.prefix == prefix_of(b_)) writers_.insert(claim.guid.entity);
      }
    }
    return writers_;
  }
  static rtps::GuidPrefix prefix_of(RunEndpoints& endpoints) {
    rtps::GuidPrefix prefix;
    std::ranges::copy(endpoints.peer.participant.domain().participant().guid().guidPrefix.value, prefix.begin());
    return prefix;
  }
  /// To all ports of both.
  void send(const Bytes& bytes) const {
    for (std::uint32_t i = 0; i < 4; ++i) {
      sockaddr_in to{};
      to.sin_family = AF_INET;
      to.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * own_domain() + 10 + i));
      to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      ::sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
    }
  }
  void send_as_b(std::initializer_list<Octets> submessages) {
    Octets all = header(prefix_of(b_));
    for (const Octets& submessage : submessages) all.raw(submessage.bytes());
    send(all.bytes());
  }
  bool a_hears_b() {
    const auto seen = [&] {
      const auto& statuses = a_.control.statuses();
      const auto it = statuses.find(core::RegionId{1});
      return it == statuses.end() ? -1 : it->second.status.step;
    };
    const auto before = seen();
    return talk_until([&] { return seen() > before; });
  }

  int socket_;
  RunEndpoints a_, b_;
  std::set<std::uint32_t> writers_;
  core::Step step_ = 0;
};

TEST_F(GuardedRegions, OutliveTheDatagramOf92Bytes) {
  ASSERT_TRUE(a_hears_b());
  Octets octets = header();
  octets.raw({0x80, 1}).u16(56).zeros(56).zeros(12);
  for (int i = 0; i < 100; ++i) send(octets.bytes());
  EXPECT_TRUE(a_hears_b());
  EXPECT_GT(guarded(a_.peer.participant).refused[static_cast<std::size_t>(rtps::Refusal::kStatistics)], 0U);
}

/// Its key is all that can be read of it.
Octets data_of(std::uint32_t writer, std::uint64_t sequence, std::uint32_t source) {
  return data(writer, sequence, Octets().raw({0, 1, 0, 0}).u32(source).zeros(8).bytes());
}

Octets heartbeat_to_all(std::uint32_t writer, std::uint64_t first, std::uint64_t last, std::uint32_t count) {
  return submessage(0x07, 0, Octets().entity(0).entity(writer).sequence(first).sequence(last).u32(count));
}

/// Somebody goes on in the name of a region that has fallen silent.
class UsurpedRegion : public GuardedRegions {
 protected:
  static constexpr std::uint64_t kNext = 10'000;
  static constexpr std::uint32_t kCount = 1'000'000;

  void SetUp() override {
    ASSERT_TRUE(a_hears_b());
    ASSERT_TRUE(talk_until([&] { return writers_of_b().size() >= 4; }));
    for (const std::uint32_t writer : writers_of_b()) send_as_b({heartbeat_to_all(writer, kNext, kNext - 1, kCount)});
  }
  void TearDown() override {
    std::this_thread::sleep_for(200ms);
    EXPECT_TRUE(talk_until([&] { return step_ > 50; }));
  }
  static void wait_until_b_is_taken_for_gone() { std::this_thread::sleep_for(3s); }
};

/// Fast DDS passes over a heartbeat that is not newer than the last; two of one number, one of them unfinished, end it.
TEST_F(UsurpedRegion, IsOutlivedWhenASampleComesInPartsAndWhole) {
  for (const std::uint32_t writer : writers_of_b()) {
    send_as_b({fragment({.writer = writer, .sequence = kNext, .sample_B = 3700})});
    send_as_b({heartbeat_to_all(writer, kNext + 1, kNext + 1, 1)});
    send_as_b({data_of(writer, kNext, 1)});
  }
}

/// StatefulReader.cpp, processGapMsg: what bits name stays unfinished, and is then told of as if it were whole.
TEST_F(UsurpedRegion, IsOutlivedWhenAGapHasBitsForSamplesOfWhichPartsAreHere) {
  for (const std::uint32_t writer : writers_of_b()) {
    send_as_b({fragment({.writer = writer, .sequence = kNext + 5, .sample_B = 3700})});
    const auto bits = Octets().u32(32).u32(0xffff'ffff);
    send_as_b({submessage(0x08, 0, Octets().entity(0).entity(writer).sequence(1).sequence(kNext).raw(bits.bytes()))});
  }
}

/// DataReaderHistory.cpp, find_key: beyond the limit an instance whose writers are gone makes room, with its samples.
TEST_F(UsurpedRegion, IsOutlivedWhenItSpeaksOfMoreInstancesThanThereAreNodes) {
  for (const std::uint32_t writer : writers_of_b()) send_as_b({data_of(writer, kNext, 77)});
  wait_until_b_is_taken_for_gone();
  for (const std::uint32_t writer : writers_of_b()) {
    send_as_b({data_of(writer, kNext + 2, 77)});
    for (std::uint32_t i = 0; i < 5000; ++i) send_as_b({data_of(writer, kNext + 3 + i, 100 + i)});
    std::this_thread::sleep_for(100ms);
    send_as_b({data_of(writer, kNext + 1, 78)});
  }
}

TEST_F(GuardedRegions, AreNotHeldUpByAHeartbeatFromFarAhead) {
  ASSERT_TRUE(a_hears_b());
  ASSERT_TRUE(talk_until([&] { return writers_of_b().size() >= 4; }));
  std::uint64_t first = 1'000'000;
  for (int round = 0; round < 15; ++round, first *= 2) {
    for (const std::uint32_t writer : writers_of_b()) {
      const Octets body = Octets().entity(0).entity(writer).sequence(first).sequence(first + 3).u32(1'000'000 + round);
      send_as_b({submessage(0x07, 0, body)});
    }
    const auto begin = Clock::now();
    a_.listen();
    std::this_thread::sleep_for(50ms);
    a_.listen();
    const auto held_up = Clock::now() - begin - 50ms;
    RecordProperty("first_" + std::to_string(first), std::to_string(std::chrono::duration<double>(held_up).count()));
    std::cout << first << ": " << std::chrono::duration<double>(held_up).count() << " s\n";
    EXPECT_LT(held_up, 5s) << first;
  }
}

}  // namespace
}  // namespace aurasim::dds
