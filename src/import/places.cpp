#include "import/places.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

namespace aurasim::importing {
namespace {

namespace fs = std::filesystem;

/// Removes `scheme` from the begin of `uri`. Returns whether it was there.
bool take_scheme(std::string& uri, std::string_view scheme) {
  if (!uri.starts_with(scheme)) return false;
  uri.erase(0, scheme.size());
  return true;
}

/// Places where the file of model://NAME/REST may be: NAME is a folder of `root`, or `root` itself.
std::vector<fs::path> candidates_in(const fs::path& root, const std::string& name_and_rest) {
  std::vector<fs::path> found = {root / name_and_rest};
  const std::size_t slash = name_and_rest.find('/');
  if (slash != std::string::npos && fs::weakly_canonical(root).filename() == name_and_rest.substr(0, slash)) {
    found.push_back(root / name_and_rest.substr(slash + 1));
  }
  return found;
}

}  // namespace

bool is_within(const fs::path& file, const fs::path& folder) {
  const fs::path real_file = fs::weakly_canonical(file), real_folder = fs::weakly_canonical(folder);
  return std::mismatch(real_folder.begin(), real_folder.end(), real_file.begin(), real_file.end()).first ==
         real_folder.end();
}

std::variant<fs::path, std::string> find_named_file(const std::string& uri, const fs::path& folder,
                                                    const std::vector<fs::path>& paths) {
  std::vector<fs::path> roots = {folder.empty() ? fs::path(".") : folder};
  roots.insert(roots.end(), paths.begin(), paths.end());
  std::string rest = uri;
  std::vector<fs::path> candidates;
  if (take_scheme(rest, "model://") || take_scheme(rest, "package://")) {
    for (const fs::path& root : roots) {
      for (fs::path& path : candidates_in(root, rest)) candidates.push_back(std::move(path));
    }
  } else {
    take_scheme(rest, "file://");
    if (rest.find("://") != std::string::npos)
      return fmt::format("'{}' is not on this machine; allowed: model://, package://, file:// or a path", uri);
    for (const fs::path& root : roots) candidates.push_back(root / rest);
  }
  std::error_code error;
  for (const fs::path& path : candidates) {
    if (!fs::is_regular_file(path, error)) continue;
    for (const fs::path& root : roots) {
      if (is_within(path, root)) return fs::weakly_canonical(path);
    }
    return fmt::format("'{}' lies outside of the model's folder; --path FOLDER allows another one", uri);
  }
  return fmt::format("no file '{}' in the model's folder; --path FOLDER adds another one", uri);
}

}  // namespace aurasim::importing
