// State that all connections of a web server share. Used by the server's thread, unless a comment says otherwise.
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

inline constexpr std::size_t kMostCallers = 256;  // connections by HTTP, pages not counted
inline constexpr std::size_t kMostCallersOfOne = 64;

/// A page with a WebSocket, as the hub sees it.
class PageConnection {
 public:
  virtual ~PageConnection() = default;
  /// Sends the next waiting message, unless one is being sent.
  virtual void pump() = 0;
  /// Ends the connection if the present message has been in sending for longer than `limit`. Returns whether it did.
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
  std::string encoding = {};  ///< content encoding of the body; empty: none
  std::string etag = {};      ///< ETag; empty: the content changes
  std::string cookie = {};    ///< value for Set-Cookie
};

/// Holds one of a limited number of places, and gives it back on destruction; in any thread.
class Place {
 public:
  Place() = default;
  /// Takes a place. Holds nothing if all are taken.
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

/// The places that one page takes. Holds nothing if all are taken.
struct PagePlace {
  Place of_all;
  Place of_address;
  explicit operator bool() const { return of_all && of_address; }
};

class WebHub {
 public:
  /// `settings.port` must be the port that the server listens on.
  WebHub(const WebSettings& settings, ShapeStore& shapes)
      : settings_(settings), shapes_(shapes), access_(settings), files_(settings.pages) {}

  // -- for connections
  const WebSettings& settings() const { return settings_; }
  ShapeStore& shapes() { return shapes_; }
  WebAccess& access() { return access_; }
  const SlotTable& table() const { return table_; }
  /// Takes a place for a page that is about to join. Taken before its WebSocket is accepted; otherwise more pages could
  /// join than there are places.
  PagePlace page_place(const std::string& address);
  /// Takes a place for a mesh that is about to be uploaded. The mesh is held in memory until it has been read.
  Place upload_place() { return {upload_places_, settings_.most_uploads}; }
  void join(const std::shared_ptr<PageConnection>& page);
  void leave(ClientId id);
  /// Handles a text message of a page.
  void read(PageConnection& page, std::string_view text);
  void refuse() { ++refused_; }
  /// Returns the answer to GET.
  HttpAnswer get(std::string_view target, const FileRequest& request, Standing standing);
  /// Returns the client's rights as JSON.
  static HttpAnswer session(Standing standing);

  /// Admits a new connection.
  void enter(const std::shared_ptr<WebCaller>& caller);

  // -- for the server
  void publish(Notice notice, SharedText text);
  void show(const WorldFrame& frame);
  void show_overlays(const SharedBytes& overlays);
  void set_metrics(std::string text) { metrics_ = std::move(text); }
  void answer(const Reply& reply);
  void drop_stalled();
  /// Releases all pages before the sockets' service ends.
  void clear() { pages_.clear(); }

  // -- any thread
  std::vector<PageRequest> take_requests();
  WebCounters counters() const;
  /// Overlays that any page wants.
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
  core::TokenBucket rays_{50, 100};  ///< rate of rays of all pages together; nodes answer them
  SlotTable table_;
  std::array<SharedText, kNotices> notices_;
  std::string metrics_;
  std::map<ClientId, std::shared_ptr<PageConnection>> pages_;
  std::uint64_t next_id_ = 1;

  std::mutex requests_mutex_;
  std::vector<PageRequest> requests_;
  std::atomic<std::size_t> page_places_{0}, upload_places_{0};
  std::map<std::string, std::atomic<std::size_t>> page_places_of_;  ///< pages of each address
  std::atomic<bool> auras_wanted_ = false, links_wanted_ = false, contacts_wanted_ = false;
  std::atomic<std::uint64_t> clients_{0}, connections_{0}, frames_sent_{0}, frames_skipped_{0}, bytes_sent_{0},
      refused_{0}, dropped_{0};
};

std::string reply_text(const Reply& reply);

}  // namespace aurasim::overseer
