#include "cli/web_setup.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "config/shipped_files.h"
#include "overseer/http_rules.h"

namespace aurasim::cli {
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

std::string address_of(const overseer::WebSettings& settings, std::uint16_t port) {
  const bool everywhere = settings.bind == "0.0.0.0" || settings.bind == "::";
  const bool v6 = settings.bind.find(':') != std::string::npos;
  const std::string host = everywhere ? "127.0.0.1" : v6 ? "[" + settings.bind + "]" : settings.bind;
  return fmt::format("http://{}:{}/", host, port);
}

}  // namespace

void WebArguments::add_to(CLI::App& command) {
  command.add_option("--port", port, "port of the viewer; 0: any that is free (overseer.port)")
      ->check(CLI::Range(0, 65535));
  command.add_option("--bind", bind, "address that the viewer listens on (overseer.bind)");
  command.add_option("--token", token,
                     "what a page must know to change the world; drawn and printed when the viewer "
                     "listens on more than loopback");
  command.add_option("--web", pages, "folder of the built page")->check(CLI::ExistingDirectory);
}

overseer::WebSettings web_settings(const config::Launch& launch, const WebArguments& arguments) {
  overseer::WebSettings settings;
  settings.bind = arguments.bind.empty() ? launch.overseer.bind : arguments.bind;
  settings.port = static_cast<std::uint16_t>(arguments.port < 0 ? launch.overseer.port : arguments.port);
  settings.token = arguments.token;
  if (settings.token.empty() && !overseer::is_loopback_address(settings.bind)) settings.token = overseer::make_token();
  settings.pages = arguments.pages.empty() ? config::shipped_page() : std::filesystem::path(arguments.pages);
  settings.scenes = scenes_beside(launch.scene_file);
  return settings;
}

std::unique_ptr<overseer::WebServer> open_web_server(overseer::WebSettings settings, overseer::ShapeStore& shapes) {
  std::unique_ptr<overseer::WebServer> server;
  std::string remark;  // beside the address, since launch shows that below its table for as long as it runs
  try {
    server = std::make_unique<overseer::WebServer>(settings, shapes);
  } catch (const overseer::CannotListen& error) {
    if (!error.port_is_taken()) throw;
    remark = fmt::format(" (port {} is taken)", settings.port);
    settings.port = 0;
    server = std::make_unique<overseer::WebServer>(settings, shapes);
  }
  std::error_code missing;
  if (!std::filesystem::is_regular_file(settings.pages / "index.html", missing)) {
    remark += " has no page: scripts/build_web.sh says why";
  }
  fmt::print("{}{}\n", address_of(settings, server->port()), remark);
  if (!settings.token.empty()) fmt::print("token: {}\n", settings.token);
  std::fflush(stdout);
  return server;
}

void check_recording(const std::filesystem::path& file) {
  errno = 0;
  if (!std::ofstream(file, std::ios::binary | std::ios::app)) {
    throw std::runtime_error(fmt::format("--record {}: cannot be written: {}", file.string(), std::strerror(errno)));
  }
}

}  // namespace aurasim::cli
