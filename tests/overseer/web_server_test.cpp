// What the server answers to HTTP.
#include "overseer/web_fixture.h"

namespace aurasim::overseer {
namespace {

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

TEST_F(Web, EveryAnswerTellsTheBrowserWhatThePageMayDo) {
  serve();
  for (const char* target : {"/", "/healthz", "/nothing", "/api/session"}) {
    const auto fields = request(port(), verb::get, target).fields;
    const auto field = [&](const char* name) { return fields.contains(name) ? fields.at(name) : std::string(); };
    const std::string policy = field("content-security-policy");
    EXPECT_THAT(policy, HasSubstr("default-src 'none'")) << target;
    EXPECT_THAT(policy, HasSubstr("frame-ancestors 'none'")) << target;
    EXPECT_THAT(policy, ::testing::Not(HasSubstr("unsafe"))) << target;
    EXPECT_THAT(policy, ::testing::Not(HasSubstr("//"))) << "no third party: " << target;
    EXPECT_EQ(field("x-content-type-options"), "nosniff") << target;
    EXPECT_EQ(field("referrer-policy"), "no-referrer") << target;
    EXPECT_EQ(field("x-frame-options"), "DENY") << target;
    EXPECT_EQ(field("strict-transport-security"), "") << "there is no TLS: " << target;
  }
}

TEST_F(Web, WithoutABuiltPageItSaysHowToBuildOne) {
  settings_.pages = folder_ / "nowhere";
  serve();
  EXPECT_THAT(request(port(), verb::get, "/").body, HasSubstr("has not been built"));
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
