// The commands of the program aurasim-import.
#pragma once

#include <memory>

#include "cli/import_arguments.h"

namespace aurasim::cli {

/// The exit code. Throws config::BadConfig for wrong input.
int run_import(const ImportArguments& given);
int run_export(const ExportArguments& given);

/// `import` and `export` as aurasim has them; parsing sets `action`, which outlives it.
std::unique_ptr<CLI::App> make_import_program(Action& action);

}  // namespace aurasim::cli
