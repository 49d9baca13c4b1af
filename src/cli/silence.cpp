#include "cli/silence.h"

#include <spdlog/spdlog.h>

#include "cli/leave.h"

namespace aurasim::cli {

void fail_for_want_of_a_run(const FileArguments& files, const config::Launch& launch) {
  spdlog::error(
      "no node of {} was heard in DDS domain {}. Another domain is named by --set dds.domain=N, other hosts are "
      "reached by --set 'dds.interfaces=[ADDRESS]'",
      files.file, launch.dds.domain);
  leave(1);
}

}  // namespace aurasim::cli
