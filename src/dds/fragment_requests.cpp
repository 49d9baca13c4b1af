#include "dds/fragment_requests.h"

#include <algorithm>
#include <array>

namespace aurasim::dds {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint8_t kAckNack = 0x06, kNackFrag = 0x12, kInfoDestination = 0x0e;
constexpr std::uint8_t kLittleFlag = 1, kFinalFlag = 2;
/// In one acknowledgement; of more it asks in the next.
constexpr int kMostRequests = 8;

/// One by one: GCC 12 warns of what insert() does.
void append(Bytes& to, std::span<const std::uint8_t> octets) {
  for (const std::uint8_t octet : octets) to.push_back(octet);
}

void append_number(Bytes& to, std::uint32_t number) {
  for (int i = 0; i < 4; ++i) to.push_back(static_cast<std::uint8_t>(number >> 8 * i));
}

/// `endpoints` are reader and writer, as in the acknowledgement.
void append_request(Bytes& to, std::span<const std::uint8_t> endpoints, std::uint64_t number,
                    const MissingFragments& missing, std::uint32_t count) {
  const auto length = static_cast<std::uint8_t>(28 + 4 * missing.words.size());
  append(to, std::array<std::uint8_t, 4>{kNackFrag, kLittleFlag, length, 0});
  append(to, endpoints);
  append_number(to, static_cast<std::uint32_t>(number >> 32));
  append_number(to, static_cast<std::uint32_t>(number));
  append_number(to, missing.base);
  append_number(to, missing.count);
  for (const std::uint32_t word : missing.words) append_number(to, word);
  append_number(to, count);
}

/// Bit `index` of a number set whose words begin at `words`.
std::size_t octet_of(std::size_t words, std::uint32_t index, bool little) {
  const std::uint32_t octet = index % 32 / 8;
  return words + index / 32 * 4 + (little ? 3 - octet : octet);
}

}  // namespace

struct FragmentRequests::Submessage {
  bool little = true;
  GuidPrefix destination{};
};

/// Takes out of it what is asked for otherwise, which it returns.
Bytes FragmentRequests::take_from(std::span<std::uint8_t> ack_nack, const Submessage& which, const PeerBook& peers) {
  constexpr std::size_t kEndpoints = 4, kWords = 4 + 8 + 8 + 4;
  WireCursor body(ack_nack, kEndpoints, ack_nack.size(), which.little);
  body.skip(4);
  const WireGuid writer{which.destination, body.entity()};
  const std::uint64_t base = body.sequence_number();
  const std::uint32_t bits = body.u32();
  Bytes requests;
  if (body.failed() || (bits + 31) / 32 * 4 + 4 > body.left()) return requests;
  int asked = 0, left = 0;
  for (std::uint32_t i = 0; i < bits; ++i) {
    std::uint8_t& octet = ack_nack[octet_of(kWords, i, which.little)];
    const auto bit = static_cast<std::uint8_t>(0x80U >> i % 8);
    if ((octet & bit) == 0) continue;
    const auto missing = peers.missing_of(writer, base + i);
    left += missing ? 0 : 1;
    if (!missing) continue;
    octet = static_cast<std::uint8_t>(octet & ~bit);
    if (++asked > kMostRequests) continue;
    append_request(requests, ack_nack.subspan(kEndpoints, 8), base + i, *missing, ++count_);
  }
  if (asked > 0 && left == 0) ack_nack[1] |= kFinalFlag;
  return requests;
}

std::optional<Bytes> FragmentRequests::put_into(std::span<const std::uint8_t> datagram, const PeerBook& peers) {
  std::optional<Bytes> changed;
  Submessage now;
  std::size_t at = kHeaderBytes;
  while (datagram.size() >= at + 4) {
    const std::uint8_t id = datagram[at];
    now.little = (datagram[at + 1] & kLittleFlag) != 0;
    const std::size_t size = 4 + std::size_t{WireCursor(datagram, at + 2, at + 4, now.little).u16()};
    if (size > datagram.size() - at) break;
    const auto submessage = datagram.subspan(at, size);
    if (id == kInfoDestination) {
      now.destination = WireCursor(datagram, at + 4, at + size, now.little).octets<GuidPrefix>();
    }
    Bytes own, requests;
    if (id == kAckNack) {
      own.assign(submessage.begin(), submessage.end());
      requests = take_from(own, now, peers);
    }
    if (!requests.empty() && !changed) {
      const auto before = datagram.first(at);
      changed.emplace(before.begin(), before.end());
    }
    if (changed) {
      append(*changed, own.empty() ? submessage : std::span<const std::uint8_t>(own));
      append(*changed, requests);
    }
    at += size;
  }
  if (changed) append(*changed, datagram.subspan(at));
  return changed;
}

}  // namespace aurasim::dds
