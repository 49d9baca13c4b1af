// The manual page, made from the commands themselves.
#pragma once

#include <string>

#include "command_line/command_line.h"

namespace aurasim::command_line {

/// The manual page in the macros of `man`. `about`: sentences on what the program is, in addition to its one-line
/// description.
std::string manual_page(const CLI::App& program, const std::string& about);

/// The command `manual`, which prints the page.
void add_manual(CLI::App& program, Action& action, const std::string& about);

}  // namespace aurasim::command_line
