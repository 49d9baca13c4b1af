// The changes of a whole run while it runs: another scene, another world, other regions. All nodes come to a change
// after the same state.
#include <algorithm>
#include <functional>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "config/launch_variants.h"
#include "dds/replica_bus.h"
#include "host/stop_signal.h"
#include "node/repartition.h"
#include "process/long_step.h"
#include "process/node_process.h"
#include "setup/launch_setup.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPatienceWithOthers = 20s;
constexpr auto kRound = 5ms;
constexpr int kMostFailedChanges = 3;  // in a row

/// Thrown when a change of the run fails, with what went wrong and the regions concerned.
class ChangeFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Collects from all regions the bodies that they host.
std::vector<node::Resident> take_census(const node::RepartitionSettings& settings, Clock::time_point deadline,
                                        dds::Participant& participant, const node::Node& node,
                                        const std::function<void()>& look_for_deaths) {
  dds::ObserverSettings watched;
  watched.map_version = settings.map->version();
  watched.region_count = static_cast<std::uint32_t>(settings.map->size());
  watched.prototype_count = static_cast<std::uint32_t>(node.scene().prototypes.size());
  dds::ReplicaReader reader(participant, watched);
  node::Census census(settings, node.current_step());
  while (!census.complete()) {
    if (Clock::now() > deadline) {
      throw ChangeFailed(fmt::format("new regions: regions {} have not published what they host", census.silent()));
    }
    look_for_deaths();
    reader.wait(kRound);
    for (const core::Replica& replica : reader.take()) census.accept(replica);
  }
  return census.take();
}

}  // namespace

/// Applies the orders about the run as a whole whose state has been computed.
void NodeProcess::apply_orders() {
  std::erase_if(run_orders_, [this](const core::Order& order) {
    const bool changes = core::changes_the_run(order.action);
    if (changes ? !has_reached(order.at_step) : node_->current_step() < order.at_step) return false;
    if (changes) {
      record(node_->finish(order.at_step));
      change_ = order;
    }
    return true;
  });
}

bool NodeProcess::change_if_due() {
  if (!change_) return false;
  const core::Order order = *std::exchange(change_, std::nullopt);
  before_change_ = BeforeChange{launch_, options_.world};
  const bool stands = hold_at_.has_value();
  try {
    if (const auto* scene = std::get_if<core::ChangeScene>(&order.action)) change_scene(scene->name);
    if (const auto* regions = std::get_if<core::Repartition>(&order.action)) change_regions(regions->boxes);
    if (const auto* load = std::get_if<core::Load>(&order.action)) change_world(load->file);
  } catch (const ChangeFailed& failed) {
    // All nodes are here and can go back to the world before the change, so the change is tried once more.
    if (!recovers() || host::stop_requested() || ++failed_changes_ > kMostFailedChanges) throw;
    throw SomebodyDied(failed.what());
  }
  failed_changes_ = 0;
  life_of_node_ = life_;
  before_change_.reset();
  if (stands) hold_in(node_->current_step());
  return true;
}

/// Changes to another scene. Bodies of the old one are dropped; the regions stay.
void NodeProcess::change_scene(const std::string& name) {
  launch_ = config::with_scene(launch_, name);
  options_.world.reset();
  spdlog::info("scene {} after step {}", name, node_->current_step());
  begin_anew();
}

/// Changes to a saved world. The regions stay, whatever they were when it was saved.
void NodeProcess::change_world(const std::string& file) {
  options_.world = cut::load_world({(options_.saves / file).string(), false}, launch_);
  spdlog::info("{}, state {}, after step {}", file, first_step(), node_->current_step());
  begin_anew();
}

/// Publishes the map and scene of a generation. The agreement stays that of the run's beginning.
void NodeProcess::publish_map(core::Generation generation, core::Step from_step) {
  messages::WorldMap map = setup::world_map(launch_);
  map.agreement = status_.content().agreement;
  map.generation = generation;
  map.from_step = from_step;
  control().publish_map(map);
}

void NodeProcess::begin_anew() {
  wait_until_all_stand();
  waits_to_start_ = generation_ + 1;
  publish_map(waits_to_start_, first_step());  // first, so that observers read the new scene before its bodies come
  node_.reset();
  connect_for_change(neighbour_transport(launch_, options_.region));
  begin_generation(waits_to_start_, *start_);
}

/// Waits until all nodes wait in the state of the change. No node may close its transport earlier, because its messages
/// may have to be retransmitted.
void NodeProcess::wait_until_all_stand() {
  enter(NodeEvent::kChanges);
  status_.make_due();  // publish the status at once, because the others wait for it
  auto deadline = Clock::now() + kPatienceWithOthers;
  const auto stands = [this](const auto& entry) {
    const messages::Status& status = entry.second.status;
    const bool is_here = status.state == messages::NodeState::kPaused && status.generation == generation_ &&
                         status.step >= node_->current_step();
    return entry.first == options_.region || is_here || status.generation > generation_;
  };
  for (;;) {
    publish();
    const auto& statuses = control().statuses();
    if (std::all_of(statuses.begin(), statuses.end(), stands)) return;
    execute_commands();
    look_for_deaths();
    if (somebody_computes_for_long()) deadline = Clock::now() + kPatienceWithOthers;
    if (Clock::now() > deadline || host::stop_requested()) {
      throw ChangeFailed(fmt::format("step {}: not every node has come to the change", node_->current_step()));
    }
    control().wait(5ms);
  }
}

/// Waits until every body that was on its way to this node has arrived.
void NodeProcess::settle_all() {
  if (node_->settled()) return;
  const auto deadline = Clock::now() + kPatienceWithOthers;
  while (!node_->ready_to_settle()) {
    look_for_deaths();
    if (Clock::now() > deadline || host::stop_requested()) {
      throw ChangeFailed("new regions: a neighbour has not come to this state");
    }
    transport().wait_for_arrival(5ms);
  }
  const node::StepReport& report = node_->settle();
  records_.write_settling(report);
}

/// True if some node computes one step for long (long_step.h). It is not dead, so a wait for all nodes goes on.
bool NodeProcess::somebody_computes_for_long() {
  const auto now = Clock::now();
  return std::ranges::any_of(control().statuses(), [&](const auto& entry) {
    return entry.first != options_.region && long_step(entry.second, now).has_value();
  });
}

void NodeProcess::connect_for_change(const dds::TransportSettings& settings) {
  const auto deadline = Clock::now() + kPatienceWithOthers;
  connect_anew(settings, [&](const char* for_what) {
    if (host::stop_requested()) throw ChangeFailed("told to stop while the run changes");
    if (Clock::now() > deadline) throw ChangeFailed(fmt::format("a change has waited in vain for {}", for_what));
    if (phase_ == NodePhase::kWaiting) publish();  // before, others still wait for the last state's status
    execute_commands();
    look_for_deaths();
    control().wait(10ms);
  });
}

void NodeProcess::change_regions(const std::vector<core::Rectangle>& boxes) {
  settle_all();
  wait_until_all_stand();
  const auto deadline = Clock::now() + kPatienceWithOthers;
  const auto changed = std::make_unique<config::Launch>(config::with_regions(launch_, boxes));
  const node::RepartitionSettings settings = {options_.region, generation_ + 1, setup::aura_rules(*changed),
                                              &changed->regions};
  endpoints_.observers().use_map(changed->regions.version());  // so that observers of the old map do not receive it
  endpoints_.observers().publish_census(*node_, settings.census);
  const std::vector<core::Departure> departures = node::find_new_hosts(
      settings, take_census(settings, deadline, endpoints_.participant(), *node_, [this] { look_for_deaths(); }),
      *node_);

  dds::TransportSettings to_all = neighbour_transport(*changed, options_.region);
  to_all.neighbours.clear();
  for (std::uint32_t r = 0; r < changed->regions.size(); ++r) {
    if (core::RegionId{r} != options_.region) to_all.neighbours.push_back(core::RegionId{r});
  }
  waits_to_start_ = settings.census;
  connect_for_change(to_all);
  node::StepReport moved;
  moved.step = node_->current_step();
  node::Exchange exchange(settings, departures, transport(), *node_);
  while (!exchange.ready()) {
    look_for_deaths();
    if (Clock::now() > deadline) {
      throw ChangeFailed(fmt::format("new regions: regions {} have not sent their bodies", exchange.silent()));
    }
    transport().wait_for_arrival(kRound);
  }
  for (const node::HandOffRow& row : exchange.finish()) {
    (row.source == options_.region ? moved.departures : moved.arrivals).push_back(row);
  }
  wait_until_all_stand();
  records_.write_settling(moved);
  status_.content().hand_offs_out += moved.departures.size();
  status_.content().hand_offs_in += moved.arrivals.size();

  launch_ = *changed;
  status_.use_regions(launch_);
  waits_to_start_ = settings.census + 1;
  connect_for_change(neighbour_transport(launch_, options_.region));
  const node::NodeSetup setup = setup::node_setup(launch_, options_.region, generation_);
  endpoints_.observers().begin_generation(generation_);
  endpoints_.commands().change_map(generation_, node_->current_step());
  saving_.change_map(start_->request, generation_);
  endpoints_.note_served_map();
  control().use_map(launch_.regions.version());
  notices_.begin_refusals();
  const node::StepReport& report = node_->take_map(setup.protocol, launch_.regions, transport());
  endpoints_.observers().after_step(*node_, report);
  record(node_->confirmed());
  pacer_.set_epoch(node_->current_step() + 1, start_->epoch_ns, start_->clock_ahead, node::read_clocks());
  publish_map(generation_, node_->current_step());
  spdlog::info("new regions after step {}: {} bodies sent, {} taken in", node_->current_step(), moved.departures.size(),
               moved.arrivals.size());
}

}  // namespace aurasim::process
