// Datagrams that the guard composes to replace received ones.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "rtps/datagram_findings.h"

namespace aurasim::rtps {

/// A datagram whose payload is filled in first; the headers are put in front of it afterwards.
class MadeDatagram {
 public:
  /// Allocates room for `payload_B` bytes without filling it.
  explicit MadeDatagram(std::size_t payload_B)
      : octets_(std::make_unique_for_overwrite<std::uint8_t[]>(kRoom_B + payload_B)),  // NOLINT: not filled with zeros
        end_(kRoom_B + payload_B) {}

  std::span<std::uint8_t> payload() const { return {octets_.get() + kRoom_B, end_ - kRoom_B}; }
  void put_in_front(std::span<const std::uint8_t> octets) {
    begin_ = kRoom_B - octets.size();
    std::ranges::copy(octets, octets_.get() + begin_);
  }
  std::span<std::uint8_t> bytes() const { return {octets_.get() + begin_, end_ - begin_}; }

 private:
  static constexpr std::size_t kRoom_B = 96;  ///< room for header, destination, time, and the begin of the submessage

  std::unique_ptr<std::uint8_t[]> octets_;  // NOLINT
  std::size_t begin_ = kRoom_B, end_;
};

/// Completes `sample`, which holds the payload, to the DATA datagram that the writer of `claim` would have sent if the
/// sample had fitted into one. `header` is the RTPS header of any datagram of that writer.
void make_data(MadeDatagram& sample, const Claim& claim, std::span<const std::uint8_t> header);
/// Returns a GAP datagram over the claim's sequence numbers, first to last.
MadeDatagram datagram_of_gap(const Claim& claim, std::span<const std::uint8_t> header);

}  // namespace aurasim::rtps
