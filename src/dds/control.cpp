#include "dds/control.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "aurasim.h"
#include "dds/control_codec.h"
#include "dds/endpoints.h"
#include "dds/random_id.h"

namespace aurasim::dds {

using core::RegionId;
using core::value_of;

const char* name_of(NodeState state) {
  static constexpr std::array kNames = {"starting", "waiting", "running", "paused", "finished", "failed"};
  return kNames.at(static_cast<std::size_t>(state));
}

const char* name_of(RunCommandKind kind) {
  static constexpr std::array kNames = {"start", "pause", "resume", "step", "reset", "stop"};
  return kNames.at(static_cast<std::size_t>(kind));
}

struct ControlBus::Impl {
  Impl(Participant& participant, const ControlSettings& settings);

  void take_statuses();
  void mark_lost();

  Participant& participant;
  ControlSettings settings;
  std::uint64_t sender = draw_id();
  Wakeup wakeup;
  std::optional<Writer> status_writer;
  Reader status_reader;
  Writer map_writer;
  Reader map_reader;
  Writer command_writer;
  Reader command_reader;
  wire::NodeStatus status;  // reused for every sample
  wire::RegionMap map;
  wire::RunControl command;

  std::map<RegionId, SeenStatus> statuses;
  std::map<std::uint64_t, WorldMap> maps;
  std::set<std::uint64_t> requests;  ///< seen or sent
  WireErrors refused;
};

ControlBus::Impl::Impl(Participant& participant_in, const ControlSettings& settings_in)
    : participant(participant_in),
      settings(settings_in),
      status_reader(participant.domain(), {TopicId::kNodeStatus, {kEveryRegionPartition}, {}}, wakeup),
      map_writer(participant.domain(), in_world(TopicId::kRegionMap), wakeup),
      map_reader(participant.domain(), in_world(TopicId::kRegionMap), wakeup),
      command_writer(participant.domain(), in_world(TopicId::kRunControl), wakeup),
      command_reader(participant.domain(), in_world(TopicId::kRunControl), wakeup) {
  if (settings.region) {
    status_writer.emplace(participant.domain(),
                          EndpointSpec{TopicId::kNodeStatus, {partition_of(*settings.region)}, settings.region},
                          wakeup);
  }
}

void ControlBus::Impl::take_statuses() {
  while (status_reader.take(&status)) {
    auto decoded = decode(status, {});
    if (const auto* error = std::get_if<WireError>(&decoded)) {
      refused.add(*error);
      continue;
    }
    auto& fresh = std::get<Status>(decoded);
    const RegionId region = fresh.region;
    statuses[region] = {std::move(fresh), false, std::chrono::steady_clock::now()};
  }
}

/// The writer that was matched last speaks for its region: an earlier one is what a restart left behind.
void ControlBus::Impl::mark_lost() {
  for (const RemoteWriter& writer : status_reader.watch().writers()) {
    const std::int64_t region = participant.domain().directory().region_of(writer.guid);
    const auto found = region < 0 ? statuses.end() : statuses.find(static_cast<RegionId>(region));
    if (found != statuses.end()) {
      found->second.lost = writer.lost;
    }
  }
}

ControlBus::ControlBus(Participant& participant, const ControlSettings& settings)
    : impl_(std::make_unique<Impl>(participant, settings)) {}

ControlBus::~ControlBus() = default;

bool ControlBus::publish_status(const Status& status) {
  if (!impl_->status_writer || status.region != impl_->settings.region) {
    throw std::logic_error("publish_status: this process is not the node of that region");
  }
  impl_->participant.progress();
  encode(status, impl_->status);
  return impl_->status_writer->write(&impl_->status) != WriteResult::kFailed;
}

const std::map<RegionId, SeenStatus>& ControlBus::statuses() {
  impl_->participant.progress();
  impl_->take_statuses();
  impl_->mark_lost();
  return impl_->statuses;
}

bool ControlBus::publish_map(const WorldMap& map) {
  impl_->participant.progress();
  encode(map, impl_->map);
  return impl_->map_writer.write(&impl_->map) != WriteResult::kFailed;
}

void ControlBus::use_map(std::uint64_t map_version) { impl_->settings.map_version = map_version; }

const std::map<std::uint64_t, WorldMap>& ControlBus::maps() {
  impl_->participant.progress();
  while (impl_->map_reader.take(&impl_->map)) {
    auto decoded = decode(impl_->map, {});
    if (const auto* error = std::get_if<WireError>(&decoded)) {
      impl_->refused.add(*error);
      continue;
    }
    auto& map = std::get<WorldMap>(decoded);
    impl_->maps.insert_or_assign(map.map_version, std::move(map));
  }
  return impl_->maps;
}

std::uint64_t ControlBus::send(RunCommand command) {
  impl_->participant.progress();
  if (command.request == 0) {
    command.request = draw_id();
  }
  impl_->requests.insert(command.request);
  encode(command, impl_->sender, impl_->command);
  if (impl_->command_writer.write(&impl_->command) == WriteResult::kFailed) {
    throw DdsError(fmt::format("cannot send the command {}: run_control does not take it", name_of(command.kind)));
  }
  return command.request;
}

std::vector<RunCommand> ControlBus::take_commands() {
  impl_->participant.progress();
  std::vector<RunCommand> commands;
  Expected expected;
  expected.map_version = impl_->settings.map_version;
  while (impl_->command_reader.take(&impl_->command)) {
    auto decoded = decode(impl_->command, expected);
    if (const auto* error = std::get_if<WireError>(&decoded)) {
      impl_->refused.add(*error);
      continue;
    }
    const auto& command = std::get<RunCommand>(decoded);
    if (impl_->requests.insert(command.request).second) {
      commands.push_back(command);
    }
  }
  return commands;
}

void ControlBus::wait(std::chrono::nanoseconds time_out) {
  impl_->participant.progress();
  impl_->wakeup.wait(time_out);
  impl_->participant.progress();
}

std::size_t ControlBus::listeners() const { return impl_->command_writer.foreign_reader_count(); }

const WireErrors& ControlBus::refused() const { return impl_->refused; }

}  // namespace aurasim::dds
