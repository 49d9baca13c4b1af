// How a process ended.
#pragma once

namespace aurasim::command_line {

enum class ExitCode : int {
  kOk = 0,
  kFailed = 1,     ///< something broke, a node died or a body was lost
  kBadConfig = 2,  ///< the files or the command line are wrong
  kRefused = 3,    ///< another run is in the same domain, or a neighbour did not come in time
  kFenced = 4,     ///< another process has taken this node's region over (fence.h)
  kBroken = 5,     ///< physics broke down for a body, which was taken out; the rest went on
  kNotSaved = 6,   ///< the run has come to its end, but none of the worlds that it was to save (--save-every) is whole
  kBrokenOff = 7,  ///< another region's node has died, and the run ends: nobody takes it over, or on_death is stop
};

/// True if a node's exit code means that it died: the run has neither ended nor been refused before it began.
inline bool is_death(int code) {
  switch (static_cast<ExitCode>(code)) {
    case ExitCode::kOk:
    case ExitCode::kBadConfig:
    case ExitCode::kRefused:
    case ExitCode::kBroken:
    case ExitCode::kNotSaved:
    case ExitCode::kBrokenOff:
      return false;
    case ExitCode::kFailed:
    case ExitCode::kFenced:
      return true;
  }
  return true;  // by a signal
}

}  // namespace aurasim::command_line
