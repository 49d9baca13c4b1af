// What all connections of a web server share. All of it belongs to the server's thread but for what says otherwise.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "overseer/web_server.h"

namespace aurasim::overseer {

/// A page with a WebSocket, as the hub sees it.
class PageConnection {
 public:
  virtual ~PageConnection() = default;
  /// Sends what there is, unless something is being sent.
  virtual void pump() = 0;
  /// Ends the connection if what is being sent has been for longer than that.
  virtual bool drop_if_stalled(std::chrono::steady_clock::duration limit) = 0;

  ClientId id{};
  ClientOutbox outbox;
  Show show;
  std::optional<core::BodyId> watched;
};

struct HttpAnswer {
  unsigned status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::string body;
};

class WebHub {
 public:
  WebHub(const WebSettings& settings, ShapeStore& shapes) : settings_(settings), shapes_(shapes) {}

  // -- for connections
  const WebSettings& settings() const { return settings_; }
  ShapeStore& shapes() { return shapes_; }
  const SlotTable& table() const { return table_; }
  bool has_room() const { return pages_.size() < settings_.most_clients; }
  void join(const std::shared_ptr<PageConnection>& page);
  void leave(ClientId id);
  /// A text message of a page.
  void read(PageConnection& page, std::string_view text);
  void refuse() { ++refused_; }
  /// The answer to GET.
  HttpAnswer get(std::string_view target);
  /// Why a request with these headers may not be served; empty: it may.
  std::string why_not(std::string_view host, std::string_view origin) const;
  bool knows_token(std::string_view token) const;

  // -- for the server
  void publish(Notice notice, SharedText text);
  void show(const WorldFrame& frame);
  void show_overlays(const SharedBytes& overlays);
  void set_metrics(std::string text) { metrics_ = std::move(text); }
  void answer(const Reply& reply);
  void drop_stalled();
  /// Lets go of all pages, before the sockets' service ends.
  void clear() { pages_.clear(); }

  // -- any thread
  std::vector<PageRequest> take_requests();
  WebCounters counters() const;
  /// What any page wants to have drawn.
  Show wanted() const { return {auras_wanted_, links_wanted_, contacts_wanted_}; }
  /// False: there are so many that this one has to go.
  bool open_connection();
  void close_connection() { --open_; }
  void count_sent(const Message& message, std::size_t bytes);

 private:
  void handle(PageConnection& page, PageMessage& message);
  void take_command(PageConnection& page, CommandMessage& message);
  void reply(PageConnection& page, const Reply& reply);
  void watch(PageConnection& page, const Watch& watch);
  void publish_watched(PageConnection& page);
  void note_wanted();
  bool enqueue(PageRequest request);
  std::string metrics() const;
  HttpAnswer get_file(std::string_view target) const;

  const WebSettings settings_;
  ShapeStore& shapes_;
  SlotTable table_;
  std::array<SharedText, kNotices> notices_;
  std::string metrics_;
  std::map<ClientId, std::shared_ptr<PageConnection>> pages_;
  std::uint64_t next_id_ = 1;

  std::mutex requests_mutex_;
  std::vector<PageRequest> requests_;
  std::atomic<std::uint64_t> open_{0};
  std::atomic<bool> auras_wanted_ = false, links_wanted_ = false, contacts_wanted_ = false;
  std::atomic<std::uint64_t> clients_{0}, connections_{0}, frames_sent_{0}, frames_skipped_{0}, bytes_sent_{0},
      refused_{0}, dropped_{0};
};

std::string reply_text(const Reply& reply);

}  // namespace aurasim::overseer
