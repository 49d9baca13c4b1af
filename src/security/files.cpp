#include "security/files.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "security/bad_keys.h"

namespace aurasim::security {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const char* doing) {
  throw BadKeys(fmt::format("{}: cannot {}: {}", file.string(), doing, std::strerror(errno)));
}

void write_all(int out, std::string_view text, const std::filesystem::path& file) {
  while (!text.empty()) {
    const ssize_t written = ::write(out, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(file, "write it");
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

std::string read_key_file(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in) fail(file, "read it");
  return text;
}

void write_key_file(const std::filesystem::path& file, std::string_view text, Secrecy secrecy) {
  const std::filesystem::path fresh = file.string() + ".new";
  ::unlink(fresh.c_str());
  const int out =
      ::open(fresh.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, secrecy == Secrecy::kPrivate ? 0600 : 0644);
  if (out < 0) fail(fresh, "create it");
  try {
    write_all(out, text, fresh);
    if (::fsync(out) != 0) fail(fresh, "write it");
  } catch (...) {
    ::close(out);
    ::unlink(fresh.c_str());
    throw;
  }
  ::close(out);
  if (::rename(fresh.c_str(), file.c_str()) != 0) fail(file, "replace it");
}

void make_key_folder(const std::filesystem::path& folder) {
  if (::mkdir(folder.c_str(), 0700) != 0) fail(folder, "create it");
}

void check_is_private(const std::filesystem::path& file) {
  struct stat status = {};
  if (::stat(file.c_str(), &status) != 0) fail(file, "read it");
  if ((status.st_mode & 077) == 0) return;
  throw BadKeys(
      fmt::format("{}: found mode {:04o}, allowed: 0600, or others on this host could read the key (chmod 600)",
                  file.string(), status.st_mode & 07777U));
}

}  // namespace aurasim::security
