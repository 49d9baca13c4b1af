// Settings, counters and requests of the web server, which its parts and its owner share.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "config/launch.h"
#include "overseer/commands.h"
#include "overseer/page_input.h"

namespace aurasim::overseer {

struct WebSettings {
  std::string bind = "127.0.0.1";
  std::uint16_t port = 8080;       ///< 0: any that is free
  std::optional<config::Tls> tls;  ///< nothing: plain HTTP
  /// Host names that clients may use, beside its addresses and the names in its certificate.
  std::vector<std::string> names;
  std::string token;            ///< token that a page must show to change the world; empty: none
  std::string view_token;       ///< token that a page must show to look at the world; empty: none
  std::filesystem::path pages;  ///< folder of the built page
  std::vector<std::string> scenes;
  std::size_t most_clients = 64;
  /// Pages of one address, except this host's own: tunnels and proxies connect from there.
  std::size_t most_clients_of_one = 16;
  std::size_t most_uploads = 8;  ///< uploads at a time
  /// A connection that has not sent the header of its first request within this time after its TLS handshake is
  /// dropped.
  std::chrono::milliseconds header_limit{5'000};
  std::chrono::milliseconds upload_limit{60'000};  ///< time for the upload of a whole mesh
  /// A page that receives nothing for this long is dropped.
  std::chrono::milliseconds stall_limit{10'000};
};

/// Counters since the start, except `clients`, which is the present number.
struct WebCounters {
  std::uint64_t clients = 0;
  std::uint64_t connections = 0;
  std::uint64_t frames_sent = 0;
  std::uint64_t frames_skipped = 0;  ///< frames merged into later ones
  std::uint64_t bytes_sent = 0;      ///< in WebSocket messages
  std::uint64_t refused = 0;         ///< refused requests and messages
  std::uint64_t dropped = 0;         ///< pages dropped because they received nothing
  std::uint64_t wrong_tokens = 0;
};

/// A request of a page to the owner.
using PageRequest = std::variant<Request, ReplayControl>;

}  // namespace aurasim::overseer
