// What was kept from Fast DDS, for people.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace aurasim::dds {

struct GuardReport {
  using Counts = std::array<std::uint64_t, 16>;  ///< by Refusal of datagram_check.h

  struct Address {
    std::uint32_t address = 0;  ///< IPv4; 127.0.0.1 is 0x7f000001
    Counts refused{};
  };

  std::uint64_t passed = 0;
  Counts refused{};
  std::vector<Address> addresses;  ///< that something was refused of, ascending
  std::uint64_t of_others = 0;     ///< refused, of more addresses than are told apart

  std::uint64_t total() const;
};

std::uint64_t total_of(const GuardReport::Counts& counts);
/// "3 length, 1 rate".
std::string text_of(const GuardReport::Counts& counts);
/// "10.0.0.7".
std::string text_of_address(std::uint32_t address);

}  // namespace aurasim::dds
