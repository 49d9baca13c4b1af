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

constexpr std::chrono::seconds kHandshakeLimit{5};
constexpr std::chrono::seconds kIdleLimit{15};  // of a connection that has been answered, and may ask again
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
  PageSocket(beast::tcp_stream stream, WebHub& hub, Place place)
      : socket_(std::move(stream)), hub_(hub), place_(std::move(place)), spacing_(socket_.get_executor()) {}

  void start(const http::request<http::string_body>& upgrade) {
    beast::get_lowest_layer(socket_).expires_never();
    Error ignored;
    beast::get_lowest_layer(socket_).socket().set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
    beast::get_lowest_layer(socket_).socket().set_option(asio::ip::tcp::no_delay(true), ignored);
    socket_.set_option(websocket::stream_base::timeout{kHandshakeLimit, kSilenceLimit, true});
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
  Place place_;
  beast::flat_buffer buffer_{kLongestMessage};
  Message in_flight_;
  asio::steady_timer spacing_;
  bool waiting_ = false;
  bool sending_ = false;
  bool ended_ = false;
  Clock::time_point send_began_;
  Clock::time_point last_frame_;
};

class HttpConnection final : public WebCaller, public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(asio::ip::tcp::socket socket, std::string address, WebHub& hub, asio::any_io_executor worker)
      : WebCaller(std::move(address)), stream_(std::move(socket)), hub_(hub), worker_(std::move(worker)) {}

  void start() { read_header(hub_.settings().header_limit); }

  void drop() override { stream_.close(); }

 private:
  using Request = http::request<http::string_body>;

  /// `limit`: for the whole of it.
  void read_header(Clock::duration limit) {
    set_silent(true);
    parser_.emplace();
    parser_->header_limit(kLongestHeader);
    parser_->body_limit(kLargestMeshFile);
    stream_.expires_after(limit);
    http::async_read_header(stream_, buffer_, *parser_, [self = shared_from_this()](Error error, std::size_t) {
      if (!error) return self->route();
      const bool is_fault = error != http::error::end_of_stream && error != beast::error::timeout &&
                            error != asio::error::operation_aborted;
      if (is_fault) self->hub_.refuse();
      self->close();
    });
  }

  std::string_view header(http::field name) const { return view_of(parser_->get()[name]); }
  std::string_view target() const { return view_of(parser_->get().target()); }

  /// The body has not been read yet: what is refused here costs nothing more.
  void route() {
    set_silent(false);
    const std::string why = hub_.why_not(header(http::field::host), header(http::field::origin));
    if (!why.empty()) return refuse(403, why);
    const http::verb method = parser_->get().method();
    if (path_of(target()) == "/ws") return upgrade();
    if (method == http::verb::post && path_of(target()) == "/api/shapes") return receive_mesh();
    if (method != http::verb::get && method != http::verb::head) return refuse(405, "only GET is answered here");
    if (!parser_->is_done()) return refuse(400, "a request of this kind has no body");
    const FileRequest request{takes_gzip(header(http::field::accept_encoding)),
                              std::string(header(http::field::if_none_match))};
    answer(hub_.get(target(), request), parser_->get().keep_alive());
  }

  void upgrade() {
    if (!websocket::is_upgrade(parser_->get())) return refuse(400, "this is a WebSocket");
    if (buffer_.size() > 0) return refuse(400, "nothing may come before the upgrade is answered");
    Place place = hub_.page_place();
    if (!place) return refuse(503, "too many pages are connected");
    std::make_shared<PageSocket>(std::move(stream_), hub_, std::move(place))->start(parser_->release());
  }

  void receive_mesh() {
    if (!hub_.knows_token(bearer_token(header(http::field::authorization))))
      return refuse(401, "the token is missing or wrong");
    upload_ = hub_.upload_place();
    if (!upload_) return refuse(503, "too many meshes are being sent: try again");
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
    answer({200, "application/json", json.dump() + "\n", {}, {}}, parser_->get().keep_alive());
  }

  void refuse(unsigned status, const std::string& why) {
    hub_.refuse();
    answer({status, "text/plain; charset=utf-8", why + "\n", {}, {}}, false);
  }

  void answer(HttpAnswer answer, bool keep_alive) {
    upload_.release();
    response_.emplace(http::int_to_status(answer.status), 11);
    response_->set(http::field::content_type, answer.content_type);
    response_->set(http::field::cache_control, "no-cache");  // ask whether it has changed
    if (!answer.etag.empty()) response_->set(http::field::etag, answer.etag);
    if (!answer.etag.empty()) response_->set(http::field::vary, "Accept-Encoding");
    if (!answer.encoding.empty()) response_->set(http::field::content_encoding, answer.encoding);
    response_->set("X-Content-Type-Options", "nosniff");
    response_->set("X-Frame-Options", "DENY");
    response_->set("Cross-Origin-Resource-Policy", "same-origin");
    response_->keep_alive(keep_alive);
    const std::size_t length = answer.body.size();
    if (parser_->get().method() != http::verb::head) response_->body() = std::move(answer.body);
    if (answer.status != 304) response_->content_length(length);
    stream_.expires_after(kUploadLimit);
    http::async_write(stream_, *response_, [self = shared_from_this(), keep_alive](Error error, std::size_t) {
      if (error || !keep_alive) return self->close();
      self->read_header(kIdleLimit);
    });
  }

  void close() {
    Error ignored;
    stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  }

  beast::tcp_stream stream_;
  WebHub& hub_;
  asio::any_io_executor worker_;
  Place upload_;
  beast::flat_buffer buffer_{64 * 1024};
  std::optional<http::request_parser<http::string_body>> parser_;
  std::optional<http::response<http::string_body>> response_;
};

}  // namespace

void serve_connection(asio::ip::tcp::socket socket, WebHub& hub, const asio::any_io_executor& worker) {
  Error unknown;  // it has gone again, and will be noticed soon
  std::string address = socket.remote_endpoint(unknown).address().to_string();
  const auto connection = std::make_shared<HttpConnection>(std::move(socket), std::move(address), hub, worker);
  hub.enter(connection);
  connection->start();
}

}  // namespace aurasim::overseer
