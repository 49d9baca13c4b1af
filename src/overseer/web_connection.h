// Serves one TCP connection of a browser from its first byte on.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>

#include "overseer/web_hub.h"

namespace aurasim::overseer {

/// Serves it until either side ends it. `tls`: null for plain HTTP. `worker` runs what takes long (reading meshes).
/// Hub, context and worker outlive it.
void serve_connection(boost::asio::ip::tcp::socket socket, WebHub& hub, boost::asio::ssl::context* tls,
                      const boost::asio::any_io_executor& worker);

}  // namespace aurasim::overseer
