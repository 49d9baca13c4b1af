// Finds the files that a model names. They must lie in the model's folder or in folders that the caller gives.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace aurasim::importing {

/// Returns the file that `uri` names, or the reason why there is none. `uri`: model://NAME/REST, package://NAME/REST,
/// file://PATH or a path relative to `folder`. Symbolic links are followed before the place of the file is checked.
std::variant<std::filesystem::path, std::string> find_named_file(const std::string& uri,
                                                                 const std::filesystem::path& folder,
                                                                 const std::vector<std::filesystem::path>& paths);

/// True when `file` lies in `folder` or below it.
bool is_within(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace aurasim::importing
