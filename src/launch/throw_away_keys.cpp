#include "launch/throw_away_keys.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "setup/key_choice.h"

namespace aurasim::launch {
namespace {

constexpr const char* kPrefix = "aurasim-keys-";

/// For its owner only, like what mkdtemp makes.
std::filesystem::path new_folder() {
  std::string name = (std::filesystem::temp_directory_path() / kPrefix).string() + "XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error(fmt::format("{}: cannot create it: {}", name, std::strerror(errno)));
  }
  return name;
}

/// A folder of this user, and no link to one.
bool is_own_folder(const std::filesystem::path& path) {
  struct stat found = {};
  return ::lstat(path.c_str(), &found) == 0 && S_ISDIR(found.st_mode) && found.st_uid == ::geteuid();
}

}  // namespace

/// Keys are made once the lock is held: a folder with keys that nobody has locked is of a process that is gone.
ThrowAwayKeys::ThrowAwayKeys(std::size_t regions) : parent_(new_folder()), lock_(host::FolderLock::when_free(parent_)) {
  try {
    setup::make_keys_for_one_host(folder(), regions);
  } catch (...) {
    std::error_code error;
    std::filesystem::remove_all(parent_, error);
    throw;
  }
}

ThrowAwayKeys::~ThrowAwayKeys() {
  std::error_code error;
  std::filesystem::remove_all(parent_, error);
}

std::vector<std::filesystem::path> remove_keys_of_the_gone() {
  std::vector<std::filesystem::path> removed;
  std::error_code error;
  const std::filesystem::path all = std::filesystem::temp_directory_path(error);
  if (error) return removed;
  for (std::filesystem::directory_iterator at(all, error), end; !error && at != end; at.increment(error)) {
    const std::filesystem::path& folder = at->path();
    if (!folder.filename().string().starts_with(kPrefix) || !is_own_folder(folder)) continue;
    const auto lock = host::FolderLock::if_free(folder);
    std::error_code failed;
    if (lock == nullptr || std::filesystem::is_empty(folder, failed) || failed) continue;  // it is being made
    std::filesystem::remove_all(folder, failed);
    if (!failed) removed.push_back(folder);
  }
  return removed;
}

}  // namespace aurasim::launch
