// Who has died, who is there in its place, and how a node leaves: what the recovery of a run begins with
// (node_process_recovery.cpp).
#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "cli/node_process.h"
#include "cli/other_role.h"
#include "cli/run_steering.h"
#include "cli/spawn.h"
#include "cli/stop_signal.h"

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPatienceWithSpare = 5s;
constexpr auto kLaunchersFirst = 5s;
constexpr auto kPatienceOfSuccessor = 30s;
constexpr auto kPatienceWithSuccessor = 20s;
constexpr int kMostStandIns = 3;  // for one region in a row, at one place

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
  // Else it is the one from before the death: whom it has missed is no news.
  const bool is_running = restoring_ <= generation_ && node_ && life_of_node_ == life_;
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
    const bool stands =
        state == dds::NodeState::kRecovering || state == dds::NodeState::kSpare || state == dds::NodeState::kCutOff;
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

/// The run is over, or the others compute without us: nobody waits for this process any more.
bool NodeProcess::is_not_needed() {
  const auto& statuses = control_.statuses();
  const auto has_finished = [](const auto& entry) { return entry.second.status.state == dds::NodeState::kFinished; };
  if (std::ranges::any_of(statuses, has_finished) && vacant_regions().size() + 1 == launch_.regions.size()) return true;
  const bool computes = std::ranges::any_of(statuses, [](const auto& entry) {
    return entry.second.is_live() && entry.second.status.state == dds::NodeState::kRunning;
  });
  const bool waits = std::ranges::any_of(statuses, [](const auto& entry) {
    return entry.second.is_live() && entry.second.status.state == dds::NodeState::kRecovering;
  });
  if (!computes || waits) idle_since_ = Clock::now();
  return Clock::now() > idle_since_ + kPatienceOfSuccessor;
}

/// Whoever is there for another region, if anybody is, has come to take over, too.
bool NodeProcess::nobody_knows_the_world() {
  const bool somebody_does = std::ranges::any_of(control_.statuses(), [this](const auto& entry) {
    const dds::SeenStatus& seen = entry.second;
    const bool is_there = !seen.lost && !seen.has_ended();  // it may be cut off
    return entry.first != options_.region && is_there && seen.status.state != dds::NodeState::kSpare;
  });
  if (somebody_does) alone_since_ = Clock::now();
  return Clock::now() > alone_since_ + kPatienceOfSuccessor;
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
  if (options_.has_launcher && Clock::now() < recovering_since_ + kLaunchersFirst) return;
  for (const std::uint32_t region : vacant) {
    if (!called_.contains(region)) call_spare(core::RegionId{region});
  }
}

bool NodeProcess::call_spare(core::RegionId region) {
  const std::vector<dds::Status> spares = control_.spares();
  const auto free =
      std::ranges::find_if(spares, [this](const dds::Status& spare) { return !taken_.contains(spare.process); });
  if (free == spares.end()) return false;
  control_.send(about_process(dds::RunCommandKind::kTake, options_.run, region, free->process));
  taken_.insert(free->process);
  called_[core::value_of(region)] = Clock::now();
  return true;
}

/// Of those that stay.
bool NodeProcess::is_next_after(core::RegionId region) {
  const auto regions = static_cast<std::uint32_t>(launch_.regions.size());
  const auto& statuses = control_.statuses();
  for (std::uint32_t i = 1; i < regions; ++i) {
    const core::RegionId next{(core::value_of(region) + i) % regions};
    if (next == options_.region) return !leaving_.contains(status_.process);
    const auto other = statuses.find(next);
    if (other != statuses.end() && other->second.is_live() && !leaving_.contains(other->second.status.process)) {
      return false;
    }
  }
  return false;
}

/// Nobody has come for these regions: the host of the next region each does the work of two. A launcher has its own
/// reasons not to start a process again. False: that has been tried often enough.
bool NodeProcess::stand_in(const std::vector<std::uint32_t>& vacant) {
  if (options_.has_launcher) return false;
  for (const std::uint32_t region : vacant) {
    StandIn& tried = stood_in_[region];
    const core::Step step = node_->current_step();
    const bool at_the_same_place = std::abs(step - tried.at) <= launch_.checkpoint_steps();
    tried = {at_the_same_place ? tried.times + 1 : 1, step};
    if (tried.times > kMostStandIns) return false;
    if (!is_next_after(core::RegionId{region})) continue;
    spdlog::warn("nobody has taken region {} over: this host does, beside region {}", region,
                 core::value_of(options_.region));
    spawn_apart(words_of_successor(own_words(), core::RegionId{region}, options_.run));
  }
  return true;
}

/// Somebody wants a node to leave. Its launcher starts a successor; where nodes were started by hand, the lowest region
/// calls a spare, and where there is none the host of the next region starts one.
void NodeProcess::hear_of_drain(const dds::RunCommand& drain) {
  if (!recovers()) return;
  const auto& statuses = control_.statuses();
  const auto meant = statuses.find(drain.region);
  const bool is_self = drain.region == options_.region && drain.process == status_.process;
  const bool is_there = is_self || (meant != statuses.end() && meant->second.status.process == drain.process);
  if (!is_there || !leaving_.insert(drain.process).second) return;
  drains_ = drains_ || is_self;
  if (options_.has_launcher) return;
  const bool leads = std::ranges::none_of(
      statuses, [this](const auto& entry) { return entry.first < options_.region && entry.second.is_live(); });
  if (!control_.spares().empty()) {
    if (leads) call_spare(drain.region);
  } else if (!is_self && is_next_after(drain.region)) {
    spdlog::info("the node of region {} is to leave: this host takes it over, beside region {}",
                 core::value_of(drain.region), core::value_of(options_.region));
    spawn_apart(words_of_successor(own_words(), drain.region, options_.run));
  }
}

/// Somebody stays who can go on with what we have.
bool NodeProcess::can_leave_to_others() {
  if (!recovers()) return false;
  return std::ranges::any_of(control_.statuses(), [this](const auto& entry) {
    return entry.first != options_.region && entry.second.is_live() && !leaving_.contains(entry.second.status.process);
  });
}

/// SIGTERM: its host goes down, the run does not.
void NodeProcess::leave_if_asked() {
  if (!asked_to_leave() || leaves_by_) return;
  leaves_by_ = Clock::now() + kPatienceWithSuccessor;
  dds::RunCommand drain = about_process(dds::RunCommandKind::kDrain, options_.run, options_.region, status_.process);
  control_.send(drain);
  hear_of_drain(drain);
}

/// There is another process for our region, and a state since then that everybody keeps: nobody has to go back far.
bool NodeProcess::may_leave() {
  if (!has_successor()) return false;
  if (!successor_since_) successor_since_ = node_->current_step();
  const std::vector<dds::KeptPart> ours = checkpoints_->parts();
  const core::RegionId keeper = this->keeper();
  const auto& statuses = control_.statuses();
  const bool stands = phase_ == NodePhase::kPaused;  // then there will be no newer state
  return std::ranges::any_of(ours, [&](const dds::KeptPart& part) {
    if (part.region != options_.region || (part.step < *successor_since_ && !stands)) return false;
    return std::ranges::all_of(statuses, [&](const auto& entry) {
      const dds::KeptPart theirs{entry.first, part.step};
      const bool is_keeper = entry.first == keeper;
      const auto& kept = entry.second.status.parts;
      return entry.first == options_.region || (std::ranges::find(kept, theirs) != kept.end() &&
                                                (!is_keeper || std::ranges::find(kept, part) != kept.end()));
    });
  });
}

/// As if it had died, in a moment that costs the others least.
ExitCode NodeProcess::leave_to_successor() {
  spdlog::info("region {} leaves after state {}: {}", core::value_of(options_.region), node_->current_step(),
               has_successor() ? "another process takes over" : "nobody has come to take over yet");
  control_.send(about_process(dds::RunCommandKind::kLost, options_.run, options_.region, status_.process));
  return ExitCode::kOk;
}

}  // namespace aurasim::cli
