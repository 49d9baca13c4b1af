#include "dds/dds_transport.h"

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "aurasim.h"
#include "dds/dds_seams.h"
#include "dds/endpoints.h"
#include "messages/codec.h"

namespace aurasim::dds {

using core::RegionId;
using core::value_of;

namespace {

constexpr auto kPatienceWithListeners = std::chrono::seconds(10);
constexpr std::size_t kEndpointsOfALink = 6;

/// All endpoints between this region and one neighbour, except the aura writer, which all neighbours share.
struct Link {
  Link(Domain& domain, RegionId self, RegionId neighbour, core::Generation life, Wakeup& wakeup)
      : region(neighbour),
        aura_reader(domain, on(TopicId::kAura, {.source = neighbour, .life = life}, self), wakeup),
        migration_reader(domain, from(neighbour, self, life, TopicId::kMigration), wakeup),
        migration_writer(domain, to(neighbour, self, life, TopicId::kMigration), wakeup),
        ack_reader(domain, from(neighbour, self, life, TopicId::kMigrationAck), wakeup),
        ack_writer(domain, to(neighbour, self, life, TopicId::kMigrationAck), wakeup) {}

  static EndpointSpec from(RegionId neighbour, RegionId self, core::Generation life, TopicId topic) {
    return on(topic, {.source = neighbour, .destination = self, .life = life}, self);
  }
  static EndpointSpec to(RegionId neighbour, RegionId self, core::Generation life, TopicId topic) {
    return on(topic, {.source = self, .destination = neighbour, .life = life}, self);
  }

  RegionId region;
  Reader aura_reader;
  Reader migration_reader;
  Writer migration_writer;
  Reader ack_reader;
  Writer ack_writer;

  std::uint64_t match = 0;  ///< RemoteWriter::order of the neighbour's aura writer that we know; 0: none yet
  bool lost = false;
  bool met = false;           ///< has been matched once
  std::uint64_t refused = 0;  ///< samples of this neighbour that were refused
};

void count_sent(TopicCounters& counters, WriteResult result, std::size_t bytes) {
  if (result == WriteResult::kFailed) {
    ++counters.send_failed;
    return;
  }
  ++counters.sent;
  counters.sent_bytes += bytes;
  counters.retried += result == WriteResult::kSentAtSecondTry ? 1 : 0;
}

template <class WireMessage>
std::size_t bytes_of(const WireMessage& sample) {
  return WireMessage::getCdrSerializedSize(sample);
}

/// True for errors of messages that name this run, map and source correctly but have unsound content.
bool is_our_own(messages::WireError error) {
  switch (error) {
    case messages::WireError::kMalformed:
    case messages::WireError::kVersion:
    case messages::WireError::kGeneration:
    case messages::WireError::kMapVersion:
    case messages::WireError::kSource:
      return false;
    default:
      return true;
  }
}

template <class WireMessage>
constexpr std::optional<core::MessageKind> kind_of(const WireMessage&) {
  if constexpr (std::is_same_v<WireMessage, wire::AuraBatch>) return core::MessageKind::kAura;
  if constexpr (std::is_same_v<WireMessage, wire::Migration>) return core::MessageKind::kHandOff;
  return {};  // a lost acknowledgement is asked for again
}

/// Takes all samples of a reader into `inbox`. What decode refuses is counted, by topic and by link. A sample that was
/// not sent by the region's node is dropped and never counts against that node. While it is unknown which process that
/// is (`is_told`), such a sample is not counted against its sender either: of two processes the first may have died
/// unnoticed.
template <class WireMessage, class Message>
void drain(Reader& reader, WireMessage& sample, const messages::Expected& expected,
           const std::optional<ProcessPrefix>& node, bool is_told, std::vector<Message>& inbox, TopicCounters& counters,
           std::uint64_t& refused, std::vector<core::Refusal>& refusals) {
  Origin origin;
  while (reader.take(&sample, &origin)) {
    ++counters.received;
    counters.received_bytes += bytes_of(sample);
    if (node && origin.writer.guidPrefix != *node) {
      counters.refused.add(messages::WireError::kSource);
      if (is_told)
        reader.refuse_from(origin, fmt::format("it is not the node of region {}", value_of(*expected.source)));
      continue;
    }
    auto decoded = messages::decode(sample, expected);
    if (const auto* error = std::get_if<messages::WireError>(&decoded)) {
      counters.refused.add(*error);
      ++refused;
      const auto kind = kind_of(sample);
      if (!kind || !is_our_own(*error)) continue;
      refusals.push_back(
          {*expected.source, sample.generation(), sample.stamp(), *kind, name_of(*error), sample.redo()});
    } else {
      inbox.push_back(std::move(std::get<Message>(decoded)));
    }
  }
  const std::uint64_t lost = reader.take_lost();
  counters.refused.add(messages::WireError::kParts, lost);
  refused += lost;
}

messages::Expected expected_of(const TransportSettings& settings) {
  return {.map_version = settings.map_version,
          .generation = std::nullopt,
          .source = std::nullopt,
          .destination = settings.region,
          .region_count = settings.region_count,
          .prototype_count = settings.prototype_count,
          .static_count = settings.static_count,
          .joint_count = settings.joint_count,
          .block_m = settings.block_m};
}

void check_settings(const TransportSettings& settings) {
  std::set<RegionId> seen = {settings.region};
  if (value_of(settings.region) >= settings.region_count) {
    throw std::invalid_argument(fmt::format("region {} of only {}", value_of(settings.region), settings.region_count));
  }
  for (const RegionId neighbour : settings.neighbours) {
    if (!seen.insert(neighbour).second || value_of(neighbour) >= settings.region_count) {
      throw std::invalid_argument(
          fmt::format("region {}: neighbour {} is itself, named twice, or not one of {} regions",
                      value_of(settings.region), value_of(neighbour), settings.region_count));
    }
  }
}

}  // namespace

struct DdsTransport::Impl {
  Impl(Participant& participant, const TransportSettings& settings);

  Link* find(RegionId region);
  bool is_lost(RegionId region);
  /// The process that is the node of the link's region. While no status names it: the process whose writer was matched
  /// first.
  std::optional<ProcessPrefix> node_of(const Link& link) const;
  Link& link_to(RegionId region);
  void wait_for(const std::vector<RegionId>& listeners);
  /// Names of the link's endpoints that are not matched yet.
  std::vector<std::string> unmatched(const Link& link) const;
  std::vector<std::string> missing_neighbours(std::vector<RegionId>& regions) const;
  void take_peer_changes(std::vector<core::PeerEvent>& peers);
  void send_aura(const core::AuraBatch& batch);
  void send_hand_off(const core::HandOff& hand_off);
  void send_ack(const core::HandOffAck& ack);

  TransportSettings settings;
  messages::Expected expected;
  Participant& participant;
  Wakeup& wakeup;
  Writer aura_writer;
  /// Links to settings.neighbours, then to other regions as they were requested.
  std::vector<std::unique_ptr<Link>> links;
  std::optional<DdsSeams> seams;  ///< if regions are coupled
  wire::AuraBatch aura;           // reused for every sample
  wire::Migration migration;
  wire::MigrationAck ack;
  TransportCounters counters;
};

DdsTransport::Impl::Impl(Participant& participant_in, const TransportSettings& settings_in)
    : settings(settings_in),
      expected(expected_of(settings_in)),
      participant(participant_in),
      wakeup(participant.domain().wakeup()),
      aura_writer(participant.domain(),
                  on(TopicId::kAura, {.source = settings.region, .life = settings.life}, settings.region), wakeup) {
  for (const RegionId neighbour : settings.neighbours) {
    links.push_back(std::make_unique<Link>(participant.domain(), settings.region, neighbour, settings.life, wakeup));
  }
  if (!settings.coupled) return;
  SeamSettings seam_settings{settings.region, settings.region_count, settings.map_version, settings.life, {}, {}};
  seam_settings.is_lost = [this](RegionId region) { return is_lost(region); };
  seam_settings.is_node = [this](RegionId region, const ProcessPrefix& process) {
    Link* const link = find(region);
    const auto node = link == nullptr ? std::nullopt : node_of(*link);
    return !node || *node == process;
  };
  seams.emplace(participant, seam_settings);
}

/// True if the process that was the region's node has gone or fallen silent.
bool DdsTransport::Impl::is_lost(RegionId region) {
  Link* const link = find(region);
  if (link == nullptr) return false;
  const RemoteWriter writer = link->aura_reader.watch().latest(node_of(*link));
  return link->lost || writer.lost || (link->match != 0 && writer.order != link->match);
}

Link* DdsTransport::Impl::find(RegionId region) {
  const auto found = std::ranges::find_if(links, [&](const auto& link) { return link->region == region; });
  return found == links.end() ? nullptr : found->get();
}

std::optional<ProcessPrefix> DdsTransport::Impl::node_of(const Link& link) const {
  if (const auto node = participant.domain().speakers().of(link.region)) return node;
  const RemoteWriter first = link.aura_reader.watch().latest();
  return first.order == 0 ? std::nullopt : std::optional(first.guid.guidPrefix);
}

/// Returns the link to `region`, and creates it if bodies need a region that was no neighbour at first.
Link& DdsTransport::Impl::link_to(RegionId region) {
  if (Link* link = find(region)) return *link;
  links.push_back(std::make_unique<Link>(participant.domain(), settings.region, region, settings.life, wakeup));
  return *links.back();
}

/// Waits until the listeners are matched, because samples sent before would be lost to them. They have been expected
/// for half a second, so there is mostly nothing to wait for. A node that computes one step for long creates its
/// endpoints after that step.
void DdsTransport::Impl::wait_for(const std::vector<RegionId>& listeners) {
  auto deadline = std::chrono::steady_clock::now() + kPatienceWithListeners;
  for (const RegionId region : listeners) {
    Link& link = link_to(region);
    while (!link.met && !link.lost && std::chrono::steady_clock::now() < deadline) {
      link.met = unmatched(link).empty();
      if (link.met) break;
      if (settings.is_busy && settings.is_busy(region)) {
        deadline = std::chrono::steady_clock::now() + kPatienceWithListeners;
      }
      participant.progress();
      wakeup.wait(std::chrono::milliseconds(1));
    }
  }
}

std::vector<std::string> DdsTransport::Impl::unmatched(const Link& link) const {
  std::vector<std::string> missing;
  const std::optional<ProcessPrefix> node = node_of(link);
  const auto need = [&](bool there, const char* name) {
    if (!there) {
      missing.emplace_back(name);
    }
  };
  need(link.aura_reader.watch().any_matched(node), "its aura writer");
  need(aura_writer.reaches(link.region), "its aura reader");
  need(link.migration_reader.watch().any_matched(node), "its migration writer");
  need(link.migration_writer.reaches(link.region), "its migration reader");
  need(link.ack_reader.watch().any_matched(node), "its migration_ack writer");
  need(link.ack_writer.reaches(link.region), "its migration_ack reader");
  if (seams) {
    for (std::string& name : seams->unmatched(link.region)) missing.push_back(std::move(name));
  }
  return missing;
}

std::vector<std::string> DdsTransport::Impl::missing_neighbours(std::vector<RegionId>& regions) const {
  std::vector<std::string> texts;
  for (const auto& link : links) {
    const auto missing = unmatched(*link);
    if (missing.empty() || link->lost) {
      continue;
    }
    regions.push_back(link->region);
    texts.push_back(missing.size() == kEndpointsOfALink + (seams ? 2 : 0)
                        ? fmt::format("region {} (nothing received from it)", value_of(link->region))
                        : fmt::format("region {} ({})", value_of(link->region), fmt::join(missing, ", ")));
  }
  return texts;
}

void DdsTransport::Impl::take_peer_changes(std::vector<core::PeerEvent>& peers) {
  for (const auto& link : links) {
    const RemoteWriter writer = link->aura_reader.watch().latest(node_of(*link));
    if (link->match == 0) {
      link->match = writer.order;
    }
    const bool other_match = writer.order != link->match;
    if (!link->lost && (writer.lost || other_match)) {
      link->lost = true;
      peers.push_back({link->region, core::PeerChange::kLost});
    }
    if (link->lost && writer.alive && unmatched(*link).empty()) {
      link->lost = false;
      link->match = writer.order;
      peers.push_back({link->region, core::PeerChange::kJoined});
    }
  }
}

void DdsTransport::Impl::send_aura(const core::AuraBatch& batch) {
  messages::encode(batch, aura);
  aura_writer.forget_acknowledged();
  count_sent(counters.aura, aura_writer.write(&aura), bytes_of(aura));
}

void DdsTransport::Impl::send_hand_off(const core::HandOff& hand_off) {
  Link* link = find(hand_off.destination);
  if (link == nullptr || link->lost) {
    ++counters.migration.not_sent;
    return;
  }
  messages::encode(hand_off, migration);
  link->migration_writer.forget_acknowledged();
  count_sent(counters.migration, link->migration_writer.write(&migration), bytes_of(migration));
}

void DdsTransport::Impl::send_ack(const core::HandOffAck& message) {
  Link* link = find(message.destination);
  if (link == nullptr || link->lost) {
    ++counters.migration_ack.not_sent;
    return;
  }
  messages::encode(message, settings.map_version, ack);
  link->ack_writer.forget_acknowledged();
  count_sent(counters.migration_ack, link->ack_writer.write(&ack), bytes_of(ack));
}

DdsTransport::DdsTransport(Participant& participant, const TransportSettings& settings)
    : impl_((check_settings(settings), std::make_unique<Impl>(participant, settings))) {}

DdsTransport::~DdsTransport() = default;

const ExchangeTimes* DdsTransport::exchange_times() { return impl_->seams ? &impl_->seams->times() : nullptr; }

core::SeamMail* DdsTransport::seams() { return impl_->seams ? &*impl_->seams : nullptr; }

void DdsTransport::wait_until_matched(std::chrono::nanoseconds time_out) {
  const auto deadline = std::chrono::steady_clock::now() + time_out;
  while (!all_matched()) {
    impl_->participant.progress();
    const auto left = deadline - std::chrono::steady_clock::now();
    if (left <= std::chrono::nanoseconds::zero()) {
      std::vector<RegionId> regions;
      const auto texts = impl_->missing_neighbours(regions);
      throw NeighboursMissing(
          fmt::format("region {} has waited in vain for {}", value_of(impl_->settings.region), fmt::join(texts, ", ")),
          regions);
    }
    impl_->wakeup.wait(std::min<std::chrono::nanoseconds>(left, std::chrono::seconds(1)));
  }
}

bool DdsTransport::all_matched() const {
  return std::ranges::all_of(impl_->links,
                             [&](const auto& link) { return link->lost || impl_->unmatched(*link).empty(); });
}

std::size_t DdsTransport::found() const {
  std::size_t found = 0;
  for (const auto& link : impl_->links)
    found += kEndpointsOfALink + (impl_->seams ? 2 : 0) - impl_->unmatched(*link).size();
  return found;
}

void DdsTransport::take(core::Inbox& inbox) {
  impl_->participant.progress();
  TransportCounters& counters = impl_->counters;
  for (const auto& link : impl_->links) {
    messages::Expected expected = impl_->expected;
    expected.source = link->region;
    const std::optional<ProcessPrefix> node = impl_->node_of(*link);
    const bool is_told = impl_->participant.domain().speakers().of(link->region).has_value();
    const auto take_all = [&](Reader& reader, auto& sample, auto& messages, TopicCounters& topic) {
      drain(reader, sample, expected, node, is_told, messages, topic, link->refused, inbox.refusals);
    };
    take_all(link->aura_reader, impl_->aura, inbox.auras, counters.aura);
    take_all(link->migration_reader, impl_->migration, inbox.hand_offs, counters.migration);
    take_all(link->ack_reader, impl_->ack, inbox.acks, counters.migration_ack);
  }
  impl_->take_peer_changes(inbox.peers);
}

void DdsTransport::send(const core::Outbox& outbox) {
  impl_->participant.progress();
  for (const RegionId region : outbox.expected) impl_->link_to(region);
  impl_->wait_for(outbox.listeners);
  for (const auto& hand_off : outbox.hand_offs) {
    impl_->send_hand_off(hand_off);
  }
  for (const auto& ack : outbox.acks) {
    impl_->send_ack(ack);
  }
  impl_->send_aura(outbox.aura);
}

void DdsTransport::wait_for_arrival(std::chrono::nanoseconds time_out) {
  impl_->participant.progress();
  impl_->wakeup.wait(time_out);
  impl_->participant.progress();
}

const TransportCounters& DdsTransport::counters() const { return impl_->counters; }

std::vector<std::pair<RegionId, std::uint64_t>> DdsTransport::refused() const {
  std::vector<std::pair<RegionId, std::uint64_t>> refused;
  for (const auto& link : impl_->links) {
    if (link->refused > 0) refused.emplace_back(link->region, link->refused);
  }
  return refused;
}

}  // namespace aurasim::dds
