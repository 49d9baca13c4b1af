// Serves the page, its WebSocket and the numbers about it (docs/viewer.md), in one thread of its own. The owner hands
// over frames and texts that never change again, and fetches what pages ask for. Boost stays behind this header.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "overseer/client_outbox.h"
#include "overseer/commands.h"
#include "overseer/page_input.h"
#include "overseer/shape_store.h"

namespace aurasim::overseer {

struct WebSettings {
  std::string bind = "127.0.0.1";
  std::uint16_t port = 8080;    ///< 0: any that is free
  std::string token;            ///< what a page must know to change the world; empty: nothing
  std::filesystem::path pages;  ///< folder of the built page
  std::vector<std::string> scenes;
  std::size_t most_clients = 64;
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
};

/// The address is in use, or is not one of this host.
class CannotListen : public std::runtime_error {
 public:
  CannotListen(const std::string& what, bool port_is_taken) : std::runtime_error(what), port_is_taken_(port_is_taken) {}
  bool port_is_taken() const { return port_is_taken_; }

 private:
  bool port_is_taken_;
};

using PageRequest = std::variant<Request, ReplayControl>;

class WebServer {
 public:
  /// Listens from now on. Throws CannotListen. The store outlives the server.
  WebServer(const WebSettings& settings, ShapeStore& shapes);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  std::uint16_t port() const;

  /// To every page, also to those that come later.
  void publish(Notice notice, std::string json);
  void show(const WorldFrame& frame);
  /// To the pages that want them.
  void show_overlays(Bytes overlays);
  void set_metrics(std::string text);
  void answer(const Reply& reply);

  /// What pages have asked for since the last call.
  std::vector<PageRequest> take_requests();
  WebCounters counters() const;
  /// What any page wants to have drawn.
  Show wanted() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::overseer
