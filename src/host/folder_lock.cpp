#include "host/folder_lock.h"

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

namespace aurasim::host {
namespace {

int open_folder(const std::filesystem::path& folder, int flags) {
  return ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | flags);
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  folder_ = open_folder(folder, 0);
  if (folder_ < 0) throw std::runtime_error(fmt::format("cannot use {}: {}", folder.string(), std::strerror(errno)));
  if (::flock(folder_, LOCK_EX | LOCK_NB) == 0) return;
  const bool is_taken = errno == EWOULDBLOCK;
  ::close(folder_);
  if (is_taken) throw std::runtime_error(fmt::format("another run is writing its report to {}", folder.string()));
  folder_ = -1;  // a file system without locks
}

FolderLock::~FolderLock() {
  if (folder_ >= 0) ::close(folder_);
}

std::unique_ptr<FolderLock> FolderLock::when_free(const std::filesystem::path& folder) { return hold(folder, 0); }

std::unique_ptr<FolderLock> FolderLock::if_free(const std::filesystem::path& folder) { return hold(folder, LOCK_NB); }

std::unique_ptr<FolderLock> FolderLock::hold(const std::filesystem::path& folder, int how) {
  const int opened = open_folder(folder, O_NOFOLLOW);
  if (opened < 0) return nullptr;
  std::unique_ptr<FolderLock> lock(new FolderLock(opened));
  while (::flock(opened, LOCK_EX | how) != 0) {
    if (errno != EINTR) return nullptr;
  }
  return lock;
}

}  // namespace aurasim::host
