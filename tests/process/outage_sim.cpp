#include "outage_sim.h"

#include <algorithm>

#include <fmt/format.h>

#include "outage_process.h"
#include "process/keepers.h"
#include "process/restore_plan.h"

namespace aurasim::process::test {
namespace {

using namespace std::chrono_literals;
using messages::NodeState;

constexpr auto kTick = 100ms;
constexpr auto kLease = 10s;
constexpr auto kPatienceWithParts = 10s;
constexpr core::Step kLookahead = 2;
constexpr std::size_t kPartsKept = 6;

}  // namespace

OutageSim::OutageSim(std::uint32_t hosts, std::uint64_t seed) : hosts_(hosts), random_(seed) {
  std::map<core::RegionId, std::uint16_t> by_region;
  for (std::uint32_t h = 0; h < hosts; ++h) by_region[core::RegionId{h}] = static_cast<std::uint16_t>(h);
  for (std::uint32_t h = 0; h < hosts; ++h) {
    processes_.push_back(std::make_unique<Process>(h + 1, h, core::RegionId{h}, hosts));
    processes_.back()->keepers = keepers_of(core::RegionId{h}, hosts, by_region);
  }
}

OutageSim::~OutageSim() = default;

bool OutageSim::passes(std::uint32_t from, std::uint32_t to) const {
  if (from == to) return true;
  return std::ranges::none_of(outages_, [&](const Outage& outage) {
    if (now_ < outage.begin || now_ >= outage.end || !outage.links.contains({from, to})) return false;
    return !outage.flaps || (now_ - outage.begin) % 2s < 1s;
  });
}

void OutageSim::deliver() {
  for (const auto& from : processes_) {
    for (const auto& to : processes_) {
      if (from != to && to->phase != Phase::kEnded) deliver(*from, *to);
    }
  }
  for (const auto& to : processes_) {
    std::vector<dds::RemoteWriter> writers;
    for (const auto& from : processes_) {
      dds::RemoteWriter writer;
      writer.guid = from->writer;
      writer.lost = to->heard[from->id].lost;
      if (from != to) writers.push_back(writer);
    }
    to->roster->look(writers);
    to->nodes = nodes_of(*to);
  }
}

void OutageSim::deliver(Process& from, Process& to) {
  HeardProcess& heard = to.heard[from.id];
  const bool has_left = from.phase == Phase::kEnded && from.status.state == NodeState::kFailed;
  if ((from.phase == Phase::kEnded && !has_left) || !passes(from.host, to.host)) {
    heard.whole_since = {};
    // Leases end up to a quarter earlier or later, by when life was last proved.
    if (!heard.lost && now_ > heard.last + kLease + heard.until_found) {
      heard.lost = true;
      if (heard.generation == to.generation && heard.step >= 0) to.silent.insert(from.region);
      heard.is_stuck = from.phase != Phase::kEnded && !from.heard[to.id].lost;
      if (from.heard[to.id].lost) from.heard[to.id].is_stuck = false;
    }
    return;
  }
  if (heard.whole_since == Time{}) {
    heard.whole_since = now_;
    heard.until_found = std::chrono::milliseconds(200 + random_() % 1300);
  }
  if (heard.lost && (heard.is_stuck || now_ < heard.whole_since + heard.until_found)) return;
  heard.lost = false;
  heard.last = now_;
  const dds::Origin origin{from.writer, {}};
  if (to.roster->problem_with(from.status, origin).empty()) to.roster->note(from.status, origin);
  if (from.phase == Phase::kRuns) {
    heard.step = from.step;
    heard.generation = from.generation;
  }
  for (const core::Step step : std::exchange(from.unsent[to.region], {})) to.parts[from.region].insert(step);
  for (const messages::RunCommand& restore : restores_) {
    const bool is_its_own = restore.members[core::value_of(from.region)].process == from.id;
    if (is_its_own && restore.region == from.region && sender_of(to, restore.region) == &from) {
      hear_of_restore(to, restore);
    }
  }
  const bool gives = from.phase == Phase::kGathers || from.phase == Phase::kConnects || from.phase == Phase::kWaits;
  if (!gives || to.phase != Phase::kGathers || from.current() != to.current()) return;
  for (std::size_t r = 0; r < from.restoration.restore()->members.size(); ++r) {
    if (from.restoration.restore()->members[r].holder == from.region)
      to.given.insert(core::RegionId{static_cast<std::uint32_t>(r)});
  }
}

/// Of a region several processes may be there: the one that sent a restore is the node that the receiver believes in.
OutageSim::Process* OutageSim::sender_of(const Process& process, core::RegionId region) const {
  const auto known = process.nodes.find(region);
  if (known == process.nodes.end()) return nullptr;
  const auto found =
      std::ranges::find(processes_, known->second.status.process, [](const auto& other) { return other->id; });
  return found == processes_.end() ? nullptr : found->get();
}

SeenNodes OutageSim::nodes_of(Process& process) const {
  SeenNodes nodes = process.roster->statuses();
  for (auto& [region, seen] : nodes) {
    const auto heard = process.heard.find(seen.status.process);
    if (heard != process.heard.end()) seen.seen = heard->second.last;
  }
  nodes[process.region] = {};
  nodes[process.region].status = process.status;
  nodes[process.region].seen = now_;
  return nodes;
}

void OutageSim::run_until(Time end) {
  for (; now_ < end && broken_.empty(); now_ += kTick) {
    for (const Kill& kill : kills_) {
      for (const auto& process : processes_) {
        if (kill.at <= now_ && kill.at > now_ - kTick && process->host == kill.host) process->phase = Phase::kEnded;
      }
    }
    deliver();
    for (std::size_t i = 0; i < processes_.size(); ++i) {  // a stand-in may join
      if (processes_[i]->phase != Phase::kEnded) act(*processes_[i]);
    }
  }
}

void OutageSim::act(Process& process) {
  const bool running = process.phase == Phase::kRuns;
  std::vector<core::RegionId> silent;
  if (running) silent.assign(process.silent.begin(), process.silent.end());
  const OwnWorld own = process.restoration.own_world(process.region, process.generation, std::move(silent));
  if (running || own.is_going_back) {
    if (const auto why = why_stand(process.nodes, own)) stand(process, *why);
  }
  switch (process.phase) {
    case Phase::kRuns:
      compute(process);
      break;
    case Phase::kStands:
    case Phase::kTakesOver:
      agree(process);
      break;
    case Phase::kGathers:
    case Phase::kConnects:
    case Phase::kWaits:
      go_back(process);
      break;
    case Phase::kEnded:
      return;
  }
  if (process.phase == Phase::kEnded) return;
  const bool stands = process.phase == Phase::kStands || process.phase == Phase::kGathers ||
                      process.phase == Phase::kConnects || process.phase == Phase::kTakesOver;
  messages::Status& status = process.status;
  status.state = process.phase == Phase::kRuns          ? NodeState::kRunning
                 : process.phase == Phase::kWaits       ? NodeState::kWaiting
                 : !process.knows_world                 ? NodeState::kSpare
                 : stands && process.fence.is_cut_off() ? NodeState::kCutOff
                                                        : NodeState::kRecovering;
  status.generation = stands ? process.restoration.waits_in() : process.current();
  status.step = process.step;
  status.parts.clear();
  for (const auto& [region, steps] : process.parts) {
    for (const core::Step step : steps) status.parts.push_back({region, step});
  }
}

void OutageSim::compute(Process& process) {
  process.recovery.note_kept(process.nodes, 0);
  if (!process.fence.open({process.silent.begin(), process.silent.end()}, now_)) return;
  for (std::uint32_t r = 0; r < hosts_; ++r) {
    const Process* const other = sender_of(process, core::RegionId{r});
    if (core::RegionId{r} == process.region) continue;
    const HeardProcess heard = other != nullptr ? process.heard[other->id] : HeardProcess{};
    const bool is_here = other != nullptr && heard.generation == process.generation;
    if ((is_here ? heard.step : process.step == 0 ? 0 : -1) < process.step + 1 - kLookahead) return;
  }
  ++process.step;
  if (process.generation < newest_begun_) {
    broken_ = fmt::format("process {} of region {} computes state {} of generation {}, generation {} has begun",
                          process.id, core::value_of(process.region), process.step, process.generation, newest_begun_);
  }
  if (process.step % kCheckpointSteps == 0) keep_part(process);
}

void OutageSim::keep_part(Process& process) {
  std::set<core::Step>& own = process.parts[process.region];
  own.insert(process.step);
  for (auto& [region, steps] : process.parts) {
    while (steps.size() > kPartsKept) steps.erase(steps.begin());
  }
  for (const core::RegionId keeper : process.keepers) process.unsent[keeper].insert(process.step);
}

void OutageSim::stand(Process& process, const std::string& why) {
  tell(process, "stands: " + why);
  process.phase = process.knows_world ? Phase::kStands : Phase::kTakesOver;
  process.restoration.begin(now_);
  process.restoration.begin_attempt(process.generation);
  process.recovery.begin(now_);
  process.fence.watch_closely();
}

void OutageSim::agree(Process& process) {
  if (process.restoration.is_agreed(process.generation)) {
    process.restoration.go_back();
    process.phase = Phase::kGathers;
    process.given.clear();
    const std::vector<messages::RunCommand::Member>& members = process.restoration.restore()->members;
    for (std::size_t r = 0; r < members.size(); ++r) {
      if (members[r].holder == process.region) {
        process.given.insert(core::RegionId{static_cast<std::uint32_t>(r)});
      }
    }
    process.deadline = now_ + kPatienceWithParts;
    return;
  }
  const bool may_go_on = !process.knows_world || process.fence.open({}, now_);
  SeenNodes nodes = process.nodes;
  nodes[process.region].status = process.status;
  if (!process.knows_world &&
      (process.recovery.is_not_needed(nodes, now_) || process.recovery.nobody_knows_the_world(nodes, now_))) {
    tell(process, "ends: nobody needs it");
    process.phase = Phase::kEnded;
    return;
  }
  const std::set<std::uint64_t> nobody_leaves;
  const RecoveryActs acts = process.recovery.look(
      {nodes, nobody_leaves, process.id, process.knows_world, may_go_on, process.fence.is_cut_off(), process.step},
      now_);
  if (acts.replaced_in && process.knows_world) return give_way(process);
  if (acts.meets_anew) return meet_anew(process);
  process.status.dead = unreachable_regions(nodes, process.region, hosts_);
  for (const core::RegionId region : acts.stand_ins) start_stand_in(process.host, region);
  if (may_go_on && process.knows_world) lead(process, nodes);
}

/// To all others it is a new process, and they to it.
void OutageSim::meet_anew(Process& process) {
  tell(process, "meets the others anew");
  process.heard.clear();
  process.roster.emplace(dds::RosterSettings{hosts_, 1, 1, process.region, process.writer, false}, process.speakers);
  for (const auto& other : processes_) {
    if (other.get() == &process) continue;
    if (!other->heard[process.id].lost && process.phase == Phase::kRuns) other->silent.insert(process.region);
    other->heard[process.id] = {};
  }
}

void OutageSim::lead(Process& process, const SeenNodes& nodes) {
  process.recovery.note_kept(nodes, 0);
  std::optional<RestorePlan> plan = plan_restore(nodes, hosts_);
  if (!plan || plan->lead != process.region) return;
  messages::RunCommand restore = plan->command;
  restore.generation = std::max(restore.generation, process.current() + 1);
  if (restore.count == 1 && !process.recovery.may_begin_again(0)) return;
  if (restore.count == 1) restore.at_step = 0;
  restore.region = process.region;
  tell(process, fmt::format("all go back to state {} as generation {}", restore.at_step, restore.generation));
  restores_.push_back(restore);
  process.restoration.use(restore);
}

void OutageSim::hear_of_restore(Process& process, const messages::RunCommand& restore) {
  const RestoreMeaning meaning =
      process.restoration.meaning(restore, process.region, process.id, process.generation, process.generation);
  if (meaning == RestoreMeaning::kGoBack) process.restoration.use(restore);
  if (meaning == RestoreMeaning::kLeftOut) process.recovery.note_left_out(restore);
  if (meaning == RestoreMeaning::kReplaced && process.knows_world) give_way(process);
}

void OutageSim::give_way(Process& process) {
  tell(process, "ends: another process has its region");
  process.phase = Phase::kEnded;
  process.status.state = NodeState::kFailed;
}

void OutageSim::go_back(Process& process) {
  if (now_ > process.deadline) return stand(process, "waited in vain");
  if (process.phase == Phase::kGathers) {
    if (process.given.size() < hosts_) return;
    process.phase = Phase::kConnects;
    process.deadline = now_ + kPatienceWithParts;
  }
  const auto is_here = [&](const messages::RunCommand::Member& member) {
    const auto other = std::ranges::find(processes_, member.process, [](const auto& p) { return p->id; });
    if (other == processes_.end() || (*other)->phase == Phase::kEnded) return false;
    const bool meets = (*other)->phase == Phase::kConnects || (*other)->phase == Phase::kWaits ||
                       ((*other)->phase == Phase::kRuns && (*other)->generation == process.current());
    return member.process == process.id ||
           (meets && (*other)->current() == process.current() && !process.heard[member.process].lost &&
            passes((*other)->host, process.host) && passes(process.host, (*other)->host));
  };
  if (process.phase == Phase::kConnects) {
    if (!std::ranges::all_of(process.restoration.restore()->members, is_here)) return;
    process.phase = Phase::kWaits;
    process.is_started = false;
    return;
  }
  const auto waits = [&](const auto& entry) {
    return entry.first == process.region || (!entry.second.lost && entry.second.status.state == NodeState::kWaiting &&
                                             entry.second.status.generation == process.current());
  };
  if (process.region == core::RegionId{0} && process.nodes.size() == hosts_) {
    process.is_started = process.is_started || std::ranges::all_of(process.nodes, waits);
  } else if (const Process* const first = sender_of(process, core::RegionId{0})) {
    const bool said = first->is_started && first->current() == process.current();
    process.is_started = process.is_started || (said && passes(first->host, process.host));
  }
  if (process.is_started) begin(process);
}

void OutageSim::begin(Process& process) {
  const messages::RunCommand& restore = *process.restoration.restore();
  process.generation = process.current();
  process.restoration.finish();
  process.phase = Phase::kRuns;
  process.knows_world = true;
  process.step = restore.at_step;
  process.silent.clear();
  process.unsent.clear();
  process.fence.begin_anew();
  for (auto& [region, steps] : process.parts) steps.erase(steps.upper_bound(process.step), steps.end());
  for (std::uint32_t r = 0; r < hosts_; ++r) {
    if (restore.count == 0) process.parts[core::RegionId{r}].insert(process.step);
  }
  std::map<core::RegionId, std::uint16_t> hosts;
  for (const auto& other : processes_) {
    if (restore.members[core::value_of(other->region)].process == other->id) {
      hosts[other->region] = static_cast<std::uint16_t>(other->host);
    }
  }
  process.keepers = keepers_of(process.region, hosts_, hosts);
  if (!begun_with_.try_emplace(process.generation, restore.members[0].process, restore.region).second &&
      begun_with_[process.generation] != std::pair(restore.members[0].process, restore.region)) {
    broken_ = fmt::format("generation {} begins as two worlds", process.generation);
  }
  if (process.generation > newest_begun_) {
    newest_begun_ = process.generation;
    went_back_to_.push_back(process.step);
  }
  tell(process, fmt::format("goes on from state {}", process.step));
}

void OutageSim::start_stand_in(std::uint32_t host, core::RegionId region) {
  processes_.push_back(std::make_unique<Process>(processes_.size() + 1, host, region, hosts_));
  Process& process = *processes_.back();
  process.phase = Phase::kTakesOver;
  process.knows_world = false;
  process.step = 0;
  process.recovery.begin(now_);
  process.status.state = NodeState::kSpare;
  tell(process, "takes over");
}

std::string OutageSim::problem() const {
  std::map<core::RegionId, int> nodes;
  std::set<core::Generation> generations;
  for (const auto& process : processes_) {
    if (process->phase == Phase::kEnded || process->phase == Phase::kTakesOver) continue;
    if (process->phase != Phase::kRuns) {
      return fmt::format("process {} of region {} does not compute", process->id, core::value_of(process->region));
    }
    ++nodes[process->region];
    generations.insert(process->generation);
  }
  if (generations.size() != 1) return "nodes of several generations compute";
  for (const auto& [region, count] : nodes) {
    if (count != 1) return fmt::format("region {} has {} nodes", core::value_of(region), count);
  }
  return nodes.size() == hosts_ ? std::string() : "a region has no node";
}

core::Step OutageSim::newest_state() const {
  core::Step newest = 0;
  for (const auto& process : processes_) newest = std::max(newest, process->step);
  return newest;
}

void OutageSim::tell(const Process& process, const std::string& what) {
  story_ += fmt::format("{:7.1f} s  region {} (process {}, host {}) state {}: {}\n",
                        std::chrono::duration<double>(now_ - at(0)).count(), core::value_of(process.region), process.id,
                        process.host, process.step, what);
}

}  // namespace aurasim::process::test
