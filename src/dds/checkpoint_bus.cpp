#include "dds/checkpoint_bus.h"

#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "dds/checkpoint_codec.h"
#include "dds/typed_endpoints.h"

namespace aurasim::dds {

struct CheckpointBus::Impl {
  Impl(Participant& participant_in, core::RegionId region_in)
      : participant(participant_in),
        region(region_in),
        to_all(participant.domain(), in_world(TopicId::kCheckpoint), wakeup) {
    read();
  }

  void read() {
    reader.emplace(participant.domain(),
                   EndpointSpec{TopicId::kCheckpoint, {in_life(partition_to(region), life), kWorldPartition}, region},
                   wakeup);
  }

  Participant& participant;
  core::RegionId region;
  Wakeup wakeup;
  TypedWriter<wire::Checkpoint> to_all;
  core::Generation life = 0;
  std::optional<core::RegionId> keeper;
  std::optional<TypedWriter<wire::Checkpoint>> to_keeper;
  std::optional<TypedReader<wire::Checkpoint>> reader;
};

CheckpointBus::CheckpointBus(Participant& participant, core::RegionId region)
    : impl_(std::make_unique<Impl>(participant, region)) {}

CheckpointBus::~CheckpointBus() = default;

void CheckpointBus::use_keeper(core::RegionId keeper, core::Generation life) {
  if (impl_->keeper == keeper && impl_->life == life) return;
  impl_->keeper = keeper;
  if (std::exchange(impl_->life, life) != life) impl_->read();
  const std::string partition = in_life(partition_of(impl_->region, keeper), life);
  impl_->to_keeper.emplace(impl_->participant.domain(), EndpointSpec{TopicId::kCheckpoint, {partition}, impl_->region},
                           impl_->wakeup);
}

bool CheckpointBus::send(const Checkpoint& checkpoint) {
  impl_->participant.progress();
  if (checkpoint.kind != Checkpoint::Kind::kToKeep) return impl_->to_all.send(checkpoint) != WriteResult::kFailed;
  return !impl_->to_keeper || impl_->to_keeper->send(checkpoint) != WriteResult::kFailed;
}

bool CheckpointBus::is_kept() {
  return impl_->to_keeper && impl_->to_keeper->reader_count() > 0 && impl_->to_keeper->all_acknowledged();
}

std::vector<Checkpoint> CheckpointBus::take() {
  impl_->participant.progress();
  impl_->wakeup.clear();
  std::vector<Checkpoint> taken;
  const Speakers& speakers = impl_->participant.domain().speakers();
  impl_->reader->take_each({}, [&](Checkpoint&& part, const Origin& origin) {
    // In a recovery, whoever keeps another's part gives it.
    const bool may_say = part.kind == Checkpoint::Kind::kGoBack ? speakers.is_node(origin.writer)
                                                                : speakers.may_speak(origin.writer, part.source);
    if (may_say) return taken.push_back(std::move(part));
    impl_->reader->refuse_from(origin, fmt::format("a part of region {}", core::value_of(part.source)));
  });
  return taken;
}

const WireErrors& CheckpointBus::refused() const { return impl_->reader->refused(); }

}  // namespace aurasim::dds
