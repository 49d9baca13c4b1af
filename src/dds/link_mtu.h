// How large a datagram may be before IP cuts it into fragments, of which one that is lost loses all.
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
  bool is_running = true;  ///< its link carries
};

/// As the kernel tells; empty when it does not.
std::vector<Interface> interfaces_of_this_host();

/// Can a participant with this white list (addresses; empty: all) be made that reaches other hosts? Fast DDS leaves out
/// interfaces whose links are down, and never looks at them again.
bool all_links_are_up(const std::vector<Interface>& interfaces, const std::vector<std::string>& white_list);

/// The largest UDP payload that fits into one packet on every one of `interfaces` that `white_list` (addresses; empty:
/// all) lets through. 0 when there is no limit to know of: loopback does not cut.
std::uint32_t largest_payload_B(const std::vector<Interface>& interfaces, const std::vector<std::string>& white_list);

}  // namespace aurasim::dds
