// The nodes' statuses as a table for a terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <string>

#include "dds/control.h"

namespace aurasim::launch {

/// Size that a table has to fit into, in characters.
struct TerminalSize {
  std::size_t columns = 1000;
  std::size_t rows = 1000;
};

/// One line per region and a line of sums, each shorter than the terminal is wide. The least important columns are left
/// out. When there are more regions than rows, the last line but one says how many are not shown. `now`: used to mark
/// nodes that compute one step for long.
std::string live_table(const std::map<core::RegionId, messages::SeenStatus>& statuses, TerminalSize size = {},
                       std::chrono::steady_clock::time_point now = {});

/// One line per region with the regions that it receives from. For regions that are not near each other it also shows
/// since when, and by whose introduction.
std::string listening_lines(const std::map<core::RegionId, messages::SeenStatus>& statuses, TerminalSize size = {});

/// Prints text over the text printed last, if standard output is a terminal; otherwise below it.
class TerminalView {
 public:
  TerminalView();
  /// Prints `text`. False when standard output is closed.
  bool show(const std::string& text);
  bool is_terminal() const { return is_terminal_; }
  /// Present size of the terminal, which may change. Unlimited for a file or a pipe.
  TerminalSize size() const;

 private:
  bool is_terminal_;
  std::size_t lines_ = 0;
};

}  // namespace aurasim::launch
