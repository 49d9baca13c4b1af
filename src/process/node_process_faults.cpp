// Messages of a running node about faults. A node never waits, or loses a body, without a message.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "process/long_step.h"
#include "process/node_process.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kLongWait = 2s;

}  // namespace

/// Logs messages of neighbours that were refused. Such a neighbour is marked dead, because the content of its message
/// is lost for good.
void NodeProcess::note_refusals() {
  status_.refused = transport_->refused();
  const std::vector<core::Refusal>& refusals = node_->protocol().intake().refusals();
  for (; refusals_noted_ < refusals.size(); ++refusals_noted_) {
    const core::Refusal& refusal = refusals[refusals_noted_];
    const std::uint32_t source = core::value_of(refusal.source);
    fault_ = fmt::format("refused the {} of region {} for state {}: {}. Region {} is held for dead",
                         core::name_of(refusal.kind), source, refusal.stamp, refusal.why, source);
    spdlog::error("region {} {}", core::value_of(options_.region), fault_);
  }
}

/// Logs refused messages of non-neighbours. They mark no node dead; each kind is logged once and counted.
void NodeProcess::note_strangers() {
  for (const std::string& text : participant_->take_said()) {
    spdlog::warn("region {}: {}", core::value_of(options_.region), text);
  }
  std::erase_if(status_.refused, [](const auto& refused) { return refused.first == messages::kNoRegion; });
  const std::uint64_t refused = participant_->refused_of_strangers();
  if (refused > 0) status_.refused.emplace_back(messages::kNoRegion, refused);
}

void NodeProcess::note_waiting() {
  if (!waiting_since_) waiting_since_ = Clock::now();
  const auto waited = Clock::now() - *waiting_since_;
  const core::Step next = node_->current_step() + 1;
  const std::vector<core::RegionId> missing = node_->protocol().missing(next);
  if (waited < kLongWait || missing.empty()) return;
  std::vector<std::string> whom;
  for (const core::RegionId region : missing) {
    std::string text = fmt::format("{}", core::value_of(region));
    const auto other = control_.statuses().find(region);
    if (other != control_.statuses().end()) {
      if (const auto step = long_step(other->second, Clock::now())) text += fmt::format(" ({})", *step);
    }
    for (const auto& [source, count] : status_.refused) {
      if (source == region) text += fmt::format(" ({} of its messages were refused)", count);
    }
    whom.push_back(std::move(text));
  }
  const bool is_news = waiting_.empty();
  waiting_ = fmt::format("waits for regions [{}] before state {}, for {} s", fmt::join(whom, ", "), next,
                         std::chrono::duration_cast<std::chrono::seconds>(waited).count());
  if (is_news) spdlog::warn("region {} {}", core::value_of(options_.region), waiting_);
}

/// True if some node computes one step for long (long_step.h). It is not dead, so a wait for all nodes goes on.
bool NodeProcess::somebody_computes_for_long() {
  const auto now = Clock::now();
  return std::ranges::any_of(control_.statuses(), [&](const auto& entry) {
    return entry.first != options_.region && long_step(entry.second, now).has_value();
  });
}

/// Logs bodies that were removed because they exceeded the limits (core/limits.h).
void NodeProcess::note_faults(const node::StepReport& report) {
  for (const physics::Removal& removal : report.removals) {
    if (removal.fault.empty()) continue;
    ++broken_bodies_;
    fault_ =
        fmt::format("body {} was taken out in state {}: {}", core::value_of(removal.body), removal.step, removal.fault);
    spdlog::error("region {}: {}", core::value_of(options_.region), fault_);
  }
}

/// Time until `step` is due. In slow motion, states before a pause, a reset or the end are due as in real time.
std::chrono::nanoseconds NodeProcess::time_until(core::Step step) const {
  const std::chrono::nanoseconds until = pacer_.until(step, node::read_clocks());
  if (step > hurry_until_) return until;
  const auto in_real_time = computed_at_ + std::chrono::duration<double>(launch_.step_s()) - Clock::now();
  return std::min(until, std::max(0ns, std::chrono::duration_cast<std::chrono::nanoseconds>(in_real_time)));
}

}  // namespace aurasim::process
