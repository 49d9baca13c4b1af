// Rules of the HTTP server: which requests are allowed, and which file answers. No sockets in here.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace aurasim::overseer {

/// The file below `root` that answers `target` (a request's path, escapes and query included), or nothing: no such
/// file, or one outside of `root`, by dots, escapes or links.
std::optional<std::filesystem::path> file_for(const std::filesystem::path& root, std::string_view target);

/// Returns `target` without its query.
std::string_view path_of(std::string_view target);
/// Returns the value of `name` in a target's query, unescaped; empty if it is not there.
std::string query_value(std::string_view target, std::string_view name);

std::string_view mime_type(const std::filesystem::path& file);

std::string lower(std::string_view text);
/// Returns a host without its port: "localhost:8080" -> "localhost", "[::1]:80" -> "[::1]".
std::string_view host_name(std::string_view host);
/// True when `host` is a name or an address, with or without a port. Refuses texts that mean another host to other
/// programs, like "localhost:80@evil.example".
bool is_host(std::string_view host);
/// True when `name` matches `known`, which may begin with "*." for one label, as in certificates.
bool matches_name(std::string_view name, std::string_view known);
/// True when a request comes from our own page. A page of another site may send requests to our server through the
/// user's browser; its Origin shows that. If its name points to this machine (DNS rebinding), the Host shows it. With
/// `tls`, an Origin without TLS is another site's; without `tls`, an Origin with TLS may come through a proxy.
bool is_same_origin(std::string_view origin, std::string_view host, bool tls);
bool is_loopback_name(std::string_view host);
bool is_loopback_address(std::string_view address);

/// Returns the token of an Authorization header: "Bearer TOKEN" -> "TOKEN".
std::string_view bearer_token(std::string_view authorization);
/// Returns the value of a cookie in a Cookie header; empty if it is not there.
std::string_view cookie_value(std::string_view cookies, std::string_view name);
/// Compares two texts. For texts of equal length the time does not depend on where they differ.
bool equal_in_constant_time(std::string_view a, std::string_view b);
/// Draws a token: 128 random bits as text.
std::string make_token();

/// Text of the error that no page has been built in `folder`.
std::string page_is_not_built(const std::filesystem::path& folder);

}  // namespace aurasim::overseer
