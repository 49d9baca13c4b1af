#include "client/last_words.h"

#include <algorithm>

#include <sys/stat.h>
#include <unistd.h>

namespace aurasim::client {

std::string last_words(int file, off_t longest_B) {
  struct ::stat about {};
  if (::fstat(file, &about) != 0 || !S_ISREG(about.st_mode)) return {};
  std::string words(static_cast<std::size_t>(std::min(about.st_size, longest_B)), '\0');
  const ssize_t got = ::pread(file, words.data(), words.size(), about.st_size - static_cast<off_t>(words.size()));
  words.resize(static_cast<std::size_t>(std::max<ssize_t>(0, got)));
  while (!words.empty() && words.back() == '\n') words.pop_back();
  return words;
}

}  // namespace aurasim::client
