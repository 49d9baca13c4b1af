#include "dds/control.h"

#include <algorithm>
#include <array>
#include <deque>
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
  static constexpr std::array kNames = {"starting", "waiting", "running",    "paused",
                                        "finished", "failed",  "recovering", "spare"};
  return kNames.at(static_cast<std::size_t>(state));
}

const char* name_of(RunCommandKind kind) {
  static constexpr std::array kNames = {"start", "pause", "resume",  "step",  "reset", "stop",
                                        "rate",  "lost",  "restore", "drain", "take"};
  return kNames.at(static_cast<std::size_t>(kind));
}

namespace {

/// What one process has published last.
struct Received {
  Guid writer;
  SeenStatus seen;
  std::deque<std::chrono::nanoseconds> clock_ahead;  ///< by the last samples
};

/// A sample that was long on its way makes its sender's clock look late: the fastest tells best. Of the last second, as
/// clocks may be set.
constexpr std::size_t kSamplesOfAClock = 10;

/// Where Fast DDS matched a writer anew, the later match counts.
bool is_lost(const std::vector<RemoteWriter>& writers, const Guid& guid) {
  const auto found = std::find_if(writers.rbegin(), writers.rend(), [&](const auto& w) { return w.guid == guid; });
  return found == writers.rend() || found->lost;
}

}  // namespace

struct ControlBus::Impl {
  Impl(Participant& participant, const ControlSettings& settings);

  void take_statuses();
  void note(Status status, const Origin& origin);
  void look();
  void choose_publisher(RegionId region, const std::vector<Received>& of_region);
  bool is_of_the_run(const Received& one) const;

  Participant& participant;
  ControlSettings settings;
  std::uint64_t sender = draw_id();
  Wakeup wakeup;
  std::optional<Writer> status_writer;
  Reader status_reader;
  std::optional<Writer> map_writer;
  Reader map_reader;
  std::optional<Writer> command_writer;
  std::optional<Reader> command_reader;
  wire::NodeStatus status;  // reused for every sample
  wire::RegionMap map;
  wire::RunControl command;

  std::map<RegionId, std::vector<Received>> received;  ///< in order of the first sample
  std::map<RegionId, Guid> publishers;
  std::map<RegionId, SeenStatus> statuses;
  std::map<std::uint64_t, WorldMap> maps;
  std::set<std::uint64_t> dead;      ///< processes that have ended
  std::set<std::uint64_t> requests;  ///< seen or sent
  WireErrors refused;
};

ControlBus::Impl::Impl(Participant& participant_in, const ControlSettings& settings_in)
    : participant(participant_in),
      settings(settings_in),
      status_reader(participant.domain(), {TopicId::kNodeStatus, {kEveryRegionPartition}, {}}, wakeup),
      map_reader(participant.domain(), in_world(TopicId::kRegionMap), wakeup) {
  if (!settings.only_watches) {
    command_writer.emplace(participant.domain(), in_world(TopicId::kRunControl), wakeup);
    command_reader.emplace(participant.domain(), in_world(TopicId::kRunControl), wakeup);
  }
  if (settings.region) {
    status_writer.emplace(participant.domain(),
                          EndpointSpec{TopicId::kNodeStatus, {partition_of(*settings.region)}, settings.region},
                          wakeup);
    map_writer.emplace(participant.domain(), in_world(TopicId::kRegionMap), wakeup);
  }
}

void ControlBus::Impl::take_statuses() {
  Origin origin;
  while (status_reader.take(&status, &origin)) {
    auto decoded = decode(status, {});
    if (const auto* error = std::get_if<WireError>(&decoded)) {
      refused.add(*error);
    } else {
      note(std::move(std::get<Status>(decoded)), origin);
    }
  }
}

void ControlBus::Impl::note(Status fresh, const Origin& origin) {
  std::vector<Received>& of_region = received[fresh.region];
  auto found = std::ranges::find(of_region, origin.writer, &Received::writer);
  if (found == of_region.end()) {
    found = of_region.insert(found, {origin.writer, {}, {}});
  }
  found->seen.status = std::move(fresh);
  found->seen.seen = std::chrono::steady_clock::now();
  found->clock_ahead.push_back(origin.clock_ahead);
  if (found->clock_ahead.size() > kSamplesOfAClock) found->clock_ahead.pop_front();
  found->seen.clock_ahead = std::ranges::max(found->clock_ahead);
}

/// Whose proof of life has ended, and whose status stands for each region now.
void ControlBus::Impl::look() {
  const std::vector<RemoteWriter> writers = status_reader.watch().writers();
  for (auto& [region, of_region] : received) {
    for (Received& one : of_region) {
      one.seen.dead = dead.contains(one.seen.status.process);
      one.seen.lost = one.seen.dead || is_lost(writers, one.writer);
    }
    if (region != kNoRegion) choose_publisher(region, of_region);
    std::erase_if(of_region, [&](const Received& one) { return one.seen.lost && one.writer != publishers[region]; });
  }
}

void ControlBus::Impl::choose_publisher(RegionId region, const std::vector<Received>& of_region) {
  const Received* chosen = nullptr;
  for (const Received& one : of_region) {
    if (!is_of_the_run(one)) continue;
    const bool stands = publishers.contains(region) && publishers[region] == one.writer;
    const bool is_better = chosen == nullptr || (one.seen.is_live() && !chosen->seen.is_live()) ||
                           (stands && one.seen.is_live() == chosen->seen.is_live());
    if (is_better) chosen = &one;
  }
  if (chosen == nullptr) return;
  publishers[region] = chosen->writer;
  statuses[region] = chosen->seen;
}

bool ControlBus::Impl::is_of_the_run(const Received& one) const {
  const Status& s = one.seen.status;
  if (settings.agreement && s.agreement != *settings.agreement) return false;
  if (settings.run && s.run != *settings.run) return false;
  return settings.region != s.region || one.writer == status_writer->guid();
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
  impl_->look();
  return impl_->statuses;
}

std::vector<SeenStatus> ControlBus::strangers() {
  statuses();
  std::vector<SeenStatus> strangers;
  for (const auto& [region, of_region] : impl_->received) {
    for (const Received& one : of_region) {
      if (region != kNoRegion && one.seen.is_live() && !impl_->is_of_the_run(one)) strangers.push_back(one.seen);
    }
  }
  return strangers;
}

void ControlBus::hold_for_dead(std::uint64_t process) { impl_->dead.insert(process); }

std::vector<Status> ControlBus::spares() {
  statuses();
  std::vector<Status> spares;
  for (const Received& one : impl_->received[kNoRegion]) {
    if (one.seen.is_live() && impl_->is_of_the_run(one)) spares.push_back(one.seen.status);
  }
  return spares;
}

bool ControlBus::publish_map(const WorldMap& map) {
  if (!impl_->map_writer) throw std::logic_error("publish_map: this process is no node");
  impl_->participant.progress();
  encode(map, impl_->map);
  return impl_->map_writer->write(&impl_->map) != WriteResult::kFailed;
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
  if (!impl_->command_writer) throw std::logic_error("send: this process only watches");
  impl_->participant.progress();
  if (command.request == 0) {
    command.request = draw_id();
  }
  impl_->requests.insert(command.request);
  encode(command, impl_->sender, impl_->command);
  if (impl_->command_writer->write(&impl_->command) == WriteResult::kFailed) {
    throw DdsError(fmt::format("cannot send the command {}: run_control does not take it", name_of(command.kind)));
  }
  return command.request;
}

std::vector<RunCommand> ControlBus::take_commands() {
  impl_->participant.progress();
  std::vector<RunCommand> commands;
  if (!impl_->command_reader) return commands;
  Expected expected;
  expected.map_version = impl_->settings.map_version;
  Origin origin;
  while (impl_->command_reader->take(&impl_->command, &origin)) {
    auto decoded = decode(impl_->command, expected);
    if (const auto* error = std::get_if<WireError>(&decoded)) {
      impl_->refused.add(*error);
      continue;
    }
    auto& command = std::get<RunCommand>(decoded);
    if (impl_->settings.run && command.run != 0 && command.run != *impl_->settings.run) continue;
    command.clock_ahead = origin.clock_ahead;
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

std::size_t ControlBus::listeners() const {
  return impl_->command_writer ? impl_->command_writer->foreign_reader_count() : 0;
}

const WireErrors& ControlBus::refused() const { return impl_->refused; }

}  // namespace aurasim::dds
