#include "cli/folder_lock.h"

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

namespace aurasim::cli {

FolderLock::FolderLock(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  folder_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
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

}  // namespace aurasim::cli
