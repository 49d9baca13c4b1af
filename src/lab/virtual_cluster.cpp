#include "lab/virtual_cluster.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include <malloc.h>

namespace aurasim::lab {
namespace {

/// By region: those that listen to it from the start.
std::vector<std::vector<core::RegionId>> listeners(const core::Scene& scene, const core::RegionMap& map,
                                                   const ClusterRules& rules) {
  std::optional<core::BlockOwners> owners;
  if (rules.coupled) owners.emplace(physics::block_owners(map, scene, node_setup(rules).physics));
  return core::all_near(map, {rules.neighbour_distance_m, owners ? &*owners : nullptr});
}

/// Keeps freed memory in the process; to be called once. Each cluster makes and drops worlds of a few MB. Memory given
/// back to the system would have to be requested and cleared again.
bool keep_freed_memory() { return mallopt(M_MMAP_THRESHOLD, 1 << 28) != 0 && mallopt(M_TRIM_THRESHOLD, 1 << 28) != 0; }

}  // namespace

node::NodeSetup node_setup(const ClusterRules& rules) {
  node::NodeSetup setup;
  setup.protocol.sync = rules.sync;
  setup.protocol.aura = rules.aura;
  setup.protocol.aura.looks_once = rules.physics.looks_once();
  setup.protocol.aura.sweeps = rules.physics.continuous;
  setup.protocol.neighbour_distance_m = rules.neighbour_distance_m;
  setup.physics = rules.physics;
  setup.control = rules.control;
  setup.physics.step_s = rules.aura.step_s;
  setup.physics.substeps = rules.aura.substeps;
  setup.hash_states = rules.hash_states;
  setup.clock = rules.clock;
  setup.recorded = rules.recorded;
  return setup;
}

VirtualCluster::VirtualCluster(const core::Scene& scene, const core::RegionMap& map, const ClusterRules& rules,
                               const core::WorldCut* world, node::Recorded recorded)
    : rules_(rules),
      map_(map),
      network_(listeners(scene, map, rules), rules.network, rules.seed),
      seams_(map.size()),
      random_(rules.seed * 0x9E3779B97F4A7C15ull + 1) {
  [[maybe_unused]] static const bool kept = keep_freed_memory();
  for (const BrokenLink& link : rules.broken_links) {
    network_.faults().cut(link.a, link.b, link.from_s, link.until_s);
  }
  if (rules.bandwidth_B_s) post_.emplace(network_, map_.size(), *rules.bandwidth_B_s, rules.physics.block_m);
  node::NodeSetup setup = node_setup(rules);
  for (std::uint32_t r = 0; r < map_.size(); ++r) {
    setup.protocol.self = core::RegionId{r};
    if (rules.coupled) setup.seams = &seams_.of(core::RegionId{r});
    Member& member = members_.emplace_back();
    transport::Transport& mail = post_ ? post_->endpoint(core::RegionId{r}) : network_.endpoint(core::RegionId{r});
    member.node = std::make_unique<node::Node>(setup, scene, map_, mail);
    member.phase_s = r < rules.phase_s.size() ? rules.phase_s[r] : 0;
  }
  for (Member& member : members_) {
    if (world != nullptr) {
      member.node->start(*world, recorded);
    } else {
      member.node->start();
    }
  }
}

VirtualCluster::~VirtualCluster() = default;

double VirtualCluster::chance() {
  random_ = random_ * 6364136223846793005ull + 1442695040888963407ull;
  return static_cast<double>(random_ >> 11) * 0x1p-53;
}

/// When the member's next step is due on the shared clock. A member that is late does not pause between frames.
double VirtualCluster::due_s(const Member& member) const {
  const auto next = static_cast<double>(member.node->current_step() + 1);
  return std::max(next * rules_.aura.step_s + member.phase_s, member.free_s);
}

VirtualCluster::Event VirtualCluster::next() {
  if (const std::optional<Event> event = try_next()) return *event;
  throw std::logic_error("every node of the cluster waits for a message that nobody sends:" + who_waits());
}

/// Text that names each live node and the regions whose messages it waits for.
std::string VirtualCluster::who_waits() const {
  std::string text;
  for (const Member& member : members_) {
    if (!member.is_alive) continue;
    const core::Step next = member.node->current_step() + 1;
    text += " region " + std::to_string(core::value_of(member.node->region())) + " for what state " +
            std::to_string(next) + " needs of";
    for (const core::RegionId region : member.node->protocol().missing(next)) {
      text += ' ';
      text += std::to_string(core::value_of(region));
    }
    text += ";";
  }
  return text;
}

/// Coupled nodes compute a state all at once, each in a thread of its own, and then their events come one by one.
std::optional<VirtualCluster::Event> VirtualCluster::next_of_coupled() {
  if (computed_.empty() && !compute_all()) return std::nullopt;
  const Event event = computed_.front();
  computed_.pop_front();
  return event;
}

bool VirtualCluster::compute_all() {
  double due = 0;
  for (const Member& member : members_) {
    if (!member.is_alive || holds(member)) return false;
    due = std::max(due, due_s(member));
  }
  network_.advance_to(std::max(due, network_.now_s()));
  const auto is_ready = [](Member& member) { return member.node->ready(); };
  while (!std::ranges::all_of(members_, is_ready)) {
    if (!std::isfinite(network_.next_arrival_s())) return false;
    network_.advance_to(std::max(network_.next_arrival_s(), network_.now_s()));
  }
  std::vector<std::function<void()>> works;
  for (Member& member : members_) works.push_back([&member] { member.node->step(); });
  seams_.run(works);
  for (Member& member : members_) {
    member.free_s = network_.now_s();
    computed_.push_back({member.node->region(), &member.node->report()});
  }
  return true;
}

std::optional<VirtualCluster::Event> VirtualCluster::try_next() {
  if (rules_.coupled) return next_of_coupled();
  for (;;) {
    double event_s = std::numeric_limits<double>::infinity();
    Member* chosen = nullptr;
    for (Member& member : members_) {
      if (!member.is_alive || holds(member)) continue;
      const double at_s = member.waiting ? std::max(network_.next_arrival_s(), network_.now_s()) : due_s(member);
      if (at_s >= event_s) continue;
      event_s = at_s;
      chosen = &member;
    }
    if (!chosen) return std::nullopt;
    // A message may arrive in the very moment in which a node computes.
    const bool something_arrives = network_.next_arrival_s() <= event_s;
    network_.advance_to(std::max(event_s, network_.now_s()));
    const bool was_waiting = chosen->waiting;
    if (was_waiting || something_arrives) {
      for (Member& member : members_) member.waiting = false;
    }
    if (was_waiting) continue;
    if (!chosen->node->ready()) {
      chosen->waiting = true;
      continue;
    }
    compute(*chosen, network_.now_s());
    return Event{chosen->node->region(), report_};
  }
}

void VirtualCluster::end_in(core::Step last) {
  for (Member& member : members_) member.last = last;
}

void VirtualCluster::stand_in(core::Step state) {
  constexpr int kMostRounds = 10'000;
  end_in(state);
  stands_ = true;
  int rounds = 0;
  do {
    if (++rounds > kMostRounds) throw std::logic_error("the nodes do not finish the check of a state");
    while (try_next()) {
    }
    deliver_all();
  } while (!all_stand());
  stands_ = false;
  end_in(std::numeric_limits<core::Step>::max());
}

bool VirtualCluster::holds(const Member& member) const {
  return member.node->current_step() >= member.last && !(stands_ && member.node->is_going_back());
}

/// Lets each node go on with its check. True if all have ended it.
bool VirtualCluster::all_stand() {
  bool all = true;
  for (Member& member : members_) {
    if (!member.is_alive) continue;
    const bool stands = member.node->current_step() == member.last && member.node->stand();
    all = all && stands;
  }
  return all;
}

void VirtualCluster::deliver_all() {
  while (std::isfinite(network_.next_arrival_s())) {
    network_.advance_to(std::max(network_.next_arrival_s(), network_.now_s()));
    for (Member& member : members_) {
      if (member.is_alive) member.node->ready();
    }
  }
}

void VirtualCluster::crash(core::RegionId region, double lease_s) {
  network_.crash(region, lease_s);
  stop(region);
}

void VirtualCluster::crash_in_step(core::RegionId region, std::size_t parcels) {
  computed_.clear();
  seams_.end_after(region, parcels);
  try {
    compute_all();
  } catch (const core::SeamsBroken&) {
    // The others stand in the middle of the state, as in a real run.
  }
  computed_.clear();
  stop(region);
}

void VirtualCluster::compute(Member& member, double at_s) {
  const double frame_s = rules_.shortest_frame_s + (rules_.longest_frame_s - rules_.shortest_frame_s) * chance();
  network_.set_send_delay(frame_s);
  report_ = &member.node->step();
  member.lag_s = at_s - static_cast<double>(report_->step) * rules_.aura.step_s - member.phase_s;
  member.node->protocol().report_frame(report_->step, frame_s);
  member.free_s = at_s + frame_s;
}

core::Step VirtualCluster::confirmed() const {
  core::Step confirmed = std::numeric_limits<core::Step>::max();
  for (const Member& member : members_) {
    if (member.is_alive) confirmed = std::min(confirmed, member.node->confirmed_step());
  }
  return confirmed;
}

core::Step VirtualCluster::slowest() const {
  core::Step slowest = std::numeric_limits<core::Step>::max();
  for (const Member& member : members_) {
    if (member.is_alive) slowest = std::min(slowest, member.node->current_step());
  }
  return slowest;
}

double VirtualCluster::slow_down() const {
  double most = 1;
  for (const Member& member : members_) {
    const auto steps = static_cast<double>(std::max<core::Step>(1, member.node->current_step()));
    most = std::max(most, 1 + member.lag_s / (steps * rules_.aura.step_s));
  }
  return most;
}

std::uint64_t VirtualCluster::violations() const {
  std::uint64_t sum = 0;
  for (const Member& member : members_) sum += member.node->protocol().violations().total();
  return sum;
}

std::uint64_t VirtualCluster::violations(core::ViolationKind kind) const {
  std::uint64_t sum = 0;
  for (const Member& member : members_) sum += member.node->protocol().violations().count(kind);
  return sum;
}

}  // namespace aurasim::lab
