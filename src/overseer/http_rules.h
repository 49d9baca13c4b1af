// Who may ask for what over HTTP, and which file answers. No sockets in here.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace aurasim::overseer {

/// The file below `root` that answers `target` (a request's path, escapes and query included), or nothing: no such
/// file, or one outside of `root`, by dots, escapes or links.
std::optional<std::filesystem::path> file_for(const std::filesystem::path& root, std::string_view target);

/// `target` without its query.
std::string_view path_of(std::string_view target);
/// The value of `name` in a target's query, unescaped; empty if it is not there.
std::string query_value(std::string_view target, std::string_view name);

std::string_view mime_type(const std::filesystem::path& file);

std::string lower(std::string_view text);
/// "localhost:8080" -> "localhost", "[::1]:80" -> "[::1]".
std::string_view host_name(std::string_view host);
/// Whether `host` is a name or an address, with a port or without: nothing that means another host to others, like
/// "localhost:80@evil.example".
bool is_host(std::string_view host);
/// `known` may begin with "*.", which stands for one label, as in certificates.
bool matches_name(std::string_view name, std::string_view known);
/// A page of another site may ask our server through the user's browser. Its Origin gives it away; where it has made
/// its own name point to this machine (DNS rebinding), its Host does. With TLS a page that came without it is another
/// site's; without, there may be a proxy that speaks it.
bool is_same_origin(std::string_view origin, std::string_view host, bool tls);
bool is_loopback_name(std::string_view host);
bool is_loopback_address(std::string_view address);

/// "Bearer TOKEN" -> "TOKEN".
std::string_view bearer_token(std::string_view authorization);
/// The value of a cookie in a Cookie header; empty if it is not there.
std::string_view cookie_value(std::string_view cookies, std::string_view name);
/// Takes as long whatever two of one length differ in.
bool equal_in_constant_time(std::string_view a, std::string_view b);
/// 128 random bits as text.
std::string make_token();

/// For a folder in which no page has been built.
std::string page_is_not_built(const std::filesystem::path& folder);

}  // namespace aurasim::overseer
