#include "host/version.h"

#include <fmt/format.h>

#include "host/commit.h"

namespace aurasim::host {

std::string commit() { return AURASIM_COMMIT; }

std::string version_and_commit() { return fmt::format("aurasim {} ({})", AURASIM_VERSION, commit()); }

std::string version_text() {
  return fmt::format("aurasim {} (commit {}, {}, GCC {})", AURASIM_VERSION, commit(), AURASIM_BUILD_TYPE, __VERSION__);
}

}  // namespace aurasim::host
