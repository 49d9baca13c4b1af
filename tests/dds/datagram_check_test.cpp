// What Fast DDS never sees. Each refusal is of a datagram that is fine but for what the test is named after.
#include "rtps/datagram_check.h"

#include <random>

#include <gtest/gtest.h>

#include "datagram_mutator.h"
#include "datagram_samples.h"

namespace aurasim::dds {
namespace {

using namespace testing;  // NOLINT: samples
using testing::datagram;

std::optional<rtps::Refusal> check(const Bytes& bytes) {
  rtps::Findings findings;
  return rtps::check_datagram(bytes, findings);
}

std::optional<rtps::Refusal> check(const Octets& submessage) { return check(datagram({submessage})); }

Octets announced(const Octets& more, std::uint32_t lease_s = 5) {
  return data(rtps::kParticipantWriter, 1, participant(kPrefix, more, lease_s).bytes());
}

Octets offered(const Octets& more) { return data(kEndpointWriter, 1, endpoint(kPrefix, kWriter, more).bytes()); }

constexpr auto kFine = std::nullopt;

TEST(Datagram, IsFineIfItIsWhatPeersSend) {
  EXPECT_EQ(check(datagram({})), kFine);
  EXPECT_EQ(check(heartbeat(1, 0)), kFine);
  EXPECT_EQ(check(heartbeat(7, 900)), kFine);
  EXPECT_EQ(check(gap(3, 10, 256)), kFine);
  EXPECT_EQ(check(data(kWriter, 5, {0, 1, 0, 0, 9, 9, 9, 9})), kFine);
  EXPECT_EQ(check(fragment({})), kFine);
  EXPECT_EQ(check(fragment({.first = 3, .payload_B = 3000 - 2048})), kFine);
  EXPECT_EQ(check(announced({})), kFine);
  EXPECT_EQ(check(offered(Octets().parameter(0x29, Octets().u32(2).text("region/1").text("region/*/to/1")))), kFine);
}

TEST(Datagram, MustBeRtpsOfVersionTwo) {
  for (const std::size_t at : {0, 1, 2, 3, 4}) {
    Bytes bytes = datagram({heartbeat(1, 1)});
    ++bytes[at];
    EXPECT_EQ(check(bytes), rtps::Refusal::kHeader) << at;
  }
  EXPECT_EQ(check(Bytes{'R', 'T', 'P', 'S', 2, 3}), rtps::Refusal::kHeader);
  EXPECT_EQ(check(Bytes{}), rtps::Refusal::kHeader);
}

TEST(Datagram, HasKnownSubmessagesThatFit) {
  EXPECT_EQ(check(submessage(0x42, 0, Octets().zeros(8))), rtps::Refusal::kSubmessage);
  EXPECT_EQ(check(submessage(0x81, 0, Octets().zeros(8))), rtps::Refusal::kSubmessage);
  Bytes cut = datagram({heartbeat(1, 1)});
  cut.pop_back();
  EXPECT_EQ(check(cut), rtps::Refusal::kLength);
  EXPECT_EQ(check(datagram({Octets().raw({0x07, 1})})), rtps::Refusal::kLength);
  EXPECT_EQ(check(submessage(0x07, 0, Octets().zeros(24))), rtps::Refusal::kLength);
  EXPECT_EQ(check(datagram({submessage(0x01, 0, Octets().zeros(3)), heartbeat(1, 1)})), rtps::Refusal::kLength);
  Octets many = header();
  for (int i = 0; i < 600; ++i) many.raw({0x01, 1, 0, 0});
  EXPECT_EQ(check(many.bytes()), rtps::Refusal::kSubmessage);
}

/// This one ended every process of a run (RTPSStatisticsMessages.hpp:128).
TEST(Datagram, Of92BytesWithStatisticsThatAreNotAtItsEndIsRefused) {
  Octets octets = header();
  octets.raw({0x80, 1}).u16(56).zeros(56).zeros(12);
  ASSERT_EQ(octets.bytes().size(), 92U);
  EXPECT_EQ(check(octets.bytes()), rtps::Refusal::kStatistics);
  for (const std::uint64_t length : {0, 52, 60, 68}) {
    Octets other = header();
    other.raw({0x80, 1}).u16(length).zeros(68);
    EXPECT_EQ(check(other.bytes()), rtps::Refusal::kStatistics) << length;
  }
}

TEST(Datagram, LosesItsStatistics) {
  const Bytes bytes = datagram({heartbeat(1, 1), statistics()});
  rtps::Findings findings;
  EXPECT_EQ(rtps::check_datagram(bytes, findings), kFine);
  EXPECT_EQ(findings.size, bytes.size() - 60);
}

TEST(Datagram, HasSequenceNumbersThatARunCanReach) {
  for (const std::uint64_t wrong : {std::uint64_t{0}, rtps::kLargestSequenceNumber + 1, ~std::uint64_t{0}}) {
    EXPECT_EQ(check(heartbeat(wrong, rtps::kLargestSequenceNumber)), rtps::Refusal::kSequenceNumber);
    EXPECT_EQ(check(gap(wrong, rtps::kLargestSequenceNumber)), rtps::Refusal::kSequenceNumber);
    EXPECT_EQ(check(data(kWriter, wrong, {0, 1, 0, 0})), rtps::Refusal::kSequenceNumber);
    EXPECT_EQ(check(fragment({.sequence = wrong})), rtps::Refusal::kSequenceNumber);
  }
  EXPECT_EQ(check(heartbeat(5, 3)), rtps::Refusal::kSequenceNumber);
  EXPECT_EQ(check(heartbeat(5, ~std::uint64_t{0})), rtps::Refusal::kSequenceNumber);
  EXPECT_EQ(check(gap(5, 4)), rtps::Refusal::kSequenceNumber);
}

TEST(Datagram, HasNoMoreBitsThanAreThere) {
  EXPECT_EQ(check(gap(3, 10, 257)), rtps::Refusal::kNumberSet);
  EXPECT_EQ(check(submessage(0x06, 0, Octets().entity(kReader).entity(kWriter).sequence(3).u32(64).zeros(4))),
            rtps::Refusal::kNumberSet);
  EXPECT_EQ(
      check(submessage(0x12, 0, Octets().entity(kReader).entity(kWriter).sequence(3).u32(~0U).raw(bits(8).bytes()))),
      rtps::Refusal::kFragment);
}

TEST(Datagram, HasFragmentsThatFitTheirSample) {
  EXPECT_EQ(check(fragment({.first = 0})), rtps::Refusal::kFragment);
  EXPECT_EQ(check(fragment({.first = 4})), rtps::Refusal::kFragment);
  EXPECT_EQ(check(fragment({.count = 0})), rtps::Refusal::kFragment);
  EXPECT_EQ(check(fragment({.first = 3, .count = 2})), rtps::Refusal::kFragment);
  EXPECT_EQ(check(fragment({.first = 2, .count = 65'535})), rtps::Refusal::kFragment);
  EXPECT_EQ(check(fragment({.fragment_B = 1})), rtps::Refusal::kFragment);    // a note of each would be kept
  EXPECT_EQ(check(fragment({.sample_B = ~0U})), rtps::Refusal::kFragment);    // 4 GB, taken at once
  EXPECT_EQ(check(fragment({.payload_B = 1020})), rtps::Refusal::kFragment);  // the rest would be read from elsewhere
  EXPECT_EQ(check(fragment({.first = 3, .payload_B = 512})), rtps::Refusal::kFragment);
}

TEST(Datagram, HasParametersThatFit) {
  EXPECT_EQ(check(data(kWriter, 1, {0, 1, 0, 0}, Octets().u16(0x70).u16(16).zeros(8).bytes())),
            rtps::Refusal::kParameterList);
  EXPECT_EQ(check(data(kWriter, 1, {0, 1, 0, 0}, Octets().u16(0x70).u16(15).zeros(16).bytes())),
            rtps::Refusal::kParameterList);
  EXPECT_EQ(check(data(kWriter, 1, {0, 1, 0, 0}, Octets().parameter(0x71, Octets()).sentinel().bytes())),
            rtps::Refusal::kParameter);
  const Octets no_end = to_all(Octets().parameter(0x50, Octets().guid(kPrefix, 0x1c1)).parameter(0x02, lease(5)));
  EXPECT_EQ(check(data(rtps::kParticipantWriter, 1, no_end.bytes())), rtps::Refusal::kParameterList);
}

TEST(Datagram, HasStringsThatEnd) {
  const auto name = [](std::uint32_t length) { return Octets().u32(length).raw({'a', 'b', 'c', 'd'}).zeros(4); };
  EXPECT_EQ(check(announced(Octets().parameter(0x62, name(5)))), kFine);
  EXPECT_EQ(check(announced(Octets().parameter(0x62, name(4)))), rtps::Refusal::kParameter);  // no zero
  EXPECT_EQ(check(announced(Octets().parameter(0x62, name(6)))), rtps::Refusal::kParameter);  // two
  EXPECT_EQ(check(announced(Octets().parameter(0x62, name(9)))),
            rtps::Refusal::kParameter);  // longer than the parameter
  EXPECT_EQ(check(announced(Octets().parameter(0x62, name(~0U)))), rtps::Refusal::kParameter);
}

TEST(Datagram, HasPartitionsThatDoNotTakeForEverToMatch) {
  const auto partition = [](std::string_view text) { return Octets().parameter(0x29, Octets().u32(1).text(text)); };
  EXPECT_EQ(check(offered(partition("a*b*c*d*"))), kFine);
  EXPECT_EQ(check(offered(partition("a*b*c*d*e*"))), rtps::Refusal::kParameter);
  EXPECT_EQ(check(offered(Octets().parameter(0x29, Octets().u32(2).text("a")))), rtps::Refusal::kParameter);
  EXPECT_EQ(check(offered(Octets().parameter(0x29, Octets().u32(~0U).text("a")))), rtps::Refusal::kParameter);
}

TEST(Datagram, HasPropertiesLocatorsAndLeasesThatAreSome) {
  EXPECT_EQ(check(announced(Octets().parameter(0x59, Octets().u32(1).text("key").text("value")))), kFine);
  EXPECT_EQ(check(announced(Octets().parameter(0x59, Octets().u32(~0U).text("key")))), rtps::Refusal::kParameter);
  EXPECT_EQ(check(announced(Octets().parameter(0x59, Octets().u32(1).u32(0xffff'fffc).zeros(8)))),
            rtps::Refusal::kParameter);
  EXPECT_EQ(check(announced(Octets().parameter(0x32, Octets().u32(1).u32(7410).zeros(16)))), kFine);
  EXPECT_EQ(check(announced(Octets().parameter(0x32, Octets().u32(1).u32(70'000).zeros(16)))),
            rtps::Refusal::kParameter);
  EXPECT_EQ(check(announced(Octets().parameter(0x32, Octets().u32(1).u32(7410)))), rtps::Refusal::kParameter);
  Octets many;
  for (int i = 0; i < 40; ++i) many.parameter(0x32, Octets().u32(1).u32(7410).zeros(16));
  EXPECT_EQ(check(announced(many)), rtps::Refusal::kParameter);
  EXPECT_EQ(check(announced({}, 0)), rtps::Refusal::kParameter);
  EXPECT_EQ(check(announced({}, 0x7fff'ffff)), rtps::Refusal::kParameter);  // remembered for ever
}

TEST(Datagram, SaysOnceWhoIsAnnounced) {
  EXPECT_EQ(check(announced(Octets().parameter(0x70, Octets().guid({}, 0x1c1)))), rtps::Refusal::kParameter);
  const Octets nobody = to_all(Octets().parameter(0x02, lease(5)).sentinel());
  EXPECT_EQ(check(data(rtps::kParticipantWriter, 1, nobody.bytes())), rtps::Refusal::kPayload);
  EXPECT_EQ(check(data(rtps::kParticipantWriter, 1, participant({}).bytes())), rtps::Refusal::kPayload);
  EXPECT_EQ(check(data(kEndpointWriter, 1, endpoint(kPrefix, 0).bytes())), rtps::Refusal::kPayload);
}

TEST(Datagram, HidesTypesFiltersAndKeysOfSamples) {
  Bytes bytes = datagram({offered(Octets().parameter(0x72, Octets().zeros(400)).parameter(0x35, Octets().zeros(8)))});
  rtps::Findings findings;
  EXPECT_EQ(rtps::check_datagram(bytes, findings), kFine);
  EXPECT_EQ(findings.hidden_parameters.size(), 2U);
  findings.hide(bytes);
  EXPECT_EQ(rtps::check_datagram(bytes, findings), kFine);
  EXPECT_TRUE(findings.hidden_parameters.empty());
  const Bytes key = Octets().parameter(0x70, Octets().zeros(16)).sentinel().bytes();
  EXPECT_EQ(rtps::check_datagram(datagram({fragment({}, {}, key)}), findings), kFine);
  EXPECT_EQ(findings.hidden_parameters.size(), 1U);
  EXPECT_EQ(rtps::check_datagram(datagram({data(kWriter, 1, {0, 1, 0, 0}, key)}), findings), kFine);
  EXPECT_EQ(findings.hidden_parameters.size(), 1U);
}

TEST(Datagram, OfDdsSecurityHasLengthsThatFit) {
  EXPECT_EQ(check(submessage(0x31, 0, Octets().zeros(20))), kFine);
  EXPECT_EQ(check(submessage(0x31, 0, Octets().zeros(16))), rtps::Refusal::kLength);
  EXPECT_EQ(check(submessage(0x30, 0, Octets().raw({0, 0, 0, 8}).zeros(8))), kFine);
  EXPECT_EQ(check(submessage(0x30, 0, Octets().raw({0, 0, 0, 9}).zeros(8))), rtps::Refusal::kLength);
  EXPECT_EQ(check(submessage(0x32, 0, Octets().zeros(20))), kFine);
  EXPECT_EQ(check(submessage(0x34, 0, Octets().zeros(16).raw({0, 0, 0, 1}).zeros(20))), kFine);
  EXPECT_EQ(check(submessage(0x34, 0, Octets().zeros(16).raw({0xff, 0xff, 0xff, 0xff}).zeros(20))),
            rtps::Refusal::kLength);
}

/// Before it is known who somebody is, what he says is read: a count of 2^32 tokens would be taken memory for.
TEST(Datagram, HasHandshakesWhoseCountsFit) {
  const auto handshake = [](std::uint32_t tokens) {
    return data(kHandshakeWriter, 1,
                Octets()
                    .raw({0, 1, 0, 0})
                    .zeros(96)
                    .text("dds.sec.auth")
                    .u32(tokens)
                    .text("token")
                    .u32(0)
                    .u32(1)
                    .text("hash")
                    .u32(4)
                    .zeros(4)
                    .bytes());
  };
  EXPECT_EQ(check(handshake(1)), kFine);
  EXPECT_EQ(check(handshake(2)), rtps::Refusal::kPayload);
  EXPECT_EQ(check(handshake(~0U)), rtps::Refusal::kPayload);
}

/// Reads nothing beyond the end (AddressSanitizer sees it), and asks for no memory by what it reads.
TEST(Datagram, OfAnyBytesIsCheckedWithoutHarm) {
  DatagramMutator mutator(20'240'611);
  const Octets names =
      Octets().parameter(0x62, Octets().text("node")).parameter(0x59, Octets().u32(1).text("a").text("b"));
  mutator.use({datagram({announced(names)}), datagram({offered(names)}), datagram({heartbeat(1, 9), gap(3, 5, 40)}),
               datagram({fragment({})}), datagram({data(kWriter, 3, {0, 1, 0, 0, 1, 2, 3, 4})}),
               datagram({statistics()})});
  rtps::Findings findings;
  std::size_t refused = 0;
  constexpr std::size_t kCount = 200'000;
  for (std::size_t i = 0; i < kCount; ++i) {
    const Bytes bytes = mutator.next();
    const Bytes exactly(bytes.begin(), bytes.end());  // no room behind
    if (rtps::check_datagram(exactly, findings)) ++refused;
    EXPECT_LE(findings.size, exactly.size());
  }
  EXPECT_GT(refused, kCount / 4);
  EXPECT_LT(refused, kCount);
}

}  // namespace
}  // namespace aurasim::dds
