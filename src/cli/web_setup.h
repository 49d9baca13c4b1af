// From launch file and command line to a web server.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "config/launch.h"
#include "overseer/web_server.h"

namespace aurasim::cli {

/// As on the command line; what is not given is as in the launch file.
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

/// Draws the tokens that are needed and were not given. Throws as check_tls_of; so for what the command line names.
overseer::WebSettings web_settings(const config::Launch& launch, const WebArguments& arguments);

/// Prints the address, and the tokens that were not given: who starts it may keep its output, and knows those. Takes
/// another port when the wanted one is taken, and says so.
std::unique_ptr<overseer::WebServer> open_web_server(overseer::WebSettings settings, const WebArguments& given,
                                                     overseer::ShapeStore& shapes);

/// Throws std::runtime_error when the file cannot be written.
void check_recording(const std::filesystem::path& file);

}  // namespace aurasim::cli
