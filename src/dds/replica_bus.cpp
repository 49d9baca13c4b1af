#include "dds/replica_bus.h"

#include "aurasim.h"
#include "dds/observing.h"
#include "dds/replica_codec.h"

namespace aurasim::dds {
struct ReplicaWriter::Impl {
  Impl(Participant& participant, core::RegionId region)
      : deltas(participant.domain(), {TopicId::kReplica, {partition_of(region)}, region, {}}, wakeup),
        keys(participant.domain(), {TopicId::kReplicaKey, {partition_of(region)}, region, {}}, wakeup) {}

  Wakeup wakeup;
  Writer deltas;
  Writer keys;
  wire::Replica sample;  // reused
};

ReplicaWriter::ReplicaWriter(Participant& participant, core::RegionId region)
    : impl_(std::make_unique<Impl>(participant, region)) {}

ReplicaWriter::~ReplicaWriter() = default;

bool ReplicaWriter::send(const core::Replica& replica) {
  encode(replica, impl_->sample);
  Writer& writer = replica.key_frame ? impl_->keys : impl_->deltas;
  return writer.write(&impl_->sample) != WriteResult::kFailed;
}

bool ReplicaWriter::anybody_listens() const {
  return impl_->deltas.reader_count() > 0 || impl_->keys.reader_count() > 0;
}

std::uint64_t ReplicaWriter::arrivals() const { return impl_->deltas.matches() + impl_->keys.matches(); }

struct ReplicaReader::Impl {
  Impl(Participant& participant_in, const ObserverSettings& settings)
      : participant(participant_in),
        expected(expected_of(settings)),
        deltas(participant.domain(), {TopicId::kReplica, {kEveryRegionPartition}, {}, {}}, wakeup),
        keys(participant.domain(), {TopicId::kReplicaKey, {kEveryRegionPartition}, {}, {}}, wakeup) {}

  Participant& participant;
  Expected expected;
  Wakeup wakeup;
  Reader deltas;
  Reader keys;
  wire::Replica sample;  // reused
  WireErrors refused;
  std::uint64_t received = 0;
};

ReplicaReader::ReplicaReader(Participant& participant, const ObserverSettings& settings)
    : impl_(std::make_unique<Impl>(participant, settings)) {}

ReplicaReader::~ReplicaReader() = default;

std::vector<core::Replica> ReplicaReader::take() {
  impl_->participant.progress();
  impl_->wakeup.clear();
  std::vector<core::Replica> replicas;
  drain(impl_->deltas, impl_->sample, impl_->expected, replicas, impl_->refused);
  drain(impl_->keys, impl_->sample, impl_->expected, replicas, impl_->refused);
  impl_->received += replicas.size();
  return replicas;
}

void ReplicaReader::wait(std::chrono::nanoseconds time_out) {
  impl_->participant.progress();
  impl_->wakeup.wait(time_out);
}

const WireErrors& ReplicaReader::refused() const { return impl_->refused; }

std::uint64_t ReplicaReader::received() const { return impl_->received; }

}  // namespace aurasim::dds
