// Arguments of `aurasim import` and `aurasim export`. A separate program, aurasim-import, does the work, because the
// libraries that read other programs' files would slow down the start of every node.
#pragma once

#include <string>
#include <vector>

#include "cli/commands.h"

namespace aurasim::cli {

struct ImportArguments {
  std::string file;
  std::string out;
  std::vector<std::string> names;  ///< --as
  std::vector<std::string> poses;  ///< --at
  std::vector<std::string> paths;
  double mass_kg = 0;  ///< 0: not given
  bool strict = false;
};

struct ExportArguments {
  command_line::FileArguments files;
  std::string out;
  bool strict = false;
};

/// Adds the command. Its arguments go to `given`, which must outlive the command.
CLI::App* add_import_words(CLI::App& program, ImportArguments& given);
CLI::App* add_export_words(CLI::App& program, ExportArguments& given);

}  // namespace aurasim::cli
