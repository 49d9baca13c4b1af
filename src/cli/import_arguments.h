// What `aurasim import` and `aurasim export` are told. The work is done by a program of its own, aurasim-import: the
// libraries that read other programs' files would make every node start later.
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
  FileArguments files;
  std::string out;
  bool strict = false;
};

/// Adds the command; what it is told goes to `given`, which outlives it.
CLI::App* add_import_words(CLI::App& program, ImportArguments& given);
CLI::App* add_export_words(CLI::App& program, ExportArguments& given);

}  // namespace aurasim::cli
