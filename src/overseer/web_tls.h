// TLS of the web server, by OpenSSL: 1.2 and 1.3, forward secrecy and authenticated encryption only.
#pragma once

#include <string>
#include <vector>

#include <boost/asio/ssl/context.hpp>

#include "config/launch.h"

namespace aurasim::overseer {

/// Makes the TLS context. Throws BadTls like check_tls (tls_files.h).
boost::asio::ssl::context make_tls_context(const config::Tls& tls);

/// Names and addresses that the context's certificate is for.
std::vector<std::string> names_of_certificate(boost::asio::ssl::context& context);

}  // namespace aurasim::overseer
