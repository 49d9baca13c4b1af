// Serves the page, its WebSocket and the metrics (docs/viewer.md) in one thread of its own. The owner passes in frames
// and texts that never change again, and fetches the requests of pages. Boost stays behind this header.
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "overseer/client_outbox.h"
#include "overseer/shape_store.h"
#include "overseer/web_settings.h"

namespace aurasim::overseer {

/// The address is in use, or is not one of this host.
class CannotListen : public std::runtime_error {
 public:
  CannotListen(const std::string& what, bool port_is_taken) : std::runtime_error(what), port_is_taken_(port_is_taken) {}
  bool port_is_taken() const { return port_is_taken_; }

 private:
  bool port_is_taken_;
};

class WebServer {
 public:
  /// Starts to listen. Throws CannotListen, BadTls (tls_files.h). The store must outlive the server.
  WebServer(const WebSettings& settings, ShapeStore& shapes);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  std::uint16_t port() const;

  /// Sends a notice to every page, also to those that join later.
  void publish(Notice notice, std::string json);
  void show(const WorldFrame& frame);
  /// Sends overlays to the pages that want them.
  void show_overlays(Bytes overlays);
  void set_metrics(std::string text);
  void answer(const Reply& reply);

  /// Returns the requests of pages since the last call.
  std::vector<PageRequest> take_requests();
  WebCounters counters() const;
  /// Overlays that any page wants.
  Show wanted() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aurasim::overseer
