// What every answer of the web server tells the browser about what the page may do.
#pragma once

#include <array>
#include <utility>

namespace aurasim::overseer {

/// The page is made of its own files and talks to its own server: nothing of a third party, nothing inline, no frame
/// around it. ('self' holds for the WebSocket, too.)
inline constexpr const char* kContentPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'";

inline constexpr std::array<std::pair<const char*, const char*>, 7> kFixedHeaders = {{
    {"Cache-Control", "no-cache"},  // ask whether it has changed
    {"Content-Security-Policy", kContentPolicy},
    {"X-Content-Type-Options", "nosniff"},
    {"X-Frame-Options", "DENY"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
}};

/// Over TLS, and not for this host's own names: browsers would keep it for all ports of them.
inline constexpr const char* kStrictTransport = "max-age=31536000";

}  // namespace aurasim::overseer
