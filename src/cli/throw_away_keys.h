#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "cli/folder_lock.h"

namespace aurasim::cli {

/// Keys for one run on this host, in a folder that nobody else may read, until this ends. It is locked as long as its
/// process lives: what is left of a process that was killed is known by that.
class ThrowAwayKeys {
 public:
  explicit ThrowAwayKeys(std::size_t regions);
  ~ThrowAwayKeys();
  ThrowAwayKeys(const ThrowAwayKeys&) = delete;
  ThrowAwayKeys& operator=(const ThrowAwayKeys&) = delete;

  std::filesystem::path folder() const { return parent_ / "keys"; }

 private:
  std::filesystem::path parent_;
  std::unique_ptr<FolderLock> lock_;
};

/// Removes the keys of this user's processes that have ended without doing so, from the folder for temporary files.
/// Returns the folders that are gone now.
std::vector<std::filesystem::path> remove_keys_of_the_gone();

}  // namespace aurasim::cli
