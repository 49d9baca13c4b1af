// What clients ask of a node, and the changes of a whole run while it runs: its rate, another scene, other regions. All
// nodes come to a change after the same state.
#include <algorithm>
#include <functional>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "cli/launch_setup.h"
#include "cli/node_process.h"
#include "cli/stop_signal.h"
#include "config/launch_variants.h"
#include "dds/replica_bus.h"
#include "node/repartition.h"

namespace aurasim::cli {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPatienceWithOthers = 20s;
constexpr auto kRound = 5ms;
constexpr double kRateNoticeS = 0.1;
constexpr int kMostFailedChanges = 3;  // in a row

/// What went wrong and with whom.
class ChangeFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What all regions say that they host.
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

void NodeProcess::execute(const dds::RunCommand& command) {
  using Kind = dds::RunCommandKind;
  if (command.kind == Kind::kStart) {
    const bool is_awaited = !start_ && command.generation == waits_to_start_;
    if (is_awaited && can_be_meant(command)) start_ = with_clock_of(core::RegionId{0}, command);
    return;
  }
  if (command.kind == Kind::kLost) return control_.hear_of_death(command);
  if (command.kind == Kind::kRestore) {
    if (can_be_meant(command)) hear_of_restore(command);
    return;
  }
  if (command.kind == Kind::kDrain) return hear_of_drain(command);
  if (command.generation > generation_ && restore_ && command.generation == restore_->generation) {
    early_.push_back(command);
  }
  if (restore_ && command.generation < restore_->generation) return late_.push_back(command);
  if (command.generation != generation_ || !node_) return;  // for a run that is over
  if (!can_be_meant(command)) return;
  switch (command.kind) {
    case Kind::kStart:
    case Kind::kLost:
    case Kind::kRestore:
    case Kind::kDrain:
    case Kind::kTake:
      break;
    case Kind::kPause:
      hold_at_ = command.at_step;
      hurry_until_ = std::max(hurry_until_, command.at_step);
      break;
    case Kind::kStep:
      if (hold_at_) {
        pacer_.set_epoch(*hold_at_ + 1, command.epoch_ns, command.clock_ahead, node::read_clocks());
        hold_at_ = *hold_at_ + command.count;
      }
      break;
    case Kind::kResume:
      if (hold_at_) pacer_.set_epoch(*hold_at_ + 1, command.epoch_ns, command.clock_ahead, node::read_clocks());
      hold_at_.reset();
      break;
    case Kind::kReset:
      reset_ = command;
      hurry_until_ = std::max(hurry_until_, command.at_step);
      break;
    case Kind::kStop:
      stop_at_ = std::min(stop_at_.value_or(command.at_step), command.at_step);
      hurry_until_ = std::max(hurry_until_, command.at_step);
      break;
    case Kind::kRate:
      pacer_.set_rate(command.rate, command.at_step, command.epoch_ns, command.clock_ahead, node::read_clocks());
      status_.rate = command.rate;
      break;
  }
}

/// What was said to the world that all have left, as they did: some might have obeyed and some not. So all do what the
/// one who says where all go back to says once more.
void NodeProcess::obey_late_commands() {
  for (dds::RunCommand command : std::exchange(late_, {})) {
    if (restore_->region != options_.region) continue;
    command.generation = generation_;
    command.request = 0;
    command.request = control_.send(command);
    execute(command);
  }
}

bool NodeProcess::can_be_meant(const dds::RunCommand& command) {
  const std::string why = run_control_limits_.problem_with(command, std::max({generation_, restoring_, status_.era}),
                                                           node::wall_clock_ns());
  if (!why.empty()) control_.refuse(command, why);
  return why.empty();
}

void NodeProcess::reset_if_due() {
  if (!reset_ || node_->current_step() < reset_->at_step) return;
  const dds::RunCommand reset = *reset_;
  reset_.reset();
  enter(NodeEvent::kReset);
  begin_generation(reset.generation + 1, reset);
}

/// The state of a change has been computed, and is still to be confirmed: what is ordered now would not reach all
/// before they stop for it.
bool NodeProcess::is_about_to_change() const {
  return std::ranges::any_of(run_orders_, [this](const core::Order& order) {
    return core::changes_the_run(order.action) && node_->current_step() >= order.at_step;
  });
}

/// The live node of the lowest region gives commands their place in time.
void NodeProcess::serve_clients() {
  if (is_about_to_change()) return;
  const auto& statuses = control_.statuses();
  const auto is_ours = [this](const dds::SeenStatus& seen) { return seen.status.agreement == status_.agreement; };
  RunView run;
  run.leads = true;
  for (const auto& [region, seen] : statuses) {
    if (!is_ours(seen)) continue;
    run.facts.complete = run.facts.complete && seen.is_live();
    if (!seen.is_live()) continue;
    run.facts.bodies += seen.status.bodies;
    run.leads = run.leads && region >= options_.region;
  }
  run.lacking = [&statuses, is_ours](std::uint64_t mesh) {
    std::vector<core::RegionId> lacking;
    for (const auto& [region, seen] : statuses) {
      const std::vector<std::uint64_t>& known = seen.status.meshes;
      const bool has_it = std::find(known.begin(), known.end(), mesh) != known.end();
      if (is_ours(seen) && seen.is_live() && !has_it) lacking.push_back(region);
    }
    return lacking;
  };
  run.holds_at = hold_at_;
  command_server_->serve(*node_, run);
  save_what_is_kept();
  if (run.leads) {
    save_regularly();
    compute_until_change();
    step_back(run);
  }
  status_.meshes = command_server_->meshes();
  if (const std::optional<double> rate = command_server_->take_wanted_rate()) change_rate(*rate);
}

/// All nodes are told outside the steps, which may be seconds apart. The step that would be due in a moment stays due
/// then, and from it on the new rate holds.
void NodeProcess::change_rate(double rate) {
  const double steps = std::min(pacer_.rate(), 1.0) * kRateNoticeS / launch_.step_s();
  dds::RunCommand command;
  command.kind = dds::RunCommandKind::kRate;
  command.generation = generation_;
  command.at_step = node_->current_step() + 1 + static_cast<core::Step>(steps);
  command.epoch_ns = node::wall_clock_ns() + static_cast<std::int64_t>(1e9 * kRateNoticeS);
  command.rate = rate;
  command.request = control_.send(command);
  execute(command);
}

/// A change of the run comes after a state, which has to be certain. In a pause all compute up to there, and stand
/// again in the first state of what is new.
void NodeProcess::compute_until_change() {
  const std::optional<core::Step> change = command_server_->change_at();
  if (!change || !hold_at_ || node_->current_step() < *hold_at_) return;
  const core::Step until_certain = node_->current_step() - node_->confirmed_step();
  dds::RunCommand command;
  command.kind = dds::RunCommandKind::kStep;
  command.generation = generation_;
  command.run = options_.run;
  command.count = std::max<core::Step>(1, *change + until_certain - *hold_at_);
  command.at_step = *hold_at_ + command.count;
  command.epoch_ns = node::wall_clock_ns() + static_cast<std::int64_t>(1e9 * kRateNoticeS);
  command.request = control_.send(command);
  execute(command);
}

/// Orders about the run as a whole whose state has been computed.
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

void NodeProcess::change_if_due() {
  if (!change_) return;
  const core::Order order = *std::exchange(change_, std::nullopt);
  before_change_ = BeforeChange{launch_, options_.world};
  const bool stands = hold_at_.has_value();
  try {
    if (const auto* scene = std::get_if<core::ChangeScene>(&order.action)) change_scene(scene->name);
    if (const auto* regions = std::get_if<core::Repartition>(&order.action)) change_regions(regions->boxes);
    if (const auto* load = std::get_if<core::Load>(&order.action)) change_world(load->file);
  } catch (const ChangeFailed& failed) {
    // All are here, and what they had before can be gone back to: then it is tried once more.
    if (!recovers() || stop_requested() || ++failed_changes_ > kMostFailedChanges) throw;
    throw SomebodyDied(failed.what());
  }
  failed_changes_ = 0;
  life_of_node_ = life_;
  before_change_.reset();
  if (stands) hold_at_ = node_->current_step();
}

/// Bodies of the old scene are forgotten; the regions stay.
void NodeProcess::change_scene(const std::string& name) {
  launch_ = config::with_scene(launch_, name);
  options_.world.reset();
  spdlog::info("scene {} after step {}", name, node_->current_step());
  begin_anew();
}

/// The regions stay as they are, whatever they were when it was saved.
void NodeProcess::change_world(const std::string& file) {
  options_.world = load_world({(options_.saves / file).string(), false}, launch_);
  spdlog::info("{}, state {}, after step {}", file, first_step(), node_->current_step());
  begin_anew();
}

/// The agreement is that of the beginning, whatever has changed since.
void NodeProcess::publish_map(core::Generation generation, core::Step from_step) {
  dds::WorldMap map = world_map(launch_);
  map.agreement = status_.agreement;
  map.generation = generation;
  map.from_step = from_step;
  control_.publish_map(map);
}

void NodeProcess::begin_anew() {
  wait_until_all_stand();
  waits_to_start_ = generation_ + 1;
  publish_map(waits_to_start_, first_step());  // first: observers read the new scene before its bodies come
  node_.reset();
  connect_anew(neighbour_transport(launch_, options_.region));
  begin_generation(waits_to_start_, *start_);
}

/// What we have sent may still have to be repeated: nobody closes a transport before all have what they wait for.
void NodeProcess::wait_until_all_stand() {
  enter(NodeEvent::kChanges);
  const auto deadline = Clock::now() + kPatienceWithOthers;
  const auto stands = [this](const auto& entry) {
    const dds::Status& status = entry.second.status;
    const bool is_here = status.state == dds::NodeState::kPaused && status.generation == generation_ &&
                         status.step >= node_->current_step();
    return entry.first == options_.region || is_here || status.generation > generation_;
  };
  for (;;) {
    publish();
    const auto& statuses = control_.statuses();
    if (std::all_of(statuses.begin(), statuses.end(), stands)) return;
    execute_commands();
    look_for_deaths();
    if (Clock::now() > deadline || stop_requested()) {
      throw ChangeFailed(fmt::format("step {}: not every node has come to the change", node_->current_step()));
    }
    control_.wait(5ms);
  }
}

/// Waits until every body that was on its way to us is here.
void NodeProcess::settle_all() {
  if (node_->settled()) return;
  const auto deadline = Clock::now() + kPatienceWithOthers;
  while (!node_->ready_to_settle()) {
    look_for_deaths();
    if (Clock::now() > deadline || stop_requested()) {
      throw ChangeFailed("new regions: a neighbour has not come to this state");
    }
    transport_->wait_for_arrival(5ms);
  }
  const node::StepReport& report = node_->settle();
  if (recorder_) recorder_->write_settling(report);
}

/// Another transport; returns when all nodes have theirs and region 0 says when to go on. It meets those that others
/// have made for this change, and not what they are about to let go of: what is sent to that is lost.
void NodeProcess::connect_anew(dds::TransportSettings settings) {
  settings.life = life_ = waits_to_start_;
  transport_.reset();
  transport_.emplace(participant_, settings);
  const auto deadline = Clock::now() + kPatienceWithOthers;
  while (!transport_->all_matched()) {
    if (Clock::now() > deadline) transport_->wait_until_matched(0ns);  // says who is missing
    if (stop_requested()) throw ChangeFailed("told to stop while the run changes");
    execute_commands();
    look_for_deaths();
    control_.wait(10ms);
  }
  generation_ = waits_to_start_;
  start_.reset();
  enter(NodeEvent::kStands);
  while (!start_) {
    if (Clock::now() > deadline || stop_requested()) throw ChangeFailed("the run does not go on after a change");
    publish();
    start_when_all_wait();
    execute_commands();
    look_for_deaths();
    control_.wait(10ms);
  }
  enter(NodeEvent::kStarted);
}

void NodeProcess::change_regions(const std::vector<core::Rectangle>& boxes) {
  settle_all();
  wait_until_all_stand();
  const auto deadline = Clock::now() + kPatienceWithOthers;
  const auto changed = std::make_unique<config::Launch>(config::with_regions(launch_, boxes));
  const node::RepartitionSettings settings = {options_.region, generation_ + 1, aura_rules(*changed),
                                              &changed->regions};
  observers_->use_map(changed->regions.version());  // the old map's observers have nothing to do with it
  observers_->publish_census(*node_, settings.census);
  const std::vector<core::Departure> departures = node::find_new_hosts(
      settings, take_census(settings, deadline, participant_, *node_, [this] { look_for_deaths(); }), *node_);

  dds::TransportSettings to_all = neighbour_transport(*changed, options_.region);
  to_all.neighbours.clear();
  for (std::uint32_t r = 0; r < changed->regions.size(); ++r) {
    if (core::RegionId{r} != options_.region) to_all.neighbours.push_back(core::RegionId{r});
  }
  waits_to_start_ = settings.census;
  connect_anew(to_all);
  node::StepReport moved;
  moved.step = node_->current_step();
  node::Exchange exchange(settings, departures, *transport_, *node_);
  while (!exchange.ready()) {
    look_for_deaths();
    if (Clock::now() > deadline) {
      throw ChangeFailed(fmt::format("new regions: regions {} have not sent their bodies", exchange.silent()));
    }
    transport_->wait_for_arrival(kRound);
  }
  for (const node::HandOffRow& row : exchange.finish()) {
    (row.source == options_.region ? moved.departures : moved.arrivals).push_back(row);
  }
  wait_until_all_stand();
  if (recorder_) recorder_->write_settling(moved);
  status_.hand_offs_out += moved.departures.size();
  status_.hand_offs_in += moved.arrivals.size();

  launch_ = *changed;
  status_.map_version = launch_.regions.version();
  status_.footprint = launch_.regions.region(options_.region);
  waits_to_start_ = settings.census + 1;
  connect_anew(neighbour_transport(launch_, options_.region));
  const node::NodeSetup setup = node_setup(launch_, options_.region, generation_);
  observers_->begin_generation(generation_);
  command_server_->change_map(generation_, node_->current_step());
  served_map_ = launch_.regions.version();
  control_.use_map(launch_.regions.version());
  refusals_noted_ = 0;
  const node::StepReport& report = node_->take_map(setup.protocol, launch_.regions, *transport_);
  observers_->after_step(*node_, report);
  record(node_->confirmed());
  pacer_.set_epoch(node_->current_step() + 1, start_->epoch_ns, start_->clock_ahead, node::read_clocks());
  publish_map(generation_, node_->current_step());
  spdlog::info("new regions after step {}: {} bodies sent, {} taken in", node_->current_step(), moved.departures.size(),
               moved.arrivals.size());
}

}  // namespace aurasim::cli
