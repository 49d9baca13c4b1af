// Options that several commands have in common.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "command_line/command_line.h"
#include "cut/saved_world.h"

namespace aurasim::setup {

/// Options of a node, and of a spare that becomes one, for processes with a launcher. A launcher finds a successor when
/// the process dies.
struct LauncherArguments {
  bool is_there = false;
  int heartbeat = -1;  ///< heartbeat.h

  void add_to(CLI::App& command);
};

/// Option for the key with which a process joins a run with keys.
struct KeyArguments {
  std::string as;  ///< name of the key; empty: the first key of the right role

  void add_to(CLI::App& command);
};

/// Adds --load and --other-build. Returns the option --load.
CLI::Option* add_to(CLI::App& command, cut::LoadArguments& arguments);
/// Adds --saves, --save-every and --save-keep.
void add_to(CLI::App& command, cut::SaveArguments& arguments);

}  // namespace aurasim::setup
