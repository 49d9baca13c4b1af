// Where files that a model names may lie: in the model's folder or in those that the caller gives, nowhere else.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace aurasim::importing {

/// The file that `uri` names: model://NAME/REST, package://NAME/REST, file://PATH or a path relative to `folder`.
/// Or why there is none. Symbolic links are followed before it is asked where the file lies.
std::variant<std::filesystem::path, std::string> find_named_file(const std::string& uri,
                                                                 const std::filesystem::path& folder,
                                                                 const std::vector<std::filesystem::path>& paths);

/// Whether `file` lies in `folder` or below it.
bool is_within(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace aurasim::importing
