// How a node notices deaths and successors, and how it leaves. A recovery begins with these
// (node_process_recovery.cpp).
#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "host/other_role.h"
#include "host/spawn.h"
#include "host/stop_signal.h"
#include "process/node_process.h"
#include "steering/run_steering.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPatienceWithSuccessor = 20s;

}  // namespace

/// Why this node must not compute its next state (why_stand).
std::optional<std::string> NodeProcess::death() {
  if (launch_.regions.size() == 1) return std::nullopt;
  OwnWorld own;
  own.region = options_.region;
  own.current = std::max(generation_, restoring_);
  // Otherwise node_ is from before the death, and its silent neighbours are known already.
  const bool is_running = restoring_ <= generation_ && node_ && life_of_node_ == life_;
  if (is_running) own.silent = node_->protocol().intake().dead_regions();
  if (restore_) own.restore = &*restore_;
  own.is_going_back = is_going_back_;
  return why_stand(control().statuses(), own);
}

/// To be called while all wait for each other. Throws SomebodyDied if a node has died.
void NodeProcess::look_for_deaths() {
  if (const auto why = death()) throw SomebodyDied(*why);
}

bool NodeProcess::has_successor() {
  return std::ranges::any_of(control().strangers(), [this](const messages::SeenStatus& stranger) {
    const messages::Status& other = stranger.status;
    return other.region == options_.region && other.state == messages::NodeState::kSpare &&
           other.agreement == status_.content().agreement && other.run == options_.run;
  });
}

bool NodeProcess::call_spare(core::RegionId region) {
  const std::vector<messages::Status> spares = control().spares();
  const auto free =
      std::ranges::find_if(spares, [this](const messages::Status& spare) { return !taken_.contains(spare.process); });
  if (free == spares.end()) return false;
  control().send(steering::about_process(messages::RunCommandKind::kTake, options_.run, region, free->process));
  taken_.insert(free->process);
  recovery_.note_called(region, Clock::now());
  return true;
}

/// Starts a second process on this host for each of these regions, because no process has come for them.
void NodeProcess::stand_in(const std::vector<core::RegionId>& regions) {
  for (const core::RegionId region : regions) {
    spdlog::warn("nobody has taken region {} over: this host does, beside region {}", core::value_of(region),
                 core::value_of(options_.region));
    host::spawn_apart(host::words_of_successor(host::own_words(), region, options_.run));
  }
}

/// Receives a drain command: a node is to leave. Its launcher starts a successor. If nodes were started by hand, the
/// lowest region calls a spare; if there is none, the host of the next region starts a process.
void NodeProcess::hear_of_drain(const messages::RunCommand& drain) {
  if (!recovers()) return;
  const auto& statuses = control().statuses();
  const auto meant = statuses.find(drain.region);
  const bool is_self = drain.region == options_.region && drain.process == status_.content().process;
  const bool is_there = is_self || (meant != statuses.end() && meant->second.status.process == drain.process);
  if (!is_there || !leaving_.insert(drain.process).second) return;
  drains_ = drains_ || is_self;
  if (options_.has_launcher) return;
  const bool leads = std::ranges::none_of(
      statuses, [this](const auto& entry) { return entry.first < options_.region && entry.second.is_live(); });
  if (!control().spares().empty()) {
    if (leads) call_spare(drain.region);
  } else if (!is_self && recovery_.is_next_after(drain.region, recovery_view(statuses, true))) {
    spdlog::info("the node of region {} is to leave: this host takes it over, beside region {}",
                 core::value_of(drain.region), core::value_of(options_.region));
    host::spawn_apart(host::words_of_successor(host::own_words(), drain.region, options_.run));
  }
}

/// True if another node stays that can go on with this node's world.
bool NodeProcess::can_leave_to_others() {
  if (!recovers()) return false;
  return std::ranges::any_of(control().statuses(), [this](const auto& entry) {
    return entry.first != options_.region && entry.second.is_live() && !leaving_.contains(entry.second.status.process);
  });
}

/// Begins to leave after a SIGTERM: the host goes down, but the run goes on.
void NodeProcess::leave_if_asked() {
  if (!host::asked_to_leave() || leaves_by_) return;
  leaves_by_ = Clock::now() + kPatienceWithSuccessor;
  messages::RunCommand drain = steering::about_process(messages::RunCommandKind::kDrain, options_.run, options_.region,
                                                       status_.content().process);
  control().send(drain);
  hear_of_drain(drain);
}

/// True if another process is there for this region, and a state since then is kept by all keepers, so that the run
/// does not go back far.
bool NodeProcess::may_leave() {
  if (!has_successor()) return false;
  if (!successor_since_) successor_since_ = node_->current_step();
  const std::vector<messages::KeptPart> ours = checkpoints().parts();
  const std::vector<core::RegionId>& keepers = checkpoints().keepers();
  const auto& statuses = control().statuses();
  const bool stands = phase_ == NodePhase::kPaused;  // a paused run has no newer state
  return std::ranges::any_of(ours, [&](const messages::KeptPart& part) {
    if (part.region != options_.region || (part.step < *successor_since_ && !stands)) return false;
    return std::ranges::all_of(statuses, [&](const auto& entry) {
      const messages::KeptPart theirs{entry.first, part.step};
      const bool is_keeper = std::ranges::find(keepers, entry.first) != keepers.end();
      const auto& kept = entry.second.status.parts;
      return entry.first == options_.region || (std::ranges::find(kept, theirs) != kept.end() &&
                                                (!is_keeper || std::ranges::find(kept, part) != kept.end()));
    });
  });
}

/// Leaves the region to a successor. To the others it is as a death, at the moment that costs them least.
command_line::ExitCode NodeProcess::leave_to_successor() {
  spdlog::info("region {} leaves after state {}: {}", core::value_of(options_.region), node_->current_step(),
               has_successor() ? "another process takes over" : "nobody has come to take over yet");
  control().send(steering::about_process(messages::RunCommandKind::kLost, options_.run, options_.region,
                                         status_.content().process));
  return command_line::ExitCode::kOk;
}

}  // namespace aurasim::process
