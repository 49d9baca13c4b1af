#include "dds/control.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <deque>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "aurasim.h"
#include "dds/control_codec.h"
#include "dds/endpoints.h"
#include "dds/random_id.h"
#include "dds/rate_limit.h"

namespace aurasim::dds {

using core::RegionId;
using core::value_of;

const char* name_of(NodeState state) {
  static constexpr std::array kNames = {"starting", "waiting",    "running", "paused", "finished",
                                        "failed",   "recovering", "spare",   "cut off"};
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

std::uint16_t host_of(const Guid& guid) {
  return static_cast<std::uint16_t>(guid.guidPrefix.value[2] << 8 | guid.guidPrefix.value[3]);
}

/// Of what is kept of others, whoever they are.
constexpr std::size_t kMostOfARegion = 64;   ///< processes that say that they are its node
constexpr std::size_t kMostOfNoRegion = 64;  ///< and of all regions that the run has not
constexpr std::size_t kMostMaps = 256;
constexpr std::size_t kMostRequests = 1U << 16U;
constexpr std::size_t kMostClaims = 1024;
constexpr std::size_t kMostWaiting = 64;
constexpr auto kUntilKnown = std::chrono::seconds(3);
constexpr auto kLongAgo = std::chrono::seconds(1);
/// Statuses come ten times a second.
constexpr auto kShowsNoLife = std::chrono::milliseconds(300);

/// A process that only waits does nobody harm: a successor does, and a second launch of the same file by mistake.
bool acts(const Status& status) {
  return status.state == NodeState::kRunning || status.state == NodeState::kPaused ||
         status.state == NodeState::kRecovering;
}

/// Which of a region's processes is its node: of those that live, one that has not only come to take over from another.
int rank_of(const SeenStatus& seen) { return !seen.is_live() ? 0 : seen.status.state == NodeState::kSpare ? 1 : 2; }

/// Where Fast DDS matched a writer anew, the later match counts.
bool is_lost(const std::vector<RemoteWriter>& writers, const Guid& guid) {
  const auto found = std::find_if(writers.rbegin(), writers.rend(), [&](const auto& w) { return w.guid == guid; });
  return found == writers.rend() || found->lost;
}

struct HeardCommand {
  RunCommand command;
  Origin origin;
  std::chrono::steady_clock::time_point since;
};

/// Late joiners are told what was said long before, by nodes that have been replaced since.
bool is_old_news(const RunCommand& command, const Origin& origin) {
  const bool is_of_nodes = command.kind == RunCommandKind::kStart || command.kind == RunCommandKind::kRestore;
  return is_of_nodes && origin.clock_ahead < -kLongAgo;
}

}  // namespace

struct ControlBus::Impl {
  Impl(Participant& participant, const ControlSettings& settings);

  void take_statuses();
  void note(Status status, const Origin& origin);
  std::string problem_with(const Status& status, const Origin& origin) const;
  std::string problem_with(const RunCommand& command, const Origin& origin) const;
  void judge(HeardCommand heard, std::vector<RunCommand>& commands);
  bool is_region(RegionId region) const { return region != kNoRegion && value_of(region) < settings.region_count; }
  bool has_room_for(RegionId region) const;
  bool shows_no_life(const Received& one) const;
  bool remember(std::uint64_t request, const Guid& sender);
  bool is_of(std::uint64_t process, const Origin& origin) const;
  bool is_of(RegionId region, const Origin& origin) const;
  void look();
  void choose_publisher(RegionId region, const std::vector<Received>& of_region);
  bool is_of_the_run(const Status& status, const Guid& writer) const;
  bool is_of_the_run(const Received& one) const { return is_of_the_run(one.seen.status, one.writer); }

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
  std::map<std::pair<std::uint64_t, Guid>, WorldMap> announced;  ///< by version and writer
  std::map<std::uint64_t, WorldMap> maps;
  std::set<std::uint64_t> dead;                ///< processes that have ended
  std::set<std::uint64_t> claimed;             ///< others say so
  std::map<std::uint64_t, Guid> requests;      ///< seen or sent, and by whom
  std::vector<HeardCommand> waiting;           ///< of nodes, if it is they who have said it
  std::deque<std::uint64_t> request_sequence;  ///< oldest first
  RateLimit<Guid> against_statuses{1, 1};
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
      status_reader.refuse_from(origin, *error);
    } else {
      note(std::move(std::get<Status>(decoded)), origin);
    }
  }
}

/// Empty: none.
std::string ControlBus::Impl::problem_with(const Status& fresh, const Origin& origin) const {
  const std::uint32_t number = value_of(fresh.region);
  if (!participant.domain().speakers().is_at_home(origin.writer, fresh.region)) {
    return fmt::format("it speaks of region {} where others do", number);
  }
  const auto known = statuses.find(fresh.region);
  const bool has_node =
      known != statuses.end() && rank_of(known->second) == 2 && publishers.at(fresh.region) != origin.writer;
  const bool says_so = has_node && acts(fresh) && is_of_the_run(fresh, origin.writer);
  return says_so ? fmt::format("region {} has another node", number) : std::string();
}

bool ControlBus::Impl::has_room_for(RegionId region) const {
  if (is_region(region) || region == kNoRegion) {
    const auto known = received.find(region);
    return known == received.end() || known->second.size() < kMostOfARegion;
  }
  std::size_t others = 0;
  for (const auto& [other, of_region] : received) others += is_region(other) ? 0 : of_region.size();
  return others < kMostOfNoRegion;
}

void ControlBus::Impl::note(Status fresh, const Origin& origin) {
  if (const std::string problem = problem_with(fresh, origin); !problem.empty()) {
    refused.add(WireError::kSource);
    // A node that was started anew before the old one is known to be dead says so for some seconds.
    if (against_statuses.allows(origin.writer, std::chrono::steady_clock::now())) {
      status_reader.refuse_from(origin, problem);
    }
    return;
  }
  if (!has_room_for(fresh.region)) return;
  std::vector<Received>& of_region = received[fresh.region];
  auto found = std::ranges::find(of_region, origin.writer, &Received::writer);
  if (found == of_region.end()) {
    found = of_region.insert(found, {origin.writer, {}, {}});
  }
  found->seen.status = std::move(fresh);
  found->seen.seen = std::chrono::steady_clock::now();
  found->seen.host = host_of(origin.writer);
  found->clock_ahead.push_back(origin.clock_ahead);
  if (found->clock_ahead.size() > kSamplesOfAClock) found->clock_ahead.pop_front();
  found->seen.clock_ahead = std::ranges::max(found->clock_ahead);
}

/// Whose proof of life has ended, and whose status stands for each region now.
void ControlBus::Impl::look() {
  const std::vector<RemoteWriter> writers = status_reader.watch().writers();
  for (auto& [region, of_region] : received) {
    for (Received& one : of_region) {
      if (claimed.contains(one.seen.status.process) && shows_no_life(one)) dead.insert(one.seen.status.process);
      one.seen.dead = dead.contains(one.seen.status.process);
      one.seen.lost = one.seen.dead || is_lost(writers, one.writer);
    }
    if (is_region(region)) choose_publisher(region, of_region);
    std::erase_if(of_region, [&](const Received& one) { return one.seen.lost && one.writer != publishers[region]; });
  }
}

void ControlBus::Impl::choose_publisher(RegionId region, const std::vector<Received>& of_region) {
  const Received* chosen = nullptr;
  for (const Received& one : of_region) {
    if (!is_of_the_run(one)) continue;
    const bool stands = publishers.contains(region) && publishers[region] == one.writer;
    const int rank = rank_of(one.seen);
    const bool is_better =
        chosen == nullptr || rank > rank_of(chosen->seen) || (stands && rank == rank_of(chosen->seen));
    if (is_better) chosen = &one;
  }
  if (chosen == nullptr) return;
  publishers[region] = chosen->writer;
  statuses[region] = chosen->seen;
  participant.domain().speakers().set(region, chosen->writer.guidPrefix);
}

/// On this host its process is looked for; elsewhere, who lives says something.
bool ControlBus::Impl::shows_no_life(const Received& one) const {
  if (!participant.stays_on_this_host()) return std::chrono::steady_clock::now() > one.seen.seen + kShowsNoLife;
  const auto pid = static_cast<::pid_t>(one.seen.status.pid);
  return pid <= 0 || (::kill(pid, 0) != 0 && errno == ESRCH);
}

bool ControlBus::Impl::remember(std::uint64_t request, const Guid& sender) {
  if (!requests.try_emplace(request, sender).second) return false;
  request_sequence.push_back(request);
  if (request_sequence.size() > kMostRequests) {
    requests.erase(request_sequence.front());
    request_sequence.pop_front();
  }
  return true;
}

/// Does this process itself speak?
bool ControlBus::Impl::is_of(std::uint64_t process, const Origin& origin) const {
  return std::ranges::any_of(received, [&](const auto& entry) {
    return std::ranges::any_of(entry.second, [&](const Received& one) {
      return one.seen.status.process == process && one.writer.guidPrefix == origin.writer.guidPrefix;
    });
  });
}

/// Is it a node of that region, or about to be one? Of two, one may not yet be known to have died.
bool ControlBus::Impl::is_of(RegionId region, const Origin& origin) const {
  const auto known = received.find(region);
  return known != received.end() && std::ranges::any_of(known->second, [&](const Received& one) {
           return is_of_the_run(one) && one.writer.guidPrefix == origin.writer.guidPrefix;
         });
}

/// Empty: none. What operators say, and launchers, anybody may say.
std::string ControlBus::Impl::problem_with(const RunCommand& asked, const Origin& origin) const {
  const Speakers& speakers = participant.domain().speakers();
  const bool is_first_node = speakers.may_speak(origin.writer, RegionId{0}) || is_of(RegionId{0}, origin);
  const bool is_node = speakers.is_node(origin.writer);
  const bool is_of_its_region = speakers.may_speak(origin.writer, asked.region);
  switch (asked.kind) {
    case RunCommandKind::kStart:
      return is_first_node ? "" : "only the node of region 0 starts a run";
    case RunCommandKind::kRate:
      return is_node ? "" : "only a node of the run sets its rate";
    case RunCommandKind::kRestore:
      return is_node && is_of_its_region ? "" : "only the node of a region says where all go back to";
    default:
      return {};
  }
}

bool ControlBus::Impl::is_of_the_run(const Status& s, const Guid& writer) const {
  if (!is_region(s.region) && s.region != kNoRegion) return false;
  if (participant.domain().speakers().shuns(writer.guidPrefix)) return false;
  if (settings.agreement && s.agreement != *settings.agreement) return false;
  if (settings.run && s.run != *settings.run) return false;
  return settings.region != s.region || writer == status_writer->guid();
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

void ControlBus::hear_of_death(const RunCommand& lost) {
  if (lost.is_of_itself) return hold_for_dead(lost.process);
  for (const auto& [region, of_region] : impl_->received) {
    const auto meant =
        std::ranges::find(of_region, lost.process, [](const Received& one) { return one.seen.status.process; });
    if (meant == of_region.end()) continue;
    if (impl_->participant.stays_on_this_host() && !impl_->shows_no_life(*meant))
      return refuse(lost, "its process lives");
    if (impl_->claimed.size() < kMostClaims) impl_->claimed.insert(lost.process);
  }
}

std::vector<Status> ControlBus::spares() {
  statuses();
  std::vector<Status> spares;
  for (const Received& one : impl_->received[kNoRegion]) {
    if (one.seen.is_live() && impl_->is_of_the_run(one)) spares.push_back(one.seen.status);
  }
  return spares;
}

bool ControlBus::publish_map(const WorldMap& map) {
  // In a run with keys only nodes may: nobody else has a writer before it is asked for.
  if (!impl_->map_writer) {
    impl_->map_writer.emplace(impl_->participant.domain(), in_world(TopicId::kRegionMap), impl_->wakeup);
  }
  impl_->participant.progress();
  encode(map, impl_->map);
  return impl_->map_writer->write(&impl_->map) != WriteResult::kFailed;
}

void ControlBus::use_map(std::uint64_t map_version) { impl_->settings.map_version = map_version; }

const std::map<std::uint64_t, WorldMap>& ControlBus::maps() {
  impl_->participant.progress();
  Origin origin;
  while (impl_->map_reader.take(&impl_->map, &origin)) {
    auto decoded = decode(impl_->map, {});
    if (const auto* error = std::get_if<WireError>(&decoded)) {
      impl_->refused.add(*error);
      impl_->map_reader.refuse_from(origin, *error);
      continue;
    }
    auto& map = std::get<WorldMap>(decoded);
    const std::pair by{map.map_version, origin.writer};
    if (impl_->announced.size() < kMostMaps || impl_->announced.contains(by) ||
        impl_->participant.domain().speakers().is_node(origin.writer)) {
      impl_->announced.insert_or_assign(by, std::move(map));
    }
  }
  impl_->maps.clear();
  for (const auto& [by, map] : impl_->announced) {
    const bool is_ours = impl_->settings.agreement && map.agreement == *impl_->settings.agreement;
    if (is_ours && !impl_->participant.domain().speakers().is_node(by.second)) continue;
    const auto [known, is_first] = impl_->maps.try_emplace(by.first, map);
    if (!is_first && map.generation > known->second.generation) known->second = map;
  }
  return impl_->maps;
}

std::uint64_t ControlBus::send(RunCommand command) {
  if (!impl_->command_writer) throw std::logic_error("send: this process only watches");
  impl_->participant.progress();
  if (command.request == 0) {
    command.request = draw_id();
  }
  impl_->remember(command.request, impl_->command_writer->guid());
  encode(command, impl_->sender, impl_->command);
  if (impl_->command_writer->write(&impl_->command) == WriteResult::kFailed) {
    throw DdsError(fmt::format("cannot send the command {}: run_control does not take it", name_of(command.kind)));
  }
  return command.request;
}

/// A process that has just begun hears commands before it knows who the nodes are: what only they may say waits for
/// that, and what they say after it waits with it: a pause means nothing before the world that it is for.
void ControlBus::Impl::judge(HeardCommand heard, std::vector<RunCommand>& commands) {
  const bool is_behind = std::ranges::any_of(
      waiting, [&](const HeardCommand& other) { return other.origin.writer == heard.origin.writer; });
  if (is_behind && waiting.size() < kMostWaiting) return waiting.push_back(std::move(heard));
  const std::string problem = problem_with(heard.command, heard.origin);
  if (problem.empty()) {
    RunCommand& command = heard.command;
    command.clock_ahead = heard.origin.clock_ahead;
    command.is_of_itself = is_of(command.process, heard.origin);
    command.is_of_a_node = participant.domain().speakers().is_node(heard.origin.writer);
    if (remember(command.request, heard.origin.writer)) commands.push_back(std::move(command));
    return;
  }
  if (std::chrono::steady_clock::now() < heard.since + kUntilKnown && waiting.size() < kMostWaiting) {
    waiting.push_back(std::move(heard));
    return;
  }
  refused.add(WireError::kSource);
  if (is_old_news(heard.command, heard.origin)) return;
  command_reader->refuse_from(heard.origin, fmt::format("{}: {}", name_of(heard.command.kind), problem));
}

std::vector<RunCommand> ControlBus::take_commands() {
  impl_->participant.progress();
  std::vector<RunCommand> commands;
  if (!impl_->command_reader) return commands;
  std::vector<HeardCommand> heard = std::exchange(impl_->waiting, {});
  Expected expected;
  expected.map_version = impl_->settings.map_version;
  Origin origin;
  while (impl_->command_reader->take(&impl_->command, &origin)) {
    auto decoded = decode(impl_->command, expected);
    if (const auto* error = std::get_if<WireError>(&decoded)) {
      impl_->refused.add(*error);
      impl_->command_reader->refuse_from(origin, *error);
      continue;
    }
    auto& command = std::get<RunCommand>(decoded);
    if (impl_->settings.run && command.run != 0 && command.run != *impl_->settings.run) continue;
    heard.push_back({std::move(command), origin, std::chrono::steady_clock::now()});
  }
  if (!heard.empty()) statuses();  // who may say what
  for (HeardCommand& one : heard) impl_->judge(std::move(one), commands);
  return commands;
}

void ControlBus::refuse(const RunCommand& command, const std::string& why) {
  const auto sender = impl_->requests.find(command.request);
  if (sender == impl_->requests.end()) return;
  impl_->refused.add(WireError::kRange);
  impl_->command_reader->refuse_from({sender->second}, fmt::format("{}: {}", name_of(command.kind), why));
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
