#include "dds/overlay_bus.h"

#include "dds/observing.h"
#include "dds/typed_endpoints.h"

namespace aurasim::dds {
namespace {

/// Reader of a topic of all regions whose samples may be missed.
template <class Wire>
class Glance {
 public:
  Glance(Participant& participant, const ObserverSettings& settings, TopicId topic, const char* profile)
      : expected_(expected_of(settings)),
        reader_(participant.domain(), {topic, {topics::partition_of(topic)}, {}, profile}, wakeup_) {}

  auto take() {
    std::vector<typename TypedReader<Wire>::Message> messages;
    reader_.take_all(expected_, messages);
    return messages;
  }

 private:
  messages::Expected expected_;
  Wakeup wakeup_;
  TypedReader<Wire> reader_;
};

}  // namespace

struct ClusterGraphWriter::Impl {
  Impl(Participant& participant, core::RegionId region)
      : writer(participant.domain(), on(TopicId::kClusterGraph, {.source = region}, region), wakeup) {}

  Wakeup wakeup;
  TypedWriter<wire::ClusterGraph> writer;
};

ClusterGraphWriter::ClusterGraphWriter(Participant& participant, core::RegionId region)
    : impl_(std::make_unique<Impl>(participant, region)) {}

ClusterGraphWriter::~ClusterGraphWriter() = default;

bool ClusterGraphWriter::anybody_listens() const { return impl_->writer.reader_count() > 0; }

void ClusterGraphWriter::send(const core::ClusterGraph& graph) { impl_->writer.send(graph); }

struct ClusterGraphWatch::Impl : Glance<wire::ClusterGraph> {
  using Glance::Glance;
};

ClusterGraphWatch::ClusterGraphWatch(Participant& participant, const ObserverSettings& settings)
    : impl_(std::make_unique<Impl>(participant, settings, TopicId::kClusterGraph, "cluster_graph_reader")) {}

ClusterGraphWatch::~ClusterGraphWatch() = default;

std::vector<core::ClusterGraph> ClusterGraphWatch::take() { return impl_->take(); }

struct AuraWatch::Impl : Glance<wire::AuraBatch> {
  using Glance::Glance;
};

AuraWatch::AuraWatch(Participant& participant, const ObserverSettings& settings)
    : impl_(std::make_unique<Impl>(participant, settings, TopicId::kAura, "aura_observer_reader")) {}

AuraWatch::~AuraWatch() = default;

std::vector<core::AuraBatch> AuraWatch::take() { return impl_->take(); }

}  // namespace aurasim::dds
