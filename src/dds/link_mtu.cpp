#include "dds/link_mtu.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace aurasim::dds {
namespace {

constexpr std::uint32_t kHeaders_B = 20 + 8;  // IPv4 without options, UDP

std::uint32_t mtu_of(int socket, const char* name) {
  ::ifreq request{};
  std::strncpy(request.ifr_name, name, IFNAMSIZ - 1);
  return ::ioctl(socket, SIOCGIFMTU, &request) == 0 ? static_cast<std::uint32_t>(request.ifr_mtu) : 0;
}

std::string address_of(const ::sockaddr& address) {
  ::sockaddr_in ipv4{};
  std::memcpy(&ipv4, &address, sizeof ipv4);
  std::array<char, INET_ADDRSTRLEN> text{};
  ::inet_ntop(AF_INET, &ipv4.sin_addr, text.data(), text.size());
  return text.data();
}

}  // namespace

std::vector<Interface> interfaces_of_this_host() {
  std::vector<Interface> interfaces;
  ::ifaddrs* first = nullptr;
  if (::getifaddrs(&first) != 0) return interfaces;
  const std::unique_ptr<::ifaddrs, void (*)(::ifaddrs*)> owner(first, ::freeifaddrs);
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  for (const ::ifaddrs* i = first; i != nullptr; i = i->ifa_next) {
    const bool is_up = (i->ifa_flags & IFF_UP) != 0;
    if (!is_up || i->ifa_addr == nullptr || i->ifa_addr->sa_family != AF_INET) continue;
    interfaces.push_back({i->ifa_name, address_of(*i->ifa_addr), (i->ifa_flags & IFF_LOOPBACK) != 0,
                          mtu_of(socket, i->ifa_name), (i->ifa_flags & IFF_RUNNING) != 0});
  }
  if (socket >= 0) ::close(socket);
  return interfaces;
}

bool all_links_are_up(const std::vector<Interface>& interfaces, const std::vector<std::string>& white_list) {
  const auto runs = [&](const std::string& address) {
    const auto found = std::ranges::find(interfaces, address, &Interface::address);
    return found != interfaces.end() && found->is_running;
  };
  if (!white_list.empty()) return std::ranges::all_of(white_list, runs);
  return std::ranges::all_of(interfaces, &Interface::is_running) &&
         std::ranges::any_of(interfaces, [](const Interface& i) { return !i.is_loopback; });
}

std::uint32_t largest_payload_B(const std::vector<Interface>& interfaces, const std::vector<std::string>& white_list) {
  std::uint32_t smallest = 0;
  for (const Interface& i : interfaces) {
    const bool carries = white_list.empty() || std::ranges::find(white_list, i.address) != white_list.end();
    if (!carries || i.is_loopback || i.mtu_B <= kHeaders_B) continue;
    smallest = smallest == 0 ? i.mtu_B : std::min(smallest, i.mtu_B);
  }
  return smallest == 0 ? 0 : smallest - kHeaders_B;
}

}  // namespace aurasim::dds
