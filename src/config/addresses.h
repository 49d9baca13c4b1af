// Recognises addresses of hosts in texts. Pure: whether the host exists is checked where the address is used.
#pragma once

#include <string>

namespace aurasim::config {

/// True for an IPv4 address such as 10.0.0.7.
bool is_ipv4(const std::string& text);
/// True for an address of IPv4 or IPv6, and for "localhost".
bool is_address(const std::string& text);
/// True for 10.0.0.7 and 10.0.0.7:7410.
bool is_ipv4_with_port(const std::string& text);

}  // namespace aurasim::config
