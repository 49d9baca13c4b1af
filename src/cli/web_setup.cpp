#include "cli/web_setup.h"

#include <algorithm>
#include <cstdio>
#include <system_error>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "overseer/http_rules.h"

namespace aurasim::cli {
namespace {

/// Beside the program, in the source tree around the build folder, or in that which it was built from.
std::filesystem::path usual_pages() {
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const std::filesystem::path built = std::filesystem::path("src") / "overseer" / "web" / "dist";
  const std::filesystem::path of_source = std::filesystem::path(AURASIM_SOURCE_DIR) / built;
  for (const std::filesystem::path& pages : {folder / "web", folder.parent_path().parent_path() / built, of_source}) {
    std::error_code error;
    if (std::filesystem::is_regular_file(pages / "index.html", error)) return pages;
  }
  return of_source;
}

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
  settings.pages = arguments.pages.empty() ? usual_pages() : std::filesystem::path(arguments.pages);
  settings.scenes = scenes_beside(launch.scene_file);
  return settings;
}

std::unique_ptr<overseer::WebServer> open_web_server(overseer::WebSettings settings, overseer::ShapeStore& shapes) {
  std::unique_ptr<overseer::WebServer> server;
  try {
    server = std::make_unique<overseer::WebServer>(settings, shapes);
  } catch (const overseer::CannotListen& error) {
    if (!error.port_is_taken()) throw;
    spdlog::warn("{}; taking another port", error.what());
    settings.port = 0;
    server = std::make_unique<overseer::WebServer>(settings, shapes);
  }
  fmt::print("{}\n", address_of(settings, server->port()));
  if (!settings.token.empty()) fmt::print("token: {}\n", settings.token);
  std::fflush(stdout);
  return server;
}

}  // namespace aurasim::cli
