#include "dds/replica_bus.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "dds/observing.h"
#include "dds/typed_endpoints.h"

namespace aurasim::dds {
struct ReplicaWriter::Impl {
  Impl(Participant& participant, core::RegionId region)
      : deltas(participant.domain(), on(TopicId::kReplica, {.source = region}, region), wakeup),
        keys(participant.domain(), on(TopicId::kReplicaKey, {.source = region}, region), wakeup) {}

  Wakeup wakeup;
  TypedWriter<wire::Replica> deltas;
  TypedWriter<wire::Replica> keys;
};

ReplicaWriter::ReplicaWriter(Participant& participant, core::RegionId region)
    : impl_(std::make_unique<Impl>(participant, region)) {}

ReplicaWriter::~ReplicaWriter() = default;

bool ReplicaWriter::send(const core::Replica& replica) {
  const WriteResult sent = replica.key_frame ? impl_->keys.send_newest(replica) : impl_->deltas.send(replica);
  return sent != WriteResult::kFailed;
}

bool ReplicaWriter::anybody_listens() const {
  return impl_->deltas.reader_count() > 0 || impl_->keys.reader_count() > 0;
}

std::uint64_t ReplicaWriter::arrivals() const { return impl_->deltas.matches() + impl_->keys.matches(); }

struct ReplicaReader::Impl {
  Impl(Participant& participant_in, const ObserverSettings& settings)
      : participant(participant_in), expected(expected_of(settings)), wakeup(participant.domain().wakeup()) {
    listen();
  }

  void listen() {
    deltas.emplace(participant.domain(), on(TopicId::kReplica), wakeup);
    keys.emplace(participant.domain(), on(TopicId::kReplicaKey), wakeup);
  }
  void take_from(TypedReader<wire::Replica>& reader, std::vector<core::Replica>& replicas);
  void listen_anew_to_who_became_a_node();

  Participant& participant;
  messages::Expected expected;
  Wakeup& wakeup;
  std::optional<TypedReader<wire::Replica>> deltas;
  std::optional<TypedReader<wire::Replica>> keys;
  std::uint64_t received = 0;
  std::uint64_t refused_before = 0;  ///< samples refused by former readers
  /// Regions and processes whose replicas were refused because the process was not known as that region's node.
  std::set<std::pair<core::RegionId, ProcessPrefix>> strangers;
};

/// Most processes remembered that are no nodes, however many send.
constexpr std::size_t kMostStrangers = 64;

void ReplicaReader::Impl::take_from(TypedReader<wire::Replica>& reader, std::vector<core::Replica>& replicas) {
  const Speakers& speakers = participant.domain().speakers();
  reader.take_each(expected, [&](core::Replica&& replica, const Origin& origin) {
    const bool is_of_node = speakers.may_speak(origin.writer, replica.source);
    if (is_of_node && speakers.is_at_home(origin.writer, replica.source)) return replicas.push_back(std::move(replica));
    if (!is_of_node && strangers.size() < kMostStrangers) strangers.emplace(replica.source, origin.writer.guidPrefix);
    reader.refuse_from(origin, fmt::format("it is not the node of region {}", core::value_of(replica.source)));
  });
}

/// Renews the readers when a process whose replicas were refused has become a node. Replicas of a process that takes
/// over a region can arrive before its status. Refused ones are not retransmitted, and a paused node has nothing new to
/// publish. New readers get a key frame from every node.
void ReplicaReader::Impl::listen_anew_to_who_became_a_node() {
  const auto is_node = [&speakers = participant.domain().speakers()](const auto& stranger) {
    return speakers.of(stranger.first) == stranger.second;
  };
  if (std::ranges::none_of(strangers, is_node)) return;
  refused_before += deltas->refused().total() + keys->refused().total();
  listen();
  strangers.clear();
}

ReplicaReader::ReplicaReader(Participant& participant, const ObserverSettings& settings)
    : impl_(std::make_unique<Impl>(participant, settings)) {}

ReplicaReader::~ReplicaReader() = default;

std::vector<core::Replica> ReplicaReader::take() {
  impl_->participant.progress();
  std::vector<core::Replica> replicas;
  for (auto* reader : {&impl_->deltas, &impl_->keys}) impl_->take_from(**reader, replicas);
  impl_->listen_anew_to_who_became_a_node();
  impl_->received += replicas.size();
  return replicas;
}

void ReplicaReader::wait(std::chrono::nanoseconds time_out) {
  impl_->participant.progress();
  impl_->wakeup.wait(time_out);
}

std::uint64_t ReplicaReader::refused() const {
  return impl_->refused_before + impl_->deltas->refused().total() + impl_->keys->refused().total();
}

std::uint64_t ReplicaReader::received() const { return impl_->received; }

}  // namespace aurasim::dds
