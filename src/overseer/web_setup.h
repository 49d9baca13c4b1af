// Makes a web server from the launch file and the command line.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "config/launch.h"
#include "overseer/web_server.h"

namespace aurasim::overseer {

/// Options of the command line. Options not given are taken from the launch file.
struct WebArguments {
  int port = -1;
  std::string bind;
  std::string token;
  std::string view_token;
  bool anyone_may_look = false;
  std::vector<std::string> names;
  std::string tls_certificate, tls_key;  ///< both or none
  std::string pages;

  void add_to(CLI::App& command);
};

/// Throws BadConfig when certificate and key, if there are any, cannot be used.
void check_tls_of(const config::Launch& launch);

/// Settings of the web server. Draws the needed tokens that were not given. Throws as check_tls_of() does, also for
/// files that the command line names.
WebSettings web_settings(const config::Launch& launch, const WebArguments& arguments);

/// Opens the server. Prints the address, and the tokens that were drawn; given tokens are not printed, because the
/// output may be stored. If the wanted port is taken, it uses another one and says so.
std::unique_ptr<WebServer> open_web_server(WebSettings settings, const WebArguments& given, ShapeStore& shapes);

/// Checks the recording's file. Throws std::runtime_error when it cannot be written.
void check_recording(const std::filesystem::path& file);

}  // namespace aurasim::overseer
