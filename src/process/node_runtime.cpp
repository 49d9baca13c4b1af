#include "process/node_runtime.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "config/launch_variants.h"
#include "core/wall_clock.h"
#include "cut/saved_world.h"
#include "dds/dds_seams.h"
#include "dds/random_id.h"
#include "process/exchange_choice.h"
#include "process/long_step.h"
#include "setup/launch_setup.h"

namespace aurasim::process {
namespace {

using Clock = std::chrono::steady_clock;

RecoverySettings recovery_settings(const config::Launch& launch, const NodeOptions& options, bool can_be_cut) {
  RecoverySettings settings;
  settings.region = options.region;
  settings.regions = static_cast<std::uint32_t>(launch.regions.size());
  settings.patience =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(launch.survival.patience_s));
  settings.can_be_cut = can_be_cut;
  settings.has_launcher = options.has_launcher;
  settings.checkpoint_steps = launch.checkpoint_steps();
  return settings;
}

messages::Status identity_of_node(const config::Launch& launch, const NodeOptions& options) {
  messages::Status status;
  status.region = options.region;
  status.run = options.run;
  status.pid = static_cast<std::uint32_t>(::getpid());
  status.process = dds::draw_id();
  status.map_version = launch.regions.version();
  status.agreement = launch.agreement();
  status.footprint = launch.regions.region(options.region);
  status.lookahead = launch.lookahead();
  status.exchange = in_use(launch.exchange);
  return status;
}

FenceSettings fence_settings(const config::Launch& launch, const NodeOptions& options, bool can_be_cut) {
  FenceSettings settings;
  settings.region = options.region;
  settings.regions = static_cast<std::uint32_t>(launch.regions.size());
  settings.can_be_cut = can_be_cut;
  settings.never_waits = launch.time.sync == core::SyncMode::kFreeRunning;
  return settings;
}

}  // namespace

NodeRuntime::NodeRuntime(config::Launch the_launch, const NodeOptions& the_options)
    : launch(std::move(the_launch)),
      options(the_options),
      endpoints(launch, options),
      fence(fence_settings(launch, options, !endpoints.stays_on_this_host()),
            [this] { return endpoints.peer_signs(); }),
      saving(launch, options),
      records(options.report, options.region),
      notices(options.region, node::read_clocks()),
      status(identity_of_node(launch, options), Clock::now(), launch.regions.size()),
      schedule(launch.step_s(), launch.time.pace == config::Pace::kWall, options.steps),
      start(options.region, launch.regions.size()),
      leaving(options.region, status.content().process),
      recovery(recovery_settings(launch, options, !endpoints.stays_on_this_host())) {}

void NodeRuntime::enter(NodeEvent event) {
  const std::optional<NodePhase> next = next_phase(phase, event);
  if (!next) throw std::logic_error(fmt::format("node: '{}' while {}", name_of(event), name_of(phase)));
  phase = *next;
}

void NodeRuntime::refuse(const std::string& why) {
  spdlog::error("{}", why);
  const bool is_known = phase != NodePhase::kListening;  // before that, another process may have the region
  enter(NodeEvent::kRefusal);
  if (is_known) publish(why);
}

bool NodeRuntime::fence_is_open() { return fence.open(node->protocol().intake().dead_regions(), Clock::now()); }

dds::TransportSettings NodeRuntime::transport_settings() {
  dds::TransportSettings settings = neighbour_transport(launch, options.region);
  settings.life = life;
  settings.why_stand = [this] {
    control().hear_of_deaths();  // where all wait in the middle of a step, nobody executes commands
    return death();
  };
  settings.is_busy = [this](core::RegionId region) {
    const auto seen = control().statuses().find(region);
    return seen != control().statuses().end() && long_step(seen->second, Clock::now());
  };
  return settings;
}

void NodeRuntime::publish_map(core::Generation of, core::Step from_step) {
  messages::WorldMap map = setup::world_map(launch);
  map.agreement = status.content().agreement;
  map.generation = of;
  map.from_step = from_step;
  control().publish_map(map);
}

void NodeRuntime::use_exchange(config::Exchange exchange) {
  launch = config::with_exchange(launch, exchange);
  status.use_exchange(launch);
}

void NodeRuntime::take_exchange_of_others() {
  if (launch.exchange != config::Exchange::kAuto) return;
  const messages::ExchangeInUse chosen = chosen_by_others(control().statuses(), status.content().agreement);
  if (chosen == messages::ExchangeInUse::kNotChosen) return;
  use_exchange(chosen == messages::ExchangeInUse::kCoupled ? config::Exchange::kCoupled : config::Exchange::kAura);
}

void NodeRuntime::note_exchanges(Clock::time_point now) {
  const dds::ExchangeTimes* const times = transport().exchange_times();
  if (times == nullptr) return;
  records.note_exchanges(*times);
  status.note_exchanges(times->seconds);
  const auto slow =
      exchange_watch.note(times->seconds, times->waited_for, times->waited_s, launch.exchange_limit_s(), now);
  if (!slow) return;
  spdlog::warn("{}", *slow);
  notices.note_news(*slow);
}

void NodeRuntime::start_when_all_wait() {
  auto command = start.to_send(control().statuses(), options.run, core::wall_clock_ns());
  if (!command) return;
  command->request = control().send(*command);
  start.accept(*command);
}

void NodeRuntime::begin_to_connect(dds::TransportSettings settings) {
  settings.life = life = start.generation();
  endpoints.connect(settings);
}

const char* NodeRuntime::go_on_connecting() {
  if (generation != start.generation()) {
    if (!transport().all_matched()) return "its neighbours";
    generation = start.generation();
    start.forget();
    enter(NodeEvent::kStands);
  }
  start_when_all_wait();
  if (!start.start()) return "the others";
  enter(NodeEvent::kStarted);
  return nullptr;
}

std::optional<std::string> NodeRuntime::death() {
  if (launch.regions.size() == 1) return std::nullopt;
  // In any other case node is from before the death, and its silent neighbours are known already.
  const bool is_running = restoration.computes_in(generation) && node && life_of_node == life;
  std::vector<core::RegionId> silent;
  if (is_running) silent = node->protocol().intake().dead_regions();
  OwnWorld own = restoration.own_world(options.region, generation, std::move(silent));
  if (is_running && launch.is_coupled() && !has_reached_the_end()) own.coupled_in = node->current_step();
  return why_stand(control().statuses(), own);
}

void NodeRuntime::look_for_deaths() {
  if (const auto why = death()) throw SomebodyDied(*why);
}

SeenNodes NodeRuntime::nodes_and_self() {
  SeenNodes nodes = control().statuses();
  nodes[options.region].status = status.content();
  return nodes;
}

RecoveryView NodeRuntime::recovery_view(const SeenNodes& nodes, bool may_go_on) const {
  return {nodes,         leaving.processes(), status.content().process, node != nullptr, may_go_on, fence.is_cut_off(),
          present_step()};
}

void NodeRuntime::break_off(const std::string& why) {
  if (!restoration.break_off(why)) return;
  spdlog::error("region {}: the run ends in state {}: {}. {}", core::value_of(options.region), present_step(), why,
                cut::say_newest_saved(saving.folders(), saving.saved_by()));
}

void NodeRuntime::give_way(core::Step step) {
  fence.close(
      fmt::format("another process has taken over region {} in state {}", core::value_of(options.region), step));
  throw_away_after(step);
}

/// Drops the states after `step` that this process has computed and recorded alone. The run's world went on without
/// them.
void NodeRuntime::throw_away_after(core::Step step) {
  if (node->current_step() > step) {
    spdlog::warn("region {}: states {} to {} of this process are discarded", core::value_of(options.region), step + 1,
                 node->current_step());
  }
  if (records.is_replaced()) return records.close();
  record_after(step);
}

void NodeRuntime::send_restore(messages::RunCommand restore) {
  restore.run = options.run;
  restore.region = options.region;
  restore.rate = schedule.rate();
  publish_map(restore.generation, restore.at_step);
  restore.request = control().send(restore);
  restoration.use(restore);
  for (const messages::RunCommand& command : schedule.commands_to_repeat(restore)) control().send(command);
}

}  // namespace aurasim::process
