// The server over TLS.
#include <boost/asio/ssl.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket/ssl.hpp>

#include "overseer/test_certificate.h"
#include "overseer/tls_files.h"
#include "overseer/web_fixture.h"

namespace aurasim::overseer {
namespace {

namespace asio = testing::asio;
namespace beast = testing::beast;
namespace http = testing::http;
namespace ssl = asio::ssl;
using testing::HttpReply;
using ::testing::Not;
using ::testing::StartsWith;
using testing::TestCertificate;

class WebOverTls : public Web {
 protected:
  void SetUp() override {
    Web::SetUp();
    const TestCertificate certificate("DNS:localhost,DNS:viewer.test,DNS:*.lab.test,IP:127.0.0.1");
    settings_.tls = config::Tls{folder_ / "certificate.pem", folder_ / "key.pem"};
    certificate.write_certificate(settings_.tls->certificate);
    certificate.write_key(settings_.tls->key);
    client_.load_verify_file(settings_.tls->certificate);
    client_.set_verify_mode(ssl::verify_peer);
  }

  /// `host`: as in a browser's address; the connection always goes to this host.
  HttpReply request_over_tls(const std::string& target, const std::string& host = "localhost",
                             const std::vector<std::pair<std::string, std::string>>& fields = {},
                             http::verb verb = http::verb::get) {
    asio::io_context io;
    beast::ssl_stream<beast::tcp_stream> stream(io, client_);
    http::request<http::string_body> request(verb, target, 11);
    request.set(http::field::host, host);
    request.keep_alive(false);
    for (const auto& [name, value] : fields) request.set(name, value);
    http::response<http::string_body> response;
    beast::flat_buffer buffer;
    HttpReply reply;
    beast::get_lowest_layer(stream).async_connect(testing::local(port()), [&](beast::error_code) {
      stream.async_handshake(ssl::stream_base::client, [&](beast::error_code refused) {
        handshake_ = refused;
        if (refused) return;
        http::async_write(stream, request, [&](beast::error_code, std::size_t) {
          http::async_read(stream, buffer, response, [&](beast::error_code failed, std::size_t) {
            if (!failed) reply = testing::reply_of(response);
          });
        });
      });
    });
    io.run_for(10s);
    return reply;
  }

  /// The first message that a page gets; empty: none.
  std::string first_message(const std::vector<std::pair<std::string, std::string>>& fields) {
    asio::io_context io;
    beast::websocket::stream<beast::ssl_stream<beast::tcp_stream>> page(io, client_);
    page.set_option(beast::websocket::stream_base::decorator([&](beast::websocket::request_type& request) {
      for (const auto& [name, value] : fields) request.set(name, value);
    }));
    beast::flat_buffer buffer;
    std::string message;
    beast::get_lowest_layer(page).async_connect(testing::local(port()), [&](beast::error_code) {
      page.next_layer().async_handshake(ssl::stream_base::client, [&](beast::error_code) {
        page.async_handshake("viewer.test", "/ws", [&](beast::error_code refused) {
          if (refused) return io.stop();
          page.async_read(buffer, [&](beast::error_code, std::size_t) {
            message = beast::buffers_to_string(buffer.data());
            io.stop();
          });
        });
      });
    });
    io.run_for(10s);
    return message;
  }

  /// "certificate" or "key", if that is said to be wrong.
  std::string what_is_wrong() {
    try {
      WebServer server(settings_, shapes_);
    } catch (const BadTls& error) {
      said_ = error.what();
      return error.key();
    }
    return {};
  }

  ssl::context client_{ssl::context::tls_client};
  beast::error_code handshake_;
  std::string said_;
};

TEST_F(WebOverTls, ThePageAndItsWebSocketAreServed) {
  serve();
  EXPECT_EQ(request_over_tls("/").body, "<p>the page");
  EXPECT_THAT(first_message({{"Origin", "https://viewer.test"}}), HasSubstr("hello"));
  EXPECT_EQ(first_message({{"Origin", "http://viewer.test"}}), "");
  EXPECT_EQ(first_message({{"Origin", "https://evil.example"}}), "");
}

TEST_F(WebOverTls, BrowsersAreToldToStayWithItButNotOnThisHostsOwnNames) {
  serve();
  EXPECT_THAT(request_over_tls("/", "viewer.test").fields["strict-transport-security"], HasSubstr("max-age="));
  EXPECT_FALSE(request_over_tls("/", "localhost").fields.contains("strict-transport-security"));
}

TEST_F(WebOverTls, ItIsAskedForByTheNamesOfItsCertificate) {
  serve();
  for (const char* host : {"viewer.test:8443", "b.lab.test", "127.0.0.1"})
    EXPECT_EQ(request_over_tls("/", host).status, 200U) << host;
  for (const char* host : {"evil.example", "lab.test", "10.0.0.1"})
    EXPECT_EQ(request_over_tls("/", host).status, 403U) << host;
}

TEST_F(WebOverTls, TheCookieIsForTlsOnly) {
  settings_.token = "the token";
  serve();
  const auto reply =
      request_over_tls("/api/session", "localhost", {{"Authorization", "Bearer the token"}}, http::verb::post);
  const std::string cookie = reply.fields.at("set-cookie");
  EXPECT_THAT(cookie, StartsWith("__Host-"));
  EXPECT_THAT(cookie, HasSubstr("; Secure"));
  const auto again = request_over_tls("/api/session", "localhost", {{"Cookie", cookie.substr(0, cookie.find(';'))}});
  EXPECT_THAT(again.body, HasSubstr("operate"));
}

TEST_F(WebOverTls, OlderVersionsAndWeakCiphersAreRefused) {
  serve();
  SSL_CTX* const native = client_.native_handle();
  SSL_CTX_set_max_proto_version(native, TLS1_2_VERSION);
  EXPECT_EQ(request_over_tls("/").status, 200U);
  SSL_CTX_set_cipher_list(native, "AES128-SHA:ECDHE-ECDSA-AES128-SHA:@SECLEVEL=0");
  EXPECT_EQ(request_over_tls("/").status, 0U);
  EXPECT_TRUE(handshake_) << "no cipher of both";
  SSL_CTX_set_cipher_list(native, "ALL:@SECLEVEL=0");
  SSL_CTX_set_max_proto_version(native, TLS1_1_VERSION);
  EXPECT_EQ(request_over_tls("/").status, 0U);
  EXPECT_TRUE(handshake_) << "TLS 1.1";
}

TEST_F(WebOverTls, WhoLeavesOutTheSIsToldSo) {
  serve();
  const std::string answer = testing::raw(port(), "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(answer, HasSubstr("HTTPS"));
  EXPECT_THAT(answer, Not(HasSubstr("the page")));
  EXPECT_EQ(request_over_tls("/").status, 200U);
}

TEST_F(WebOverTls, BytesThatAreNoHandshakeHarmNobody) {
  serve();
  testing::raw(port(), std::string(100'000, '\xff'));
  testing::raw(port(), std::string("\x16\x03\x01\xff\xff\x01\x00\xff\xff", 9) + std::string(70'000, 'a'));
  EXPECT_GE(server_->counters().refused, 2U);
  EXPECT_EQ(request_over_tls("/").status, 200U);
}

TEST_F(WebOverTls, AHandshakeThatDripsInIsNotWaitedFor) {
  settings_.header_limit = 300ms;
  serve();
  asio::io_context io;
  auto slow = connect_many(io, 1);
  beast::error_code closed;
  const std::string hello("\x16\x03\x01\x02\x00", 5);
  asio::write(slow[0], asio::buffer(hello), closed);
  const auto deadline = testing::Clock::now() + 30s;
  while (!closed && testing::Clock::now() < deadline) {
    asio::write(slow[0], asio::buffer(std::string(1, '\x01')), closed);
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_TRUE(closed);
}

TEST_F(WebOverTls, FiveHundredHandshakesThatAreNotEndedKeepNobodyOut) {
  settings_.header_limit = 10min;
  serve();
  asio::io_context io;
  auto silent = connect_many(io, 500);
  ASSERT_TRUE(holds_in_time([&] { return server_->counters().connections == 500; }));
  EXPECT_EQ(request_over_tls("/").status, 200U);
}

TEST_F(WebOverTls, FilesThatCannotBeUsedAreNamed) {
  const config::Tls good = *settings_.tls;
  settings_.tls->certificate = folder_ / "nowhere.pem";
  EXPECT_EQ(what_is_wrong(), "certificate");
  EXPECT_THAT(said_, HasSubstr("nowhere.pem"));
  settings_.tls = good;
  settings_.tls->key = folder_;
  EXPECT_EQ(what_is_wrong(), "key");
  settings_.tls->key = folder_ / "pages" / "index.html";
  std::filesystem::permissions(settings_.tls->key, std::filesystem::perms::owner_read);
  EXPECT_EQ(what_is_wrong(), "key") << "no PEM";
  settings_.tls->certificate = folder_ / "pages" / "index.html";
  EXPECT_EQ(what_is_wrong(), "certificate") << "no PEM";
  settings_.tls = good;
  settings_.tls->key = folder_ / "other.pem";
  TestCertificate("DNS:localhost").write_key(settings_.tls->key);
  EXPECT_EQ(what_is_wrong(), "key") << "of another certificate";
  TestCertificate("DNS:localhost").write_key(settings_.tls->key, "passphrase");
  EXPECT_EQ(what_is_wrong(), "key") << "nobody is asked for a passphrase";
  settings_.tls = good;
  std::filesystem::permissions(good.key, std::filesystem::perms::others_read, std::filesystem::perm_options::add);
  EXPECT_EQ(what_is_wrong(), "key") << "everybody may read it";
  EXPECT_THAT(said_, HasSubstr("chmod"));
  std::filesystem::permissions(good.key, std::filesystem::perms::others_read, std::filesystem::perm_options::remove);
  EXPECT_EQ(what_is_wrong(), "");
}

}  // namespace
}  // namespace aurasim::overseer
