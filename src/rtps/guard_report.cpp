#include "rtps/guard_report.h"

#include <numeric>
#include <tuple>

#include <fmt/format.h>

#include "rtps/datagram_findings.h"

namespace aurasim::rtps {

static_assert(std::tuple_size_v<GuardReport::Counts> == kRefusalCount);

std::uint64_t total_of(const GuardReport::Counts& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

std::uint64_t GuardReport::total() const { return total_of(refused); }

std::string text_of(const GuardReport::Counts& counts) {
  std::string text;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", counts[i], name_of(static_cast<Refusal>(i)));
  }
  return text;
}

std::string text_of_address(std::uint32_t address) {
  return fmt::format("{}.{}.{}.{}", address >> 24, address >> 16 & 255, address >> 8 & 255, address & 255);
}

}  // namespace aurasim::rtps
