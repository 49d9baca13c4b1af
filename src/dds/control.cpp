#include "dds/control.h"

#include <algorithm>
#include <array>
#include <deque>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "aurasim.h"
#include "core/wall_clock.h"
#include "dds/endpoints.h"
#include "dds/node_roster.h"
#include "dds/random_id.h"
#include "dds/rations.h"
#include "messages/control_codec.h"
#include "messages/status_period.h"

namespace aurasim::dds {

using core::RegionId;

namespace {

/// Limits on what is remembered of other processes, trusted or not.
constexpr std::size_t kMostMaps = 256;
constexpr std::size_t kMostRequests = 1U << 16U;
constexpr std::size_t kMostWaiting = 64;
constexpr auto kUntilKnown = std::chrono::seconds(3);
constexpr auto kLongAgo = std::chrono::seconds(1);
/// Looks at the whole roster for each period of statuses. Silence shows by time alone.
constexpr int kLooksInAPeriod = 5;

struct HeardCommand {
  messages::RunCommand command;
  Origin origin;
  std::chrono::steady_clock::time_point since;
};

/// True for commands that were sent long ago, by nodes that have been replaced since. Late joiners receive them, too.
bool is_old_news(const messages::RunCommand& command, const Origin& origin) {
  const bool is_of_nodes = command.kind == messages::RunCommandKind::kStart ||
                           command.kind == messages::RunCommandKind::kRestore ||
                           command.kind == messages::RunCommandKind::kEnd;
  return is_of_nodes && origin.clock_ahead < -kLongAgo;
}

/// Longer than a hub may be cut off without DDS noticing it, and than it takes then until statuses come again.
std::chrono::nanoseconds silence_by_hub(const Reader& statuses, std::uint32_t regions) {
  constexpr int kPeriods = 5;
  return statuses.believed_silence() + kPeriods * messages::status_period(regions);
}

std::optional<Writer> status_writer_of(Domain& domain, std::optional<RegionId> region, Wakeup& wakeup) {
  if (!region) return std::nullopt;
  return std::optional<Writer>(std::in_place, domain, on(TopicId::kNodeStatus, {.source = region}, region), wakeup);
}

}  // namespace

struct ControlBus::Impl {
  Impl(Participant& participant, const ControlSettings& settings);

  void take_statuses();
  void note(messages::Status status, const Origin& origin);
  NodeRoster& look();
  bool is_time_to_look();
  std::string problem_with(const messages::RunCommand& command, const Origin& origin) const;
  void take_in_commands();
  void judge(HeardCommand heard);
  bool remember(std::uint64_t request, const Guid& sender);
  bool is_too_much(const Origin& origin);

  Participant& participant;
  ControlSettings settings;
  std::uint64_t sender = draw_id();
  Wakeup& wakeup;
  std::optional<Writer> status_writer;
  Reader status_reader;
  std::optional<Writer> map_writer;
  Reader map_reader;
  std::optional<Writer> command_writer;
  std::optional<Reader> command_reader;
  NodeRoster roster;
  wire::NodeStatus status;  // reused for every sample
  wire::RegionMap map;
  wire::RunControl command;

  std::optional<std::uint64_t> published_map;                              ///< version of the last one
  std::map<std::pair<std::uint64_t, Guid>, messages::WorldMap> announced;  ///< by version and writer
  std::map<std::uint64_t, messages::WorldMap> maps;
  std::map<std::uint64_t, Guid> requests;  ///< requests seen or sent, and their writers
  std::vector<HeardCommand> waiting;  ///< commands that only nodes may send, kept until their sender is known to be one
  std::vector<messages::RunCommand> taken;     ///< from the reader, and not returned yet
  std::deque<std::uint64_t> request_sequence;  ///< oldest first
  std::uint64_t seen_changes = 0;              ///< of the status reader's watch, at the last look
  std::chrono::steady_clock::time_point next_look;
  RateLimit<Guid> against_statuses{1, 1};
  RateLimit<ProcessPrefix> asked{kWordsASecond, kWordsAtOnce};
  messages::WireErrors refused;
};

ControlBus::Impl::Impl(Participant& participant_in, const ControlSettings& settings_in)
    : participant(participant_in),
      settings(settings_in),
      wakeup(participant.domain().wakeup()),
      status_writer(status_writer_of(participant.domain(), settings.region, wakeup)),
      status_reader(participant.domain(), on(TopicId::kNodeStatus), wakeup),
      map_reader(participant.domain(), on(TopicId::kRegionMap), wakeup),
      roster({.region_count = settings.region_count,
              .agreement = settings.agreement,
              .run = settings.run,
              .region = settings.region,
              .writer = status_writer ? status_writer->guid() : Guid(),
              .stays_on_this_host = participant.stays_on_this_host(),
              .believes_silence = participant.domain().believes_silence(),
              .silence_by_hub = silence_by_hub(status_reader, settings.region_count)},
             participant.domain().speakers()) {
  if (!settings.only_watches) {
    command_writer.emplace(participant.domain(), on(TopicId::kRunControl), wakeup);
    if (!settings.only_sends) {
      command_reader.emplace(participant.domain(), on(TopicId::kRunControl), wakeup);
    }
  }
  if (settings.region) map_writer.emplace(participant.domain(), on(TopicId::kRegionMap), wakeup);
}

void ControlBus::Impl::take_statuses() {
  Origin origin;
  while (status_reader.take(&status, &origin)) {
    origin.heed(status.sent_ns());
    auto decoded = messages::decode(status, {});
    if (const auto* error = std::get_if<messages::WireError>(&decoded)) {
      refused.add(*error);
      status_reader.refuse_from(origin, *error);
    } else {
      note(std::move(std::get<messages::Status>(decoded)), origin);
    }
  }
}

void ControlBus::Impl::note(messages::Status fresh, const Origin& origin) {
  const std::string problem = roster.problem_with(fresh, origin);
  if (problem.empty()) return roster.note(std::move(fresh), origin);
  refused.add(messages::WireError::kSource);
  // A restarted node publishes as the region for some seconds before the old one is known to be dead.
  if (against_statuses.allows(origin.writer, std::chrono::steady_clock::now())) {
    status_reader.refuse_from(origin, problem);
  }
}

/// Looks at what is new of the roster: a look at all of it costs time that grows with the number of nodes, as does the
/// number of statuses, and the loops of a process ask several times in each round.
NodeRoster& ControlBus::Impl::look() {
  participant.progress();
  take_statuses();
  if (is_time_to_look()) {
    roster.look(status_reader.writers());
  } else if (roster.has_news()) {
    roster.look_at_news(status_reader.writers());
  }
  return roster;
}

/// True if processes have come or gone, or some time has passed.
bool ControlBus::Impl::is_time_to_look() {
  const auto now = std::chrono::steady_clock::now();
  const std::uint64_t changes = status_reader.changes();
  if (changes == seen_changes && now < next_look) return false;
  seen_changes = changes;
  next_look = now + messages::status_period(settings.region_count) / kLooksInAPeriod;
  return true;
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

bool ControlBus::Impl::is_too_much(const Origin& origin) {
  if (asked.allows(origin.writer.guidPrefix, std::chrono::steady_clock::now())) return false;
  command_reader->ration(origin, words_of_ration());
  return true;
}

/// Returns why `asked` is refused; empty: it is accepted. Commands of operators and launchers are accepted from any
/// process.
std::string ControlBus::Impl::problem_with(const messages::RunCommand& asked, const Origin& origin) const {
  const Speakers& speakers = participant.domain().speakers();
  const bool is_first_node = speakers.may_speak(origin.writer, RegionId{0}) || roster.is_of(RegionId{0}, origin);
  const bool is_node = speakers.is_node(origin.writer);
  const bool is_of_its_region = speakers.may_speak(origin.writer, asked.region);
  switch (asked.kind) {
    case messages::RunCommandKind::kStart:
      return is_first_node ? "" : "only the node of region 0 starts a run";
    case messages::RunCommandKind::kRate:
      return is_node ? "" : "only a node of the run sets its rate";
    case messages::RunCommandKind::kRestore:
      return is_node && is_of_its_region ? "" : "only the node of a region says where all go back to";
    case messages::RunCommandKind::kEnd:
      return is_node ? "" : "only a node of the run says that nobody takes a region over";
    default:
      return {};
  }
}

ControlBus::ControlBus(Participant& participant, const ControlSettings& settings)
    : impl_(std::make_unique<Impl>(participant, settings)) {}

ControlBus::~ControlBus() = default;

void ControlBus::move_to(Participant& participant) {
  auto anew = std::make_unique<Impl>(participant, impl_->settings);
  anew->requests = std::move(impl_->requests);
  anew->taken = std::move(impl_->taken);
  anew->request_sequence = std::move(impl_->request_sequence);
  impl_ = std::move(anew);
}

bool ControlBus::publish_status(const messages::Status& status) {
  if (!impl_->status_writer || status.region != impl_->settings.region) {
    throw std::logic_error("publish_status: this process is not the node of that region");
  }
  impl_->participant.progress();
  messages::encode(status, impl_->status);
  impl_->status.sent_ns(core::wall_clock_ns());
  impl_->status_writer->forget_all();
  return impl_->status_writer->write(&impl_->status) != WriteResult::kFailed;
}

bool ControlBus::status_is_known() { return !impl_->status_writer || impl_->status_writer->all_acknowledged(); }

const std::map<RegionId, messages::SeenStatus>& ControlBus::statuses() { return impl_->look().statuses(); }

std::vector<messages::SeenStatus> ControlBus::strangers() { return impl_->look().strangers(); }

std::vector<messages::Status> ControlBus::spares() { return impl_->look().spares(); }

void ControlBus::hold_for_dead(std::uint64_t process) { impl_->roster.hold_for_dead(process); }

void ControlBus::receive_death(const messages::RunCommand& lost) {
  if (lost.is_of_itself) return hold_for_dead(lost.process);
  if (!impl_->roster.receive_death(lost.process)) refuse(lost, "its process lives");
}

bool ControlBus::publish_map(const messages::WorldMap& map) {
  // In a run with keys only nodes may publish maps, so other processes create the writer only when needed.
  if (!impl_->map_writer) {
    impl_->map_writer.emplace(impl_->participant.domain(), on(TopicId::kRegionMap), impl_->wakeup);
  }
  impl_->participant.progress();
  messages::encode(map, impl_->map);
  if (std::exchange(impl_->published_map, map.map_version) == map.map_version) impl_->map_writer->forget_all();
  return impl_->map_writer->write(&impl_->map) != WriteResult::kFailed;
}

void ControlBus::use_map(std::uint64_t map_version) { impl_->settings.map_version = map_version; }

const std::map<std::uint64_t, messages::WorldMap>& ControlBus::maps() {
  impl_->participant.progress();
  Origin origin;
  while (impl_->map_reader.take(&impl_->map, &origin)) {
    auto decoded = messages::decode(impl_->map, {});
    if (const auto* error = std::get_if<messages::WireError>(&decoded)) {
      impl_->refused.add(*error);
      impl_->map_reader.refuse_from(origin, *error);
      continue;
    }
    auto& map = std::get<messages::WorldMap>(decoded);
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

std::uint64_t ControlBus::send(messages::RunCommand command) {
  if (!impl_->command_writer) throw std::logic_error("send: this process only watches");
  impl_->participant.progress();
  if (command.request == 0) {
    command.request = draw_id();
  }
  impl_->remember(command.request, impl_->command_writer->guid());
  messages::encode(command, impl_->sender, impl_->command);
  impl_->command.sent_ns(core::wall_clock_ns());
  if (impl_->command_writer->write(&impl_->command) == WriteResult::kFailed) {
    throw DdsError(fmt::format("cannot send the command {}: run_control does not take it", name_of(command.kind)));
  }
  return command.request;
}

/// A process that has just started receives commands before it knows which processes are nodes. Commands that only
/// nodes may send wait until that is known. Later commands of the same sender wait with them, because a pause means
/// nothing before the world that it applies to.
void ControlBus::Impl::judge(HeardCommand heard) {
  const bool is_behind = std::ranges::any_of(
      waiting, [&](const HeardCommand& other) { return other.origin.writer == heard.origin.writer; });
  if (is_behind && waiting.size() < kMostWaiting) return waiting.push_back(std::move(heard));
  const std::string problem = problem_with(heard.command, heard.origin);
  if (problem.empty()) {
    messages::RunCommand& sound = heard.command;
    sound.clock_ahead = heard.origin.clock_ahead;
    sound.is_of_itself = roster.is_of(sound.process, heard.origin);
    sound.is_of_a_node = participant.domain().speakers().is_node(heard.origin.writer);
    if (remember(sound.request, heard.origin.writer)) taken.push_back(std::move(sound));
    return;
  }
  if (std::chrono::steady_clock::now() < heard.since + kUntilKnown && waiting.size() < kMostWaiting) {
    waiting.push_back(std::move(heard));
    return;
  }
  refused.add(messages::WireError::kSource);
  if (is_old_news(heard.command, heard.origin)) return;
  command_reader->refuse_from(heard.origin, fmt::format("{}: {}", name_of(heard.command.kind), problem));
}

/// Adds the commands that have come to `taken`.
void ControlBus::Impl::take_in_commands() {
  participant.progress();
  if (!command_reader) return;
  std::vector<HeardCommand> heard = std::exchange(waiting, {});
  messages::Expected expected;
  expected.map_version = settings.map_version;
  Origin origin;
  while (command_reader->take(&command, &origin)) {
    if (is_too_much(origin)) continue;
    origin.heed(command.sent_ns());
    auto decoded = messages::decode(command, expected);
    if (const auto* error = std::get_if<messages::WireError>(&decoded)) {
      refused.add(*error);
      command_reader->refuse_from(origin, *error);
      continue;
    }
    auto& sound = std::get<messages::RunCommand>(decoded);
    if (settings.run && sound.run != 0 && sound.run != *settings.run) continue;
    heard.push_back({std::move(sound), origin, std::chrono::steady_clock::now()});
  }
  if (!heard.empty()) look();  // learns which process may send what
  for (HeardCommand& one : heard) judge(std::move(one));
}

std::vector<messages::RunCommand> ControlBus::take_commands() {
  impl_->take_in_commands();
  return std::exchange(impl_->taken, {});
}

void ControlBus::hear_of_deaths() {
  impl_->take_in_commands();
  std::erase_if(impl_->taken, [this](const messages::RunCommand& command) {
    if (command.kind != messages::RunCommandKind::kLost) return false;
    receive_death(command);
    return true;
  });
}

void ControlBus::note_state() { impl_->asked.allow_more(kWordsAState); }

void ControlBus::refuse(const messages::RunCommand& command, const std::string& why) {
  const auto sender = impl_->requests.find(command.request);
  if (sender == impl_->requests.end()) return;
  impl_->refused.add(messages::WireError::kRange);
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

const messages::WireErrors& ControlBus::refused() const { return impl_->refused; }

}  // namespace aurasim::dds
