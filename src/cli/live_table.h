// What the nodes say of themselves, as a table for a terminal.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <string>

#include "dds/control.h"

namespace aurasim::cli {

/// Where a table has to fit.
struct TerminalSize {
  std::size_t columns = 1000;
  std::size_t rows = 1000;
};

/// One line per region and a line of sums, each shorter than the terminal is wide: what matters least is left out.
/// When there are more regions than rows, the last line but one says how many are not shown.
/// `now`: to say who computes one step for long.
std::string live_table(const std::map<core::RegionId, dds::SeenStatus>& statuses, TerminalSize size = {},
                       std::chrono::steady_clock::time_point now = {});

/// Who listens to whom, a line for each region: since when and by whose introduction, where they are not near each
/// other.
std::string listening_lines(const std::map<core::RegionId, dds::SeenStatus>& statuses, TerminalSize size = {});

/// Prints `text` over what was printed last (if standard output is a terminal; otherwise below it).
class TerminalView {
 public:
  TerminalView();
  /// False when nobody sees it any more.
  bool show(const std::string& text);
  bool is_terminal() const { return is_terminal_; }
  /// Of now; a terminal may change. Boundless for a file or a pipe.
  TerminalSize size() const;

 private:
  bool is_terminal_;
  std::size_t lines_ = 0;
};

}  // namespace aurasim::cli
