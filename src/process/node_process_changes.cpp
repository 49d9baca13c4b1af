// The changes of a whole run while it runs: another scene, another world, other regions. All nodes come to a change
// after the same state.
#include <stdexcept>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "config/launch_variants.h"
#include "host/stop_signal.h"
#include "process/long_step.h"
#include "process/node_process.h"
#include "process/region_change.h"
#include "setup/launch_setup.h"

namespace aurasim::process {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPatienceWithOthers = 20s;
constexpr auto kRound = 5ms;

/// Thrown when a change of the run fails, with what went wrong and the regions concerned.
class ChangeFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace

/// Removes the orders about the run as a whole whose state has been computed. A change becomes due, and the node is
/// finished in its state.
void NodeProcess::take_reached_changes() {
  for (const core::Step step : changes_.take_reached(node_->current_step(), node_->confirmed_step())) {
    record(node_->finish(step));
  }
}

/// True if another world, or a world of other regions, has begun.
bool NodeProcess::change_if_due() {
  if (!changes_.is_due()) return false;
  const core::Order order = changes_.begin({launch_, options_.world});
  const bool stands = schedule_.holds_at().has_value();
  try {
    if (const auto* scene = std::get_if<core::ChangeScene>(&order.action)) change_scene(scene->name);
    if (const auto* regions = std::get_if<core::Repartition>(&order.action)) change_regions(regions->boxes);
    if (const auto* load = std::get_if<core::Load>(&order.action)) change_world(load->file);
  } catch (const ChangeFailed& failed) {
    // All nodes are here and can go back to the world before the change, so the change is tried once more.
    if (!recovers() || host::stop_requested() || !changes_.may_try_again()) throw;
    throw SomebodyDied(failed.what());
  }
  changes_.finish();
  life_of_node_ = life_;
  if (stands) schedule_.hold_in(node_->current_step());
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

/// Begins the changed world from its first state, in a new generation.
void NodeProcess::begin_anew() {
  wait_until_all_stand();
  start_.await(generation_ + 1);
  publish_map(start_.generation(), first_step());  // first, so that observers read the new scene before its bodies come
  node_.reset();
  connect_for_change(neighbour_transport(launch_, options_.region));
  begin_generation(start_.generation(), *start_.start());
}

/// Waits until all nodes wait in the state of the change. No node may close its transport earlier, because its messages
/// may have to be retransmitted.
void NodeProcess::wait_until_all_stand() {
  enter(NodeEvent::kChanges);
  status_.make_due();  // publish the status at once, because the others wait for it
  auto deadline = Clock::now() + kPatienceWithOthers;
  for (;;) {
    publish();
    if (all_stand(control().statuses(), options_.region, generation_, node_->current_step())) return;
    execute_commands();
    look_for_deaths();
    if (computes_for_long(control().statuses(), options_.region, Clock::now()))
      deadline = Clock::now() + kPatienceWithOthers;
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

/// Connects the nodes anew for the awaited generation, and waits until it starts.
void NodeProcess::connect_for_change(const dds::TransportSettings& settings) {
  const auto deadline = Clock::now() + kPatienceWithOthers;
  begin_to_connect(settings);
  while (const char* const missing = go_on_connecting()) {
    if (host::stop_requested()) throw ChangeFailed("told to stop while the run changes");
    if (Clock::now() > deadline) throw ChangeFailed(fmt::format("a change has waited in vain for {}", missing));
    if (phase_ == NodePhase::kWaiting) publish();  // before, others still wait for the last state's status
    execute_commands();
    look_for_deaths();
    control().wait(10ms);
  }
}

/// Changes to other regions. Bodies and orders stay; each body goes to the host that the new map wants.
void NodeProcess::change_regions(const std::vector<core::Rectangle>& boxes) {
  settle_all();
  wait_until_all_stand();
  const auto deadline = Clock::now() + kPatienceWithOthers;
  RegionChange change(launch_, boxes, options_.region, generation_);
  change.begin_census(endpoints_, *node_);
  while (!change.has_census()) {
    if (Clock::now() > deadline) throw ChangeFailed(change.missing_in_census());
    look_for_deaths();
    change.receive_census(kRound);
  }
  change.end_census(*node_);
  start_.await(change.generation());
  connect_for_change(change.transport_to_all());
  change.begin_exchange(transport(), *node_);
  while (!change.has_all_bodies()) {
    look_for_deaths();
    if (Clock::now() > deadline) throw ChangeFailed(change.missing_in_exchange());
    transport().wait_for_arrival(kRound);
  }
  const node::StepReport moved = change.finish(*node_);
  wait_until_all_stand();
  records_.write_settling(moved);
  status_.note_moved(moved);
  launch_ = change.launch();
  start_.await(change.generation() + 1);
  begin_changed_map();
  spdlog::info("new regions after step {}: {} bodies sent, {} taken in", node_->current_step(), moved.departures.size(),
               moved.arrivals.size());
}

/// Goes on in the present state with the regions of launch_, in the awaited generation.
void NodeProcess::begin_changed_map() {
  status_.use_regions(launch_);
  connect_for_change(neighbour_transport(launch_, options_.region));
  const node::NodeSetup setup = setup::node_setup(launch_, options_.region, generation_);
  endpoints_.observers().begin_generation(generation_);
  endpoints_.commands().change_map(generation_, node_->current_step());
  saving_.change_map(start_.start()->request, generation_);
  endpoints_.note_served_map();
  control().use_map(launch_.regions.version());
  notices_.begin_refusals();
  const node::StepReport& report = node_->take_map(setup.protocol, launch_.regions, transport());
  endpoints_.observers().after_step(*node_, report);
  record(node_->confirmed());
  schedule_.go_on_after(node_->current_step(), *start_.start(), node::read_clocks());
  publish_map(generation_, node_->current_step());
}

}  // namespace aurasim::process
