// Checks the files that an SDF file includes, because sdformat follows circles without end.
#pragma once

#include <filesystem>
#include <vector>

namespace aurasim::importing {

/// Throws BadModel if a file includes itself, directly or through others, or if it goes too deep.
void check_sdf_includes(const std::filesystem::path& file, const std::vector<std::filesystem::path>& paths);

/// Returns the file that an <include>'s uri names: the file itself, or `model.sdf` in the named folder. Empty if there
/// is none.
std::filesystem::path included_file(const std::string& uri, const std::filesystem::path& folder,
                                    const std::vector<std::filesystem::path>& paths);

}  // namespace aurasim::importing
