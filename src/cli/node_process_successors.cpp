// Who has died, who is there in its place, and how a node leaves: what the recovery of a run begins with
// (node_process_recovery.cpp).
#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cli/node_process.h"
#include "cli/run_steering.h"

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPatienceWithSpare = 5s;
constexpr auto kLaunchersFirst = 5s;
constexpr auto kPatienceOfSuccessor = 30s;

}  // namespace

bool NodeProcess::recovers() const {
  return launch_.survival.on_death == config::OnDeath::kRecover && launch_.regions.size() > 1 && !goes_on_;
}

/// Before `generation_`, or the one that a recovery is about to begin, can go on: has one more of its nodes died, or is
/// somebody else recovering from that?
std::optional<std::string> NodeProcess::death() {
  if (!recovers()) return std::nullopt;
  const core::Generation current = std::max(generation_, restoring_);
  if (restore_ && restore_->generation > current) return "all go back to an earlier state";
  const bool is_running = restoring_ <= generation_ && node_;
  std::vector<core::RegionId> silent;
  if (is_running) silent = node_->protocol().intake().dead_regions();
  for (const auto& [region, seen] : control_.statuses()) {
    if (region == options_.region || !is_meant(region, seen.status)) continue;
    const dds::NodeState state = seen.status.state;
    const std::uint32_t number = core::value_of(region);
    if (!seen.has_ended() && std::ranges::find(silent, region) != silent.end()) {
      return fmt::format("region {} is silent, or has said what cannot be", number);
    }
    if (seen.lost && !seen.has_ended()) return fmt::format("the node of region {} has died", number);
    if (!seen.lost && state == dds::NodeState::kFailed)
      return fmt::format("the node of region {} has given up", number);
    // Whoever was there has left: its successor waits. (After a recovery, others are heard late to have begun.)
    const bool is_member = restore_ && restore_->members.at(number).process == seen.status.process;
    if (!is_going_back_ && !seen.lost && state == dds::NodeState::kSpare && !is_member) {
      return fmt::format("the node of region {} has left", number);
    }
    const bool stands = state == dds::NodeState::kRecovering || state == dds::NodeState::kSpare;
    if (!seen.lost && stands && seen.status.generation >= current) {
      return fmt::format("region {} says that a node has died", number);
    }
  }
  return std::nullopt;
}

/// In a recovery, others may still hear of the process that has died before they hear of the one in its place.
bool NodeProcess::is_meant(core::RegionId region, const dds::Status& status) const {
  if (!is_going_back_) return true;
  return restore_->members.at(core::value_of(region)).process == status.process;
}

/// While all wait for each other. Throws SomebodyDied.
void NodeProcess::look_for_deaths() {
  if (const auto why = death()) throw SomebodyDied(*why);
}

bool NodeProcess::has_successor() {
  return std::ranges::any_of(control_.strangers(), [this](const dds::SeenStatus& stranger) {
    const dds::Status& other = stranger.status;
    return other.region == options_.region && other.state == dds::NodeState::kSpare &&
           other.agreement == status_.agreement && other.run == options_.run;
  });
}

/// The others compute without us: nobody waits for this process any more.
bool NodeProcess::is_not_needed() {
  const auto& statuses = control_.statuses();
  const bool computes = std::ranges::any_of(statuses, [](const auto& entry) {
    return entry.second.is_live() && entry.second.status.state == dds::NodeState::kRunning;
  });
  const bool waits = std::ranges::any_of(statuses, [](const auto& entry) {
    return entry.second.is_live() && entry.second.status.state == dds::NodeState::kRecovering;
  });
  if (!computes || waits) idle_since_ = Clock::now();
  return Clock::now() > idle_since_ + kPatienceOfSuccessor;
}

/// Regions that nobody is there for.
std::vector<std::uint32_t> NodeProcess::vacant_regions() {
  std::vector<std::uint32_t> vacant;
  const auto& statuses = control_.statuses();
  for (std::uint32_t r = 0; r < launch_.regions.size(); ++r) {
    const auto seen = statuses.find(core::RegionId{r});
    if (core::RegionId{r} != options_.region && (seen == statuses.end() || !seen->second.is_live()))
      vacant.push_back(r);
  }
  return vacant;
}

/// The lowest region that stands tells spares which of the vacant regions they take over. A launcher starts its own
/// nodes again, and is faster.
void NodeProcess::call_spares(const std::vector<std::uint32_t>& vacant) {
  std::erase_if(called_, [&](const auto& call) {
    return std::ranges::find(vacant, call.first) == vacant.end() || Clock::now() > call.second + kPatienceWithSpare;
  });
  for (const auto& [region, seen] : control_.statuses()) {
    if (region < options_.region && !seen.lost && seen.status.state == dds::NodeState::kRecovering) return;
  }
  if (options_.run != 0 && Clock::now() < recovering_since_ + kLaunchersFirst) return;
  for (const std::uint32_t region : vacant) {
    if (!called_.contains(region)) call_spare(core::RegionId{region});
  }
}

void NodeProcess::call_spare(core::RegionId region) {
  const std::vector<dds::Status> spares = control_.spares();
  const auto free =
      std::ranges::find_if(spares, [this](const dds::Status& spare) { return !taken_.contains(spare.process); });
  if (free == spares.end()) return;
  control_.send(about_process(dds::RunCommandKind::kTake, options_.run, region, free->process));
  taken_.insert(free->process);
  called_[core::value_of(region)] = Clock::now();
}

/// Somebody wants a node to leave. Its launcher starts a successor; where nodes were started by hand, the lowest region
/// calls a spare.
void NodeProcess::hear_of_drain(const dds::RunCommand& drain) {
  if (!recovers()) return;
  const auto& statuses = control_.statuses();
  const auto meant = statuses.find(drain.region);
  const bool is_self = drain.region == options_.region && drain.process == status_.process;
  drains_ = drains_ || is_self;
  const bool leads = std::ranges::none_of(
      statuses, [this](const auto& entry) { return entry.first < options_.region && entry.second.is_live(); });
  const bool is_there = is_self || (meant != statuses.end() && meant->second.status.process == drain.process);
  if (options_.run == 0 && leads && is_there) call_spare(drain.region);
}

/// There is another process for our region, and a state since then that everybody keeps: nobody has to go back far.
bool NodeProcess::may_leave() {
  if (!has_successor()) return false;
  if (!successor_since_) successor_since_ = node_->current_step();
  const std::vector<dds::KeptPart> ours = checkpoints_->parts();
  return std::ranges::any_of(ours, [&](const dds::KeptPart& part) {
    if (part.region != options_.region || part.step < *successor_since_) return false;
    return std::ranges::all_of(control_.statuses(), [&](const auto& entry) {
      const dds::KeptPart theirs{entry.first, part.step};
      const bool is_keeper = entry.first == keeper();
      const auto& kept = entry.second.status.parts;
      return entry.first == options_.region || (std::ranges::find(kept, theirs) != kept.end() &&
                                                (!is_keeper || std::ranges::find(kept, part) != kept.end()));
    });
  });
}

/// As if it had died, in a moment that costs the others least.
ExitCode NodeProcess::leave_to_successor() {
  spdlog::info("region {} leaves after state {}: another process takes over", core::value_of(options_.region),
               node_->current_step());
  control_.send(about_process(dds::RunCommandKind::kLost, options_.run, options_.region, status_.process));
  return ExitCode::kOk;
}

}  // namespace aurasim::cli
