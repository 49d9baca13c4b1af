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
#include "dds/links.h"
#include "messages/codec.h"

namespace aurasim::dds {

using core::RegionId;
using core::value_of;

namespace {

constexpr auto kPatienceWithListeners = std::chrono::seconds(10);
/// Time between two looks at who is silent, while nobody comes or goes. A small part of any lease.
constexpr auto kLookAtPeersEvery = std::chrono::milliseconds(5);

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

core::MessageKind kind_of(const wire::AuraBatch&) { return core::MessageKind::kAura; }
core::MessageKind kind_of(const wire::Migration&) { return core::MessageKind::kHandOff; }

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

  bool is_lost(RegionId region);
  void wait_for(const std::vector<RegionId>& listeners);
  void make_writers_for(const core::Outbox& outbox);
  std::size_t endpoints_of(const Link& link) const {
    return Links::endpoints_of(link) + (seams ? seams->endpoints_of(link.region) : 0);
  }
  /// Names of the link's endpoints that are not matched yet.
  std::vector<std::string> unmatched(const Link& link) const;
  std::vector<std::string> missing_neighbours(std::vector<RegionId>& regions) const;
  template <class WireMessage, class Message>
  void take_all(Reader& reader, WireMessage& sample, std::vector<Message>& messages, TopicCounters& topic,
                std::vector<core::Refusal>& refusals);
  template <class WireMessage>
  Link* sender_of(Reader& reader, const WireMessage& sample, const Origin& origin);
  bool is_time_for_peers();
  void take_peer_changes(std::vector<core::PeerEvent>& peers);
  void send_aura(const core::AuraBatch& batch);
  void send_hand_off(const core::HandOff& hand_off);

  TransportSettings settings;
  messages::Expected expected;
  Participant& participant;
  Wakeup& wakeup;
  Links links;
  std::optional<DdsSeams> seams;  ///< if regions are coupled
  wire::AuraBatch aura;           // reused for every sample
  wire::Migration migration;
  TransportCounters counters;
  std::uint64_t seen_changes = 0;  ///< of the watches of aura readers, at the last look at peers
  std::chrono::steady_clock::time_point next_look_at_peers;
};

DdsTransport::Impl::Impl(Participant& participant_in, const TransportSettings& settings_in)
    : settings(settings_in),
      expected(expected_of(settings_in)),
      participant(participant_in),
      wakeup(participant.domain().wakeup()),
      links(participant.domain(), settings.region, settings.life, settings.neighbours) {
  if (!settings.coupled) return;
  const auto node_of = [this](RegionId region) {
    const Link* const link = links.find(region);
    return link == nullptr ? participant.domain().speakers().of(region) : links.node_of(*link);
  };
  seams.emplace(participant, SeamSettings{.region = settings.region,
                                          .region_count = settings.region_count,
                                          .near = settings.near,
                                          .map_version = settings.map_version,
                                          .life = settings.life,
                                          .is_lost = [this](RegionId region) { return is_lost(region); },
                                          .why_stand = settings.why_stand,
                                          .node_of = node_of});
}

/// True if the process that was the region's node has gone or fallen silent.
bool DdsTransport::Impl::is_lost(RegionId region) {
  const Link* const link = links.find(region);
  return link != nullptr && links.is_lost(*link);
}

/// The link to the region whose node sent the sample. Null: no such node did; then the sample is counted as refused. It
/// never counts against a node. While it is unknown which process is the region's node, it is not counted against its
/// sender either: of two processes the first may have died unnoticed.
template <class WireMessage>
Link* DdsTransport::Impl::sender_of(Reader& reader, const WireMessage& sample, const Origin& origin) {
  const RegionId claimed{sample.source()};
  Link* const link = links.of_writer(origin.writer, claimed);
  if (link != nullptr) {
    const auto node = links.node_of(*link);
    if (!node || origin.writer.guidPrefix == *node) return link;
  }
  const RegionId region = link != nullptr ? link->region : claimed;
  if (participant.domain().speakers().of(region))
    reader.refuse_from(origin, fmt::format("it is not the node of region {}", value_of(region)));
  return nullptr;
}

/// Takes all samples of a reader into `messages`. What decode refuses is counted, by topic and by link.
template <class WireMessage, class Message>
void DdsTransport::Impl::take_all(Reader& reader, WireMessage& sample, std::vector<Message>& messages,
                                  TopicCounters& topic, std::vector<core::Refusal>& refusals) {
  Origin origin;
  while (reader.take(&sample, &origin)) {
    ++topic.received;
    topic.received_bytes += bytes_of(sample);
    Link* const link = sender_of(reader, sample, origin);
    if (link == nullptr) {
      topic.refused.add(messages::WireError::kSource);
      continue;
    }
    expected.source = link->region;
    auto decoded = messages::decode(sample, expected);
    if (const auto* error = std::get_if<messages::WireError>(&decoded)) {
      topic.refused.add(*error);
      ++link->refused;
      if (!is_our_own(*error)) continue;
      refusals.push_back(
          {link->region, sample.generation(), sample.stamp(), kind_of(sample), name_of(*error), sample.redo()});
    } else {
      messages.push_back(std::move(std::get<Message>(decoded)));
    }
  }
  topic.refused.add(messages::WireError::kParts, reader.take_lost());
}

/// Waits until the listeners are matched, because samples sent before would be lost to them. They have been expected
/// for half a second, so there is mostly nothing to wait for. A node that computes one step for long creates its
/// endpoints after that step.
void DdsTransport::Impl::wait_for(const std::vector<RegionId>& listeners) {
  auto deadline = std::chrono::steady_clock::now() + kPatienceWithListeners;
  links.add(listeners);
  for (const RegionId region : listeners) {
    Link& link = *links.find(region);
    while (!link.met && !links.is_lost(link) && std::chrono::steady_clock::now() < deadline) {
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

/// Makes the writers to regions to which no hand-off has gone before, and waits until they are matched.
void DdsTransport::Impl::make_writers_for(const core::Outbox& outbox) {
  std::vector<RegionId> fresh;
  for (const auto& hand_off : outbox.hand_offs) {
    Link* const link = links.find(hand_off.destination);
    if (link == nullptr || link->lost || link->migration_writer) continue;
    links.migrations_to(*link);
    link->met = false;
    fresh.push_back(link->region);
  }
  wait_for(fresh);
}

std::vector<std::string> DdsTransport::Impl::unmatched(const Link& link) const {
  std::vector<std::string> missing = links.unmatched(link);
  if (seams) {
    for (std::string& name : seams->unmatched(link.region)) missing.push_back(std::move(name));
  }
  return missing;
}

std::vector<std::string> DdsTransport::Impl::missing_neighbours(std::vector<RegionId>& regions) const {
  std::vector<std::string> texts;
  for (const auto& link : links.all()) {
    const auto missing = unmatched(*link);
    if (missing.empty() || link->lost) {
      continue;
    }
    regions.push_back(link->region);
    texts.push_back(missing.size() == endpoints_of(*link)
                        ? fmt::format("region {} (nothing received from it)", value_of(link->region))
                        : fmt::format("region {} ({})", value_of(link->region), fmt::join(missing, ", ")));
  }
  return texts;
}

/// True if writers have come or gone, or some time has passed: a look compares all links with all writers.
bool DdsTransport::Impl::is_time_for_peers() {
  const auto now = std::chrono::steady_clock::now();
  std::uint64_t changes = 0;
  for (const auto& reader : links.aura_readers()) changes += reader->watch().changes();
  if (changes == seen_changes && now < next_look_at_peers) return false;
  seen_changes = changes;
  next_look_at_peers = now + kLookAtPeersEvery;
  return true;
}

void DdsTransport::Impl::take_peer_changes(std::vector<core::PeerEvent>& peers) {
  for (const auto& link : links.all()) {
    const RemoteWriter writer = links.aura_writer_of(*link);
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
  links.auras().forget_acknowledged();
  count_sent(counters.aura, links.auras().write(&aura), bytes_of(aura));
}

void DdsTransport::Impl::send_hand_off(const core::HandOff& hand_off) {
  Link* link = links.find(hand_off.destination);
  if (link == nullptr || link->lost) {
    ++counters.migration.not_sent;
    return;
  }
  messages::encode(hand_off, migration);
  Writer& writer = links.migrations_to(*link);
  writer.forget_acknowledged();
  count_sent(counters.migration, writer.write(&migration), bytes_of(migration));
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
  return std::ranges::all_of(impl_->links.all(),
                             [&](const auto& link) { return link->lost || impl_->unmatched(*link).empty(); });
}

std::size_t DdsTransport::found() const {
  std::size_t found = 0;
  for (const auto& link : impl_->links.all()) found += impl_->endpoints_of(*link) - impl_->unmatched(*link).size();
  return found;
}

void DdsTransport::take(core::Inbox& inbox) {
  impl_->participant.progress();
  const auto take_all = [&](Reader& reader, auto& sample, auto& messages, TopicCounters& topic) {
    impl_->take_all(reader, sample, messages, topic, inbox.refusals);
  };
  TransportCounters& counters = impl_->counters;
  for (const auto& reader : impl_->links.aura_readers()) take_all(*reader, impl_->aura, inbox.auras, counters.aura);
  take_all(impl_->links.migrations(), impl_->migration, inbox.hand_offs, counters.migration);
  if (impl_->is_time_for_peers()) impl_->take_peer_changes(inbox.peers);
}

void DdsTransport::send(const core::Outbox& outbox) {
  impl_->participant.progress();
  for (const RegionId region : outbox.left) impl_->links.remove(region);
  impl_->links.add(outbox.expected);
  impl_->wait_for(outbox.listeners);
  impl_->make_writers_for(outbox);
  for (const auto& hand_off : outbox.hand_offs) {
    impl_->send_hand_off(hand_off);
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
  for (const auto& link : impl_->links.all()) {
    if (link->refused > 0) refused.emplace_back(link->region, link->refused);
  }
  return refused;
}

}  // namespace aurasim::dds
