#include "config/shipped_files.h"

#include <algorithm>
#include <system_error>

namespace aurasim::config {
namespace {

std::filesystem::path folder_of_program() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
}

bool is_shipped(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::is_regular_file(folder / "qos" / "aurasim.xml", error);
}

}  // namespace

std::filesystem::path shipped_folder() {
  const std::filesystem::path program = folder_of_program();
  const std::filesystem::path installed = program.parent_path() / "share" / "aurasim";
  for (const std::filesystem::path& folder : {installed, program.parent_path().parent_path()}) {
    if (is_shipped(folder)) return folder;
  }
  const std::filesystem::path of_source = AURASIM_SOURCE_DIR;
  return is_shipped(of_source) ? of_source : installed;
}

std::filesystem::path shipped_profiles() { return shipped_folder() / "qos" / "aurasim.xml"; }

std::filesystem::path shipped_page() {
  const std::filesystem::path folder = shipped_folder();
  std::error_code error;
  const std::filesystem::path of_source = folder / "src" / "overseer" / "web";
  return std::filesystem::is_directory(of_source, error) ? of_source / "dist" : folder / "web";
}

std::string launch_file_named(const std::string& name) {
  std::error_code error;
  if (name.empty() || name.find('/') != std::string::npos || std::filesystem::exists(name, error)) return name;
  const std::filesystem::path file = shipped_folder() / "launch_configs" / (name + ".yaml");
  return std::filesystem::is_regular_file(file, error) ? file.string() : name;
}

std::vector<std::string> shipped_launch_names() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(shipped_folder() / "launch_configs", error)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace aurasim::config
