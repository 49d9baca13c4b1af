// Report for people: which datagrams were kept from Fast DDS.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace aurasim::rtps {

struct GuardReport {
  using Counts = std::array<std::uint64_t, 16>;  ///< by Refusal of datagram_check.h

  struct Address {
    std::uint32_t address = 0;  ///< IPv4; 127.0.0.1 is 0x7f000001
    Counts refused{};
  };

  std::uint64_t passed = 0;
  Counts refused{};
  std::vector<Address> addresses;  ///< addresses from which something was refused, ascending
  std::uint64_t of_others = 0;     ///< datagrams refused from addresses beyond those counted one by one

  std::uint64_t total() const;
};

std::uint64_t total_of(const GuardReport::Counts& counts);
/// Text of the counts that are not 0, e.g. "3 length, 1 rate".
std::string text_of(const GuardReport::Counts& counts);
/// Text of an IPv4 address, e.g. "10.0.0.7".
std::string text_of_address(std::uint32_t address);

}  // namespace aurasim::rtps
