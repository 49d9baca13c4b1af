#include "messages/control_codec.h"

#include <cmath>
#include <initializer_list>

#include "aurasim.h"
#include "core/limits.h"
#include "messages/columns.h"
#include "messages/header_check.h"

namespace aurasim::messages {

using core::RegionId;
using core::value_of;

namespace {

using MaybeError = std::optional<WireError>;

/// Largest number of regions, parts or meshes in a message: more than any run has.
constexpr std::size_t kMostOfAll = 4096;
constexpr core::Step kGoesOn = -1;  ///< the run goes on: no state at which it is to pause

bool finite_and_not_negative(std::initializer_list<double> values) {
  return std::ranges::all_of(values, [](double x) { return std::isfinite(x) && x >= 0; });
}

/// True for a valid rectangle. Infinite sides are valid; NaN and swapped sides are not.
bool is_rectangle(const core::Rectangle& r) { return r.x0 < r.x1 && r.y0 < r.y1; }

/// Cuts a text to the length of the IDL's bounded string, never within a UTF-8 character.
std::string cut_to_wire(const std::string& text) {
  constexpr std::size_t kMax = 256;
  if (text.size() <= kMax) {
    return text;
  }
  std::size_t end = kMax;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) {
    --end;
  }
  return text.substr(0, end);
}

void encode_durations(const Status& status, wire::NodeStatus& out) {
  out.frame_p50_ms(status.frame.p50_ms);
  out.frame_p99_ms(status.frame.p99_ms);
  out.frame_max_ms(status.frame.max_ms);
  out.physics_p50_ms(status.physics.p50_ms);
  out.physics_p99_ms(status.physics.p99_ms);
  out.physics_max_ms(status.physics.max_ms);
  out.protocol_p50_ms(status.protocol.p50_ms);
  out.protocol_p99_ms(status.protocol.p99_ms);
  out.protocol_max_ms(status.protocol.max_ms);
  out.transport_p50_ms(status.transport.p50_ms);
  out.transport_p99_ms(status.transport.p99_ms);
  out.transport_max_ms(status.transport.max_ms);
  out.exchange_p50_ms(status.exchange_times.p50_ms);
  out.exchange_p99_ms(status.exchange_times.p99_ms);
  out.exchange_max_ms(status.exchange_times.max_ms);
}

void decode_durations(const wire::NodeStatus& in, Status& status) {
  status.frame = {in.frame_p50_ms(), in.frame_p99_ms(), in.frame_max_ms()};
  status.physics = {in.physics_p50_ms(), in.physics_p99_ms(), in.physics_max_ms()};
  status.protocol = {in.protocol_p50_ms(), in.protocol_p99_ms(), in.protocol_max_ms()};
  status.transport = {in.transport_p50_ms(), in.transport_p99_ms(), in.transport_max_ms()};
  status.exchange_times = {in.exchange_p50_ms(), in.exchange_p99_ms(), in.exchange_max_ms()};
}

void encode_counts(const Status& status, wire::NodeStatus& out) {
  out.bodies(status.bodies);
  out.awake(status.awake);
  out.foreign_auras(status.foreign_auras);
  out.hand_offs_out(status.hand_offs_out);
  out.hand_offs_in(status.hand_offs_in);
  out.violations_speed(status.violations.speed);
  out.violations_latency(status.violations.latency);
  out.violations_frame(status.violations.frame);
  out.violations_promise(status.violations.promise);
  out.violations_span(status.violations.span);
  out.late_collisions(status.late_collisions);
  out.missed_collisions(status.missed_collisions);
  out.redos(status.redos);
  out.setpoints_heard(status.setpoints_heard);
  out.setpoints_late(status.setpoints_late);
  out.setpoints_refused(status.setpoints_refused);
  fill(out.listens_to(), status.listens_to, [](const core::Listened& who) { return value_of(who.region); });
  fill(out.listens_since(), status.listens_to, [](const core::Listened& who) { return who.since; });
  fill(out.listens_by(), status.listens_to,
       [&](const core::Listened& who) { return value_of(who.introduced_by.value_or(status.region)); });
  out.largest_cluster(status.largest_cluster);
}

void decode_counts(const wire::NodeStatus& in, Status& status) {
  status.bodies = in.bodies();
  status.awake = in.awake();
  status.foreign_auras = in.foreign_auras();
  status.hand_offs_out = in.hand_offs_out();
  status.hand_offs_in = in.hand_offs_in();
  status.violations = {in.violations_speed(), in.violations_latency(), in.violations_frame(), in.violations_promise(),
                       in.violations_span()};
  status.late_collisions = in.late_collisions();
  status.missed_collisions = in.missed_collisions();
  status.redos = in.redos();
  status.setpoints_heard = in.setpoints_heard();
  status.setpoints_late = in.setpoints_late();
  status.setpoints_refused = in.setpoints_refused();
  for (std::size_t i = 0; i < in.listens_to().size(); ++i) {
    core::Listened& who = status.listens_to.emplace_back();
    who.region = core::RegionId{in.listens_to()[i]};
    who.since = in.listens_since()[i];
    if (in.listens_by()[i] != in.source()) who.introduced_by = core::RegionId{in.listens_by()[i]};
  }
  status.largest_cluster = in.largest_cluster();
}

MaybeError check_values(const wire::NodeStatus& in, const Expected& expected) {
  const bool finite = finite_and_not_negative(
      {in.frame_p50_ms(), in.frame_p99_ms(), in.frame_max_ms(), in.physics_p50_ms(), in.physics_p99_ms(),
       in.physics_max_ms(), in.protocol_p50_ms(), in.protocol_p99_ms(), in.protocol_max_ms(), in.transport_p50_ms(),
       in.transport_p99_ms(), in.transport_max_ms(), in.exchange_p50_ms(), in.exchange_p99_ms(), in.exchange_max_ms(),
       in.round_trip_ms(), in.real_time_factor(), in.rate()});
  if (!finite) {
    return WireError::kNotFinite;
  }
  if (in.state() > static_cast<std::uint8_t>(NodeState::kCutOff) ||
      in.exchange() > static_cast<std::uint8_t>(ExchangeInUse::kCoupled)) {
    return WireError::kEnum;
  }
  const bool in_range =
      is_rectangle({in.footprint_x0(), in.footprint_y0(), in.footprint_x1(), in.footprint_y1()}) &&
      in.lookahead() >= 0 && in.holds_at() >= kGoesOn && all_below(in.dead(), expected.region_count) &&
      all_below(in.refused_source(), expected.region_count) && all_below(in.listens_to(), expected.region_count) &&
      none_negative(in.listens_since()) && all_below(in.listens_by(), expected.region_count) &&
      none_negative(in.part_step()) && all_below(in.part_region(), expected.region_count);
  return in_range ? MaybeError{} : WireError::kRange;
}

MaybeError check(const wire::NodeStatus& in, const Expected& expected) {
  if (const auto error = check_header(in, expected)) {
    return error;
  }
  if (const auto error = check_source(in, expected)) {
    return error;
  }
  const std::size_t listens = in.listens_to().size();
  if (std::max({in.dead().size(), in.refused_source().size(), listens, in.part_region().size(), in.meshes().size(),
                in.saved().size(), in.not_saved().size()}) > kMostOfAll) {
    return WireError::kTooLarge;
  }
  if (in.refused_source().size() != in.refused_count().size() || in.listens_since().size() != listens ||
      in.listens_by().size() != listens || in.part_region().size() != in.part_step().size()) {
    return WireError::kLength;
  }
  return check_values(in, expected);
}

MaybeError check_command(const wire::RunControl& in) {
  if (in.kind() > static_cast<std::uint8_t>(RunCommandKind::kEnd)) {
    return WireError::kEnum;
  }
  const std::size_t members = in.member_process().size();
  if (members > kMostOfAll) {
    return WireError::kTooLarge;
  }
  if (!same_rows(members, {{in.member_holder().size()}, {in.member_survives().size()}})) {
    return WireError::kLength;
  }
  const auto kind = static_cast<RunCommandKind>(in.kind());
  const bool has_rate = kind == RunCommandKind::kRate || kind == RunCommandKind::kRestore;
  const bool in_range = in.request() != 0 && in.count() >= 0 && in.epoch_ns() >= 0 &&
                        (!has_rate || core::limits::is_rate(in.rate())) &&
                        all_below(in.member_holder(), static_cast<std::uint32_t>(members));
  return in_range ? MaybeError{} : WireError::kRange;
}

}  // namespace

void encode(const Status& status, wire::NodeStatus& out) {
  out.source(value_of(status.region));
  out.version(kProtocolVersion);
  out.generation(status.generation);
  out.stamp(status.step);
  out.map_version(status.map_version);
  out.agreement(status.agreement);
  out.run(status.run);
  out.pid(status.pid);
  out.process(status.process);
  out.state(static_cast<std::uint8_t>(status.state));
  out.holds_at(status.holds_at.value_or(kGoesOn));
  out.era(status.era);
  fill(out.part_region(), status.parts, [](const KeptPart& part) { return value_of(part.region); });
  fill(out.part_step(), status.parts, [](const KeptPart& part) { return part.step; });
  encode_counts(status, out);
  encode_durations(status, out);
  out.real_time_factor(status.real_time_factor);
  out.rate(status.rate);
  out.meshes(status.meshes);
  out.saved(status.saved);
  out.not_saved(status.not_saved);
  fill(out.refused_source(), status.refused, [](const auto& refused) { return value_of(refused.first); });
  fill(out.refused_count(), status.refused, [](const auto& refused) { return refused.second; });
  out.footprint_x0(status.footprint.x0);
  out.footprint_y0(status.footprint.y0);
  out.footprint_x1(status.footprint.x1);
  out.footprint_y1(status.footprint.y1);
  out.lookahead(status.lookahead);
  out.exchange(static_cast<std::uint8_t>(status.exchange));
  out.round_trip_ms(status.round_trip_ms);
  out.text(cut_to_wire(status.text));
  fill(out.dead(), status.dead, [](RegionId region) { return value_of(region); });
}

Decoded<Status> decode(const wire::NodeStatus& in, const Expected& expected) {
  if (const auto error = check(in, expected)) {
    return *error;
  }
  Status status;
  status.region = static_cast<RegionId>(in.source());
  status.generation = in.generation();
  status.step = in.stamp();
  status.map_version = in.map_version();
  status.agreement = in.agreement();
  status.run = in.run();
  status.pid = in.pid();
  status.process = in.process();
  status.state = static_cast<NodeState>(in.state());
  if (in.holds_at() != kGoesOn) status.holds_at = in.holds_at();
  status.era = in.era();
  for (std::size_t i = 0; i < in.part_region().size(); ++i) {
    status.parts.push_back({RegionId{in.part_region()[i]}, in.part_step()[i]});
  }
  decode_counts(in, status);
  decode_durations(in, status);
  status.real_time_factor = in.real_time_factor();
  status.rate = in.rate();
  status.meshes = in.meshes();
  status.saved = in.saved();
  status.not_saved = in.not_saved();
  for (std::size_t i = 0; i < in.refused_source().size(); ++i) {
    status.refused.emplace_back(RegionId{in.refused_source()[i]}, in.refused_count()[i]);
  }
  status.footprint = {in.footprint_x0(), in.footprint_y0(), in.footprint_x1(), in.footprint_y1()};
  status.lookahead = in.lookahead();
  status.exchange = static_cast<ExchangeInUse>(in.exchange());
  status.round_trip_ms = in.round_trip_ms();
  status.text = in.text().to_string();
  fill(status.dead, in.dead(), [](std::uint32_t region) { return static_cast<RegionId>(region); });
  return status;
}

void encode(const WorldMap& map, wire::RegionMap& out) {
  out.map_version(map.map_version);
  out.version(kProtocolVersion);
  out.generation(map.generation);
  out.stamp(map.from_step);
  out.agreement(map.agreement);
  fill(out.x0(), map.regions, [](const core::Rectangle& r) { return r.x0; });
  fill(out.y0(), map.regions, [](const core::Rectangle& r) { return r.y0; });
  fill(out.x1(), map.regions, [](const core::Rectangle& r) { return r.x1; });
  fill(out.y1(), map.regions, [](const core::Rectangle& r) { return r.y1; });
  out.scene(cut_to_wire(map.scene));
}

Decoded<WorldMap> decode(const wire::RegionMap& in, const Expected& expected) {
  if (const auto error = check_header(in, expected)) {
    return *error;
  }
  const std::size_t regions = in.x0().size();
  if (regions > kMostOfAll) {
    return WireError::kTooLarge;
  }
  if (!same_rows(regions, {{in.y0().size()}, {in.x1().size()}, {in.y1().size()}})) {
    return WireError::kLength;
  }
  WorldMap map;
  map.map_version = in.map_version();
  map.agreement = in.agreement();
  map.generation = in.generation();
  map.from_step = in.stamp();
  map.scene = in.scene().to_string();
  for (std::size_t i = 0; i < regions; ++i) {
    map.regions.push_back({in.x0()[i], in.y0()[i], in.x1()[i], in.y1()[i]});
  }
  if (regions == 0 || !std::ranges::all_of(map.regions, is_rectangle)) {
    return WireError::kRange;
  }
  return map;
}

void encode(const RunCommand& command, std::uint64_t sender, wire::RunControl& out) {
  out.sender(sender);
  out.version(kProtocolVersion);
  out.generation(command.generation);
  out.stamp(command.at_step);
  out.map_version(command.map_version);
  out.run(command.run);
  out.request(command.request);
  out.kind(static_cast<std::uint8_t>(command.kind));
  out.count(command.count);
  out.program(command.after.program);
  out.word(command.after.number);
  out.epoch_ns(command.epoch_ns);
  out.rate(command.rate);
  out.region(value_of(command.region));
  out.process(command.process);
  out.era(command.era);
  fill(out.member_process(), command.members, [](const RunCommand::Member& member) { return member.process; });
  fill(out.member_holder(), command.members, [](const RunCommand::Member& member) { return value_of(member.holder); });
  fill(out.member_survives(), command.members,
       [](const RunCommand::Member& member) { return static_cast<std::uint8_t>(member.survives); });
}

Decoded<RunCommand> decode(const wire::RunControl& in, const Expected& expected) {
  Expected any_map = expected;
  if (in.map_version() == 0) {
    any_map.map_version = std::uint64_t{0};
  }
  if (const auto error = check_header(in, any_map)) {
    return *error;
  }
  if (const auto error = check_command(in)) {
    return *error;
  }
  RunCommand command{.request = in.request(),
                     .kind = static_cast<RunCommandKind>(in.kind()),
                     .generation = in.generation(),
                     .map_version = in.map_version(),
                     .run = in.run(),
                     .at_step = in.stamp(),
                     .count = in.count(),
                     .after = {in.program(), in.word()},
                     .epoch_ns = in.epoch_ns(),
                     .rate = in.rate(),
                     .region = RegionId{in.region()},
                     .process = in.process(),
                     .era = in.era(),
                     .members = {}};
  for (std::size_t i = 0; i < in.member_process().size(); ++i) {
    command.members.push_back({in.member_process()[i], RegionId{in.member_holder()[i]}, in.member_survives()[i] != 0});
  }
  return command;
}

}  // namespace aurasim::messages
