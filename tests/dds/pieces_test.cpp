// Discovery that comes in fragments: Fast DDS sees it whole.
#include <algorithm>
#include <string>

#include "guard_fixture.h"
#include "rtps/datagram_check.h"

namespace aurasim::dds {
namespace {

using namespace testing;  // NOLINT: samples
using testing::datagram;

class InPieces : public Guard {
 protected:
  InPieces() { passes(data(rtps::kParticipantWriter, 1, participant(kPrefix).bytes())); }

  static Octets timestamp() { return submessage(0x09, 0, Octets().u32(1'700'000'000).u32(0x8000'0000)); }
  static std::vector<Bytes> in_pieces(std::uint32_t writer, const Bytes& payload, std::uint64_t number) {
    std::vector<Bytes> pieces;
    for (std::size_t at = 0; at < payload.size(); at += 1024) {
      const std::size_t size = std::min<std::size_t>(1024, payload.size() - at);
      const Bytes part(payload.begin() + static_cast<std::ptrdiff_t>(at),
                       payload.begin() + static_cast<std::ptrdiff_t>(at + size));
      pieces.push_back(datagram({timestamp(),
                                 fragment({writer, number, static_cast<std::uint32_t>(at / 1024 + 1), 1, 1024,
                                           static_cast<std::uint32_t>(payload.size()), size},
                                          part),
                                 heartbeat(1, 2, writer)}));
    }
    return pieces;
  }
  /// What Fast DDS sees of fragments, one after the other.
  std::vector<Bytes> seen_of(std::vector<Bytes> pieces) {
    std::vector<Bytes> seen;
    for (Bytes& piece : pieces) {
      const auto admitted = guard_.admit(piece, kSource, now_);
      for (const rtps::MadeDatagram& made : admitted.before) seen.push_back(octets_of(made));
      rtps::Findings findings;
      EXPECT_FALSE(admitted.size > 0 && rtps::check_datagram(std::span(piece).first(admitted.size), findings));
      for (const rtps::Claim& claim : findings.claims) EXPECT_NE(claim.kind, rtps::Claim::Kind::kFragments);
    }
    return seen;
  }
  static Bytes whole(std::uint32_t writer, const Bytes& payload, std::uint64_t number) {
    const Octets sample = data(writer, number, payload);
    Bytes to_the_end = sample.bytes();
    to_the_end[2] = to_the_end[3] = 0;
    return datagram({timestamp(), Octets().raw(to_the_end)});
  }
};

class DiscoveryInPieces : public InPieces {
 protected:
  /// One parameter of 2.8 kB, all of `octet`.
  [[gnu::noinline]] static Bytes description(std::uint16_t pid, std::uint8_t octet) {  // GCC 12 warns of it otherwise
    Octets value;
    value.raw(Bytes(2804, octet));
    return endpoint(kPrefix, kWriter, Octets().parameter(pid, value)).bytes();
  }
  static std::vector<Bytes> sound(std::uint64_t number) {
    return in_pieces(kEndpointWriter, description(0x8000, 0), number);
  }
  /// So many partitions there are not.
  static std::vector<Bytes> unsound(std::uint64_t number) {
    return in_pieces(kEndpointWriter, description(0x29, 0xff), number);
  }
};

TEST_F(DiscoveryInPieces, IsSeenWhole) {
  ASSERT_EQ(sound(1).size(), 3U);
  const auto seen = seen_of(sound(1));
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0], whole(kEndpointWriter, description(0x8000, 0), 1));
}

TEST_F(DiscoveryInPieces, MayComeInAnyOrderAndTwice) {
  const auto pieces = sound(1);
  EXPECT_EQ(seen_of({pieces[2], pieces[0], pieces[2], pieces[1]}).size(), 1U);
  EXPECT_EQ(seen_of(sound(1)).size(), 1U) << "it has been asked for again";
}

TEST_F(DiscoveryInPieces, ThatIsUnsoundIsNeverSeen) {
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(seen_of(unsound(2)).empty());
  EXPECT_EQ(refused(rtps::Refusal::kParameter), 3U);
  EXPECT_EQ(seen_of(sound(3)).size(), 1U);
}

/// What a type object says, Fast DDS 2.9.1 ends itself for (issue 3296).
TEST_F(DiscoveryInPieces, IsSeenWithoutTypeObjects) {
  const auto seen = seen_of(in_pieces(kEndpointWriter, description(0x72, 0xee), 1));
  ASSERT_EQ(seen.size(), 1U);
  rtps::Findings findings;
  EXPECT_FALSE(rtps::check_datagram(seen[0], findings));
  EXPECT_TRUE(findings.hidden_parameters.empty()) << "it is hidden";
}

TEST_F(DiscoveryInPieces, OfSomebodyWhoIsNotKnownYetIsSeen) {
  rtps::DatagramGuard guard;
  std::size_t seen = 0;
  Octets name;
  name.text(std::string(2000, 'a'));
  const Bytes announcement = participant(kPrefix, Octets().parameter(0x8001, name)).bytes();
  for (Bytes& piece : in_pieces(rtps::kParticipantWriter, announcement, 1))
    seen += guard.admit(piece, kSource, now_).before.size();
  EXPECT_EQ(seen, 1U);
  for (Bytes& piece : sound(1)) seen += guard.admit(piece, kSource, now_).before.size();
  EXPECT_EQ(seen, 2U);
}

/// Others that begin, and never end.
TEST_F(DiscoveryInPieces, IsNotKeptOutByMore) {
  for (std::uint64_t number = 10; number < 5'000; ++number) passes(unsound(number)[0]);
  EXPECT_EQ(seen_of(sound(5'000)).size(), 1U);
}

TEST_F(DiscoveryInPieces, HasSomeKilobytes) {
  EXPECT_FALSE(passes(fragment({.writer = kEndpointWriter, .sample_B = 100'000})));
  EXPECT_EQ(refused(rtps::Refusal::kFragment), 1U);
}

TEST_F(DiscoveryInPieces, MayComeAnyNumberOfTimes) {
  for (std::uint64_t number = 1; number <= 5'000; ++number) ASSERT_EQ(seen_of(sound(number)).size(), 1U) << number;
}

TEST_F(DiscoveryInPieces, IsForWhomAllItsPiecesAreFor) {
  std::uint64_t number = 0;
  const auto seen_by = [&](std::uint32_t first, std::uint32_t others) {
    auto pieces = sound(++number);
    constexpr std::size_t kReaderAt = rtps::kHeaderBytes + 12 + 4 + 4;
    for (Bytes& piece : pieces) {
      const std::uint32_t reader = &piece == &pieces.front() ? first : others;
      for (int i = 0; i < 4; ++i) piece[kReaderAt + i] = static_cast<std::uint8_t>(reader >> 8 * (3 - i));
    }
    const auto seen = seen_of(pieces);
    if (seen.size() != 1) return ~0U;
    std::uint32_t reader = 0;
    for (int i = 0; i < 4; ++i) reader = reader << 8 | seen[0][kReaderAt + i];
    return reader;
  };
  EXPECT_EQ(seen_by(kReader, kReader), kReader);
  EXPECT_EQ(seen_by(kReader, kReader + 0x100), 0U);
  EXPECT_EQ(seen_by(0, 0), 0U);
  EXPECT_EQ(seen_by(0, kReader), 0U);
}

}  // namespace
}  // namespace aurasim::dds
