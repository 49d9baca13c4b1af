#include "overseer/web_setup.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "config/shipped_files.h"
#include "config/yaml_tree.h"
#include "overseer/http_rules.h"
#include "overseer/tls_files.h"

namespace aurasim::overseer {
namespace {

std::vector<std::string> scenes_beside(const std::filesystem::path& scene_file) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(scene_file.parent_path(), error)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string address_of(const WebSettings& settings, std::uint16_t port) {
  const bool everywhere = settings.bind == "0.0.0.0" || settings.bind == "::";
  const bool v6 = settings.bind.find(':') != std::string::npos;
  const std::string host = everywhere ? "127.0.0.1" : v6 ? "[" + settings.bind + "]" : settings.bind;
  return fmt::format("{}://{}:{}/", settings.tls ? "https" : "http", host, port);
}

/// The host's own name, and its names in its network.
std::vector<std::string> own_names() {
  std::array<char, HOST_NAME_MAX + 1> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0 || name[0] == '\0') return {};
  return {name.data(), std::string(name.data()) + ".local"};
}

/// "FILE:LINE:COLUMN" of a value of overseer.tls. Only the file if the value is not in it.
std::string place_in(const std::filesystem::path& file, const std::string& key) {
  config::Errors ignored;
  const std::optional<config::YamlNode> root = config::read_yaml(file, ignored);
  const config::YamlNode* node = root ? &*root : nullptr;
  for (const std::string_view step : {std::string_view("overseer"), std::string_view("tls"), std::string_view(key)}) {
    if (node != nullptr) node = node->find(step);
  }
  if (node == nullptr) return file.string();
  return fmt::format("{}:{}:{}", file.string(), node->place.line, node->place.column);
}

}  // namespace

void WebArguments::add_to(CLI::App& command) {
  command.add_option("--port", port, "port of the viewer; 0: any that is free (overseer.port)")
      ->check(CLI::Range(0, 65535));
  command.add_option("--bind", bind, "address that the viewer listens on (overseer.bind)");
  command
      .add_option("--token", token,
                  "what a page must know to change the world; drawn and printed when the viewer listens on more than "
                  "loopback")
      ->envname("AURASIM_TOKEN");
  command
      .add_option("--view-token", view_token, "what a page must know to look at the world; drawn and printed likewise")
      ->envname("AURASIM_VIEW_TOKEN");
  command.add_flag("--anyone-may-look", anyone_may_look, "no token is needed to look at the world");
  command
      .add_option("--name", names,
                  "name that the viewer is asked for by, beside its addresses, this host's name and those of its "
                  "certificate")
      ->allow_extra_args(false);
  CLI::Option* const certificate = command.add_option("--tls-certificate", tls_certificate,
                                                      "PEM file; with it the viewer speaks HTTPS (overseer.tls)");
  CLI::Option* const key = command.add_option("--tls-key", tls_key, "PEM file with the certificate's key");
  certificate->needs(key);
  key->needs(certificate);
  command.add_option("--web", pages, "folder of the built page")->check(CLI::ExistingDirectory);
}

void check_tls_of(const config::Launch& launch) {
  if (!launch.overseer.tls) return;
  try {
    check_tls(*launch.overseer.tls);
  } catch (const BadTls& error) {
    throw config::BadConfig(
        {fmt::format("{}: overseer.tls.{}: {}", place_in(launch.file, error.key()), error.key(), error.what())});
  }
}

namespace {

std::optional<config::Tls> tls_of(const config::Launch& launch, const WebArguments& arguments) {
  if (arguments.tls_certificate.empty()) {
    check_tls_of(launch);
    return launch.overseer.tls;
  }
  const config::Tls tls{arguments.tls_certificate, arguments.tls_key};
  try {
    check_tls(tls);
  } catch (const BadTls& error) {
    throw config::BadConfig({fmt::format("--tls-{}: {}", error.key(), error.what())});
  }
  return tls;
}

}  // namespace

WebSettings web_settings(const config::Launch& launch, const WebArguments& arguments) {
  WebSettings settings;
  settings.bind = arguments.bind.empty() ? launch.overseer.bind : arguments.bind;
  settings.port = static_cast<std::uint16_t>(arguments.port < 0 ? launch.overseer.port : arguments.port);
  settings.tls = tls_of(launch, arguments);
  const bool is_reached_by_others = !is_loopback_address(settings.bind);
  if (is_reached_by_others) settings.names = own_names();
  settings.names.insert(settings.names.end(), arguments.names.begin(), arguments.names.end());
  settings.view_token = arguments.anyone_may_look ? "" : arguments.view_token;
  if (settings.view_token.empty() && is_reached_by_others && !arguments.anyone_may_look)
    settings.view_token = make_token();
  settings.token = arguments.token;
  if (settings.token.empty() && (is_reached_by_others || !settings.view_token.empty())) settings.token = make_token();
  settings.pages = arguments.pages.empty() ? config::shipped_page() : std::filesystem::path(arguments.pages);
  settings.scenes = scenes_beside(launch.scene_file);
  return settings;
}

std::unique_ptr<WebServer> open_web_server(WebSettings settings, const WebArguments& given, ShapeStore& shapes) {
  std::unique_ptr<WebServer> server;
  std::string remark;  // printed with the address, because launch shows that line below its table all the time
  try {
    server = std::make_unique<WebServer>(settings, shapes);
  } catch (const CannotListen& error) {
    if (!error.port_is_taken()) throw;
    remark = fmt::format(" (port {} is taken)", settings.port);
    settings.port = 0;
    server = std::make_unique<WebServer>(settings, shapes);
  }
  std::error_code missing;
  if (!std::filesystem::is_regular_file(settings.pages / "index.html", missing)) {
    remark += " has no page: scripts/build_web.sh says why";
  }
  const std::string address = address_of(settings, server->port());
  fmt::print("{}{}\n", address, remark);
  if (!settings.view_token.empty() && given.view_token.empty())
    fmt::print("to look:    {}#token={}\n", address, settings.view_token);
  if (!settings.token.empty() && given.token.empty()) fmt::print("to operate: {}#token={}\n", address, settings.token);
  std::fflush(stdout);
  return server;
}

void check_recording(const std::filesystem::path& file) {
  errno = 0;
  if (!std::ofstream(file, std::ios::binary | std::ios::app)) {
    throw std::runtime_error(fmt::format("--record {}: cannot be written: {}", file.string(), std::strerror(errno)));
  }
}

}  // namespace aurasim::overseer
