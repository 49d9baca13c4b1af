// A folder that one process writes at a time.
#pragma once

#include <filesystem>

namespace aurasim::cli {

class FolderLock {
 public:
  /// Makes the folder if there is none, and holds it as long as this object and its process live. Throws
  /// std::runtime_error when another process holds it, or there can be no such folder.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int folder_ = -1;
};

}  // namespace aurasim::cli
