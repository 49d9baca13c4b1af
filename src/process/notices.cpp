#include "process/notices.h"

#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;

constexpr auto kLongWait = 2s;

/// Smaller clusters are no reason for a message, even if they are all that a node hosts.
constexpr std::size_t kLargeCluster = 1000;

std::string text_of(const MissingRegion& missing) {
  std::string text = fmt::format("{}", core::value_of(missing.region));
  if (missing.long_step) text += fmt::format(" ({})", *missing.long_step);
  if (missing.refused > 0) text += fmt::format(" ({} of its messages were refused)", missing.refused);
  return text;
}

}  // namespace

void Notices::note_fault(std::string text) {
  fault_ = std::move(text);
  spdlog::error("region {}: {}", core::value_of(region_), fault_);
}

void Notices::note_refusals(const std::vector<core::Refusal>& refusals) {
  for (; refusals_noted_ < refusals.size(); ++refusals_noted_) {
    const core::Refusal& refusal = refusals[refusals_noted_];
    const std::uint32_t source = core::value_of(refusal.source);
    fault_ = fmt::format("refused the {} of region {} for state {}: {}. Region {} is held for dead",
                         core::name_of(refusal.kind), source, refusal.stamp, refusal.why, source);
    spdlog::error("region {} {}", core::value_of(region_), fault_);
  }
}

void Notices::note_removals(std::span<const physics::Removal> removals) {
  for (const physics::Removal& removal : removals) {
    if (removal.fault.empty()) continue;
    ++broken_bodies_;
    note_fault(fmt::format("body {} was taken out in state {}: {}", core::value_of(removal.body), removal.step,
                           removal.fault));
  }
}

void Notices::note_cluster(std::size_t largest_cluster, std::size_t hosted, core::Step step,
                           const std::string& remedy) {
  if (says_large_cluster_ || largest_cluster < kLargeCluster || 2 * largest_cluster < hosted) return;
  says_large_cluster_ = true;
  news_ = fmt::format(
      "{} of the {} bodies here are one cluster in state {}: they touch each other or may do so soon, so one node has "
      "to host them. More nodes do not make this run faster. {}",
      largest_cluster, hosted, step, remedy);
  spdlog::warn("region {}: {}", core::value_of(region_), news_);
}

bool Notices::waits_for_long(Clock::time_point now) {
  if (!waiting_since_) waiting_since_ = now;
  return now - *waiting_since_ >= kLongWait;
}

void Notices::note_missing(core::Step next, std::span<const MissingRegion> missing, Clock::time_point now) {
  if (missing.empty() || !waiting_since_) return;
  std::vector<std::string> whom;
  for (const MissingRegion& one : missing) whom.push_back(text_of(one));
  const bool is_new = waiting_.empty();
  waiting_ = fmt::format("waits for regions [{}] before state {}, for {} s", fmt::join(whom, ", "), next,
                         std::chrono::duration_cast<std::chrono::seconds>(now - *waiting_since_).count());
  if (is_new) spdlog::warn("region {} {}", core::value_of(region_), waiting_);
}

void Notices::note_computed() {
  waiting_since_.reset();
  waiting_.clear();
}

void Notices::note_clock(const node::Instant& now, core::Step step) {
  const std::chrono::nanoseconds jump = clock_watch_.look(now);
  if (jump == 0ns) return;
  news_ =
      fmt::format("this host's wall clock was set {:.1f} s {} at step {}: the pace is kept without it",
                  std::chrono::duration<double>(std::chrono::abs(jump)).count(), jump > 0ns ? "forward" : "back", step);
  spdlog::warn("{}", news_);
}

void Notices::note_records(const std::optional<records::RecordsEnd>& end) {
  if (!end || std::exchange(says_records_end_, true)) return;
  news_ = fmt::format("nothing is recorded after step {}: {}", end->after, end->why);
  spdlog::error("{}", news_);
}

}  // namespace aurasim::process
