// Headers of every answer, which limit what the browser lets the page do.
#pragma once

#include <array>
#include <utility>

namespace aurasim::overseer {

/// Content policy. The page uses its own files and its own server only: no third parties, nothing inline, no frame
/// around it. ('self' includes the WebSocket.)
inline constexpr const char* kContentPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'";

inline constexpr std::array<std::pair<const char*, const char*>, 7> kFixedHeaders = {{
    {"Cache-Control", "no-cache"},  // the browser has to ask whether the file has changed
    {"Content-Security-Policy", kContentPolicy},
    {"X-Content-Type-Options", "nosniff"},
    {"X-Frame-Options", "DENY"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
}};

/// Strict transport, sent over TLS only and not for this host's own names, for which browsers would apply it to all
/// ports.
inline constexpr const char* kStrictTransport = "max-age=31536000";

}  // namespace aurasim::overseer
