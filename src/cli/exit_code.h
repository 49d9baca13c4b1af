// How a process ended.
#pragma once

namespace aurasim::cli {

enum class ExitCode : int {
  kOk = 0,
  kFailed = 1,     ///< something broke, a node died or a body was lost
  kBadConfig = 2,  ///< the files or the command line are wrong
  kRefused = 3,    ///< another run is in the same domain, or a neighbour did not come in time
  kFenced = 4,     ///< the others hold this node for dead, or may (fence.h)
  kBroken = 5,     ///< physics broke down for a body, which was taken out; the rest went on
};

}  // namespace aurasim::cli
