#include "dds/fragment_requests.h"

#include <array>

#include "dds/wire_cursor.h"
#include "dds/wire_octets.h"

namespace aurasim::dds {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint8_t kAckNack = 0x06, kNackFrag = 0x12, kInfoDestination = 0x0e;
constexpr std::uint8_t kLittleFlag = 1, kFinalFlag = 2;
/// Most samples whose fragments are requested for one acknowledgement; the rest follow with the next.
constexpr int kMostRequests = 8;

/// Appends a request for fragments. `endpoints` are reader and writer, as in the acknowledgement.
void append_request(Bytes& to, std::span<const std::uint8_t> endpoints, std::uint64_t number,
                    const MissingFragments& missing, std::uint32_t count) {
  const auto length = static_cast<std::uint8_t>(28 + 4 * missing.words.size());
  append(to, std::array<std::uint8_t, 4>{kNackFrag, kLittleFlag, length, 0});
  append(to, endpoints);
  append_number_pair(to, number);
  append_number(to, missing.base);
  append_number(to, missing.count);
  for (const std::uint32_t word : missing.words) append_number(to, word);
  append_number(to, count);
}

/// Offset of the octet with bit `index` of a number set whose words begin at `words`.
std::size_t octet_of(std::size_t words, std::uint32_t index, bool little) {
  const std::uint32_t octet = index % 32 / 8;
  return words + index / 32 * 4 + (little ? 3 - octet : octet);
}

}  // namespace

/// Returns the acknowledgement without the samples whose fragments are requested, followed by those requests. Empty:
/// nothing to change.
Bytes FragmentRequests::instead_of(std::span<const std::uint8_t> ack_nack, const GuidPrefix& destination,
                                   const PeerBook& peers) {
  constexpr std::size_t kEndpoints = 4, kWords = 4 + 8 + 8 + 4;
  const bool little = (ack_nack[1] & kLittleFlag) != 0;
  WireCursor body(ack_nack, kEndpoints, ack_nack.size(), little);
  body.skip(4);
  const WireGuid writer{destination, body.entity()};
  const std::uint64_t base = body.sequence_number();
  const std::uint32_t bits = body.u32();
  if (body.failed() || (bits + 31) / 32 * 4 + 4 > body.left()) return {};
  Bytes changed, requests;
  int asked = 0, left = 0;
  for (std::uint32_t i = 0; i < bits; ++i) {
    const std::size_t at = octet_of(kWords, i, little);
    const auto bit = static_cast<std::uint8_t>(0x80U >> i % 8);
    if ((ack_nack[at] & bit) == 0) continue;
    const auto missing = peers.missing_of(writer, base + i);
    left += missing ? 0 : 1;
    if (!missing) continue;
    if (changed.empty()) append(changed, ack_nack);
    changed[at] = static_cast<std::uint8_t>(changed[at] & ~bit);
    if (++asked > kMostRequests) continue;
    append_request(requests, ack_nack.subspan(kEndpoints, 8), base + i, *missing, ++count_);
  }
  if (!changed.empty() && left == 0) changed[1] |= kFinalFlag;
  append(changed, requests);
  return changed;
}

std::optional<Bytes> FragmentRequests::put_into(std::span<const std::uint8_t> datagram, const PeerBook& peers) {
  std::optional<Bytes> changed;
  GuidPrefix destination{};
  std::size_t at = kHeaderBytes, copied = 0;
  while (datagram.size() >= at + 4) {
    const std::uint8_t id = datagram[at];
    const bool little = (datagram[at + 1] & kLittleFlag) != 0;
    const std::size_t size = 4 + std::size_t{WireCursor(datagram, at + 2, at + 4, little).u16()};
    if (size > datagram.size() - at) break;
    if (id == kInfoDestination) {
      destination = WireCursor(datagram, at + 4, at + size, little).octets<GuidPrefix>();
    } else if (id == kAckNack) {
      if (const Bytes instead = instead_of(datagram.subspan(at, size), destination, peers); !instead.empty()) {
        if (!changed) changed.emplace();
        append(*changed, datagram.subspan(copied, at - copied));
        append(*changed, instead);
        copied = at + size;
      }
    }
    at += size;
  }
  if (changed) append(*changed, datagram.subspan(copied));
  return changed;
}

}  // namespace aurasim::dds
