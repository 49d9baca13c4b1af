// What the nodes say of themselves, as a table for a terminal.
#pragma once

#include <map>
#include <string>

#include "dds/control.h"

namespace aurasim::cli {

/// One line per region and a line of sums.
std::string live_table(const std::map<core::RegionId, dds::SeenStatus>& statuses);

/// Prints `text` over what was printed last (if standard output is a terminal; otherwise below it).
class TerminalView {
 public:
  TerminalView();
  /// False when nobody sees it any more.
  bool show(const std::string& text);
  bool is_terminal() const { return is_terminal_; }

 private:
  bool is_terminal_;
  std::size_t lines_ = 0;
};

}  // namespace aurasim::cli
