#include "overseer/http_rules.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/rand.h>

namespace aurasim::overseer {
namespace {

/// Decodes escapes. Nothing: an escape is invalid.
std::optional<std::string> unescape(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      plain += text[i];
      continue;
    }
    unsigned value = 0;
    if (i + 2 >= text.size()) return std::nullopt;
    const auto [end, error] = std::from_chars(text.data() + i + 1, text.data() + i + 3, value, 16);
    if (error != std::errc{} || end != text.data() + i + 3) return std::nullopt;
    plain += static_cast<char>(value);
    i += 2;
  }
  return plain;
}

bool is_safe(std::string_view path) {
  if (path.empty() || path.front() != '/') return false;
  return std::none_of(path.begin(), path.end(), [](unsigned char c) { return c < 0x20 || c == '\\' || c == 0x7f; });
}

}  // namespace

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

std::string_view path_of(std::string_view target) { return target.substr(0, target.find_first_of("?#")); }

std::string query_value(std::string_view target, std::string_view name) {
  const std::size_t question = target.find('?');
  if (question == std::string_view::npos) return {};
  std::string_view query = target.substr(question + 1);
  while (!query.empty()) {
    const std::string_view pair = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(query.size(), pair.size() + 1));
    const std::size_t equals = pair.find('=');
    if (equals != std::string_view::npos && pair.substr(0, equals) == name)
      return unescape(pair.substr(equals + 1)).value_or("");
  }
  return {};
}

std::optional<std::filesystem::path> file_for(const std::filesystem::path& root, std::string_view target) {
  const std::optional<std::string> path = unescape(path_of(target));
  if (!path || !is_safe(*path)) return std::nullopt;
  std::filesystem::path relative = std::filesystem::path(*path).relative_path();
  for (const std::filesystem::path& part : relative) {
    if (part == ".." || (part.native().size() > 1 && part.native().front() == '.')) return std::nullopt;
  }
  if (relative.empty() || path->back() == '/') relative /= "index.html";
  std::error_code error;
  const std::filesystem::path inside = std::filesystem::canonical(root, error);
  if (error) return std::nullopt;
  const std::filesystem::path file = std::filesystem::canonical(inside / relative, error);  // follows links
  if (error || !std::filesystem::is_regular_file(file, error)) return std::nullopt;
  const auto [end, ignored] = std::mismatch(inside.begin(), inside.end(), file.begin(), file.end());
  if (end != inside.end()) return std::nullopt;
  return file;
}

std::string_view mime_type(const std::filesystem::path& file) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 16> kTypes = {{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".mjs", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", "application/json"},
      {".map", "application/json"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".jpg", "image/jpeg"},
      {".ico", "image/x-icon"},
      {".woff2", "font/woff2"},
      {".wasm", "application/wasm"},
      {".txt", "text/plain; charset=utf-8"},
      {".glb", "model/gltf-binary"},
      {".gltf", "model/gltf+json"},
      {".stl", "model/stl"},
  }};
  const std::string extension = lower(file.extension().native());
  const auto* found = std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& t) { return t.first == extension; });
  return found == kTypes.end() ? "application/octet-stream" : found->second;
}

std::string_view host_name(std::string_view host) {
  if (!host.empty() && host.front() == '[') {
    const std::size_t end = host.find(']');
    return end == std::string_view::npos ? host : host.substr(0, end + 1);
  }
  return host.substr(0, host.find(':'));
}

bool is_host(std::string_view host) {
  const std::string_view name = host_name(host);
  const std::string_view rest = host.substr(name.size());
  constexpr std::string_view kOfNames = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._";
  constexpr std::string_view kOfAddresses = "0123456789abcdefABCDEF:.", kDigits = "0123456789";
  const auto consists_of = [](std::string_view text, std::string_view allowed) {
    return text.find_first_not_of(allowed) == std::string_view::npos;
  };
  const bool is_v6 = name.size() > 2 && name.front() == '[' && name.back() == ']' &&
                     consists_of(name.substr(1, name.size() - 2), kOfAddresses);
  const bool is_name = !name.empty() && consists_of(name, kOfNames);
  return (is_v6 || is_name) && (rest.empty() || (rest.front() == ':' && consists_of(rest.substr(1), kDigits)));
}

bool matches_name(std::string_view name, std::string_view known) {
  if (!known.starts_with("*.")) return name == lower(known);
  const std::size_t dot = name.find('.');
  return dot != std::string_view::npos && dot > 0 && name.substr(dot) == lower(known.substr(1));
}

bool is_same_origin(std::string_view origin, std::string_view host, bool tls) {
  if (host.empty()) return false;
  const std::string wanted = lower(host), found = lower(origin);
  return found == "https://" + wanted || (!tls && found == "http://" + wanted);
}

bool is_loopback_name(std::string_view host) {
  const std::string name = lower(host_name(host));
  return name == "localhost" || name == "[::1]" || is_loopback_address(name);
}

bool is_loopback_address(std::string_view address) {
  if (address == "::1" || address == "localhost") return true;
  return address.starts_with("127.") &&
         std::all_of(address.begin(), address.end(), [](unsigned char c) { return std::isdigit(c) != 0 || c == '.'; });
}

std::string_view bearer_token(std::string_view authorization) {
  constexpr std::string_view kBearer = "Bearer ";
  return authorization.starts_with(kBearer) ? authorization.substr(kBearer.size()) : std::string_view{};
}

std::string_view cookie_value(std::string_view cookies, std::string_view name) {
  while (!cookies.empty()) {
    std::string_view pair = cookies.substr(0, cookies.find(';'));
    cookies.remove_prefix(std::min(cookies.size(), pair.size() + 1));
    pair.remove_prefix(std::min(pair.size(), pair.find_first_not_of(' ')));
    if (pair.starts_with(name) && pair.substr(name.size()).starts_with('=')) return pair.substr(name.size() + 1);
  }
  return {};
}

bool equal_in_constant_time(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

std::string make_token() {
  std::array<unsigned char, 16> bits{};
  if (RAND_bytes(bits.data(), static_cast<int>(bits.size())) != 1) throw std::runtime_error("no random numbers");
  std::string token;
  for (const unsigned char byte : bits) token += fmt::format("{:02x}", byte);
  return token;
}

std::string page_is_not_built(const std::filesystem::path& folder) {
  return fmt::format(
      "<!doctype html><meta charset=\"utf-8\"><title>aurasim</title>\n"
      "<h1>The page has not been built</h1>\n"
      "<p>The overseer runs, but there is no page in <code>{}</code>. Build it with <code>scripts/build_web.sh</code> "
      "and reload, or name another folder with <code>--web</code>. <a href=\"/metrics\">Metrics</a> are here all the "
      "same.</p>\n",
      folder.string());
}

}  // namespace aurasim::overseer
