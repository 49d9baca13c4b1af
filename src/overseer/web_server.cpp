#include "overseer/web_server.h"

#include <optional>
#include <thread>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <fmt/format.h>

#include "overseer/give_way.h"
#include "overseer/web_connection.h"
#include "overseer/web_tls.h"

namespace aurasim::overseer {

namespace asio = boost::asio;
using asio::ip::tcp;
using Error = boost::system::error_code;

namespace {

constexpr std::chrono::milliseconds kLookAfter{500};  // period of the check for stalled pages
constexpr std::size_t kReaders = 4;  // threads that read meshes: one that takes long does not hold up the others

tcp::acceptor opened(asio::io_context& io, const WebSettings& settings) {
  tcp::acceptor acceptor(io);
  Error error;
  const auto check = [&](const char* what) {
    if (!error) return;
    throw CannotListen(fmt::format("cannot {} {}:{}: {}", what, settings.bind, settings.port, error.message()),
                       error == asio::error::address_in_use);
  };
  const std::string host = settings.bind == "localhost" ? "127.0.0.1" : settings.bind;
  const asio::ip::address address = asio::ip::make_address(host, error);
  check("use the address");
  const tcp::endpoint endpoint(address, settings.port);
  acceptor.open(endpoint.protocol(), error);
  check("listen on");
  acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  acceptor.bind(endpoint, error);
  check("listen on");
  acceptor.listen(asio::socket_base::max_listen_connections, error);
  check("listen on");
  return acceptor;
}

std::optional<asio::ssl::context> tls_of(const WebSettings& settings) {
  if (!settings.tls) return std::nullopt;
  return make_tls_context(*settings.tls);
}

/// Completes the settings with values that are known only after binding.
WebSettings completed(WebSettings settings, std::uint16_t port, std::optional<asio::ssl::context>& tls) {
  settings.port = port;
  if (!tls) return settings;
  for (std::string& name : names_of_certificate(*tls)) settings.names.push_back(std::move(name));
  return settings;
}

}  // namespace

struct WebServer::Impl {
  Impl(const WebSettings& settings, ShapeStore& shapes)
      : tls(tls_of(settings)), acceptor(opened(io, settings)), port(acceptor.local_endpoint().port()) {
    hub.emplace(completed(settings, port, tls), shapes);
    accept();
    look_after();
    thread = std::thread([this] {
      give_way();
      io.run();
    });
  }

  ~Impl() {
    worker.join();
    io.stop();
    thread.join();
    hub->clear();
  }

  void accept() {
    acceptor.async_accept([this](const Error& error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (error) {  // e.g. out of file descriptors: retry only after a pause
        retry.expires_after(kLookAfter);
        return retry.async_wait([this](const Error& ended) {
          if (!ended) accept();
        });
      }
      serve_connection(std::move(socket), *hub, tls ? &*tls : nullptr, worker.get_executor());
      accept();
    });
  }

  void look_after() {
    timer.expires_after(kLookAfter);
    timer.async_wait([this](const Error& error) {
      if (error) return;
      hub->drop_stalled();
      look_after();
    });
  }

  template <class Job>
  void post(Job job) {
    asio::post(io, std::move(job));
  }

  std::optional<WebHub> hub;  ///< outlives all connections, which end with `io`
  asio::thread_pool worker{kReaders};
  std::optional<asio::ssl::context> tls;
  asio::io_context io{1};
  tcp::acceptor acceptor;
  std::uint16_t port;
  asio::steady_timer timer{io};
  asio::steady_timer retry{io};
  std::thread thread;
};

WebServer::WebServer(const WebSettings& settings, ShapeStore& shapes)
    : impl_(std::make_unique<Impl>(settings, shapes)) {}

WebServer::~WebServer() = default;

std::uint16_t WebServer::port() const { return impl_->port; }

void WebServer::publish(Notice notice, std::string json) {
  impl_->post([this, notice, text = std::make_shared<const std::string>(std::move(json))] {
    impl_->hub->publish(notice, text);
  });
}

void WebServer::show(const WorldFrame& frame) {
  impl_->post([this, copy = std::make_shared<const WorldFrame>(frame)] { impl_->hub->show(*copy); });
}

void WebServer::show_overlays(Bytes overlays) {
  impl_->post([this, bytes = std::make_shared<const Bytes>(std::move(overlays))] { impl_->hub->show_overlays(bytes); });
}

void WebServer::set_metrics(std::string text) {
  impl_->post([this, text = std::move(text)]() mutable { impl_->hub->set_metrics(std::move(text)); });
}

void WebServer::answer(const Reply& reply) {
  impl_->post([this, reply] { impl_->hub->answer(reply); });
}

Show WebServer::wanted() const { return impl_->hub->wanted(); }

std::vector<PageRequest> WebServer::take_requests() { return impl_->hub->take_requests(); }

WebCounters WebServer::counters() const { return impl_->hub->counters(); }

}  // namespace aurasim::overseer
