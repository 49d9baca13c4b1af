// One function per command. Each adds its command to the program's command line. The command's action returns the exit
// code.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "command_line/command_line.h"

namespace aurasim::cli {

void add_agent(CLI::App& program, command_line::Action& action);
void add_check(CLI::App& program, command_line::Action& action);
void add_schema(CLI::App& program, command_line::Action& action);
void add_export(CLI::App& program, command_line::Action& action);
void add_import(CLI::App& program, command_line::Action& action);
void add_keys(CLI::App& program, command_line::Action& action);
void add_hub(CLI::App& program, command_line::Action& action);
void add_node(CLI::App& program, command_line::Action& action);
void add_spare(CLI::App& program, command_line::Action& action);
void add_launch(CLI::App& program, command_line::Action& action);
void add_top(CLI::App& program, command_line::Action& action);
void add_echo(CLI::App& program, command_line::Action& action);
void add_cut(CLI::App& program, command_line::Action& action);
void add_overseer(CLI::App& program, command_line::Action& action);
void add_replay(CLI::App& program, command_line::Action& action);
void add_report(CLI::App& program, command_line::Action& action);
void add_compare(CLI::App& program, command_line::Action& action);
void add_send(CLI::App& program, command_line::Action& action);
void add_mesh_loader(CLI::App& program, command_line::Action& action);

}  // namespace aurasim::cli
