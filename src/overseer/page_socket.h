// A page with its WebSocket.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "core/token_bucket.h"
#include "overseer/web_hub.h"
#include "overseer/web_stream.h"

namespace aurasim::overseer {

/// Shortest time between two frames for one page, however fast the run goes.
inline constexpr std::chrono::milliseconds kFrameSpacing{12};
/// Size of the kernel's send buffer for one page, bytes. More would only make the picture older.
inline constexpr int kSendBuffer = 128 * 1024;
inline constexpr std::chrono::seconds kHandshakeLimit{5};
inline constexpr std::chrono::seconds kSilenceLimit{30};
/// Rate at which one page's messages are read. The excess waits on the page's own host, and other pages do not notice.
/// A page that drags a body sends some 30 messages a second.
inline constexpr std::size_t kReadBytes_per_s = 128 * 1024;
inline constexpr double kMessages = 200;
inline constexpr double kMessages_per_s = 100;
/// Pings of one page, as a token bucket: its size, and its refill a second. The library answers pings before our code
/// sees them, so a page that sends more is dropped.
inline constexpr double kPings = 50;
inline constexpr double kPings_per_s = 5;

template <class Stream>
class PageSocket final : public PageConnection, public std::enable_shared_from_this<PageSocket<Stream>> {
 public:
  using Error = boost::beast::error_code;
  using Clock = std::chrono::steady_clock;

  PageSocket(Stream stream, WebHub& hub, PagePlace place, Standing its_standing)
      : socket_(std::move(stream)),
        hub_(hub),
        place_(std::move(place)),
        spacing_(socket_.get_executor()),
        reading_(socket_.get_executor()) {
    standing = its_standing;
  }

  void start(const boost::beast::http::request<boost::beast::http::string_body>& upgrade) {
    namespace asio = boost::asio;
    namespace websocket = boost::beast::websocket;
    PlainStream& tcp = socket_of(socket_.next_layer());
    tcp.expires_never();
    tcp.rate_policy().read_limit(kReadBytes_per_s);
    Error ignored;
    tcp.socket().set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
    tcp.socket().set_option(asio::ip::tcp::no_delay(true), ignored);
    socket_.set_option(websocket::stream_base::timeout{kHandshakeLimit, kSilenceLimit, true});
    socket_.read_message_max(kLongestMessage);
    socket_.auto_fragment(false);
    socket_.control_callback([this](websocket::frame_type, boost::beast::string_view) {
      if (pings_.charge(Clock::now().time_since_epoch()) > Clock::duration::zero()) refuse();
    });
    socket_.async_accept(upgrade, [self = this->shared_from_this()](Error error) {
      if (error) return;
      self->hub_.join(self);
      self->read();
    });
  }

  void pump() override {
    namespace asio = boost::asio;
    if (sending_ || ended_) return;
    std::optional<Message> message = outbox.next(hub_.table(), Clock::now() - last_frame_ >= kFrameSpacing);
    if (!message) return pump_later();
    in_flight_ = std::move(*message);
    sending_ = true;
    send_began_ = Clock::now();
    if (in_flight_.is_frame) last_frame_ = send_began_;
    socket_.binary(in_flight_.bytes != nullptr);
    const asio::const_buffer buffer =
        in_flight_.bytes ? asio::buffer(*in_flight_.bytes) : asio::const_buffer(asio::buffer(*in_flight_.text));
    socket_.async_write(buffer, [self = this->shared_from_this()](Error error, std::size_t bytes) {
      self->sending_ = false;
      if (error) return self->end();
      self->hub_.count_sent(self->in_flight_, bytes);
      self->pump();
    });
  }

  bool drop_if_stalled(Clock::duration limit) override {
    if (!sending_ || ended_ || Clock::now() - send_began_ <= limit) return false;
    end();
    return true;
  }

 private:
  void read() {
    socket_.async_read(buffer_, [self = this->shared_from_this()](Error error, std::size_t) {
      if (error == boost::beast::websocket::error::message_too_big) self->hub_.refuse();
      if (error) return self->end();
      self->take();
      self->read_on();
    });
  }

  /// Reads the next message, at once or when the rate limit allows it.
  void read_on() {
    const Clock::duration wait = messages_.charge(Clock::now().time_since_epoch());
    if (wait <= Clock::duration::zero()) return read();
    reading_.expires_after(wait);
    reading_.async_wait([self = this->shared_from_this()](Error) { self->read(); });
  }

  void take() {
    const std::string text = boost::beast::buffers_to_string(buffer_.data());
    buffer_.consume(buffer_.size());
    if (socket_.got_text()) {
      hub_.read(*this, text);
    } else {
      hub_.refuse();
    }
  }

  /// Schedules a frame that comes too soon after the last one, unless another one comes first.
  void pump_later() {
    if (!outbox.has_frame() || waiting_) return;
    waiting_ = true;
    spacing_.expires_after(kFrameSpacing);
    spacing_.async_wait([self = this->shared_from_this()](Error) {
      self->waiting_ = false;
      self->pump();
    });
  }

  void refuse() {
    hub_.refuse();
    end();
  }

  void end() {
    ended_ = true;
    socket_of(socket_.next_layer()).close();
    reading_.cancel();
    hub_.leave(id);
  }

  boost::beast::websocket::stream<Stream> socket_;
  WebHub& hub_;
  PagePlace place_;
  boost::beast::flat_buffer buffer_{kLongestMessage};
  Message in_flight_;
  boost::asio::steady_timer spacing_;
  boost::asio::steady_timer reading_;
  core::TokenBucket messages_{kMessages_per_s, kMessages};
  core::TokenBucket pings_{kPings_per_s, kPings};
  bool waiting_ = false;
  bool sending_ = false;
  bool ended_ = false;
  Clock::time_point send_began_;
  Clock::time_point last_frame_;
};

}  // namespace aurasim::overseer
