// Datagrams that the guard puts together in place of what came.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "dds/datagram_findings.h"

namespace aurasim::dds {

/// A payload whose octets come before what stands in front of them.
class MadeDatagram {
 public:
  /// Memory that is not touched yet.
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
  static constexpr std::size_t kRoom_B = 96;  ///< of header, destination, time, and what begins the submessage

  std::unique_ptr<std::uint8_t[]> octets_;  // NOLINT
  std::size_t begin_ = kRoom_B, end_;
};

/// Makes of the payload that is in it what the writer of `claim` would have sent had the sample not been too large.
/// `header` is of a datagram of the writer.
void make_data(MadeDatagram& sample, const Claim& claim, std::span<const std::uint8_t> header);
/// From the claim's first number to its last.
MadeDatagram datagram_of_gap(const Claim& claim, std::span<const std::uint8_t> header);

}  // namespace aurasim::dds
