#include "overseer/web_connection.h"

#include <algorithm>

#include "overseer/http_connection.h"

namespace aurasim::overseer {
namespace {

namespace ip = boost::asio::ip;

/// Text of the address by which clients are counted. In IPv6 it is the network of 64 bits, which one client may have to
/// itself.
std::string text_of_remote(const ip::address& address) {
  if (address.is_v4() || address.is_loopback()) return address.to_string();
  if (address.to_v6().is_v4_mapped()) return ip::make_address_v4(ip::v4_mapped, address.to_v6()).to_string();
  ip::address_v6::bytes_type bytes = address.to_v6().to_bytes();
  std::fill(bytes.begin() + 8, bytes.end(), 0);
  return ip::address_v6(bytes).to_string() + "/64";
}

std::string text_of_local(const ip::address& address) {
  if (address.is_v6() && address.to_v6().is_v4_mapped())
    return ip::make_address_v4(ip::v4_mapped, address.to_v6()).to_string();
  return address.to_string();
}

template <class Stream>
void serve(Stream stream, Ends ends, WebHub& hub, const boost::asio::any_io_executor& worker) {
  const auto connection = std::make_shared<HttpConnection<Stream>>(std::move(stream), std::move(ends), hub, worker);
  hub.enter(connection);
  connection->start();
}

}  // namespace

void serve_connection(ip::tcp::socket socket, WebHub& hub, boost::asio::ssl::context* tls,
                      const boost::asio::any_io_executor& worker) {
  boost::system::error_code gone;  // errors are ignored: a lost connection is noticed soon
  Ends ends{text_of_remote(socket.remote_endpoint(gone).address()),
            text_of_local(socket.local_endpoint(gone).address())};
  PlainStream stream(std::move(socket));
  if (tls == nullptr) return serve(std::move(stream), std::move(ends), hub, worker);
  serve(TlsStream(std::move(stream), *tls), std::move(ends), hub, worker);
}

}  // namespace aurasim::overseer
