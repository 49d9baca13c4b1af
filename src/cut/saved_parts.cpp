#include "cut/saved_parts.h"

#include <algorithm>
#include <filesystem>

#include "cut/cut_file.h"

namespace aurasim::cut {

PutTogether put_together(const std::vector<std::string>& parts, const std::string& name) {
  const std::vector<std::filesystem::path> files(parts.begin(), parts.end());
  if (files.empty()) return {};
  const std::filesystem::path folder = files.front().parent_path();
  const auto is_beside = [&folder](const std::filesystem::path& part) {
    return part.parent_path() == folder && std::filesystem::exists(part);
  };
  if (!std::ranges::all_of(files, is_beside)) return {};
  const std::filesystem::path file = folder / name;
  write_cut(file, merge_cuts(files));
  for (const std::filesystem::path& part : files) {
    if (!std::filesystem::equivalent(part, file)) std::filesystem::remove(part);
  }
  return {file.string(), std::filesystem::file_size(file)};
}

}  // namespace aurasim::cut
