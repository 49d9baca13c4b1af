// Finds the largest datagram that IP does not fragment. Losing one IP fragment loses the whole datagram.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace aurasim::dds {

/// An IPv4 address of this host that is up.
struct Interface {
  std::string name;
  std::string address;
  bool is_loopback = false;
  std::uint32_t mtu_B = 0;
  bool is_running = true;  ///< its link has a carrier
};

/// Interfaces as the kernel lists them; empty when the query fails.
std::vector<Interface> interfaces_of_this_host();

/// True when every link that a participant with this white list would use is up (addresses; empty: all). Fast DDS
/// leaves out interfaces whose links are down, and never looks at them again.
bool all_links_are_up(const std::vector<Interface>& interfaces, const std::vector<std::string>& white_list);

/// The largest UDP payload, bytes, that fits into one packet on every one of `interfaces` that `white_list` (addresses;
/// empty: all) lets through. 0 when no limit is known: loopback does not fragment.
std::uint32_t largest_payload_B(const std::vector<Interface>& interfaces, const std::vector<std::string>& white_list);

}  // namespace aurasim::dds
