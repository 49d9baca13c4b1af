#include "dds/overlay_bus.h"

#include "aurasim.h"
#include "dds/cluster_graph_codec.h"
#include "dds/observing.h"

namespace aurasim::dds {
namespace {

/// A topic of all regions, of which samples may be missed.
template <class WireMessage, class Message>
class Glance {
 public:
  Glance(Participant& participant, const ObserverSettings& settings, TopicId topic, const char* profile)
      : expected_(expected_of(settings)),
        reader_(participant.domain(), {topic, {kEveryRegionPartition}, {}, profile}, wakeup_) {}

  std::vector<Message> take() {
    std::vector<Message> messages;
    drain(reader_, sample_, expected_, messages, refused_);
    return messages;
  }

 private:
  Expected expected_;
  Wakeup wakeup_;
  Reader reader_;
  WireMessage sample_;  // reused
  WireErrors refused_;
};

}  // namespace

struct ClusterGraphWriter::Impl {
  Impl(Participant& participant, core::RegionId region)
      : writer(participant.domain(), {TopicId::kClusterGraph, {partition_of(region)}, region, {}}, wakeup) {}

  Wakeup wakeup;
  Writer writer;
  wire::ClusterGraph sample;  // reused
};

ClusterGraphWriter::ClusterGraphWriter(Participant& participant, core::RegionId region)
    : impl_(std::make_unique<Impl>(participant, region)) {}

ClusterGraphWriter::~ClusterGraphWriter() = default;

bool ClusterGraphWriter::anybody_listens() const { return impl_->writer.reader_count() > 0; }

void ClusterGraphWriter::send(const core::ClusterGraph& graph) {
  encode(graph, impl_->sample);
  impl_->writer.write(&impl_->sample);
}

struct ClusterGraphWatch::Impl : Glance<wire::ClusterGraph, core::ClusterGraph> {
  using Glance::Glance;
};

ClusterGraphWatch::ClusterGraphWatch(Participant& participant, const ObserverSettings& settings)
    : impl_(std::make_unique<Impl>(participant, settings, TopicId::kClusterGraph, "cluster_graph_reader")) {}

ClusterGraphWatch::~ClusterGraphWatch() = default;

std::vector<core::ClusterGraph> ClusterGraphWatch::take() { return impl_->take(); }

struct AuraWatch::Impl : Glance<wire::AuraBatch, core::AuraBatch> {
  using Glance::Glance;
};

AuraWatch::AuraWatch(Participant& participant, const ObserverSettings& settings)
    : impl_(std::make_unique<Impl>(participant, settings, TopicId::kAura, "aura_observer_reader")) {}

AuraWatch::~AuraWatch() = default;

std::vector<core::AuraBatch> AuraWatch::take() { return impl_->take(); }

}  // namespace aurasim::dds
