// From launch file and command line to a web server.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "config/launch.h"
#include "overseer/web_server.h"

namespace aurasim::cli {

/// As on the command line; what is not given is as in the launch file.
struct WebArguments {
  int port = -1;
  std::string bind;
  std::string token;
  std::string pages;

  void add_to(CLI::App& command);
};

overseer::WebSettings web_settings(const config::Launch& launch, const WebArguments& arguments);

/// Prints the address, and the token if there is one. Takes another port when the wanted one is taken, and says so.
std::unique_ptr<overseer::WebServer> open_web_server(overseer::WebSettings settings, overseer::ShapeStore& shapes);

/// Throws std::runtime_error when the file cannot be written.
void check_recording(const std::filesystem::path& file);

}  // namespace aurasim::cli
