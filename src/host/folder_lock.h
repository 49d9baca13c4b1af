// Lock of a folder that one process uses at a time. The kernel releases it when the process ends, however it ends.
#pragma once

#include <filesystem>
#include <memory>

namespace aurasim::host {

class FolderLock {
 public:
  /// Makes the folder if there is none, and holds it as long as this object and its process live. Throws
  /// std::runtime_error when another process holds it to write its report, or there can be no such folder.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// Waits until no other process holds the folder, and holds it. Null if there is no such folder, or if its file
  /// system has no locks.
  static std::unique_ptr<FolderLock> when_free(const std::filesystem::path& folder);
  /// As when_free(), without waiting. Null also if another process holds the folder.
  static std::unique_ptr<FolderLock> if_free(const std::filesystem::path& folder);

 private:
  explicit FolderLock(int folder) : folder_(folder) {}
  static std::unique_ptr<FolderLock> hold(const std::filesystem::path& folder, int how);

  int folder_ = -1;
};

}  // namespace aurasim::host
