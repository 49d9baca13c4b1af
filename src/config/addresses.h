// Which texts are addresses of hosts. Pure: whether a host has them is asked where they are used.
#pragma once

#include <string>

namespace aurasim::config {

/// Four numbers: 10.0.0.7.
bool is_ipv4(const std::string& text);
/// Of IPv4 or IPv6, or localhost.
bool is_address(const std::string& text);
/// 10.0.0.7 or 10.0.0.7:7410.
bool is_ipv4_with_port(const std::string& text);

}  // namespace aurasim::config
