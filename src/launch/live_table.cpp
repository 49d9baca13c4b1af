#include "launch/live_table.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "host/terminal.h"
#include "process/long_step.h"

namespace aurasim::launch {
namespace {

constexpr std::size_t kLinesBesides = 7;  // header, sums, the exchange, the viewer's line, the cursor

struct Column {
  std::string head;
  std::size_t width = 0;  ///< without the space before it
  int rank = 0;           ///< columns of the highest rank are left out first
  std::vector<std::string> cells;
};

struct Sums {
  std::uint64_t bodies = 0, sent = 0, received = 0, broken = 0;
};

std::vector<Column> empty_columns() {
  return {{"region", 6, 0, {}},   {"state", 8, 0, {}},  {"step", 8, 1, {}},   {"bodies", 7, 0, {}},
          {"awake", 7, 6, {}},    {"auras", 7, 5, {}},  {"sent", 7, 2, {}},   {"received", 8, 2, {}},
          {"frame ms", 8, 3, {}}, {"p99 ms", 8, 7, {}}, {"broken", 6, 1, {}}, {"rtf", 5, 0, {}},
          {"listens", 7, 8, {}}};
}

void add_row(std::vector<Column>& columns, const std::vector<std::string>& cells) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    columns[i].width = std::max(columns[i].width, cells[i].size());
    columns[i].cells.push_back(cells[i]);
  }
}

void add_region(std::vector<Column>& columns, const messages::SeenStatus& seen) {
  const messages::Status& s = seen.status;
  const auto text = [](const auto& value) { return fmt::to_string(value); };
  const auto decimals = [](double value) { return fmt::format("{:.2f}", value); };
  add_row(columns, {text(core::value_of(s.region)), seen.lost ? "lost" : messages::name_of(s.state), text(s.step),
                    text(s.bodies), text(s.awake), text(s.foreign_auras), text(s.hand_offs_out), text(s.hand_offs_in),
                    decimals(s.frame.p50_ms), decimals(s.frame.p99_ms), text(s.violations.total()),
                    decimals(s.real_time_factor), text(s.listens_to.size())});
}

std::size_t width_of(const std::vector<Column>& columns) {
  std::size_t width = 0;
  for (const Column& column : columns) width += column.width + 1;
  return width - 1;
}

/// Leaves out columns until the table fits. The last column of the terminal stays free, because some terminals wrap
/// there.
void leave_out_what_does_not_fit(std::vector<Column>& columns, std::size_t terminal) {
  while (columns.size() > 1 && width_of(columns) >= terminal) {
    columns.erase(std::max_element(columns.begin(), columns.end(),
                                   [](const Column& a, const Column& b) { return a.rank < b.rank; }));
  }
}

std::string line(const std::vector<Column>& columns, std::size_t row) {
  std::string text;
  for (const Column& column : columns) text += fmt::format(" {:>{}}", column.cells[row], column.width);
  return text.substr(1) + "\n";
}

std::string folded(const std::string& note, std::size_t terminal) {
  const std::size_t width = std::max<std::size_t>(terminal, 20) - 1;
  std::string lines;
  for (std::size_t begin = 0; begin < note.size(); begin += width) lines += note.substr(begin, width) + "\n";
  return lines;
}

/// How bodies of two regions touch in this run, and what one exchange takes; empty until that is known.
std::string exchange_line(const std::map<core::RegionId, messages::SeenStatus>& statuses, std::size_t terminal) {
  const messages::Status* slowest = nullptr;
  double round_trip_ms = 0;
  for (const auto& [region, seen] : statuses) {
    round_trip_ms = std::max(round_trip_ms, seen.status.round_trip_ms);
    if (seen.status.exchange == messages::ExchangeInUse::kNotChosen) continue;
    if (slowest == nullptr || seen.status.exchange_times.p99_ms > slowest->exchange_times.p99_ms) {
      slowest = &seen.status;
    }
  }
  if (slowest == nullptr || statuses.size() < 2) return {};
  std::string line = fmt::format("exchange: {}", messages::name_of(slowest->exchange));
  if (round_trip_ms > 0) line += fmt::format(", chosen for round trips of {:.3g} ms", round_trip_ms);
  if (slowest->exchange_times.max_ms > 0) {
    line += fmt::format(", one takes {:.3g} ms (99% at most {:.3g} ms, region {})", slowest->exchange_times.p50_ms,
                        slowest->exchange_times.p99_ms, core::value_of(slowest->region));
  }
  return folded(line, terminal);
}

/// Notices and faults from the nodes' statuses.
std::string notes(const std::map<core::RegionId, messages::SeenStatus>& statuses, std::size_t terminal,
                  std::chrono::steady_clock::time_point now) {
  std::string lines;
  for (const auto& [region, seen] : statuses) {
    std::string whose;
    for (const auto& [source, count] : seen.status.refused) {
      whose +=
          fmt::format("{} {} of {}", whose.empty() ? "" : ",", count,
                      source == messages::kNoRegion ? "no node" : fmt::format("region {}", core::value_of(source)));
    }
    if (!whose.empty()) {
      lines += folded(fmt::format("region {} has refused messages:{}", core::value_of(region), whose), terminal);
    }
    if (const auto step = process::long_step(seen, now)) {
      lines += folded(fmt::format("region {} {}", core::value_of(region), *step), terminal);
    }
    if (seen.status.text.empty()) continue;
    lines += folded(fmt::format("region {}: {}", core::value_of(region), seen.status.text), terminal);
  }
  return lines;
}

}  // namespace

std::string live_table(const std::map<core::RegionId, messages::SeenStatus>& statuses, TerminalSize size,
                       std::chrono::steady_clock::time_point now) {
  std::vector<Column> columns = empty_columns();
  for (Column& column : columns) column.cells.push_back(column.head);
  const std::size_t room = size.rows > kLinesBesides + 1 ? size.rows - kLinesBesides : 1;
  const std::size_t shown = statuses.size() <= room ? statuses.size() : room - 1;
  Sums sums;
  std::size_t row = 0;
  for (const auto& [region, seen] : statuses) {
    if (row++ < shown) add_region(columns, seen);
    sums.bodies += seen.status.bodies;
    sums.sent += seen.status.hand_offs_out;
    sums.received += seen.status.hand_offs_in;
    sums.broken += seen.status.violations.total();
  }
  const auto text = [](std::uint64_t value) { return fmt::to_string(value); };
  add_row(columns, {"all", "", "", text(sums.bodies), "", "", text(sums.sent), text(sums.received), "", "",
                    text(sums.broken), "", ""});
  leave_out_what_does_not_fit(columns, size.columns);
  std::string table;
  for (std::size_t i = 0; i <= shown; ++i) table += line(columns, i);
  if (shown < statuses.size()) table += fmt::format("{:>6} {} more\n", "...", statuses.size() - shown);
  return table + line(columns, shown + 1) + exchange_line(statuses, size.columns) + notes(statuses, size.columns, now);
}

std::string listening_lines(const std::map<core::RegionId, messages::SeenStatus>& statuses, TerminalSize size) {
  std::string lines;
  for (const auto& [region, seen] : statuses) {
    std::string who;
    for (const core::Listened& other : seen.status.listens_to) {
      who += fmt::format("{} {}", who.empty() ? "" : ",", core::value_of(other.region));
      if (other.introduced_by) {
        who += fmt::format(" (since state {}, by {})", other.since, core::value_of(*other.introduced_by));
      }
    }
    if (!who.empty()) lines += folded(fmt::format("region {} listens to{}", core::value_of(region), who), size.columns);
  }
  return lines;
}

TerminalView::TerminalView() : is_terminal_(::isatty(STDOUT_FILENO) != 0) {}

TerminalSize TerminalView::size() const {
  ::winsize found{};
  if (!is_terminal_ || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &found) != 0 || found.ws_col == 0) return {};
  return {found.ws_col, found.ws_row};
}

bool TerminalView::show(const std::string& text) {
  const std::string over = is_terminal_ && lines_ > 0 ? fmt::format("\x1b[{}A\x1b[J", lines_) : "";
  lines_ = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  return host::print(over + text);
}

}  // namespace aurasim::launch
