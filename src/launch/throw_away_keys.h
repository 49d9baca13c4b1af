#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "host/folder_lock.h"

namespace aurasim::launch {

/// Keys for one run on this host, in a folder that only this user may read. The destructor removes them. The folder is
/// locked as long as the process lives, so that folders of killed processes can be recognised.
class ThrowAwayKeys {
 public:
  explicit ThrowAwayKeys(std::size_t regions);
  ~ThrowAwayKeys();
  ThrowAwayKeys(const ThrowAwayKeys&) = delete;
  ThrowAwayKeys& operator=(const ThrowAwayKeys&) = delete;

  std::filesystem::path folder() const { return parent_ / "keys"; }

 private:
  std::filesystem::path parent_;
  std::unique_ptr<host::FolderLock> lock_;
};

/// Removes, from the folder for temporary files, the keys that this user's ended processes have left. Returns the
/// removed folders.
std::vector<std::filesystem::path> remove_keys_of_the_gone();

}  // namespace aurasim::launch
