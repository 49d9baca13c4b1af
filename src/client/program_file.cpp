#include "client/program_file.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>

#include <aurasim/errors.h>
#include <dlfcn.h>
#include <unistd.h>

namespace aurasim::client {
namespace {

namespace fs = std::filesystem;

bool is_program(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error) && ::access(file.c_str(), X_OK) == 0;
}

/// Folder of this library; empty: not known.
fs::path folder_of_library() {
  static const char here = 0;
  Dl_info found{};
  if (::dladdr(&here, &found) == 0 || found.dli_fname == nullptr) return {};
  std::error_code error;
  return fs::canonical(found.dli_fname, error).parent_path();
}

std::string named(const std::string& file, const char* by) {
  if (!is_program(file)) throw NoProgram(file + ", named by " + by + ", is no program");
  return file;
}

}  // namespace

std::string program_file(const std::string& asked) {
  if (!asked.empty()) return named(asked, "`program`");
  const char* const of_environment = std::getenv("AURASIM_PROGRAM");
  if (of_environment != nullptr && *of_environment != '\0') return named(of_environment, "$AURASIM_PROGRAM");
  for (fs::path folder = folder_of_library(); folder.has_relative_path(); folder = folder.parent_path()) {
    for (const fs::path& file : {folder / "bin" / "aurasim", folder / "aurasim"}) {
      if (is_program(file)) return file.string();
    }
  }
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (!folder.empty() && is_program(fs::path(folder) / "aurasim")) return (fs::path(folder) / "aurasim").string();
  }
  throw NoProgram("the program `aurasim` is neither beside this library nor in $PATH; $AURASIM_PROGRAM names one");
}

}  // namespace aurasim::client
