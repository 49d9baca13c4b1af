// How a world begins on a node, and what is recorded and kept of it.
#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "host/stop_signal.h"
#include "process/exchange_choice.h"
#include "process/keepers.h"
#include "process/node_runtime.h"
#include "setup/launch_setup.h"

namespace aurasim::process {

std::unique_ptr<node::Node> NodeRuntime::make_node() {
  node::NodeSetup setup = setup::node_setup(launch, options.region, generation);
  setup.hash_states = options.report.has_value();
  setup.seams = transport().seams();
  if (options.world) endpoints.commands().bring(options.world->meshes);
  return std::make_unique<node::Node>(setup, launch.scene, launch.regions, transport());
}

void NodeRuntime::begin_generation(core::Generation next, const messages::RunCommand& begin) {
  core::Inbox mail = node ? std::move(node->mail()) : core::Inbox{};
  generation = status.content().era = next;
  checkpoints().begin_era(next);
  node = make_node();
  node->accept_early_mail(std::move(mail));
  endpoints.commands().begin_generation(*node, next);
  records.begin();
  schedule.begin_world(first_step(), begin, node::read_clocks());
  setpoints.begin_world();
  begin_with(options.world ? node->start(*options.world) : node->start());
  schedule.note_begun(first_step(), Clock::now());
}

/// To be called when the first state of a generation is there.
void NodeRuntime::begin_with(const node::StepReport& report) {
  changes.begin_world();
  restoration.begin_world();
  command_queue.begin(node->current_step(), Clock::now());
  if (recovers()) host::let_sigterm_ask_to_leave(options.has_launcher);
  notices.begin_refusals();
  records.forget_frames();
  saving.begin(start.start()->request, generation, node->current_step());
  if (launch.regions.size() > 1) checkpoints().use_keepers(keepers(), life);
  endpoints.observers().begin_generation(generation);
  endpoints.observers().after_step(*node, report);
  record(node->confirmed());
  endpoints.commands().after_step(report);
  saving.plan_checkpoint(*node);
}

void NodeRuntime::begin_restored(const messages::RunCommand& restore, const core::WorldCut& world,
                                 const std::map<core::RegionId, std::string>& parts) {
  const bool from_first = restore.count == 1;
  node = make_node();
  life_of_node = life;
  endpoints.commands().go_back(*node, generation);
  record_after(from_first ? std::nullopt : std::optional(restore.at_step));
  const bool is_sender = restore.region == options.region;
  schedule.go_back(restore, is_sender, first_step(), node::read_clocks());
  fence.begin_anew();
  checkpoints().go_back(restore.era, restore.at_step, parts);
  status.content().era = restore.era;
  begin_with(node->start(world, from_first ? node::Recorded::kNo : node::Recorded::kYes));
  const double waited_s = std::chrono::duration<double>(restoration.waited(Clock::now())).count();
  const std::string news = fmt::format("went back to state {} after {:.2f} s", node->current_step(), waited_s);
  spdlog::info("region {} {}", core::value_of(options.region), news);
  notices.note_news(news);
}

void NodeRuntime::begin_changed_map() {
  const node::NodeSetup setup = setup::node_setup(launch, options.region, generation);
  endpoints.observers().begin_generation(generation);
  endpoints.commands().change_map(generation, node->current_step());
  saving.change_map(start.start()->request, generation);
  endpoints.note_served_map();
  control().use_map(launch.regions.version());
  notices.begin_refusals();
  const node::StepReport& report = node->take_map(setup.protocol, launch.regions, transport(), transport().seams());
  endpoints.observers().after_step(*node, report);
  record(node->confirmed());
  publish_map(generation, node->current_step());
}

void NodeRuntime::record(std::span<const node::StepReport> reports) {
  for (const node::StepReport& report : reports) {
    notices.note_removals(report.removals);
    notices.note_cluster(report.largest_cluster, report.bodies, report.step,
                         remedy_for_heaps(launch, status.content().round_trip_ms, endpoints.stays_on_this_host()));
    setpoints.note_unbearable(report.unbearable);
    if (!report.put_back_from) saving.note_recorded(report.step);
    records.write(report);
  }
}

void NodeRuntime::record_after(std::optional<core::Step> step) {
  const std::string problem = records.go_on_after(step);
  if (!problem.empty()) notices.note_fault(fmt::format("nothing is recorded from here on: {}", problem));
}

/// The regions that keep this node's parts, chosen by the hosts of the present nodes.
std::vector<core::RegionId> NodeRuntime::keepers() {
  std::map<core::RegionId, std::uint16_t> hosts;
  for (const auto& [region, seen] : control().statuses()) hosts[region] = seen.host;
  return keepers_of(options.region, static_cast<std::uint32_t>(launch.regions.size()), hosts);
}

void NodeRuntime::keep_parts() {
  saving.keep_parts(*node, endpoints.commands(), checkpoints(), records.recorder());
  saving.receive(control().statuses());
  saving.reply(endpoints.commands());
  note_messages_of_saves();
}

void NodeRuntime::note_messages_of_saves() {
  for (std::string& words : saving.take_words()) notices.note_news(std::move(words));
}

void NodeRuntime::conclude_saves() {
  saving.conclude(endpoints.commands(), control().statuses(), !fence.closed() && has_reached_the_end());
  note_messages_of_saves();
}

bool NodeRuntime::has_reached(core::Step step) const {
  return node && node->current_step() >= step && node->confirmed_step() >= step;
}

bool NodeRuntime::has_reached_the_end() const { return schedule.stop_at() && has_reached(*schedule.stop_at()); }

}  // namespace aurasim::process
