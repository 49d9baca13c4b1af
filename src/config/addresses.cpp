#include "config/addresses.h"

#include <charconv>
#include <cstdint>

#include <arpa/inet.h>

namespace aurasim::config {

bool is_ipv4(const std::string& text) {
  ::in_addr address{};
  return ::inet_pton(AF_INET, text.c_str(), &address) == 1;
}

/// True for an address. One of IPv6 may name an interface behind a %.
bool is_address(const std::string& text) {
  ::in6_addr address{};
  return text == "localhost" || is_ipv4(text) ||
         ::inet_pton(AF_INET6, text.substr(0, text.find('%')).c_str(), &address) == 1;
}

bool is_ipv4_with_port(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (!is_ipv4(text.substr(0, colon))) return false;
  if (colon == std::string::npos) return true;
  std::uint16_t port = 0;
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data() + colon + 1, last, port);
  return error == std::errc{} && end == last && port != 0;
}

}  // namespace aurasim::config
