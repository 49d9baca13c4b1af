// A browser's side of HTTP and WebSocket, with a deadline for everything.
#pragma once

#include <cctype>
#include <chrono>
#include <map>
#include <optional>
#include <string>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include "overseer/page_reader.h"

namespace aurasim::overseer::testing {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

inline asio::ip::tcp::endpoint local(std::uint16_t port) { return {asio::ip::make_address("127.0.0.1"), port}; }

struct HttpReply {
  unsigned status = 0;  ///< 0: none came
  std::string type;
  std::string body;
  std::string encoding;
  std::string etag;
  std::map<std::string, std::string> fields = {};  ///< all of its header, names in small letters
};

inline HttpReply reply_of(const http::response<http::string_body>& answer) {
  const auto field = [&](http::field name) { return std::string(answer[name]); };
  HttpReply reply = {answer.result_int(), field(http::field::content_type), answer.body(),
                     field(http::field::content_encoding), field(http::field::etag)};
  for (const auto& each : answer) {
    std::string name(each.name_string());
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    reply.fields[name] = std::string(each.value());
  }
  return reply;
}

/// One request in a connection of its own. `fields` replace those that a browser would send.
inline HttpReply request(std::uint16_t port, http::verb verb, const std::string& target,
                         std::vector<std::pair<std::string, std::string>> fields = {}, const std::string& body = {}) {
  asio::io_context io;
  beast::tcp_stream stream(io);
  beast::error_code error;
  http::request<http::string_body> request(verb, target, 11);
  request.set(http::field::host, "127.0.0.1:" + std::to_string(port));
  for (const auto& [name, value] : fields) request.set(name, value);
  request.body() = body;
  if (!body.empty()) request.prepare_payload();
  http::response_parser<http::string_body> response;
  response.skip(verb == http::verb::head);
  beast::flat_buffer buffer;
  HttpReply reply;
  stream.expires_after(10s);
  stream.async_connect(local(port), [&](beast::error_code failed) {
    if (failed) return;
    http::async_write(stream, request, [&](beast::error_code, std::size_t) {
      http::async_read(stream, buffer, response, [&](beast::error_code not_read, std::size_t) {
        if (not_read) return;
        reply = reply_of(response.get());
      });
    });
  });
  io.run_for(10s);
  return reply;
}

/// Sends bytes as they are and returns what comes back until the server closes, or for a second.
inline std::string raw(std::uint16_t port, const std::string& bytes) {
  asio::io_context io;
  asio::ip::tcp::socket socket(io);
  std::string answer;
  beast::error_code error;
  socket.connect(local(port), error);
  if (error) return "no connection";
  asio::write(socket, asio::buffer(bytes), error);
  asio::async_read(socket, asio::dynamic_buffer(answer), [](beast::error_code, std::size_t) {});
  io.run_for(1s);
  return answer;
}

/// The first bytes that come, or none in 10 s.
inline std::string answer_of(asio::ip::tcp::socket& socket) {
  auto& io = static_cast<asio::io_context&>(socket.get_executor().context());
  std::string answer(1000, '\0');
  std::size_t size = 0;
  socket.async_read_some(asio::buffer(answer), [&](beast::error_code, std::size_t bytes) {
    size = bytes;
    io.stop();
  });
  io.restart();
  io.run_for(10s);
  answer.resize(size);
  return answer;
}

/// What gzip has packed.
inline std::string unpacked(const std::string& packed) {
  z_stream stream{};
  inflateInit2(&stream, 15 + 16);
  std::string plain(1 << 20, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(plain.data());
  stream.avail_out = static_cast<uInt>(plain.size());
  const int ended = inflate(&stream, Z_FINISH);
  plain.resize(ended == Z_STREAM_END ? stream.total_out : 0);
  inflateEnd(&stream);
  return plain;
}

/// A page that reads whatever it is sent.
class Page {
 public:
  using Fields = std::vector<std::pair<std::string, std::string>>;

  explicit Page(std::uint16_t port, const Fields& fields = {}) : socket_(io_) {
    const std::string host = "127.0.0.1:" + std::to_string(port);
    socket_.set_option(
        beast::websocket::stream_base::decorator([fields, host](beast::websocket::request_type& request) {
          request.set(http::field::origin, "http://" + host);
          for (const auto& [name, value] : fields) request.set(name, value);
        }));
    socket_.read_message_max(64 << 20);
    beast::get_lowest_layer(socket_).async_connect(local(port), [this, host](beast::error_code failed) {
      if (failed) return;
      socket_.async_handshake(host, "/ws", [this](beast::error_code refused) {
        open_ = !refused;
        if (open_) read();
      });
    });
    wait_until([this] { return open_; }, 3s);
  }

  bool open() const { return open_; }

  /// Reads until the condition holds; false at the deadline or when the connection has ended.
  template <class Condition>
  bool wait_until(Condition condition, Clock::duration time_out = 15s) {
    const auto deadline = Clock::now() + time_out;
    while (!condition() && Clock::now() < deadline) {
      io_.restart();
      if (io_.run_one_for(50ms) == 0 && io_.stopped()) break;  // nothing is left to do
    }
    return condition();
  }

  void send(const std::string& text, bool binary = false) {
    bool sent = false;
    socket_.binary(binary);
    socket_.async_write(asio::buffer(text), [&](beast::error_code, std::size_t) { sent = true; });
    wait_until([&] { return sent; }, 5s);
  }
  void send(const nlohmann::json& json) { send(json.dump(), false); }

  /// Sends a command and waits for its reply; null if none comes.
  nlohmann::json ask(const nlohmann::json& command) {
    const std::string id = "request " + std::to_string(++requests_);
    send(nlohmann::json{{"type", "command"}, {"request", id}, {"command", command}});
    wait_until([&] { return replies.contains(id); });
    return replies.contains(id) ? replies.at(id) : nlohmann::json();
  }

  bool has(const std::string& type) const { return latest.contains(type); }

  std::map<std::string, nlohmann::json> latest;   ///< by type
  std::map<std::string, nlohmann::json> replies;  ///< by request
  std::vector<std::string> order;                 ///< types, "frame" and "overlays" too
  PageWorld world;
  std::vector<std::uint8_t> overlays;
  std::uint64_t bytes = 0;
  std::uint64_t frame_bytes = 0;

 private:
  void read() {
    socket_.async_read(buffer_, [this](beast::error_code error, std::size_t) {
      open_ = !error;
      if (error) return;
      take();
      read();
    });
  }
  void take() {
    const std::string text = beast::buffers_to_string(buffer_.data());
    buffer_.consume(buffer_.size());
    bytes += text.size();
    if (!socket_.got_text()) {
      const auto* begin = reinterpret_cast<const std::uint8_t*>(text.data());
      const bool frame = text.at(0) == 1;
      order.push_back(frame ? "frame" : "overlays");
      if (frame) {
        frame_bytes += text.size();
        world.read({begin, text.size()});
      } else {
        overlays.assign(begin, begin + text.size());
      }
      return;
    }
    nlohmann::json json = nlohmann::json::parse(text);
    const auto type = json.at("type").get<std::string>();
    order.push_back(type);
    if (type == "reply") replies[json.at("request").get<std::string>()] = json;
    latest[type] = std::move(json);
  }

  asio::io_context io_;
  beast::websocket::stream<beast::tcp_stream> socket_;
  beast::flat_buffer buffer_;
  bool open_ = false;
  int requests_ = 0;
};

}  // namespace aurasim::overseer::testing
