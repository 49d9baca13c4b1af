// The commands of the program aurasim-import.
#pragma once

#include <memory>

#include "cli/import_arguments.h"

namespace aurasim::cli {

/// Run the commands and return the exit code. They throw config::BadConfig for wrong input.
int run_import(const ImportArguments& given);
int run_export(const ExportArguments& given);

/// The commands `import` and `export`, as aurasim has them. Parsing sets `action`, which must outlive the result.
std::unique_ptr<CLI::App> make_import_program(command_line::Action& action);

}  // namespace aurasim::cli
