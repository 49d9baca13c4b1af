#include "cli/live_table.h"

#include <algorithm>

#include <fmt/format.h>
#include <unistd.h>

#include "cli/terminal.h"

namespace aurasim::cli {

std::string live_table(const std::map<core::RegionId, dds::SeenStatus>& statuses) {
  std::string text =
      fmt::format("{:>6} {:>9} {:>8} {:>7} {:>7} {:>7} {:>8} {:>8} {:>9} {:>9} {:>9} {:>6}\n", "region", "state",
                  "step", "bodies", "awake", "auras", "sent", "received", "frame ms", "p99 ms", "broken", "rtf");
  std::uint64_t bodies = 0, sent = 0, received = 0, broken = 0;
  for (const auto& [region, seen] : statuses) {
    const dds::Status& s = seen.status;
    const dds::Violations& v = s.violations;
    const std::uint64_t violations = v.speed + v.latency + v.frame + v.promise + v.span;
    text += fmt::format("{:>6} {:>9} {:>8} {:>7} {:>7} {:>7} {:>8} {:>8} {:>9.2f} {:>9.2f} {:>9} {:>6.2f}\n",
                        core::value_of(region), seen.lost ? "lost" : dds::name_of(s.state), s.step, s.bodies, s.awake,
                        s.foreign_auras, s.hand_offs_out, s.hand_offs_in, s.frame.p50_ms, s.frame.p99_ms, violations,
                        s.real_time_factor);
    bodies += s.bodies;
    sent += s.hand_offs_out;
    received += s.hand_offs_in;
    broken += violations;
  }
  text += fmt::format("{:>6} {:>9} {:>8} {:>7} {:>7} {:>7} {:>8} {:>8} {:>9} {:>9} {:>9}\n", "all", "", "", bodies, "",
                      "", sent, received, "", "", broken);
  return text;
}

TerminalView::TerminalView() : is_terminal_(::isatty(STDOUT_FILENO) != 0) {}

bool TerminalView::show(const std::string& text) {
  const std::string over = is_terminal_ && lines_ > 0 ? fmt::format("\x1b[{}A\x1b[J", lines_) : "";
  lines_ = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  return print(over + text);
}

}  // namespace aurasim::cli
