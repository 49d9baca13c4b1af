#include "dds/replica_bus.h"

#include <utility>
#include <variant>

#include "aurasim.h"
#include "dds/endpoints.h"
#include "dds/replica_codec.h"

namespace aurasim::dds {
namespace {

Expected expected_of(const ObserverSettings& settings) {
  Expected expected;
  expected.map_version = settings.map_version;
  expected.region_count = settings.region_count;
  expected.prototype_count = settings.prototype_count;
  return expected;
}

template <class WireMessage, class Message>
void drain(Reader& reader, WireMessage& sample, const Expected& expected, std::vector<Message>& out,
           WireErrors& refused) {
  while (reader.take(&sample)) {
    auto decoded = decode(sample, expected);
    if (const auto* error = std::get_if<WireError>(&decoded)) {
      refused.add(*error);
    } else {
      out.push_back(std::move(std::get<Message>(decoded)));
    }
  }
}

}  // namespace

struct ReplicaWriter::Impl {
  Impl(Participant& participant, core::RegionId region)
      : deltas(participant.domain(), {TopicId::kReplica, {partition_of(region)}, region, {}}, bell),
        keys(participant.domain(), {TopicId::kReplicaKey, {partition_of(region)}, region, {}}, bell) {}

  Bell bell;
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
        deltas(participant.domain(), {TopicId::kReplica, {kEveryRegionPartition}, {}, {}}, bell),
        keys(participant.domain(), {TopicId::kReplicaKey, {kEveryRegionPartition}, {}, {}}, bell) {}

  Participant& participant;
  Expected expected;
  Bell bell;
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
  impl_->bell.quiet();
  std::vector<core::Replica> replicas;
  drain(impl_->deltas, impl_->sample, impl_->expected, replicas, impl_->refused);
  drain(impl_->keys, impl_->sample, impl_->expected, replicas, impl_->refused);
  impl_->received += replicas.size();
  return replicas;
}

void ReplicaReader::wait(std::chrono::nanoseconds time_out) {
  impl_->participant.progress();
  impl_->bell.wait(time_out);
}

const WireErrors& ReplicaReader::refused() const { return impl_->refused; }

std::uint64_t ReplicaReader::received() const { return impl_->received; }

struct AuraWatch::Impl {
  Impl(Participant& participant, const ObserverSettings& settings)
      : expected(expected_of(settings)),
        reader(participant.domain(), {TopicId::kAura, {kEveryRegionPartition}, {}, "aura_observer_reader"}, bell) {}

  Expected expected;
  Bell bell;
  Reader reader;
  wire::AuraBatch sample;  // reused
  WireErrors refused;
};

AuraWatch::AuraWatch(Participant& participant, const ObserverSettings& settings)
    : impl_(std::make_unique<Impl>(participant, settings)) {}

AuraWatch::~AuraWatch() = default;

std::vector<core::AuraBatch> AuraWatch::take() {
  std::vector<core::AuraBatch> batches;
  drain(impl_->reader, impl_->sample, impl_->expected, batches, impl_->refused);
  return batches;
}

}  // namespace aurasim::dds
