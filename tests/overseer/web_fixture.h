// A web server alone, and what its tests ask of it.
#pragma once

#include <atomic>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "config/meshes.h"
#include "overseer/web_client.h"
#include "overseer/web_server.h"
#include "scratch_folder.h"

namespace aurasim::overseer {

using ::testing::HasSubstr;
using testing::Page;
using testing::request;
using ::testing::StartsWith;
using testing::http::verb;
using namespace std::chrono_literals;
using Json = nlohmann::json;

inline constexpr const char* kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

inline constexpr const char* kUpgrade =
    "GET /ws HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n";

class Web : public ::testing::Test {
 protected:
  void SetUp() override {
    scratch_.write("pages/index.html", "<p>the page");
    scratch_.write("pages/assets/main.js", "1;");
    scratch_.write("secret.txt", "secret");
    settings_.port = 0;
    settings_.pages = folder_ / "pages";
    settings_.scenes = {"tower"};
  }
  void TearDown() override { server_.reset(); }

  void serve() {
    server_.emplace(settings_, shapes_);
    server_->publish(Notice::kHello, R"({"type":"hello"})");
    server_->publish(Notice::kScene, R"({"type":"scene"})");
  }
  std::uint16_t port() const { return server_->port(); }

  /// A frame in which so many bodies stand somewhere else.
  void show(std::uint32_t bodies) {
    WorldFrame frame;
    frame.stamp = stamp_ += 3;
    frame.restart = stamp_ == 3;
    for (Slot slot = 0; slot < bodies; ++slot) {
      BodyChange& change = frame.changed.emplace_back();
      change.body.slot = slot;
      change.body.id = core::BodyId{slot + 100U};
      change.body.p_WB.x() = static_cast<double>(stamp_);
      change.created = change.host_changed = frame.restart;
      change.moved = true;
    }
    server_->show(frame);
  }

  std::vector<testing::asio::ip::tcp::socket> connect_many(testing::asio::io_context& io, int count) {
    std::vector<testing::asio::ip::tcp::socket> sockets;
    for (int i = 0; i < count; ++i) sockets.emplace_back(io).connect(testing::local(port()));
    return sockets;
  }

  /// One that is named slow.obj takes until the test lets it end.
  std::variant<core::TriangleMesh, std::string> read(const std::string& name, std::string_view bytes) {
    if (name == "slow.obj") {
      slow_has_begun_ = true;
      while (!slow_may_end_) std::this_thread::sleep_for(1ms);
    }
    return config::read_mesh(name, bytes);
  }

  /// A socket on which a WebSocket has been opened by hand.
  testing::asio::ip::tcp::socket connect_raw_page(testing::asio::io_context& io) {
    testing::asio::ip::tcp::socket socket(io);
    socket.connect(testing::local(port()));
    testing::asio::write(socket, testing::asio::buffer(std::string(kUpgrade)));
    EXPECT_TRUE(testing::answer_of(socket).starts_with("HTTP/1.1 101"));
    return socket;
  }

  /// The other side closes it, whatever it sends until then.
  static bool ends(testing::asio::ip::tcp::socket& socket) {
    auto& io = static_cast<testing::asio::io_context&>(socket.get_executor().context());
    std::string all;
    bool ended = false;
    testing::asio::async_read(socket, testing::asio::dynamic_buffer(all),
                              [&](testing::beast::error_code, std::size_t) { ended = true; });
    io.restart();
    io.run_for(10s);
    return ended;
  }

  template <class Condition>
  static bool holds_in_time(Condition condition) {
    const auto deadline = testing::Clock::now() + 10s;
    while (!condition() && testing::Clock::now() < deadline) std::this_thread::sleep_for(5ms);
    return condition();
  }

  test::ScratchFolder scratch_;
  const std::filesystem::path folder_ = scratch_.path();
  WebSettings settings_;
  ShapeStore shapes_{[this](const std::string& name, std::string_view bytes) { return read(name, bytes); }};
  std::optional<WebServer> server_;
  core::Step stamp_ = 0;
  std::atomic<bool> slow_has_begun_ = false;
  std::atomic<bool> slow_may_end_ = false;
};

}  // namespace aurasim::overseer
