// Pages and others that ask for too much, too slowly or wrongly: who is shown the door, and that nobody else notices.
#include "overseer/web_fixture.h"

namespace aurasim::overseer {
namespace {

TEST_F(Web, BytesThatAreNotHttpAreAnsweredAndHarmNobody) {
  serve();
  const std::string host = "Host: localhost\r\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"400", "\x16\x03\x01 this is TLS\r\n\r\n"},
      {"400", "GET\r\n\r\n"},
      {"400", "GET / HTTP/1.1\r\nno colon\r\n\r\n"},
      {"400", "GET / HTTP/1.1\r\n" + host + "Content-Length: 99999999999999999999\r\n\r\n"},
      {"400", "GET / HTTP/1.1\r\n" + host + "Content-Length: 1\r\nTransfer-Encoding: chunked\r\n\r\n"},
      {"400", "POST /api/shapes?name=a.obj HTTP/1.1\r\n" + host + "Transfer-Encoding: chunked\r\n\r\nxyz\r\n"},
      {"413", "POST /api/shapes?name=a.obj HTTP/1.1\r\n" + host + "Content-Length: 99999999\r\n\r\n"},
      {"431", "GET /" + std::string(20'000, 'a') + " HTTP/1.1\r\n" + host + "\r\n"},
      {"431", "GET / HTTP/1.1\r\n" + host + "X: " + std::string(20'000, 'a') + "\r\n\r\n"},
      // Most of it is not read when the answer is written.
      {"431", std::string(2'000'000, 'A')},
  };
  for (const auto& [status, bytes] : cases) {
    EXPECT_THAT(testing::raw(port(), bytes), StartsWith("HTTP/1.1 " + status + " ")) << bytes.substr(0, 200);
  }
  EXPECT_EQ(request(port(), verb::get, "/healthz").status, 200U);
}

TEST_F(Web, WhatIsNoHostIsRefused) {
  serve();
  for (const char* host : {"localhost:8099@evil.com", "evil.com/localhost", "localhost:80:80", "local host",
                           "localhost#evil.com", "[::1", "[::1]evil.com", "[::1@]", ":80", "localhost:8o"}) {
    EXPECT_EQ(request(port(), verb::get, "/", {{"Host", host}}).status, 400U) << host;
  }
  EXPECT_THAT(testing::raw(port(), "GET / HTTP/1.1\r\n\r\n"), StartsWith("HTTP/1.1 400 ")) << "it needs one";
  for (const char* host : {"localhost", "LOCALHOST:80", "[::1]:8080", "127.0.0.1:"}) {
    EXPECT_EQ(request(port(), verb::get, "/", {{"Host", host}}).status, 200U) << host;
  }
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

TEST_F(Web, NestingWithoutEndIsRefused) {
  serve();
  Page page(port());
  for (const char* opening : {"[", R"({"a":)"}) {
    std::string text;
    while (text.size() < 60'000) text += opening;
    page.send(text);
  }
  EXPECT_TRUE(holds_in_time([&] { return server_->counters().refused == 2; }));
  EXPECT_TRUE(page.open());
}

/// Head of a WebSocket frame from a page, masked with zeros.
std::string frame_head(char first, std::uint64_t length) {
  std::string head = {first, static_cast<char>(0x80 | (length < 126 ? length : 127))};
  for (int shift = 56; length >= 126 && shift >= 0; shift -= 8) head += static_cast<char>(length >> shift & 0xff);
  return head + std::string(4, '\0');
}

TEST_F(Web, AFrameOfAHundredMegabytesIsNotWaitedFor) {
  serve();
  testing::asio::io_context io;
  auto socket = connect_raw_page(io);
  testing::beast::error_code closed;
  testing::asio::write(socket, testing::asio::buffer(frame_head('\x81', 100'000'000)), closed);
  const std::string megabyte(1'000'000, ' ');
  std::size_t sent = 0;
  while (!closed && sent < 100'000'000) sent += testing::asio::write(socket, testing::asio::buffer(megabyte), closed);
  EXPECT_TRUE(closed) << "all of it was taken";
  EXPECT_LT(sent, 50'000'000U);
  EXPECT_TRUE(holds_in_time([&] { return server_->counters().refused == 1; }));
  EXPECT_EQ(request(port(), verb::get, "/healthz").status, 200U);
}

TEST_F(Web, AMessageInPiecesIsNoLongerThanAnyOther) {
  serve();
  testing::asio::io_context io;
  auto socket = connect_raw_page(io);
  testing::beast::error_code closed;
  const std::string piece(1000, ' ');
  testing::asio::write(socket, testing::asio::buffer(frame_head('\x01', piece.size()) + piece), closed);
  for (int i = 0; i < 100; ++i)
    testing::asio::write(socket, testing::asio::buffer(frame_head('\x00', piece.size()) + piece), closed);
  EXPECT_TRUE(ends(socket));
}

TEST_F(Web, APageThatSendsWithoutEndIsReadSlowlyAndOthersDoNotNotice) {
  serve();
  Page page(port());
  testing::asio::io_context io;
  auto socket = connect_raw_page(io);
  std::atomic<bool> enough = false;
  std::thread flood([&] {
    std::string messages;
    for (int i = 0; i < 1000; ++i) messages += frame_head('\x82', 0);  // binary: each is refused, and counted
    testing::beast::error_code closed;
    socket.non_blocking(true);
    while (!enough) {
      socket.write_some(testing::asio::buffer(messages), closed);
      std::this_thread::sleep_for(1ms);
    }
  });
  const auto began = testing::Clock::now();
  for (int i = 0; i < 5; ++i) {
    show(100);
    EXPECT_TRUE(page.wait_until([&] { return page.world.stamp == static_cast<double>(stamp_); }));
    std::this_thread::sleep_for(200ms);
  }
  const double took_s = std::chrono::duration<double>(testing::Clock::now() - began).count();
  const std::uint64_t read = server_->counters().refused;
  EXPECT_GE(read, 200U);
  EXPECT_LE(static_cast<double>(read), 202 + 110 * took_s) << "messages in " << took_s << " s";
  enough = true;
  flood.join();
}

TEST_F(Web, NodesAreAskedForSoManyRaysAndNoMore) {
  serve();
  Page page(port());
  for (int i = 0; i < 60; ++i)
    page.send(Json{{"type", "command"},
                   {"request", std::to_string(i)},
                   {"command", {{"kind", "ray"}, {"from", {0, 0, 9}}, {"to", {0, 0, 0}}}}});
  ASSERT_TRUE(page.wait_until([&] { return page.replies.contains("59"); }));
  EXPECT_THAT(page.latest["reply"].at("text").get<std::string>(), HasSubstr("too many rays"));
  const std::size_t asked = server_->take_requests().size();
  EXPECT_GE(asked, 20U);
  EXPECT_LE(asked, 40U);
}

TEST_F(Web, APageThatPingsWithoutEndIsDropped) {
  serve();
  testing::asio::io_context io;
  auto socket = connect_raw_page(io);
  testing::beast::error_code closed;
  for (int i = 0; i < 200; ++i) testing::asio::write(socket, testing::asio::buffer(frame_head('\x89', 0)), closed);
  EXPECT_TRUE(ends(socket));
  EXPECT_TRUE(holds_in_time([&] { return server_->counters().clients == 0; }));
}

TEST_F(Web, RequestsOfOneConnectionWaitForEachOther) {
  serve();
  testing::asio::io_context io;
  auto sockets = connect_many(io, 1);
  std::string requests;
  for (int i = 0; i < 400; ++i) requests += "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";
  testing::asio::write(sockets[0], testing::asio::buffer(requests));
  std::string answers;
  testing::asio::async_read(sockets[0], testing::asio::dynamic_buffer(answers),
                            [](testing::beast::error_code, std::size_t) {});
  io.run_for(1s);
  int count = 0;
  for (std::size_t at = 0; (at = answers.find("HTTP/1.1 200", at)) != std::string::npos; ++at) ++count;
  EXPECT_GE(count, 50);
  EXPECT_LE(count, 200) << "50 at once, and 50 a second";
}

TEST_F(Web, FiveHundredConnectionsThatHaveAskedKeepNoPageOut) {
  serve();
  testing::asio::io_context io;
  auto sockets = connect_many(io, 500);
  for (auto& socket : sockets) {
    testing::beast::error_code dropped;
    testing::asio::write(socket, testing::asio::buffer(std::string("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")),
                         dropped);
  }
  ASSERT_TRUE(holds_in_time([&] { return server_->counters().connections == 500; }));
  EXPECT_EQ(request(port(), verb::get, "/").body, "<p>the page");
  EXPECT_TRUE(Page(port()).open());
}

TEST_F(Web, AMeshThatDripsInIsNotWaitedFor) {
  settings_.upload_limit = 300ms;
  settings_.most_uploads = 1;
  serve();
  testing::asio::io_context io;
  auto slow = connect_many(io, 1);
  const std::string head = "POST /api/shapes?name=a.obj HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000\r\n\r\n";
  testing::asio::write(slow[0], testing::asio::buffer(head));
  testing::beast::error_code closed;
  const auto deadline = testing::Clock::now() + 30s;
  while (!closed && testing::Clock::now() < deadline) {
    testing::asio::write(slow[0], testing::asio::buffer(std::string("v")), closed);
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_TRUE(closed);
  EXPECT_EQ(request(port(), verb::post, "/api/shapes?name=quick.obj", {}, kTetrahedron).status, 200U);
}

}  // namespace
}  // namespace aurasim::overseer
