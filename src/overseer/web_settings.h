// What the web server is told, what it counts, and what it hands on: what its parts and its owner share.
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
  std::vector<std::string> names;  ///< that it is asked for by, beside its addresses and what its certificate says
  std::string token;               ///< what a page must know to change the world; empty: nothing
  std::string view_token;          ///< likewise to look at it
  std::filesystem::path pages;     ///< folder of the built page
  std::vector<std::string> scenes;
  std::size_t most_clients = 64;
  std::size_t most_clients_of_one = 16;  ///< address, but for this host's own: tunnels and proxies come from there
  std::size_t most_uploads = 8;          ///< at a time
  /// A connection that has not sent the header of its first request by then, after its TLS handshake, is dropped.
  std::chrono::milliseconds header_limit{5'000};
  std::chrono::milliseconds upload_limit{60'000};  ///< for the whole of a mesh
  /// A page that takes nothing for so long is dropped.
  std::chrono::milliseconds stall_limit{10'000};
};

/// Since the start, but for `clients`.
struct WebCounters {
  std::uint64_t clients = 0;
  std::uint64_t connections = 0;
  std::uint64_t frames_sent = 0;
  std::uint64_t frames_skipped = 0;  ///< merged into later ones
  std::uint64_t bytes_sent = 0;      ///< in WebSocket messages
  std::uint64_t refused = 0;         ///< requests and messages
  std::uint64_t dropped = 0;         ///< pages that took nothing
  std::uint64_t wrong_tokens = 0;
};

/// What a page asks of the owner.
using PageRequest = std::variant<Request, ReplayControl>;

}  // namespace aurasim::overseer
