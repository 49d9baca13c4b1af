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
#include <utility>
#include <vector>

#include "core/token_bucket.h"
#include "overseer/client_outbox.h"
#include "overseer/page_files.h"
#include "overseer/shape_store.h"
#include "overseer/web_access.h"
#include "overseer/web_callers.h"
#include "overseer/web_settings.h"

namespace aurasim::overseer {

inline constexpr std::size_t kMostCallers = 256;  // that ask by HTTP, pages not counted
inline constexpr std::size_t kMostCallersOfOne = 64;

/// A page with a WebSocket, as the hub sees it.
class PageConnection {
 public:
  virtual ~PageConnection() = default;
  /// Sends what there is, unless something is being sent.
  virtual void pump() = 0;
  /// Ends the connection if what is being sent has been for longer than that.
  virtual bool drop_if_stalled(std::chrono::steady_clock::duration limit) = 0;

  ClientId id{};
  Standing standing = Standing::kStranger;
  ClientOutbox outbox;
  core::TokenBucket rays{10, 20};
  Show show;
  std::optional<core::BodyId> watched;
};

struct HttpAnswer {
  unsigned status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::string body = {};
  std::string encoding = {};  ///< of the body; empty: as it is
  std::string etag = {};      ///< empty: of something that changes
  std::string cookie = {};    ///< for Set-Cookie
};

/// One of so many places. Given back when it ends; in any thread.
class Place {
 public:
  Place() = default;
  /// Holds nothing if all are taken.
  Place(std::atomic<std::size_t>& taken, std::size_t most) : taken_(&taken) {
    if (taken.fetch_add(1) < most) return;
    release();
  }
  Place(Place&& other) noexcept : taken_(std::exchange(other.taken_, nullptr)) {}
  Place& operator=(Place&& other) noexcept {
    if (this == &other) return *this;
    release();
    taken_ = std::exchange(other.taken_, nullptr);
    return *this;
  }
  ~Place() { release(); }

  explicit operator bool() const { return taken_ != nullptr; }
  void release() {
    if (taken_ != nullptr) --*std::exchange(taken_, nullptr);
  }

 private:
  std::atomic<std::size_t>* taken_ = nullptr;
};

/// Of one page. Holds nothing if all are taken.
struct PagePlace {
  Place of_all;
  Place of_address;
  explicit operator bool() const { return of_all && of_address; }
};

class WebHub {
 public:
  /// The port is the one that the server listens on.
  WebHub(const WebSettings& settings, ShapeStore& shapes)
      : settings_(settings), shapes_(shapes), access_(settings), files_(settings.pages) {}

  // -- for connections
  const WebSettings& settings() const { return settings_; }
  ShapeStore& shapes() { return shapes_; }
  WebAccess& access() { return access_; }
  const SlotTable& table() const { return table_; }
  /// For a page that is about to join. Asked for before its WebSocket is accepted, or more would join than there are
  /// places for.
  PagePlace page_place(const std::string& address);
  /// For a mesh that is about to be sent: it is held in memory until it has been read.
  Place upload_place() { return {upload_places_, settings_.most_uploads}; }
  void join(const std::shared_ptr<PageConnection>& page);
  void leave(ClientId id);
  /// A text message of a page.
  void read(PageConnection& page, std::string_view text);
  void refuse() { ++refused_; }
  /// The answer to GET.
  HttpAnswer get(std::string_view target, const FileRequest& request, Standing standing);
  /// What somebody may do, as JSON.
  static HttpAnswer session(Standing standing);

  /// A new connection.
  void enter(const std::shared_ptr<WebCaller>& caller);

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
  void count_sent(const Message& message, std::size_t bytes);

 private:
  void handle(PageConnection& page, PageMessage& message);
  void take_command(PageConnection& page, CommandMessage& message);
  void reply(PageConnection& page, const Reply& reply);
  void watch(PageConnection& page, const Watch& watch);
  void publish_watched(PageConnection& page);
  void note_wanted();
  bool enqueue(PageRequest request);
  bool may_cast_a_ray(PageConnection& page);
  std::string metrics() const;
  HttpAnswer get_file(std::string_view target, const FileRequest& request);

  const WebSettings settings_;
  ShapeStore& shapes_;
  WebAccess access_;
  PageFiles files_;
  WebCallers callers_{kMostCallers, kMostCallersOfOne};
  core::TokenBucket rays_{50, 100};  ///< of all pages: nodes answer them
  SlotTable table_;
  std::array<SharedText, kNotices> notices_;
  std::string metrics_;
  std::map<ClientId, std::shared_ptr<PageConnection>> pages_;
  std::uint64_t next_id_ = 1;

  std::mutex requests_mutex_;
  std::vector<PageRequest> requests_;
  std::atomic<std::size_t> page_places_{0}, upload_places_{0};
  std::map<std::string, std::atomic<std::size_t>> page_places_of_;  ///< by address
  std::atomic<bool> auras_wanted_ = false, links_wanted_ = false, contacts_wanted_ = false;
  std::atomic<std::uint64_t> clients_{0}, connections_{0}, frames_sent_{0}, frames_skipped_{0}, bytes_sent_{0},
      refused_{0}, dropped_{0};
};

std::string reply_text(const Reply& reply);

}  // namespace aurasim::overseer
