// Which heartbeats are left out, and that none is where a sample was lost.
#include "rtps/heartbeat_limit.h"

#include <gtest/gtest.h>

#include "guard_fixture.h"

namespace aurasim::rtps {
namespace {

using namespace std::chrono_literals;
using dds::testing::ack_nack;
using dds::testing::Bytes;
using dds::testing::data;
using dds::testing::datagram;
using dds::testing::heartbeat;
using dds::testing::kReader;
using dds::testing::kWriter;
using dds::testing::Octets;
using dds::testing::statistics;
using dds::testing::submessage;

Octets destination() { return submessage(0x0e, 0, Octets().zeros(12)); }

TEST(AHeartbeat, IsFoundWhereItIsAlone) {
  const auto found = heartbeat_in(datagram({destination(), heartbeat(1, 7), statistics()}));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->writer, kWriter);
  EXPECT_EQ(found->reader, kReader);
  EXPECT_FALSE(heartbeat_in(datagram({data(kWriter, 7, Bytes(8)), heartbeat(1, 7)})));
  EXPECT_FALSE(heartbeat_in(datagram({heartbeat(1, 7), heartbeat(1, 8)})));
  EXPECT_FALSE(heartbeat_in(datagram({ack_nack(1, 0)})));
  EXPECT_FALSE(heartbeat_in(datagram({})));
  EXPECT_FALSE(heartbeat_in({}));
}

TEST(AHeartbeat, ThatProvesLifeOrAsksForNothingIsNone) {
  for (const std::uint8_t flags : {0x02, 0x04, 0x06}) {
    auto bytes = datagram({heartbeat(1, 7)});
    bytes[21] |= flags;
    EXPECT_FALSE(heartbeat_in(bytes)) << int{flags};
  }
}

/// A writer that writes every 20 ms, and has asked the reader of port 1 in its first state.
class AHeartbeatLimit : public ::testing::Test {
 protected:
  AHeartbeatLimit() {
    limit_.add_writer(kWriter);
    for (int i = 0; i < 4; ++i) write();
    EXPECT_TRUE(asks());
    write();
  }
  void write() {
    now_ += 20ms;
    limit_.note_sent(kWriter, ++last_, now_);
  }
  bool asks(std::uint32_t port = 1, std::uint32_t writer = kWriter, std::uint32_t reader = 0) {
    return limit_.allows({writer, reader}, {1, {127, 0, 0, 1}, port}, now_);
  }

  /// A reader says that it lacks so many samples, the newest ones.
  void answers(std::uint32_t lacks) {
    Request request;
    request.writer = kWriter;
    request.base = last_ + 1 - lacks;
    request.wanted = lacks;
    limit_.note_request(request, now_);
  }

  HeartbeatLimit limit_;
  std::uint64_t last_ = 0;
  HeartbeatLimit::Time now_{1h};
};

TEST_F(AHeartbeatLimit, LeavesThemOutWhileTheWriterGoesOn) {
  EXPECT_FALSE(asks());
  now_ += 40ms;
  EXPECT_FALSE(asks());
  now_ += 1ms;
  EXPECT_TRUE(asks()) << "it has fallen silent";
}

/// As before the start of a run, or in a pause.
TEST_F(AHeartbeatLimit, IsNotPatientForLongAfterOneLongTimeWithoutSamples) {
  now_ += 1h;
  write();
  asks();
  now_ += 81ms;
  EXPECT_TRUE(asks());
}

TEST_F(AHeartbeatLimit, AsksWhoHasNotBeenAskedYet) {
  EXPECT_TRUE(asks(2));
  EXPECT_FALSE(asks(2));
  EXPECT_TRUE(asks(1, kWriter, kReader));
}

TEST_F(AHeartbeatLimit, AsksAfterSomeSamplesBecauseTheyAreKept) {
  for (std::uint64_t i = 2; i < HeartbeatLimit::kMostUnasked; ++i) {
    write();
    EXPECT_FALSE(asks()) << i;
  }
  write();
  EXPECT_TRUE(asks());
  EXPECT_FALSE(asks());
}

TEST_F(AHeartbeatLimit, AsksForSomeTimeAfterALoss) {
  answers(0);
  write();
  answers(1);
  for (int i = 0; i < 400; ++i) {
    write();
    ASSERT_TRUE(asks());
  }
  for (int i = 0; i < 100; ++i) write();
  EXPECT_TRUE(asks());
  EXPECT_FALSE(asks());
}

/// A reader that comes asks for what was sent while it did not know the writer.
TEST_F(AHeartbeatLimit, TakesNothingForALossThatANewReaderLacks) {
  answers(3);
  EXPECT_FALSE(asks());
  write();
  answers(2);
  EXPECT_FALSE(asks()) << "the first of them was sent before";
  answers(1);
  EXPECT_TRUE(asks()) << "now it is a loss";
}

/// A reader that does not answer has no processor now, and many heartbeats would only take it from others.
TEST_F(AHeartbeatLimit, AsksASilentReaderLessAndLessOften) {
  int asked = 0;
  const auto end = now_ + 10s;
  for (auto longest = HeartbeatLimit::Time{0}, last = now_; now_ < end; now_ += 1ms) {
    if (!asks()) continue;
    ++asked;
    longest = now_ - std::exchange(last, now_);
    ASSERT_LE(longest, HeartbeatLimit::kLongestPause + 1ms);
  }
  EXPECT_GE(asked, 20) << "it goes on for ever";
  EXPECT_LE(asked, 25);
}

TEST_F(AHeartbeatLimit, WaitsAsLongAsStatesMayTakeOfLate) {
  now_ += 60ms;
  limit_.note_sent(kWriter, ++last_, now_);
  for (int i = 0; i < 2; ++i) write();
  now_ += 60ms;
  EXPECT_FALSE(asks());
  for (int i = 0; i < 20; ++i) write();
  asks();
  now_ += 60ms;
  EXPECT_TRUE(asks());
}

/// A sample that is sent again says nothing about how fast the writer writes.
TEST_F(AHeartbeatLimit, CountsASampleOnce) {
  now_ += 1ms;
  limit_.note_sent(kWriter, last_, now_);
  now_ += 39ms;
  EXPECT_FALSE(asks());
  now_ += 1ms;
  EXPECT_TRUE(asks());
}

TEST_F(AHeartbeatLimit, WaitsNeitherForAFastWriterLongNorForASlowOne) {
  now_ += 10s;
  limit_.note_sent(kWriter, ++last_, now_);
  now_ += HeartbeatLimit::kLongestSilence + 1ms;
  EXPECT_TRUE(asks());
  for (int i = 0; i < 50; ++i) limit_.note_sent(kWriter, ++last_, now_ += 1ms);
  EXPECT_TRUE(asks()) << "many samples";
  limit_.note_sent(kWriter, ++last_, now_ += 1ms);
  now_ += HeartbeatLimit::kSilence;
  EXPECT_FALSE(asks());
  now_ += 1ms;
  EXPECT_TRUE(asks());
}

TEST_F(AHeartbeatLimit, IsForSteadyWritersOnly) {
  EXPECT_TRUE(asks(1, kWriter + 1));
  EXPECT_TRUE(asks(1, kWriter + 1));
  limit_.remove_writer(kWriter);
  EXPECT_TRUE(asks());
  EXPECT_TRUE(asks());
}

using AGuardOfASteadyWriter = dds::testing::Guard;

TEST_F(AGuardOfASteadyWriter, LearnsOfLossesFromWhatReadersAskFor) {
  const Peer peer{1, {127, 0, 0, 1}, 7411};
  const Heartbeat heartbeat{kWriter, kReader};
  guard_.add_writer_of_nodes(kWriter, true);
  for (std::uint64_t number = 1; number <= 2; ++number) {
    guard_.note_sent(datagram({data(kWriter, number, Bytes(8))}), now_);
    guard_.allows(heartbeat, peer, now_);
  }
  EXPECT_TRUE(passes(ack_nack(3, 0)));
  EXPECT_FALSE(guard_.allows(heartbeat, peer, now_));
  guard_.note_sent(datagram({data(kWriter, 3, Bytes(8))}), now_);
  guard_.allows(heartbeat, peer, now_);
  EXPECT_FALSE(guard_.allows(heartbeat, peer, now_));
  EXPECT_TRUE(passes(ack_nack(3, 1)));
  EXPECT_TRUE(guard_.allows(heartbeat, peer, now_));
}

}  // namespace
}  // namespace aurasim::rtps
