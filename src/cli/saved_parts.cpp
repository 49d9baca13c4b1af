#include "cli/saved_parts.h"

#include <algorithm>
#include <filesystem>

#include "cut/cut_file.h"

namespace aurasim::cli {

PutTogether put_together(const std::vector<std::string>& parts, const std::string& file) {
  const std::vector<std::filesystem::path> files(parts.begin(), parts.end());
  if (!std::ranges::all_of(files, [](const auto& part) { return std::filesystem::exists(part); })) return {};
  cut::write_cut(file, cut::merge_cuts(files));
  for (const std::filesystem::path& part : files) {
    if (!std::filesystem::equivalent(part, file)) std::filesystem::remove(part);
  }
  return {true, std::filesystem::file_size(file)};
}

}  // namespace aurasim::cli
