#include "host/terminal.h"

#include <cstdio>

namespace aurasim::host {

bool print(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  return std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
}

}  // namespace aurasim::host
