#include "process/changing_phase.h"

#include <stdexcept>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "config/launch_variants.h"
#include "host/stop_signal.h"
#include "process/long_step.h"
#include "process/region_change.h"

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

void ChangingPhase::take_reached_changes() {
  for (const core::Step step : run_.changes.take_reached(run_.node->current_step(), run_.node->confirmed_step())) {
    run_.record(run_.node->finish(step));
  }
}

bool ChangingPhase::change_if_due() {
  if (!run_.changes.is_due()) return false;
  const core::Order order = run_.changes.begin({run_.launch, run_.options.world});
  const bool was_paused = run_.schedule.holds_at().has_value();
  try {
    if (const auto* scene = std::get_if<core::ChangeScene>(&order.action)) change_scene(scene->name);
    if (const auto* regions = std::get_if<core::Repartition>(&order.action)) change_regions(regions->boxes);
    if (const auto* load = std::get_if<core::Load>(&order.action)) change_world(load->file);
  } catch (const ChangeFailed& failed) {
    // All nodes are here and can go back to the world before the change, so the change is tried once more.
    if (!run_.recovers() || host::stop_requested() || !run_.changes.may_try_again()) throw;
    throw SomebodyDied(failed.what());
  }
  run_.changes.finish();
  run_.life_of_node = run_.life;
  if (was_paused) run_.schedule.hold_in(run_.node->current_step());
  return true;
}

/// Changes to another scene. Bodies of the old one are dropped; the regions stay.
void ChangingPhase::change_scene(const std::string& name) {
  run_.launch = config::with_scene(run_.launch, name);
  run_.options.world.reset();
  spdlog::info("scene {} after step {}", name, run_.node->current_step());
  begin_anew();
}

/// Changes to a saved world. The regions stay, whatever they were when it was saved.
void ChangingPhase::change_world(const std::string& file) {
  run_.options.world = cut::load_world({(run_.options.saves / file).string(), false}, run_.launch);
  spdlog::info("{}, state {}, after step {}", file, run_.first_step(), run_.node->current_step());
  begin_anew();
}

/// Changes to other regions. Bodies and orders stay; each body goes to the host that the new map wants. Where regions
/// are coupled that is the owner of its block, and it goes there in the next step.
void ChangingPhase::change_regions(const std::vector<core::Rectangle>& boxes) {
  settle_all();
  wait_for_all_nodes();
  if (run_.launch.is_coupled()) {
    const config::Launch launch = config::with_regions(run_.launch, boxes);
    run_.endpoints.observers().use_map(launch.regions.version());
    begin_regions(launch, run_.generation + 1);
    spdlog::info("new regions after step {}", run_.node->current_step());
  } else {
    move_to_regions(boxes);
  }
}

/// The same where regions are not coupled.
void ChangingPhase::move_to_regions(const std::vector<core::Rectangle>& boxes) {
  const auto deadline = Clock::now() + kPatienceWithOthers;
  RegionChange change(run_.launch, boxes, run_.options.region, run_.generation);
  change.begin_census(run_.endpoints, *run_.node);
  while (!change.has_census()) {
    if (Clock::now() > deadline) throw ChangeFailed(change.missing_in_census());
    run_.look_for_deaths();
    change.receive_census(kRound);
  }
  change.end_census(*run_.node);
  run_.start.await(change.generation());
  connect_for_change(change.transport_to_all());
  change.begin_exchange(run_.transport(), *run_.node);
  while (!change.has_all_bodies()) {
    run_.look_for_deaths();
    if (Clock::now() > deadline) throw ChangeFailed(change.missing_in_exchange());
    run_.transport().wait_for_arrival(kRound);
  }
  const node::StepReport moved = change.finish(*run_.node);
  wait_for_all_nodes();
  run_.records.write_settling(moved);
  run_.status.note_moved(moved);
  begin_regions(change.launch(), change.generation() + 1);
  spdlog::info("new regions after step {}: {} bodies sent, {} taken in", run_.node->current_step(),
               moved.departures.size(), moved.arrivals.size());
}

/// Goes on with the regions of `launch`, in a new generation.
void ChangingPhase::begin_regions(const config::Launch& launch, core::Generation generation) {
  run_.launch = launch;
  run_.status.use_regions(run_.launch);
  run_.start.await(generation);
  connect_for_change(neighbour_transport(run_.launch, run_.options.region));
  run_.begin_changed_map();
}

/// Begins the changed world from its first state, in a new generation.
void ChangingPhase::begin_anew() {
  wait_for_all_nodes();
  run_.start.await(run_.generation + 1);
  // The map comes first, so that observers read the new scene before its bodies come.
  run_.publish_map(run_.start.generation(), run_.first_step());
  run_.node.reset();
  connect_for_change(neighbour_transport(run_.launch, run_.options.region));
  run_.begin_generation(run_.start.generation(), *run_.start.start());
}

/// Waits until all nodes wait in the state of the change. No node may close its transport earlier, because its messages
/// may have to be retransmitted.
void ChangingPhase::wait_for_all_nodes() {
  run_.enter(NodeEvent::kChanges);
  run_.status.make_due();  // publish the status at once, because the others wait for it
  auto deadline = Clock::now() + kPatienceWithOthers;
  for (;;) {
    run_.publish();
    if (all_wait_in(run_.control().statuses(), run_.options.region, run_.generation, run_.node->current_step())) return;
    executor_.execute_commands();
    run_.look_for_deaths();
    if (computes_for_long(run_.control().statuses(), run_.options.region, Clock::now()))
      deadline = Clock::now() + kPatienceWithOthers;
    if (Clock::now() > deadline || host::stop_requested()) {
      throw ChangeFailed(fmt::format("step {}: not every node has reached the change", run_.node->current_step()));
    }
    run_.control().wait(5ms);
  }
}

/// Waits until every body that was on its way to this node has arrived.
void ChangingPhase::settle_all() {
  if (run_.node->settled()) return;
  const auto deadline = Clock::now() + kPatienceWithOthers;
  while (!run_.node->ready_to_settle()) {
    run_.look_for_deaths();
    if (Clock::now() > deadline || host::stop_requested()) {
      throw ChangeFailed("new regions: a neighbour has not reached this state");
    }
    run_.transport().wait_for_arrival(5ms);
  }
  const node::StepReport& report = run_.node->settle();
  run_.records.write_settling(report);
}

/// Connects the nodes anew for the awaited generation, and waits until it starts.
void ChangingPhase::connect_for_change(const dds::TransportSettings& settings) {
  const auto deadline = Clock::now() + kPatienceWithOthers;
  run_.begin_to_connect(settings);
  while (const char* const missing = run_.go_on_connecting()) {
    if (host::stop_requested()) throw ChangeFailed("the process was asked to stop while the run changes");
    if (Clock::now() > deadline)
      throw ChangeFailed(fmt::format("the change of the run has waited in vain for {}", missing));
    if (run_.phase == NodePhase::kWaiting) run_.publish();  // before, others still wait for the last state's status
    executor_.execute_commands();
    run_.look_for_deaths();
    run_.control().wait(10ms);
  }
}

}  // namespace aurasim::process
