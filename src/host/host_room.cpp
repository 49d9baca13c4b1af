#include "host/host_room.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

namespace aurasim::host {
namespace {

constexpr std::size_t kTriedByFastDds = 100;
constexpr std::size_t kOthers = 3;  // the launcher, the viewer, and a command such as `top`
constexpr int kHighestPort = 65535;

/// Parses an IPv4 or IPv6 address. Returns its length, or 0 when it is neither.
::socklen_t address_of(const std::string& text, std::uint16_t port, ::sockaddr_storage& out) {
  auto* v4 = reinterpret_cast<::sockaddr_in*>(&out);
  auto* v6 = reinterpret_cast<::sockaddr_in6*>(&out);
  if (::inet_pton(AF_INET, text == "localhost" ? "127.0.0.1" : text.c_str(), &v4->sin_addr) == 1) {
    v4->sin_family = AF_INET;
    v4->sin_port = htons(port);
    return sizeof(::sockaddr_in);
  }
  if (::inet_pton(AF_INET6, text.c_str(), &v6->sin6_addr) != 1) return 0;
  v6->sin6_family = AF_INET6;
  v6->sin6_port = htons(port);
  return sizeof(::sockaddr_in6);
}

}  // namespace

std::size_t participants_that_fit(int domain) {
  const int first_port = 7411 + 250 * domain;
  return std::min(kTriedByFastDds, static_cast<std::size_t>((kHighestPort - first_port) / 2 + 1));
}

std::optional<std::string> problem_with_regions(std::size_t regions, int domain) {
  const std::size_t room = participants_that_fit(domain) - kOthers;
  if (regions <= room) return std::nullopt;
  return fmt::format(
      "regions: found {}, allowed: at most {} on one host: Fast DDS has ports for {} processes of DDS domain {}, and "
      "{} "
      "are kept for the launcher, the viewer and a command. Use fewer regions, or several hosts (`aurasim node`)",
      regions, room, room + kOthers, domain, kOthers);
}

std::optional<std::string> warning_of_turns(std::size_t regions, unsigned processors) {
  if (processors == 0 || regions <= processors) return std::nullopt;
  return fmt::format("{} regions on {} processor{}: they take turns, and may be slower than the clock (rtf below 1)",
                     regions, processors, processors == 1 ? "" : "s");
}

std::optional<std::string> problem_with_listening(const std::string& address, std::uint16_t port) {
  ::sockaddr_storage place{};
  const ::socklen_t size = address_of(address, port, place);
  if (size == 0) return fmt::format("overseer.bind: '{}' is not an address", address);
  const int file = ::socket(place.ss_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (file < 0) return fmt::format("no viewer: {}", std::strerror(errno));
  const int reuse = 1;
  ::setsockopt(file, SOL_SOCKET, SO_REUSEADDR, &reuse, sizeof(reuse));
  const int failed = ::bind(file, reinterpret_cast<const ::sockaddr*>(&place), size) == 0 ? 0 : errno;
  ::close(file);
  if (failed == 0 || failed == EADDRINUSE) return std::nullopt;
  return fmt::format(
      "the viewer cannot listen on {}:{}: {}. Choose others by --set overseer.port=N, "
      "--set overseer.bind=ADDRESS, or none by --headless",
      address, port, std::strerror(failed));
}

}  // namespace aurasim::host
