#include "rtps/made_datagrams.h"

#include <array>
#include <vector>

#include "rtps/wire_octets.h"

namespace aurasim::rtps {
namespace {

using Bytes = std::vector<std::uint8_t>;

void append_entity(Bytes& to, std::uint32_t entity) {
  for (int i = 3; i >= 0; --i) to.push_back(static_cast<std::uint8_t>(entity >> 8 * i));
}

/// Returns the begin of a datagram: RTPS header and destination.
Bytes begin_of(const Claim& claim, std::span<const std::uint8_t> header) {
  Bytes bytes;
  bytes.reserve(128);
  append(bytes, header.first(8));
  append(bytes, claim.guid.prefix);
  if (claim.destination != GuidPrefix{}) {
    append(bytes, std::array<std::uint8_t, 4>{0x0e, 1, 12, 0});
    append(bytes, claim.destination);
  }
  return bytes;
}

}  // namespace

void make_data(MadeDatagram& sample, const Claim& claim, std::span<const std::uint8_t> header) {
  Bytes bytes = begin_of(claim, header);
  if (claim.timestamp) {  // Fast DDS puts samples in order by it
    append(bytes, std::array<std::uint8_t, 4>{0x09, 1, 8, 0});
    append_number_pair(bytes, *claim.timestamp);
  }
  // Submessage length 0: it extends to the datagram's end.
  append(bytes, std::array<std::uint8_t, 8>{0x15, 1 | 4, 0, 0, 0, 0, 16, 0});
  append_entity(bytes, claim.reader);
  append_entity(bytes, claim.guid.entity);
  append_number_pair(bytes, claim.first);
  sample.put_in_front(bytes);
}

MadeDatagram datagram_of_gap(const Claim& claim, std::span<const std::uint8_t> header) {
  Bytes bytes = begin_of(claim, header);
  append(bytes, std::array<std::uint8_t, 4>{0x08, 1, 28, 0});
  append_entity(bytes, claim.reader);
  append_entity(bytes, claim.guid.entity);
  append_number_pair(bytes, claim.first);
  append_number_pair(bytes, claim.last + 1);
  append_number(bytes, 0);
  MadeDatagram gap(0);
  gap.put_in_front(bytes);
  return gap;
}

}  // namespace aurasim::rtps
