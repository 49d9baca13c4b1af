// Who may ask for what.
#include "overseer/web_access.h"

#include "overseer/web_fixture.h"
#include "overseer/web_hub.h"

namespace aurasim::overseer {
namespace {

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

using Fields = std::vector<std::pair<std::string, std::string>>;

Fields bearer(const std::string& token) { return {{"Authorization", "Bearer " + token}}; }

TEST_F(Web, WhereThereIsATokenTheWorldChangesOnlyByIt) {
  settings_.token = "the token";
  serve();
  Page page(port());
  EXPECT_EQ(page.ask({{"kind", "pause"}}).at("ok"), false);
  page.send(Json{{"type", "replay"}, {"action", "pause"}});
  EXPECT_FALSE(Page(port(), bearer("the tokem")).open());
  EXPECT_TRUE(server_->take_requests().empty());
  page.send(Json{
      {"type", "command"}, {"request", "b"}, {"command", {{"kind", "ray"}, {"from", {0, 0, 9}}, {"to", {0, 0, 0}}}}});
  Page operators(port(), bearer("the token"));
  operators.send(Json{{"type", "command"}, {"request", "a"}, {"command", {{"kind", "pause"}}}});
  operators.send(Json{{"type", "replay"}, {"action", "pause"}});
  std::size_t count = 0;
  EXPECT_TRUE(holds_in_time([&] { return (count += server_->take_requests().size()) == 3; }));
  EXPECT_EQ(request(port(), verb::post, "/api/shapes?name=a.obj", {}, kTetrahedron).status, 401U);
  EXPECT_EQ(request(port(), verb::post, "/api/shapes?name=a.obj", bearer("the token"), kTetrahedron).status, 200U);
}

TEST_F(Web, ATokenIsExchangedForACookie) {
  settings_.token = "the token";
  settings_.view_token = "another token";
  serve();
  EXPECT_EQ(request(port(), verb::post, "/api/session").status, 401U);
  EXPECT_EQ(request(port(), verb::post, "/api/session", bearer("wrong")).status, 401U);
  const auto reply = request(port(), verb::post, "/api/session", bearer("the token"));
  EXPECT_EQ(Json::parse(reply.body), Json({{"may", "operate"}}));
  ASSERT_TRUE(reply.fields.contains("set-cookie"));
  const std::string cookie = reply.fields.at("set-cookie");
  EXPECT_THAT(cookie, HasSubstr("HttpOnly"));
  EXPECT_THAT(cookie, HasSubstr("SameSite=Strict"));
  EXPECT_THAT(cookie, ::testing::Not(HasSubstr("token"))) << "it goes to every port of this host";
  const Fields fields = {{"Cookie", "other=1; " + cookie.substr(0, cookie.find(';'))}};
  EXPECT_EQ(Json::parse(request(port(), verb::get, "/api/session", fields).body), Json({{"may", "operate"}}));
  Page page(port(), fields);
  page.send(Json{{"type", "command"}, {"request", "a"}, {"command", {{"kind", "pause"}}}});
  std::size_t count = 0;
  EXPECT_TRUE(holds_in_time([&] { return (count += server_->take_requests().size()) == 1; }));
  server_.reset();
  serve();
  EXPECT_FALSE(Page(port(), fields).open()) << "it ends with the server";
}

TEST_F(Web, WhereLookingTakesATokenStrangersGetThePageAndNothingOfTheRun) {
  settings_.token = "the token";
  settings_.view_token = "look";
  serve();
  EXPECT_EQ(request(port(), verb::get, "/").status, 200U);
  EXPECT_EQ(request(port(), verb::get, "/healthz").status, 200U);
  EXPECT_EQ(Json::parse(request(port(), verb::get, "/api/session").body), Json({{"may", "nothing"}}));
  for (const char* target : {"/metrics", "/api/scenes"}) {
    EXPECT_EQ(request(port(), verb::get, target).status, 401U) << target;
    EXPECT_EQ(request(port(), verb::get, target, bearer("look")).status, 200U) << target;
  }
  EXPECT_FALSE(Page(port()).open());
  Page page(port(), bearer("look"));
  ASSERT_TRUE(page.open());
  EXPECT_TRUE(page.wait_until([&] { return page.has("hello"); }));
  EXPECT_EQ(page.ask({{"kind", "pause"}}).at("ok"), false);
  EXPECT_EQ(request(port(), verb::post, "/api/shapes?name=a.obj", bearer("look"), kTetrahedron).status, 401U);
}

TEST_F(Web, HeadersThatStandThereTwiceAreRefused) {
  serve();
  EXPECT_THAT(testing::raw(port(), "GET / HTTP/1.1\r\nHost: localhost\r\nHost: evil.example\r\n\r\n"),
              ::testing::StartsWith("HTTP/1.1 400"));
}

/// The rules alone, at any address.
class Access : public ::testing::Test {
 protected:
  Access() {
    settings_.bind = "0.0.0.0";
    settings_.token = "operate";
    settings_.view_token = "look";
    settings_.names = {"viewer.lab", "*.example.org"};
  }
  WebAccess access() const { return WebAccess(settings_); }

  /// 0: it is let in.
  static unsigned shows(WebAccess& access, const std::string& address, const std::string& token, int at_s = 0) {
    const std::string authorization = "Bearer " + token;
    const auto found = access.standing_of(address, {authorization, {}}, WebAccess::Clock::time_point(1s * at_s));
    return std::holds_alternative<Refusal>(found) ? std::get<Refusal>(found).status : 0;
  }

  WebSettings settings_;
};

TEST_F(Access, IsByTheNamesAndAddressesThatTheServerIsMeantToBeAskedBy) {
  const WebAccess access = this->access();
  const auto is_served = [&](const char* host) { return access.why_not(host, {}, "10.0.0.5").empty(); };
  for (const char* host :
       {"10.0.0.5:8080", "localhost:9000", "127.0.0.1", "[::1]:80", "viewer.lab", "VIEWER.lab:8080", "a.example.org"})
    EXPECT_TRUE(is_served(host)) << host;
  for (const char* host : {"", "10.0.0.6", "evil.example", "viewer.lab.evil.example", "example.org", "a.b.example.org",
                           ".example.org", "localhost.evil.example", "127.0.0.1.evil.example"})
    EXPECT_FALSE(is_served(host)) << host;
}

TEST_F(Access, IsForPagesOfTheSameOrigin) {
  const auto is_served = [](const WebAccess& access, const char* origin) {
    return access.why_not("viewer.lab:8080", origin, "10.0.0.5").empty();
  };
  const WebAccess plain = access();
  EXPECT_TRUE(is_served(plain, "http://viewer.lab:8080"));
  EXPECT_TRUE(is_served(plain, "https://viewer.lab:8080")) << "a proxy speaks TLS";
  for (const char* origin : {"null", "http://viewer.lab", "http://viewer.lab:8081", "http://evil.example",
                             "viewer.lab:8080", "http://viewer.lab:8080.evil.example", "file://viewer.lab:8080"})
    EXPECT_FALSE(is_served(plain, origin)) << origin;
  settings_.tls = config::Tls{};
  EXPECT_TRUE(is_served(access(), "https://viewer.lab:8080"));
  EXPECT_FALSE(is_served(access(), "http://viewer.lab:8080")) << "whoever is in between can have made that page";
}

TEST_F(Access, GuessingIsSlow) {
  WebAccess access = this->access();
  for (int i = 0; i < 10; ++i) EXPECT_EQ(shows(access, "10.0.0.9", "guess"), 401U);
  EXPECT_EQ(shows(access, "10.0.0.9", "guess"), 429U);
  EXPECT_EQ(shows(access, "10.0.0.9", "operate"), 429U) << "not even looked at";
  EXPECT_EQ(shows(access, "10.0.0.8", "operate"), 0U) << "others do not notice";
  EXPECT_EQ(access.wrong_tokens(), 10U);
  EXPECT_EQ(shows(access, "10.0.0.9", "guess", 4), 429U);
  EXPECT_EQ(shows(access, "10.0.0.9", "guess", 6), 401U);
  EXPECT_EQ(shows(access, "10.0.0.9", "guess", 7), 429U);
  EXPECT_EQ(shows(access, "10.0.0.9", "operate", 12), 0U);
}

TEST_F(Access, WhoHasACookieDoesNotNoticeThatOthersGuess) {
  WebAccess access = this->access();
  for (int i = 0; i < 20; ++i) shows(access, "10.0.0.9", "guess");
  for (const Standing standing : {Standing::kViewer, Standing::kOperator}) {
    const std::string cookie = access.cookie(standing);
    const auto found = access.standing_of("10.0.0.9", {{}, cookie}, {});
    EXPECT_EQ(std::get<Standing>(found), standing);
  }
  EXPECT_EQ(std::get<Standing>(access.standing_of("10.0.0.9", {{}, "aurasim_8080=; aurasim_8080"}, {})),
            Standing::kStranger);
}

TEST_F(Access, ManyGuessersAreForgotten) {
  WebAccess access = this->access();
  for (int i = 0; i < 20'000; ++i) shows(access, "guesser " + std::to_string(i), "guess");
  EXPECT_EQ(shows(access, "10.0.0.8", "operate"), 0U);
}

TEST_F(Access, OneAddressCannotTakeThePlacesOfAllPages) {
  ShapeStore shapes([](const std::string&, std::string_view) { return std::string("none"); });
  WebHub hub(settings_, shapes);
  std::vector<PagePlace> places;
  const auto count_for = [&](const char* address) {
    int count = 0;
    for (; count < 100; ++count) {
      PagePlace place = hub.page_place(address);
      if (!place) break;
      places.push_back(std::move(place));
    }
    return count;
  };
  EXPECT_EQ(count_for("10.0.0.9"), 16);
  EXPECT_EQ(count_for("10.0.0.8"), 16);
  EXPECT_EQ(count_for("127.0.0.1"), 32) << "all that are left: a tunnel may end there";
  places.clear();
  EXPECT_EQ(count_for("10.0.0.9"), 16) << "places are given back";
}

}  // namespace
}  // namespace aurasim::overseer
