#include "dds/overlay_bus.h"

#include "aurasim.h"
#include "dds/bonds_codec.h"
#include "dds/observing.h"

namespace aurasim::dds {
namespace {

/// A topic of all regions, of which samples may be missed.
template <class WireMessage, class Message>
class Glance {
 public:
  Glance(Participant& participant, const ObserverSettings& settings, TopicId topic, const char* profile)
      : expected_(expected_of(settings)),
        reader_(participant.domain(), {topic, {kEveryRegionPartition}, {}, profile}, bell_) {}

  std::vector<Message> take() {
    std::vector<Message> messages;
    drain(reader_, sample_, expected_, messages, refused_);
    return messages;
  }

 private:
  Expected expected_;
  Bell bell_;
  Reader reader_;
  WireMessage sample_;  // reused
  WireErrors refused_;
};

}  // namespace

struct BondsWriter::Impl {
  Impl(Participant& participant, core::RegionId region)
      : writer(participant.domain(), {TopicId::kBonds, {partition_of(region)}, region, {}}, bell) {}

  Bell bell;
  Writer writer;
  wire::Bonds sample;  // reused
};

BondsWriter::BondsWriter(Participant& participant, core::RegionId region)
    : impl_(std::make_unique<Impl>(participant, region)) {}

BondsWriter::~BondsWriter() = default;

bool BondsWriter::anybody_listens() const { return impl_->writer.reader_count() > 0; }

void BondsWriter::send(const core::Bonds& bonds) {
  encode(bonds, impl_->sample);
  impl_->writer.write(&impl_->sample);
}

struct BondsWatch::Impl : Glance<wire::Bonds, core::Bonds> {
  using Glance::Glance;
};

BondsWatch::BondsWatch(Participant& participant, const ObserverSettings& settings)
    : impl_(std::make_unique<Impl>(participant, settings, TopicId::kBonds, "bonds_reader")) {}

BondsWatch::~BondsWatch() = default;

std::vector<core::Bonds> BondsWatch::take() { return impl_->take(); }

struct AuraWatch::Impl : Glance<wire::AuraBatch, core::AuraBatch> {
  using Glance::Glance;
};

AuraWatch::AuraWatch(Participant& participant, const ObserverSettings& settings)
    : impl_(std::make_unique<Impl>(participant, settings, TopicId::kAura, "aura_observer_reader")) {}

AuraWatch::~AuraWatch() = default;

std::vector<core::AuraBatch> AuraWatch::take() { return impl_->take(); }

}  // namespace aurasim::dds
