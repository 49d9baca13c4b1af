// The server alone, with pages of all manners: what each gets, what none gets, and who is shown the door.
#include "overseer/web_server.h"

#include <atomic>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "config/meshes.h"
#include "overseer/web_client.h"

namespace aurasim::overseer {
namespace {

using ::testing::HasSubstr;
using testing::Page;
using testing::request;
using testing::http::verb;
using namespace std::chrono_literals;
using Json = nlohmann::json;

constexpr const char* kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

constexpr const char* kUpgrade =
    "GET /ws HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n";

class Web : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::path(::testing::TempDir()) / ("aurasim_web_" + std::to_string(::getpid()) + "_" +
                                                       ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_ / "pages" / "assets");
    std::ofstream(folder_ / "pages" / "index.html") << "<p>the page";
    std::ofstream(folder_ / "pages" / "assets" / "main.js") << "1;";
    std::ofstream(folder_ / "secret.txt") << "secret";
    settings_.port = 0;
    settings_.pages = folder_ / "pages";
    settings_.scenes = {"tower"};
  }
  void TearDown() override {
    server_.reset();
    std::filesystem::remove_all(folder_);
  }

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

  template <class Condition>
  static bool holds_in_time(Condition condition) {
    const auto deadline = testing::Clock::now() + 10s;
    while (!condition() && testing::Clock::now() < deadline) std::this_thread::sleep_for(5ms);
    return condition();
  }

  std::filesystem::path folder_;
  WebSettings settings_;
  ShapeStore shapes_{[this](const std::string& name, std::string_view bytes) { return read(name, bytes); }};
  std::optional<WebServer> server_;
  core::Step stamp_ = 0;
  std::atomic<bool> slow_has_begun_ = false;
  std::atomic<bool> slow_may_end_ = false;
};

TEST_F(Web, FilesAreServedWithTheirTypes) {
  serve();
  EXPECT_EQ(request(port(), verb::get, "/").body, "<p>the page");
  EXPECT_THAT(request(port(), verb::get, "/").type, HasSubstr("text/html"));
  EXPECT_THAT(request(port(), verb::get, "/assets/main.js?v=1").type, HasSubstr("text/javascript"));
  EXPECT_EQ(request(port(), verb::get, "/nothing.js").status, 404U);
  EXPECT_EQ(request(port(), verb::get, "/healthz").body, "ok\n");
  EXPECT_EQ(Json::parse(request(port(), verb::get, "/api/scenes").body), Json({{"scenes", {"tower"}}}));
  EXPECT_EQ(request(port(), verb::head, "/healthz").status, 200U);
}

TEST_F(Web, NothingOutsideOfThePageIsServed) {
  std::filesystem::create_symlink(folder_ / "secret.txt", folder_ / "pages" / "link.txt");
  serve();
  for (const char* target : {"/../secret.txt", "/%2e%2e/secret.txt", "/assets/../../secret.txt", "/..%2fsecret.txt",
                             "/..\\secret.txt", "/link.txt", "/assets", "//etc/passwd", "/%00", "/%zz", "/.hidden"}) {
    EXPECT_EQ(request(port(), verb::get, target).status, 404U) << target;
  }
}

TEST_F(Web, WithoutABuiltPageItSaysHowToBuildOne) {
  settings_.pages = folder_ / "nowhere";
  serve();
  EXPECT_THAT(request(port(), verb::get, "/").body, HasSubstr("has not been built"));
}

TEST_F(Web, OtherMethodsAndSitesAndNamesAreRefused) {
  serve();
  EXPECT_EQ(request(port(), verb::put, "/", {}, "x").status, 405U);
  EXPECT_EQ(request(port(), verb::delete_, "/").status, 405U);
  EXPECT_EQ(request(port(), verb::get, "/", {}, "a body").status, 400U);
  EXPECT_EQ(request(port(), verb::get, "/", {{"Origin", "http://evil.example"}}).status, 403U);
  EXPECT_EQ(request(port(), verb::get, "/", {{"Origin", "null"}}).status, 403U);
  EXPECT_EQ(request(port(), verb::get, "/", {{"Host", "evil.example"}}).status, 403U) << "DNS rebinding";
  EXPECT_EQ(request(port(), verb::get, "/", {{"Host", "localhost"}}).status, 200U);
  EXPECT_EQ(request(port(), verb::get, "/ws").status, 400U);
  EXPECT_FALSE(Page(port(), {{"Origin", "http://evil.example"}}).open());
  EXPECT_FALSE(Page(port(), {{"Origin", "http://127.0.0.1:1"}}).open()) << "another port is another site";
  EXPECT_FALSE(Page(port(), {{"Host", "evil.example"}, {"Origin", "http://evil.example"}}).open());
  EXPECT_GE(server_->counters().refused, 9U);
}

TEST_F(Web, BytesThatAreNotHttpHarmNobody) {
  serve();
  testing::raw(port(), "\x16\x03\x01 this is TLS");
  testing::raw(port(), std::string(100'000, 'A'));
  testing::raw(port(), "GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999999999999999999\r\n\r\n");
  testing::raw(port(), "GET /" + std::string(20'000, 'a') + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(request(port(), verb::get, "/healthz").status, 200U);
}

TEST_F(Web, APageGetsHelloThenTheSceneThenAKeyFrame) {
  serve();
  show(5);
  show(5);
  Page page(port());
  ASSERT_TRUE(page.wait_until([&] { return page.world.frames > 0; }));
  ASSERT_GE(page.order.size(), 3U);
  EXPECT_EQ(page.order[0], "hello");
  EXPECT_EQ(page.order[1], "scene");
  EXPECT_EQ(page.order[2], "frame");
  EXPECT_EQ(page.world.stamp, 6);
  EXPECT_EQ(page.world.bodies.size(), 5U);
  show(5);
  ASSERT_TRUE(page.wait_until([&] { return page.world.stamp == 9; }));
  EXPECT_EQ(page.world.key_frames, 1);
  server_->publish(Notice::kStatus, R"({"type":"status"})");
  EXPECT_TRUE(page.wait_until([&] { return page.has("status"); }));
}

TEST_F(Web, CommandsReachTheOwnerAndRepliesThePageThatAsked) {
  serve();
  Page page(port()), other(port());
  page.send(Json{{"type", "command"}, {"request", "r1"}, {"command", {{"kind", "step"}, {"count", 7}}}});
  std::vector<PageRequest> requests;
  ASSERT_TRUE(holds_in_time([&] {
    for (PageRequest& request : server_->take_requests()) requests.push_back(std::move(request));
    return !requests.empty();
  }));
  const auto& asked = std::get<Request>(requests[0]);
  EXPECT_EQ(std::get<StepOn>(asked.command).count, 7);
  server_->answer({asked.client, asked.id, true, "done", {{"hit", false}}});
  ASSERT_TRUE(page.wait_until([&] { return page.has("reply"); }));
  EXPECT_EQ(page.latest["reply"],
            Json({{"type", "reply"}, {"request", "r1"}, {"ok", true}, {"text", "done"}, {"result", {{"hit", false}}}}));
  EXPECT_FALSE(other.wait_until([&] { return other.has("reply"); }, 200ms));
}

TEST_F(Web, BadMessagesAreAnsweredCountedAndHarmNobody) {
  serve();
  Page page(port());
  for (const char* text : {"", "{", "[]", "null", R"({"type":"fly"})", R"({"type":"watch","slot":-1})"})
    page.send(std::string(text));
  page.send(std::string("\x01\x02"), true);
  const Json reply = page.ask({{"kind", "step"}, {"count", 1e99}});
  EXPECT_EQ(reply.at("ok"), false);
  EXPECT_THAT(reply.at("text").get<std::string>(), HasSubstr("count"));
  EXPECT_GE(server_->counters().refused, 8U);
  EXPECT_TRUE(page.open());
  page.send(std::string(200'000, ' '));
  EXPECT_TRUE(page.wait_until([&] { return !page.open(); })) << "too long a message ends the connection";
  EXPECT_EQ(request(port(), verb::get, "/healthz").status, 200U);
}

TEST_F(Web, WhereThereIsATokenTheWorldChangesOnlyByIt) {
  settings_.token = "the token";
  serve();
  Page page(port());
  EXPECT_EQ(page.ask({{"kind", "pause"}}).at("ok"), false);
  EXPECT_EQ(page.ask({{"kind", "pause"}}, "the tokem").at("ok"), false);
  EXPECT_TRUE(server_->take_requests().empty());
  page.send(Json{{"type", "command"}, {"request", "a"}, {"token", "the token"}, {"command", {{"kind", "pause"}}}});
  page.send(Json{
      {"type", "command"}, {"request", "b"}, {"command", {{"kind", "ray"}, {"from", {0, 0, 9}}, {"to", {0, 0, 0}}}}});
  std::size_t count = 0;
  EXPECT_TRUE(holds_in_time([&] { return (count += server_->take_requests().size()) == 2; }));
  EXPECT_EQ(request(port(), verb::post, "/api/shapes?name=a.obj", {}, kTetrahedron).status, 401U);
  EXPECT_EQ(request(port(), verb::post, "/api/shapes?name=a.obj", {{"Authorization", "Bearer the token"}}, kTetrahedron)
                .status,
            200U);
}

TEST_F(Web, MeshesAreKeptByTheHashOfTheirBytes) {
  serve();
  const auto reply = request(port(), verb::post, "/api/shapes?name=my%20mesh.obj", {}, kTetrahedron);
  ASSERT_EQ(reply.status, 200U) << reply.body;
  const Json json = Json::parse(reply.body);
  EXPECT_EQ(json.at("points"), 4);
  EXPECT_EQ(json.at("triangles"), 4);
  const std::uint64_t hash = std::stoull(json.at("hash").get<std::string>(), nullptr, 16);
  ASSERT_NE(shapes_.find(hash), nullptr);
  EXPECT_EQ(shapes_.find(hash)->points.size(), 4U);
  EXPECT_EQ(request(port(), verb::post, "/api/shapes?name=a.obj", {}, "v 1 2").status, 422U);
  EXPECT_EQ(request(port(), verb::post, "/api/shapes?name=a.exe", {}, "v 0 0 0").status, 422U);
  EXPECT_EQ(request(port(), verb::post, "/api/shapes", {}, "v 0 0 0").status, 422U);
  EXPECT_EQ(request(port(), verb::post, "/api/shapes?name=a.gltf", {},
                    R"({"asset":{"version":"2.0"},"buffers":[{"uri":"/etc/passwd","byteLength":10}]})")
                .status,
            422U)
      << "no other file is read";
  const std::string head =
      "POST /api/shapes?name=a.stl HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99000000\r\n\r\n";
  EXPECT_THAT(testing::raw(port(), head), ::testing::Not(HasSubstr("200")));
}

TEST_F(Web, AMeshThatTakesLongHoldsUpNothingElse) {
  serve();
  unsigned slow_status = 0;
  std::thread slow(
      [&] { slow_status = request(port(), verb::post, "/api/shapes?name=slow.obj", {}, kTetrahedron).status; });
  ASSERT_TRUE(holds_in_time([&] { return slow_has_begun_.load(); }));
  const std::string other = std::string("# another\n") + kTetrahedron;
  EXPECT_EQ(request(port(), verb::post, "/api/shapes?name=quick.obj", {}, other).status, 200U);
  EXPECT_EQ(request(port(), verb::get, "/").status, 200U);
  slow_may_end_ = true;
  slow.join();
  EXPECT_EQ(slow_status, 200U);
}

TEST_F(Web, SoManyMeshesAtATimeAndNoMore) {
  settings_.most_uploads = 1;
  serve();
  std::thread slow([&] { request(port(), verb::post, "/api/shapes?name=slow.obj", {}, kTetrahedron); });
  ASSERT_TRUE(holds_in_time([&] { return slow_has_begun_.load(); }));
  EXPECT_EQ(request(port(), verb::post, "/api/shapes?name=quick.obj", {}, kTetrahedron).status, 503U);
  slow_may_end_ = true;
  slow.join();
  EXPECT_TRUE(holds_in_time(
      [&] { return request(port(), verb::post, "/api/shapes?name=quick.obj", {}, kTetrahedron).status == 200U; }));
}

TEST_F(Web, APageThatDoesNotReadIsDroppedAndOthersDoNotNotice) {
  settings_.stall_limit = 1000ms;
  serve();
  show(20'000);
  testing::asio::io_context io;
  testing::asio::ip::tcp::socket deaf(io);
  deaf.open(testing::asio::ip::tcp::v4());
  deaf.set_option(testing::asio::socket_base::receive_buffer_size(4096));
  deaf.connect(testing::local(port()));
  testing::asio::write(deaf, testing::asio::buffer(std::string(kUpgrade)));
  Page page(port());
  ASSERT_TRUE(holds_in_time([&] { return server_->counters().clients == 2; }));
  auto next = testing::Clock::now();
  EXPECT_TRUE(page.wait_until([&] {
    if (testing::Clock::now() >= next) {
      next = testing::Clock::now() + 30ms;
      show(20'000);
    }
    return server_->counters().dropped == 1 && server_->counters().clients == 1;
  }));
  show(20'000);
  EXPECT_TRUE(page.wait_until([&] { return page.world.stamp == static_cast<double>(stamp_); }));
  EXPECT_GT(server_->counters().frames_skipped, 0U);
}

TEST_F(Web, NoMorePagesThanAllowed) {
  settings_.most_clients = 2;
  serve();
  Page first(port()), second(port());
  ASSERT_TRUE(first.open() && second.open());
  EXPECT_FALSE(Page(port()).open());
}

TEST_F(Web, PagesThatAskAtTheSameMomentGetNoMoreThanTheirPlaces) {
  settings_.most_clients = 8;
  serve();
  testing::asio::io_context io;
  auto pages = connect_many(io, 60);
  for (auto& page : pages) testing::asio::write(page, testing::asio::buffer(std::string(kUpgrade)));
  int accepted = 0;
  for (auto& page : pages) accepted += testing::answer_of(page).starts_with("HTTP/1.1 101");
  EXPECT_EQ(accepted, 8);
  EXPECT_TRUE(holds_in_time([&] { return server_->counters().clients == 8; }));
  pages.clear();
  EXPECT_TRUE(holds_in_time([&] { return Page(port()).open(); })) << "places are given back";
}

TEST_F(Web, ConnectionsThatSayNothingKeepNoPageOut) {
  settings_.header_limit = 10min;
  serve();
  testing::asio::io_context io;
  auto silent = connect_many(io, 600);
  for (auto& half_open : silent) {
    testing::beast::error_code dropped;
    testing::asio::write(half_open, testing::asio::buffer(std::string("GET / HTTP/1.1\r\nHos")), dropped);
  }
  ASSERT_TRUE(holds_in_time([&] { return server_->counters().connections == 600; }));
  EXPECT_EQ(request(port(), verb::get, "/").body, "<p>the page");
  EXPECT_TRUE(Page(port()).open());
  EXPECT_GE(server_->counters().refused, 344U) << "600 for 256 places";
}

TEST_F(Web, AHeaderThatDripsInIsNotWaitedFor) {
  settings_.header_limit = 300ms;
  serve();
  testing::asio::io_context io;
  auto slow = connect_many(io, 1);
  testing::beast::error_code closed;
  const auto deadline = testing::Clock::now() + 30s;
  while (!closed && testing::Clock::now() < deadline) {
    testing::asio::write(slow[0], testing::asio::buffer(std::string("X")), closed);
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_TRUE(closed);
}

TEST_F(Web, FilesAreCompressedForThoseWhoTakeIt) {
  const std::string script(100'000, 'x');
  std::ofstream(settings_.pages / "assets" / "main.js") << script;
  serve();
  const auto plain = request(port(), verb::get, "/assets/main.js");
  EXPECT_EQ(plain.body, script);
  EXPECT_EQ(plain.encoding, "");
  const auto packed = request(port(), verb::get, "/assets/main.js", {{"Accept-Encoding", "deflate, gzip;q=0.5"}});
  EXPECT_EQ(packed.encoding, "gzip");
  EXPECT_LT(packed.body.size(), 1000U);
  EXPECT_EQ(testing::unpacked(packed.body), script);
  EXPECT_EQ(request(port(), verb::get, "/assets/main.js", {{"Accept-Encoding", "gzip;q=0"}}).encoding, "");
  EXPECT_EQ(request(port(), verb::get, "/", {{"Accept-Encoding", "gzip"}}).encoding, "") << "too small to be worth it";
}

TEST_F(Web, WhatAPageHasAlreadyIsNotSentAgain) {
  serve();
  const auto first = request(port(), verb::get, "/");
  ASSERT_FALSE(first.etag.empty());
  EXPECT_EQ(request(port(), verb::get, "/", {{"If-None-Match", first.etag}}).status, 304U);
  std::ofstream(settings_.pages / "index.html") << "<p>another page";
  EXPECT_EQ(request(port(), verb::get, "/", {{"If-None-Match", first.etag}}).body, "<p>another page");
}

TEST_F(Web, AWatchedBodyIsToldWithEachStatusUntilItIsGone) {
  serve();
  show(3);
  Page page(port());
  ASSERT_TRUE(page.wait_until([&] { return page.world.frames > 0; }));
  page.send(Json{{"type", "watch"}, {"slot", 2}});
  ASSERT_TRUE(page.wait_until([&] { return page.has("body"); }));
  EXPECT_EQ(page.latest["body"].at("id"), 102);
  WorldFrame frame;
  frame.stamp = 9;
  frame.deleted = {2};
  server_->show(frame);
  server_->publish(Notice::kStatus, R"({"type":"status"})");
  EXPECT_TRUE(page.wait_until([&] { return page.latest["body"].contains("gone"); }));
}

TEST_F(Web, OverlaysGoToThePagesThatWantThem) {
  serve();
  Page page(port()), other(port());
  page.send(Json{{"type", "show"}, {"auras", true}});
  ASSERT_TRUE(holds_in_time([&] { return server_->wanted().auras; }));
  const std::vector<AuraDisc> auras = {{1, 2}};
  server_->show_overlays(encode_overlays(auras, {}, {}));
  EXPECT_TRUE(page.wait_until([&] { return !page.overlays.empty(); }));
  EXPECT_FALSE(other.wait_until([&] { return !other.overlays.empty(); }, 100ms));
}

TEST_F(Web, AHiddenPageIsSentNothingAndMissesNothing) {
  serve();
  show(50);
  Page page(port()), other(port());
  ASSERT_TRUE(page.wait_until([&] { return page.world.frames > 0; }));
  page.send(Json{{"type", "view"}, {"hidden", true}});
  page.ask({{"kind", "nonsense"}});  // replies come all the same, and then it is known to be hidden
  const std::uint64_t bytes = page.bytes;
  for (int i = 0; i < 20; ++i) {
    show(50);
    server_->publish(Notice::kStatus, R"({"type":"status"})");
  }
  ASSERT_TRUE(
      other.wait_until([&] { return other.world.stamp == static_cast<double>(stamp_) && other.has("status"); }));
  EXPECT_FALSE(page.wait_until([&] { return page.bytes > bytes; }, 300ms));
  page.send(Json{{"type", "view"}});
  EXPECT_TRUE(page.wait_until([&] { return page.world.stamp == static_cast<double>(stamp_) && page.has("status"); }));
  EXPECT_EQ(page.world.bodies.at(7).p.x(), static_cast<double>(stamp_));
}

TEST_F(Web, ATakenPortIsSaid) {
  serve();
  settings_.port = port();
  try {
    WebServer second(settings_, shapes_);
    FAIL() << "two servers on one port";
  } catch (const CannotListen& error) {
    EXPECT_TRUE(error.port_is_taken());
    EXPECT_THAT(error.what(), HasSubstr(std::to_string(port())));
  }
}

}  // namespace
}  // namespace aurasim::overseer
