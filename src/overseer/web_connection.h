// One TCP connection of a browser: HTTP requests, until one asks for the WebSocket.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "overseer/web_hub.h"

namespace aurasim::overseer {

/// Serves it until either side ends it. `worker` runs what takes long (reading meshes). Hub and worker outlive it.
void serve_connection(boost::asio::ip::tcp::socket socket, WebHub& hub, const boost::asio::any_io_executor& worker);

}  // namespace aurasim::overseer
