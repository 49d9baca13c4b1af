#include "overseer/web_connection.h"

#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "overseer/http_rules.h"

namespace aurasim::overseer {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Clock = std::chrono::steady_clock;
using Error = beast::error_code;

constexpr std::chrono::seconds kHttpLimit{15};
constexpr std::chrono::seconds kUploadLimit{60};
constexpr std::chrono::seconds kSilenceLimit{30};
constexpr std::uint32_t kLongestHeader = 16 * 1024;
/// Frames for one page come no closer than this, however fast the run goes.
constexpr std::chrono::milliseconds kFrameSpacing{12};
/// What the kernel may hold for one page: more would only make what it shows older.
constexpr int kSendBuffer = 128 * 1024;

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

/// A page with its WebSocket.
class PageSocket final : public PageConnection, public std::enable_shared_from_this<PageSocket> {
 public:
  PageSocket(beast::tcp_stream stream, WebHub& hub)
      : socket_(std::move(stream)), hub_(hub), spacing_(socket_.get_executor()) {}

  void start(const http::request<http::string_body>& upgrade) {
    beast::get_lowest_layer(socket_).expires_never();
    Error ignored;
    beast::get_lowest_layer(socket_).socket().set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
    beast::get_lowest_layer(socket_).socket().set_option(asio::ip::tcp::no_delay(true), ignored);
    socket_.set_option(websocket::stream_base::timeout{kHttpLimit, kSilenceLimit, true});
    socket_.read_message_max(kLongestMessage);
    socket_.auto_fragment(false);
    socket_.async_accept(upgrade, [self = shared_from_this()](Error error) {
      if (error) return;
      self->hub_.join(self);
      self->read();
    });
  }

  void pump() override {
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
    socket_.async_write(buffer, [self = shared_from_this()](Error error, std::size_t bytes) {
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
    socket_.async_read(buffer_, [self = shared_from_this()](Error error, std::size_t) {
      if (error) return self->end();
      self->take();
      self->read();
    });
  }

  void take() {
    const std::string text = beast::buffers_to_string(buffer_.data());
    buffer_.consume(buffer_.size());
    if (socket_.got_text()) {
      hub_.read(*this, text);
    } else {
      hub_.refuse();
    }
  }

  /// A frame that comes too soon after the last one is sent after a moment, unless another comes first.
  void pump_later() {
    if (!outbox.has_frame() || waiting_) return;
    waiting_ = true;
    spacing_.expires_after(kFrameSpacing);
    spacing_.async_wait([self = shared_from_this()](Error) {
      self->waiting_ = false;
      self->pump();
    });
  }

  void end() {
    ended_ = true;
    Error ignored;
    beast::get_lowest_layer(socket_).socket().close(ignored);
    hub_.leave(id);
  }

  websocket::stream<beast::tcp_stream> socket_;
  WebHub& hub_;
  beast::flat_buffer buffer_{kLongestMessage};
  Message in_flight_;
  asio::steady_timer spacing_;
  bool waiting_ = false;
  bool sending_ = false;
  bool ended_ = false;
  Clock::time_point send_began_;
  Clock::time_point last_frame_;
};

class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(asio::ip::tcp::socket socket, WebHub& hub, asio::any_io_executor worker)
      : stream_(std::move(socket)), hub_(hub), worker_(std::move(worker)) {}

  ~HttpConnection() { hub_.close_connection(); }
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  void read_header() {
    parser_.emplace();
    parser_->header_limit(kLongestHeader);
    parser_->body_limit(kLargestMeshFile);
    stream_.expires_after(kHttpLimit);
    http::async_read_header(stream_, buffer_, *parser_, [self = shared_from_this()](Error error, std::size_t) {
      if (!error) return self->route();
      if (error != http::error::end_of_stream && error != beast::error::timeout) self->hub_.refuse();
      self->close();
    });
  }

 private:
  using Request = http::request<http::string_body>;

  std::string_view header(http::field name) const { return view_of(parser_->get()[name]); }
  std::string_view target() const { return view_of(parser_->get().target()); }

  /// The body has not been read yet: what is refused here costs nothing more.
  void route() {
    const std::string why = hub_.why_not(header(http::field::host), header(http::field::origin));
    if (!why.empty()) return refuse(403, why);
    const http::verb method = parser_->get().method();
    if (path_of(target()) == "/ws") return upgrade();
    if (method == http::verb::post && path_of(target()) == "/api/shapes") return receive_mesh();
    if (method != http::verb::get && method != http::verb::head) return refuse(405, "only GET is answered here");
    if (!parser_->is_done()) return refuse(400, "a request of this kind has no body");
    answer(hub_.get(target()), parser_->get().keep_alive());
  }

  void upgrade() {
    if (!websocket::is_upgrade(parser_->get())) return refuse(400, "this is a WebSocket");
    if (!hub_.has_room()) return refuse(503, "too many pages are connected");
    if (buffer_.size() > 0) return refuse(400, "nothing may come before the upgrade is answered");
    std::make_shared<PageSocket>(std::move(stream_), hub_)->start(parser_->release());
  }

  void receive_mesh() {
    if (!hub_.knows_token(bearer_token(header(http::field::authorization))))
      return refuse(401, "the token is missing or wrong");
    stream_.expires_after(kUploadLimit);
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](Error error, std::size_t) {
      if (error == http::error::body_limit) return self->refuse(413, "it is larger than 16 MiB");
      if (error) return self->close();
      self->store_mesh();
    });
  }

  void store_mesh() {
    stream_.expires_never();
    asio::post(worker_, [self = shared_from_this()] {
      const Request& request = self->parser_->get();
      auto stored = self->hub_.shapes().add(query_value(view_of(request.target()), "name"), request.body());
      asio::post(self->stream_.get_executor(), [self, stored = std::move(stored)] { self->answer_mesh(stored); });
    });
  }

  void answer_mesh(const std::variant<ShapeStore::Stored, std::string>& stored) {
    if (const auto* why = std::get_if<std::string>(&stored)) return refuse(422, *why);
    const auto& shape = std::get<ShapeStore::Stored>(stored);
    const nlohmann::json json = {
        {"hash", fmt::format("{:016x}", shape.hash)}, {"points", shape.points}, {"triangles", shape.triangles}};
    answer({200, "application/json", json.dump() + "\n"}, parser_->get().keep_alive());
  }

  void refuse(unsigned status, const std::string& why) {
    hub_.refuse();
    answer({status, "text/plain; charset=utf-8", why + "\n"}, false);
  }

  void answer(HttpAnswer answer, bool keep_alive) {
    response_.emplace(http::int_to_status(answer.status), 11);
    response_->set(http::field::content_type, answer.content_type);
    response_->set(http::field::cache_control, "no-cache");
    response_->set("X-Content-Type-Options", "nosniff");
    response_->set("X-Frame-Options", "DENY");
    response_->set("Cross-Origin-Resource-Policy", "same-origin");
    response_->keep_alive(keep_alive);
    const std::size_t length = answer.body.size();
    if (parser_->get().method() != http::verb::head) response_->body() = std::move(answer.body);
    response_->content_length(length);
    stream_.expires_after(kUploadLimit);
    http::async_write(stream_, *response_, [self = shared_from_this(), keep_alive](Error error, std::size_t) {
      if (error || !keep_alive) return self->close();
      self->read_header();
    });
  }

  void close() {
    Error ignored;
    stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  }

  beast::tcp_stream stream_;
  WebHub& hub_;
  asio::any_io_executor worker_;
  beast::flat_buffer buffer_{64 * 1024};
  std::optional<http::request_parser<http::string_body>> parser_;
  std::optional<http::response<http::string_body>> response_;
};

}  // namespace

void serve_connection(asio::ip::tcp::socket socket, WebHub& hub, const asio::any_io_executor& worker) {
  if (!hub.open_connection()) return hub.refuse();
  std::make_shared<HttpConnection>(std::move(socket), hub, worker)->read_header();
}

}  // namespace aurasim::overseer
