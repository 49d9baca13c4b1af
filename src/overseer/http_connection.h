// Serves one TCP connection of a browser: HTTP requests, until one asks for the WebSocket.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/token_bucket.h"
#include "overseer/give_way.h"
#include "overseer/http_rules.h"
#include "overseer/page_socket.h"
#include "overseer/web_headers.h"
#include "overseer/web_hub.h"
#include "overseer/web_stream.h"

namespace aurasim::overseer {

inline constexpr std::chrono::seconds kIdleLimit{15};  // longest wait for a further request after an answer
inline constexpr std::chrono::seconds kAnswerLimit{60};
inline constexpr std::chrono::seconds kGoodbyeLimit{2};
/// Most bytes that are read and discarded from a connection that is being closed.
inline constexpr std::size_t kMostThrownAway = 4 * 1024 * 1024;
inline constexpr std::uint32_t kLongestHeader = 16 * 1024;
/// Requests of one connection, as a token bucket: its size, and its refill a second. Further requests wait.
inline constexpr double kRequests = 50;
inline constexpr double kRequests_per_s = 50;

inline std::string_view view_of(boost::beast::string_view text) { return {text.data(), text.size()}; }

/// Addresses of a connection: the remote one, and the one of this host.
struct Ends {
  std::string remote;
  std::string local;
};

template <class Stream>
class HttpConnection final : public WebCaller, public std::enable_shared_from_this<HttpConnection<Stream>> {
 public:
  HttpConnection(Stream stream, Ends ends, WebHub& hub, boost::asio::any_io_executor worker)
      : WebCaller(std::move(ends.remote)),
        local_address_(std::move(ends.local)),
        stream_(std::move(stream)),
        hub_(hub),
        worker_(std::move(worker)),
        pause_(stream_.get_executor()) {}

  void start() {
    socket_of(stream_).expires_after(hub_.settings().header_limit);
    if constexpr (kIsTls<Stream>) {
      stream_.async_handshake(boost::asio::ssl::stream_base::server, [self = this->shared_from_this()](Error error) {
        if (!error) return self->read_header();
        self->hub_.refuse();
        const bool is_openssls = error.category() == boost::asio::error::get_ssl_category();
        if (is_openssls && ERR_GET_REASON(static_cast<unsigned long>(error.value())) == SSL_R_HTTP_REQUEST)
          self->say_that_this_is_tls();
      });
    } else {
      read_header();
    }
  }

  void drop() override { socket_of(stream_).close(); }

 private:
  using Error = boost::beast::error_code;
  using Field = boost::beast::http::field;
  using StringBody = boost::beast::http::string_body;
  using Clock = std::chrono::steady_clock;

  /// Reads a header within the time left of the limit that was set before.
  void read_header() {
    namespace http = boost::beast::http;
    set_silent(true);
    parser_.emplace();
    parser_->header_limit(kLongestHeader);
    parser_->body_limit(kLargestMeshFile);
    http::async_read_header(stream_, buffer_, *parser_, [self = this->shared_from_this()](Error error, std::size_t) {
      if (error) return self->give_up(error);
      self->route();
    });
  }

  /// Answers an invalid request if the sender may still be there to read the answer, and ends the connection.
  void give_up(Error error) {
    using Http = boost::beast::http::error;
    if (error == Http::header_limit || error == Http::buffer_overflow)
      return refuse(431, fmt::format("the header is longer than {} bytes", kLongestHeader));
    if (error == Http::body_limit) return refuse(413, "it is larger than 16 MiB");
    const bool has_left = error == Http::end_of_stream || error == Http::partial_message;
    if (error.category() == Error(Http::bad_method).category() && !has_left)
      return refuse(400, fmt::format("this is no HTTP request: {}", error.message()));
    const bool is_fault = error != Http::end_of_stream && error != boost::beast::error::timeout &&
                          error != boost::asio::error::operation_aborted;
    if (is_fault) hub_.refuse();
    close();
  }

  std::string_view header(Field name) const { return view_of(parser_->get()[name]); }
  bool is_twofold(Field name) const { return parser_->get().count(name) > 1; }
  std::string_view target() const { return view_of(parser_->get().target()); }

  /// Decides on a request before its body is read, so that refusing it costs nothing more.
  void route() {
    set_silent(false);
    if (is_twofold(Field::host) || is_twofold(Field::origin) || is_twofold(Field::authorization))
      return refuse(400, "a header stands there twice");
    if (!names_a_host()) return refuse(400, "the Host header must be NAME or ADDRESS, or one of them and :PORT");
    const std::string why = hub_.access().why_not(header(Field::host), header(Field::origin), local_address_);
    if (!why.empty()) return refuse(403, why);
    const auto found =
        hub_.access().standing_of(address(), {header(Field::authorization), header(Field::cookie)}, Clock::now());
    if (const auto* refusal = std::get_if<Refusal>(&found)) return refuse(refusal->status, refusal->why);
    standing_ = std::get<Standing>(found);
    serve();
  }

  /// True when the request names a host as RFC 9112, section 3.2 demands: HTTP/1.1 has a Host header, whose value may
  /// be empty.
  bool names_a_host() const {
    const auto& request = parser_->get();
    if (request.count(Field::host) == 0) return request.version() < 11;
    return header(Field::host).empty() || is_host(header(Field::host));
  }

  void serve() {
    using boost::beast::http::verb;
    const verb method = parser_->get().method();
    const std::string_view path = path_of(target());
    if (path == "/ws") return upgrade();
    if (method == verb::post && path == "/api/shapes") return receive_mesh();
    const bool is_session = method == verb::post && path == "/api/session";
    if (!is_session && method != verb::get && method != verb::head) return refuse(405, "only GET is answered here");
    if (!parser_->is_done()) return refuse(400, "a request of this kind has no body");
    if (is_session) return open_session();
    const FileRequest request{takes_gzip(header(Field::accept_encoding)), std::string(header(Field::if_none_match))};
    answer(hub_.get(target(), request, standing_), parser_->get().keep_alive());
  }

  void upgrade() {
    if (!boost::beast::websocket::is_upgrade(parser_->get())) return refuse(400, "this is a WebSocket");
    if (buffer_.size() > 0) return refuse(400, "nothing may come before the upgrade is answered");
    if (standing_ < Standing::kViewer) return refuse(401, "this takes a token");
    PagePlace place = hub_.page_place(address());
    if (!place) return refuse(503, "too many pages are connected");
    std::make_shared<PageSocket<Stream>>(std::move(stream_), hub_, std::move(place), standing_)
        ->start(parser_->release());
  }

  /// Answers a request that shows a token with a session cookie.
  void open_session() {
    if (header(Field::authorization).empty()) return refuse(401, "the token is missing or wrong");
    HttpAnswer reply = WebHub::session(standing_);
    reply.cookie = hub_.access().cookie(standing_);
    answer(std::move(reply), parser_->get().keep_alive());
  }

  void receive_mesh() {
    namespace http = boost::beast::http;
    if (standing_ < Standing::kOperator) return refuse(401, "the token is missing or wrong");
    upload_ = hub_.upload_place();
    if (!upload_) return refuse(503, "too many meshes are being sent: try again");
    socket_of(stream_).expires_after(hub_.settings().upload_limit);
    http::async_read(stream_, buffer_, *parser_, [self = this->shared_from_this()](Error error, std::size_t) {
      if (error) return self->give_up(error);
      self->store_mesh();
    });
  }

  void store_mesh() {
    socket_of(stream_).expires_never();
    boost::asio::post(worker_, [self = this->shared_from_this()] {
      give_way();
      const auto& request = self->parser_->get();
      auto stored = self->hub_.shapes().add(query_value(view_of(request.target()), "name"), request.body());
      boost::asio::post(self->stream_.get_executor(),
                        [self, stored = std::move(stored)] { self->answer_mesh(stored); });
    });
  }

  void answer_mesh(const std::variant<ShapeStore::Stored, std::string>& stored) {
    if (const auto* why = std::get_if<std::string>(&stored)) return refuse(422, *why);
    const auto& shape = std::get<ShapeStore::Stored>(stored);
    const nlohmann::json json = {
        {"hash", fmt::format("{:016x}", shape.hash)}, {"points", shape.points}, {"triangles", shape.triangles}};
    answer({.content_type = "application/json", .body = json.dump() + "\n"}, parser_->get().keep_alive());
  }

  void refuse(unsigned status, const std::string& why) {
    hub_.refuse();
    answer({.status = status, .body = why + "\n"}, false);
  }

  void answer(HttpAnswer answer, bool keep_alive) {
    namespace http = boost::beast::http;
    upload_.release();
    response_.emplace(http::int_to_status(answer.status), 11);
    response_->set(Field::content_type, answer.content_type);
    for (const auto& [name, value] : kFixedHeaders) response_->set(name, value);
    if (kIsTls<Stream> && !is_loopback_name(header(Field::host)))
      response_->set(Field::strict_transport_security, kStrictTransport);
    if (!answer.etag.empty()) response_->set(Field::etag, answer.etag);
    if (!answer.etag.empty()) response_->set(Field::vary, "Accept-Encoding");
    if (!answer.encoding.empty()) response_->set(Field::content_encoding, answer.encoding);
    if (!answer.cookie.empty()) response_->set(Field::set_cookie, answer.cookie);
    response_->keep_alive(keep_alive);
    const std::size_t length = answer.body.size();
    if (parser_->get().method() != http::verb::head) response_->body() = std::move(answer.body);
    if (answer.status != 304) response_->content_length(length);
    socket_of(stream_).expires_after(kAnswerLimit);
    http::async_write(stream_, *response_, [self = this->shared_from_this(), keep_alive](Error error, std::size_t) {
      if (error || !keep_alive) return self->close();
      self->read_next();
    });
  }

  void read_next() {
    const Clock::duration wait = requests_.charge(Clock::now().time_since_epoch());
    socket_of(stream_).expires_after(wait + kIdleLimit);
    if (wait <= Clock::duration::zero()) return read_header();
    pause_.expires_after(wait);
    pause_.async_wait([self = this->shared_from_this()](Error) { self->read_header(); });
  }

  void close() {
    set_silent(true);
    socket_of(stream_).expires_after(kGoodbyeLimit);
    if constexpr (kIsTls<Stream>) {
      stream_.async_shutdown([self = this->shared_from_this()](Error) { self->linger(); });
    } else {
      linger();
    }
  }

  /// Reads the rest before closing. Closing a socket with unread bytes resets the connection, and the answer might
  /// never be read.
  void linger() {
    Error gone;
    socket_of(stream_).socket().shutdown(boost::asio::ip::tcp::socket::shutdown_send, gone);
    buffer_.clear();
    if (!gone) throw_away(kMostThrownAway);
  }

  void throw_away(std::size_t at_most) {
    socket_of(stream_).async_read_some(buffer_.prepare(16 * 1024),
                                       [self = this->shared_from_this(), at_most](Error error, std::size_t bytes) {
                                         if (!error && bytes < at_most) self->throw_away(at_most - bytes);
                                       });
  }

  /// Answers a client that used http instead of https.
  void say_that_this_is_tls() {
    static constexpr std::string_view kAnswer =
        "HTTP/1.1 400 Bad Request\r\nContent-Type: text/plain\r\nConnection: close\r\n\r\nthis server speaks HTTPS\n";
    socket_of(stream_).expires_after(kGoodbyeLimit);
    boost::asio::async_write(socket_of(stream_), boost::asio::buffer(kAnswer),
                             [self = this->shared_from_this()](Error, std::size_t) { self->drop(); });
  }

  std::string local_address_;
  Stream stream_;
  WebHub& hub_;
  boost::asio::any_io_executor worker_;
  boost::asio::steady_timer pause_;
  core::TokenBucket requests_{kRequests_per_s, kRequests};
  Standing standing_ = Standing::kStranger;
  Place upload_;
  boost::beast::flat_buffer buffer_{64 * 1024};
  std::optional<boost::beast::http::request_parser<StringBody>> parser_;
  std::optional<boost::beast::http::response<StringBody>> response_;
};

}  // namespace aurasim::overseer
