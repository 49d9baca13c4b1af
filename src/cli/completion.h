// Completion of the command line in shells, made from the commands themselves.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace aurasim::cli {

/// A script that bash or zsh reads.
std::string bash_completion(const CLI::App& program);
std::string zsh_completion(const CLI::App& program);

}  // namespace aurasim::cli
