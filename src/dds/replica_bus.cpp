#include "dds/replica_bus.h"

#include <utility>

#include <fmt/format.h>

#include "dds/observing.h"
#include "dds/typed_endpoints.h"

namespace aurasim::dds {
struct ReplicaWriter::Impl {
  Impl(Participant& participant, core::RegionId region)
      : deltas(participant.domain(), {TopicId::kReplica, {partition_of(region)}, region, {}}, wakeup),
        keys(participant.domain(), {TopicId::kReplicaKey, {partition_of(region)}, region, {}}, wakeup) {}

  Wakeup wakeup;
  TypedWriter<wire::Replica> deltas;
  TypedWriter<wire::Replica> keys;
};

ReplicaWriter::ReplicaWriter(Participant& participant, core::RegionId region)
    : impl_(std::make_unique<Impl>(participant, region)) {}

ReplicaWriter::~ReplicaWriter() = default;

bool ReplicaWriter::send(const core::Replica& replica) {
  auto& writer = replica.key_frame ? impl_->keys : impl_->deltas;
  return writer.send(replica) != WriteResult::kFailed;
}

bool ReplicaWriter::anybody_listens() const {
  return impl_->deltas.reader_count() > 0 || impl_->keys.reader_count() > 0;
}

std::uint64_t ReplicaWriter::arrivals() const { return impl_->deltas.matches() + impl_->keys.matches(); }

struct ReplicaReader::Impl {
  Impl(Participant& participant_in, const ObserverSettings& settings)
      : participant(participant_in),
        expected(expected_of(settings)),
        wakeup(participant.domain().wakeup()),
        deltas(participant.domain(), {TopicId::kReplica, {kEveryRegionPartition}, {}, {}}, wakeup),
        keys(participant.domain(), {TopicId::kReplicaKey, {kEveryRegionPartition}, {}, {}}, wakeup) {}

  Participant& participant;
  Expected expected;
  Wakeup& wakeup;
  TypedReader<wire::Replica> deltas;
  TypedReader<wire::Replica> keys;
  std::uint64_t received = 0;
};

ReplicaReader::ReplicaReader(Participant& participant, const ObserverSettings& settings)
    : impl_(std::make_unique<Impl>(participant, settings)) {}

ReplicaReader::~ReplicaReader() = default;

std::vector<core::Replica> ReplicaReader::take() {
  impl_->participant.progress();
  std::vector<core::Replica> replicas;
  const Speakers& speakers = impl_->participant.domain().speakers();
  for (TypedReader<wire::Replica>* reader : {&impl_->deltas, &impl_->keys}) {
    reader->take_each(impl_->expected, [&](core::Replica&& replica, const Origin& origin) {
      const bool may_say =
          speakers.may_speak(origin.writer, replica.source) && speakers.is_at_home(origin.writer, replica.source);
      if (may_say) return replicas.push_back(std::move(replica));
      reader->refuse_from(origin, fmt::format("it is not the node of region {}", core::value_of(replica.source)));
    });
  }
  impl_->received += replicas.size();
  return replicas;
}

void ReplicaReader::wait(std::chrono::nanoseconds time_out) {
  impl_->participant.progress();
  impl_->wakeup.wait(time_out);
}

std::uint64_t ReplicaReader::refused() const { return impl_->deltas.refused().total() + impl_->keys.refused().total(); }

std::uint64_t ReplicaReader::received() const { return impl_->received; }

}  // namespace aurasim::dds
