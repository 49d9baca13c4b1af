// What takes a memory to refuse. Time is passed in.
#include <optional>

#include <gtest/gtest.h>

#include "guard_fixture.h"
#include "rtps/datagram_check.h"

namespace aurasim::dds {
namespace {

using namespace std::chrono_literals;
using namespace testing;  // NOLINT: samples

TEST_F(Guard, CountsByReasonAndAddress) {
  EXPECT_TRUE(passes(heartbeat(1, 1)));
  EXPECT_FALSE(passes(Bytes{1, 2, 3}));
  EXPECT_FALSE(passes(Bytes{1, 2, 3}, {0x0a000007, 1}));
  EXPECT_FALSE(passes(heartbeat(0, 1)));
  const rtps::GuardReport report = guard_.report();
  EXPECT_EQ(report.passed, 1U);
  EXPECT_EQ(report.total(), 3U);
  EXPECT_EQ(rtps::text_of(report.refused), "2 header, 1 sequence number");
  ASSERT_EQ(report.addresses.size(), 2U);
  EXPECT_EQ(rtps::text_of_address(report.addresses[0].address), "10.0.0.7");
  EXPECT_EQ(rtps::text_of(report.addresses[1].refused), "1 header, 1 sequence number");
  EXPECT_EQ(guard_.take_new_sources().size(), 2U);
  EXPECT_FALSE(passes(Bytes{}));
  EXPECT_TRUE(guard_.take_new_sources().empty());
}

/// Fast DDS 2.9.1 keeps what it is told of two participants in the same variables.
TEST_F(Guard, LetsFastDdsMeetOneParticipantAtATime) {
  const auto is_alone = [this](const Octets& submessage) {
    Bytes bytes = datagram({submessage});
    return guard_.admit(bytes, kSource, now_).is_alone;
  };
  EXPECT_TRUE(is_alone(data(rtps::kParticipantWriter, 1, participant(kPrefix).bytes())));
  EXPECT_TRUE(
      is_alone(data(kHandshakeWriter, 1, Octets().raw({0, 1, 0, 0}).zeros(96).text("dds.sec.auth").u32(0).bytes())));
  EXPECT_FALSE(is_alone(data(kEndpointWriter, 1, endpoint(kPrefix, kWriter).bytes())));
  EXPECT_FALSE(is_alone(data(kWriter, 5, {0, 1, 0, 0, 9, 9, 9, 9})));
  EXPECT_FALSE(is_alone(heartbeat(1, 1)));
}

/// Fast DDS counts from the last number that it has told of to the first of a heartbeat, with the reader's lock held.
TEST_F(Guard, RefusesHeartbeatsThatLeaveOutBillions) {
  meet();
  EXPECT_TRUE(passes(heartbeat(1'000'000, 1'000'100)));  // who comes late
  EXPECT_TRUE(passes(heartbeat(1'000'050, 1'000'200)));
  EXPECT_FALSE(passes(heartbeat(1'000'000'000, 1'000'000'001)));
  EXPECT_FALSE(passes(heartbeat(rtps::kLargestSequenceNumber, rtps::kLargestSequenceNumber)));
  EXPECT_EQ(refused(rtps::Refusal::kJump), 2U);
  for (int i = 2; i < 20; ++i) passes(heartbeat(std::uint64_t{60'000'000} * i, std::uint64_t{60'000'000} * i));
  EXPECT_GT(refused(rtps::Refusal::kJump), 12U);         // nor in many steps
  EXPECT_TRUE(passes(heartbeat(1'000'100, 1'000'300)));  // the true one goes on
}

/// With a sample among the numbers that are left out Fast DDS looks every one up in its history.
TEST_F(Guard, TakesNoSampleFromFarAhead) {
  meet();
  const auto sample = [](std::uint64_t sequence) { return data(kWriter, sequence, {0, 1, 0, 0, 1, 2, 3, 4}); };
  EXPECT_FALSE(passes(sample(5'000'000)));  // who joins late waits for the heartbeat
  EXPECT_TRUE(passes(heartbeat(5'000'000, 5'000'000)));
  EXPECT_TRUE(passes(sample(5'000'000)));
  EXPECT_TRUE(passes(sample(5'010'000)));
  EXPECT_FALSE(passes(sample(6'000'000)));
  EXPECT_FALSE(passes(fragment({.sequence = 6'000'000})));
  EXPECT_FALSE(passes(heartbeat(60'000'000, 60'000'000)));  // nor may a heartbeat go far with samples there
  EXPECT_TRUE(passes(heartbeat(5'010'000, 5'010'001)));
}

TEST_F(Guard, RefusesGapsThatLeaveOutTooMany) {
  meet();
  EXPECT_TRUE(passes(gap(1, 200'000)));
  EXPECT_FALSE(passes(gap(1, 2'000'000'000)));
  int passed = 0;
  for (int i = 0; i < 100; ++i) passed += passes(gap(200'000 * (i + 2), 200'000 * (i + 3))) ? 1 : 0;
  EXPECT_LT(passed, 5);
  EXPECT_TRUE(passes(gap(10, 12)));
}

TEST_F(Guard, TakesFragmentsOnlyLikeTheFirst) {
  meet();
  EXPECT_TRUE(passes(fragment({})));
  EXPECT_FALSE(passes(fragment({.first = 2, .sample_B = 100'000})));
  EXPECT_FALSE(passes(fragment({.first = 2, .fragment_B = 512, .payload_B = 512})));
  EXPECT_EQ(refused(rtps::Refusal::kFragment), 2U);
  EXPECT_TRUE(passes(fragment({.first = 2})));
}

TEST_F(Guard, TakesNoMessageOfARunInFragments) {
  meet();
  EXPECT_FALSE(passes(fragment({.writer = kWriter})));
  EXPECT_FALSE(passes(nack_fragments(1, kWriter)));
  const Octets more = Octets().entity(kReader).entity(kWriter).sequence(1).u32(3).u32(1);
  EXPECT_FALSE(passes(submessage(0x13, 0, more)));
  EXPECT_EQ(refused(rtps::Refusal::kFragment), 3U);
  EXPECT_TRUE(passes(nack_fragments(1)));
}

/// Many announce descriptions of endpoints, and end none.
TEST_F(Guard, BoundsWhatIsUnfinished) {
  const auto begin_of = [](std::uint32_t participant, std::uint64_t sequence) {
    return header(prefix_of(participant)).raw(fragment({.sequence = sequence, .sample_B = 64U << 10}).bytes()).bytes();
  };
  for (std::uint32_t number = 1; number <= 3; ++number) {
    ASSERT_TRUE(passes(header(prefix_of(number))
                           .raw(data(rtps::kParticipantWriter, 1, participant(prefix_of(number)).bytes()).bytes())
                           .bytes()));
  }
  for (std::uint64_t i = 1; i <= 2000; ++i) ASSERT_TRUE(passes(begin_of(1, i))) << "the first give way";
  EXPECT_FALSE(passes(begin_of(2, 1))) << "64 MiB in all";
  EXPECT_EQ(refused(rtps::Refusal::kUnfinished), 1U);
  now_ += 3s;  // what is not sent again is lost
  EXPECT_TRUE(passes(begin_of(2, 1)));
}

TEST_F(Guard, BoundsParticipants) {
  const auto announce = [&](std::uint32_t number, rtps::Source source) {
    return passes(datagram({data(rtps::kParticipantWriter, 1, participant(prefix_of(number)).bytes())}), source);
  };
  int passed = 0;
  for (std::uint32_t i = 0; i < 5'000; ++i) passed += announce(i, kSource) ? 1 : 0;
  EXPECT_EQ(passed, 256);
  EXPECT_TRUE(announce(0, kSource));               // who is known stays
  EXPECT_TRUE(announce(10'000, {0x0a000001, 7}));  // elsewhere there is room
  now_ += 30s;
  EXPECT_TRUE(announce(10'001, kSource));  // they have been silent
}

TEST_F(Guard, BoundsEndpoints) {
  meet();
  int passed = 0;
  for (std::uint32_t i = 0; i < 6'000; ++i) {
    passed += passes(data(kEndpointWriter, 1, endpoint(kPrefix, 0x1000'0003 + (i << 8)).bytes())) ? 1 : 0;
  }
  EXPECT_EQ(passed, 4095);
}

TEST_F(Guard, BoundsRates) {
  const Bytes good = datagram({heartbeat(1, 1)});
  int passed = 0;
  for (int i = 0; i < 300'000; ++i) passed += passes(good) ? 1 : 0;
  EXPECT_EQ(passed, 100'000);
  EXPECT_TRUE(passes(good, {kSource.address, 7}));
  now_ += 1s;
  EXPECT_TRUE(passes(good));
}

/// 60 steps a second: a batch of 80 kB to each neighbour, and once a minute a hand-off of 20 MB.
TEST_F(Guard, HoldsUpNoHealthyNode) {
  meet();
  std::uint64_t sequence = 0;
  for (int step = 0; step < 3'600; ++step, now_ += 16'666us) {
    const std::uint32_t size = step == 1'800 ? 20U << 20 : 80'000;
    const std::uint32_t parts = (size + 1199) / 1200;
    for (std::uint32_t i = 0; i < parts; ++i) {
      ASSERT_TRUE(passes(data(kWriter, ++sequence, Bytes(1200, 1)))) << step;
    }
    ASSERT_TRUE(passes(heartbeat(sequence - parts + 1, sequence)));
  }
}

TEST_F(Guard, TakesNothingFromWhatIsForOthers) {
  meet();
  guard_.set_own(prefix_of(77));
  const Octets elsewhere = submessage(0x0e, 0, Octets().raw({9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9}));
  const Octets gone = farewell(kEndpointWriter, kPrefix, kWriter);
  EXPECT_TRUE(passes(heartbeat(60'000'000, 60'000'000)));
  EXPECT_TRUE(passes(datagram({elsewhere, gone})));
  EXPECT_TRUE(passes(heartbeat(120'000'000, 120'000'000)));  // from where it was, not from 0
}

/// The end of an instance, which nobody in a run says.
TEST_F(Guard, SaysAsAGapWhatHasNoPayload) {
  meet();
  Bytes bytes = datagram({submessage(0x15, 2,
                                     Octets()
                                         .u16(0)
                                         .u16(16)
                                         .entity(kReader)
                                         .entity(kWriter)
                                         .sequence(7)
                                         .parameter(0x70, Octets().zeros(16))
                                         .parameter(0x71, Octets().raw({0, 0, 0, 1}))
                                         .sentinel()),
                          heartbeat(1, 7)});
  const auto admitted = guard_.admit(bytes, kSource, now_);
  ASSERT_EQ(admitted.before.size(), 1U);
  EXPECT_EQ(octets_of(admitted.before[0]), datagram({gap(7, 8)}));
  EXPECT_EQ(bytes[rtps::kHeaderBytes], 0x01) << "it is seen";
}

/// A guard of a node that has sent samples 1 to kLast by kWriter, of kSample_B each.
class RepeatsForStrangers : public Guard {
 protected:
  RepeatsForStrangers() {
    guard_.set_nodes({prefix_of(kNode)});
    for (std::uint64_t number = 1; number <= kLast; ++number) {
      guard_.note_sent(datagram({heartbeat(1, number), data(kWriter, number, Bytes(kSample_B - 20))}), now_);
    }
  }
  /// What Fast DDS is shown of it; nothing: padding.
  std::optional<rtps::Request> admit(std::uint32_t process, const Octets& submessage) {
    Bytes bytes = header(prefix_of(process)).raw(submessage.bytes()).bytes();
    EXPECT_EQ(guard_.admit(bytes, kSource, now_).size, bytes.size()) << "what else is in the datagram passes";
    rtps::Findings findings;
    EXPECT_EQ(rtps::check_datagram(bytes, findings), std::nullopt);
    return findings.requests.empty() ? std::nullopt : std::optional(findings.requests.front());
  }
  /// How many of so many requests.
  int answered(std::uint32_t process, int asked, std::uint32_t wanted = 256) {
    int count = 0;
    for (int i = 0; i < asked; ++i) {
      const auto shown = admit(process, ack_nack(1, wanted));
      if (shown && shown->wanted == wanted && shown->base == 1) ++count;
    }
    return count;
  }

  static constexpr std::uint32_t kNode = 1, kViewer = 2, kOther = 1000;
  static constexpr std::uint64_t kLast = 300;
  static constexpr std::size_t kSample_B = 10'000;
};

TEST_F(RepeatsForStrangers, AreNoMatterForNodes) {
  guard_.add_writer_of_nodes(kWriter);
  EXPECT_EQ(answered(kNode, 10'000), 10'000);
  now_ += 1h;
  EXPECT_EQ(answered(kNode, 10'000), 10'000);
  EXPECT_EQ(refused(rtps::Refusal::kRepeat), 0U);
}

TEST_F(RepeatsForStrangers, AreNoneBeforeAnyNodeIsKnown) {
  guard_.set_nodes({});
  EXPECT_EQ(answered(kViewer, 10'000), 10'000);
}

TEST_F(RepeatsForStrangers, AreSoManyBytesASecond) {
  EXPECT_EQ(answered(kViewer, 1000), 12) << "32 MB at once";
  EXPECT_EQ(refused(rtps::Refusal::kRepeat), 988U);
  const auto askers = guard_.take_new_askers();
  ASSERT_EQ(askers.size(), 1U) << "said once";
  EXPECT_EQ(askers[0].first, prefix_of(kViewer));
  now_ += 1s;
  EXPECT_EQ(answered(kViewer, 1000), 3) << "8 MB a second";
  EXPECT_EQ(answered(kOther, 1000), 12) << "another has its own";
}

TEST_F(RepeatsForStrangers, AreBoundedForAllOfThemTogether) {
  int count = 0;
  for (std::uint32_t process = 0; process < 100; ++process) count += answered(kOther + process, 20);
  EXPECT_EQ(count, 50) << "128 MB at once";
}

/// Whoever has it lacks all, but its acknowledgement is heard: Fast DDS keeps nothing for it.
TEST_F(RepeatsForStrangers, AreNoneOfWhatNodesSayToEachOther) {
  guard_.add_writer_of_nodes(kWriter);
  EXPECT_EQ(answered(kViewer, 1), 1) << "it may become a node";
  now_ += 11s;
  const auto shown = admit(kViewer, ack_nack(1, 256));
  ASSERT_TRUE(shown);
  EXPECT_EQ(shown->base, kLast + 1);
  EXPECT_EQ(shown->wanted, 0U);
  EXPECT_EQ(refused(rtps::Refusal::kRepeat), 1U);
  const auto greeting = admit(kViewer, ack_nack(0, 0));
  ASSERT_TRUE(greeting);
  EXPECT_EQ(greeting->base, 0U) << "it wants to hear where the writer is";
  EXPECT_EQ(admit(kViewer, ack_nack(kLast + 1, 0))->base, kLast + 1);
  guard_.set_nodes({prefix_of(kNode), prefix_of(kViewer)});
  EXPECT_EQ(answered(kViewer, 100), 100) << "now it is one";
}

/// 60 samples a second of each of 16 topics, 10% lost, and asked for four times until they are there.
TEST_F(RepeatsForStrangers, AreEnoughForAViewerOnABadNetwork) {
  for (int i = 0; i < 60 * 60; ++i, now_ += 16'666us) {
    for (int topic = 0; topic < 16; ++topic) {
      const int lost = (i + topic) % 10 == 0 ? 4 : 0;
      ASSERT_EQ(answered(kViewer, lost, 1), lost) << i;
    }
  }
}

/// A picture of 20 MB in parts of 1200 bytes, 10% of them lost, and asked for five times.
TEST_F(RepeatsForStrangers, AreEnoughForASpareThatComesLate) {
  constexpr std::uint32_t kOfParts = kWriter + 0x100, kParts = (20U << 20) / 1200;
  guard_.note_sent(datagram({data(kOfParts, kParts, Bytes(1200))}), now_);
  for (std::uint32_t i = 0; i < 5 * kParts / 10 / 8; ++i) {
    const auto shown = admit(kViewer, ack_nack(1, 8, kOfParts));
    ASSERT_TRUE(shown) << i;
    EXPECT_EQ(shown->wanted, 8U);
  }
}

TEST_F(Guard, PassesNothingOfWhomNobodyListensTo) {
  const auto from_it = datagram({heartbeat(1, 1)});
  Octets source;
  source.zeros(8);
  for (const std::uint8_t octet : kPrefix) source.raw({octet});
  const Bytes in_its_name =
      header(prefix_of(9)).raw(submessage(0x0c, 0, source).bytes()).raw(heartbeat(1, 1).bytes()).bytes();
  EXPECT_TRUE(passes(from_it));
  EXPECT_TRUE(passes(in_its_name));
  guard_.shun(kPrefix);
  EXPECT_FALSE(passes(from_it));
  EXPECT_FALSE(passes(in_its_name));
  EXPECT_EQ(refused(rtps::Refusal::kShunned), 2U);
  guard_.forgive(kPrefix);
  EXPECT_TRUE(passes(from_it));
}

}  // namespace
}  // namespace aurasim::dds
