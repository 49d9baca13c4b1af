#include "dds/checkpoint_bus.h"

#include <deque>
#include <list>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "dds/typed_endpoints.h"
#include "messages/checkpoint_codec.h"

namespace aurasim::dds {

namespace {

/// Most parts that are kept back because no status has identified their sender as a node yet.
constexpr std::size_t kMostWaiting = 64;

struct Given {
  messages::Checkpoint part;
  Origin by;
};

}  // namespace

struct CheckpointBus::Impl {
  Impl(Participant& participant_in, core::RegionId region_in)
      : participant(participant_in), region(region_in), wakeup(participant.domain().wakeup()) {
    read();
  }

  void read() {
    reader.emplace(participant.domain(),
                   EndpointSpec{TopicId::kCheckpoint,
                                {topics::partition_of(TopicId::kCheckpoint, {.destination = region, .life = life}),
                                 topics::kWorldPartition},
                                region},
                   wakeup);
  }

  Participant& participant;
  core::RegionId region;
  Wakeup& wakeup;
  /// Made when there is something to send: it is matched with all nodes, and recoveries are rare.
  std::optional<TypedWriter<wire::Checkpoint>> to_all;
  core::Generation life = 0;
  core::Generation generation_to_all = 0;  ///< of the last part sent to all
  std::vector<core::RegionId> keepers;
  /// One writer per keeper, so that a slow keeper delays only its own parts.
  std::list<TypedWriter<wire::Checkpoint>> to_keepers;
  std::optional<TypedReader<wire::Checkpoint>> reader;
  std::deque<Given> given;
};

CheckpointBus::CheckpointBus(Participant& participant, core::RegionId region)
    : impl_(std::make_unique<Impl>(participant, region)) {}

CheckpointBus::~CheckpointBus() = default;

void CheckpointBus::use_keepers(const std::vector<core::RegionId>& keepers, core::Generation life) {
  if (impl_->keepers == keepers && impl_->life == life) return;
  impl_->keepers = keepers;
  if (std::exchange(impl_->life, life) != life) impl_->read();
  impl_->to_keepers.clear();
  for (const core::RegionId keeper : keepers) {
    impl_->to_keepers.emplace_back(
        impl_->participant.domain(),
        on(TopicId::kCheckpoint, {.source = impl_->region, .destination = keeper, .life = life}, impl_->region),
        impl_->wakeup);
  }
}

std::size_t CheckpointBus::send_to_keepers(const messages::Checkpoint& checkpoint) {
  impl_->participant.progress();
  std::size_t sent = 0;
  for (TypedWriter<wire::Checkpoint>& keeper : impl_->to_keepers) {
    const bool is_free = keeper.reader_count() > 0 && keeper.all_acknowledged();
    if (is_free && keeper.send_newest(checkpoint) != WriteResult::kFailed) ++sent;
  }
  return sent;
}

bool CheckpointBus::send_to_all(const messages::Checkpoint& checkpoint) {
  impl_->participant.progress();
  if (!impl_->to_all) {
    impl_->to_all.emplace(impl_->participant.domain(),
                          EndpointSpec{TopicId::kCheckpoint, {topics::kWorldPartition}, {}, {}}, impl_->wakeup);
  }
  // Parts for an earlier generation are of no use any more.
  if (std::exchange(impl_->generation_to_all, checkpoint.generation) != checkpoint.generation) {
    impl_->to_all->forget_all();
  }
  return impl_->to_all->send(checkpoint) != WriteResult::kFailed;
}

std::vector<messages::Checkpoint> CheckpointBus::take() {
  impl_->participant.progress();
  std::vector<messages::Checkpoint> taken;
  const Speakers& speakers = impl_->participant.domain().speakers();
  // In a recovery any node may send another region's part, because it may be its keeper.
  const auto may_say = [&](const Given& given) {
    return given.part.kind == messages::Checkpoint::Kind::kGoBack
               ? speakers.is_node(given.by.writer)
               : speakers.may_speak(given.by.writer, given.part.source);
  };
  impl_->reader->take_each({}, [&](messages::Checkpoint&& part, const Origin& by) {
    impl_->given.push_back({std::move(part), by});
  });
  std::erase_if(impl_->given, [&](Given& given) {
    const bool is_taken = may_say(given);
    if (is_taken) taken.push_back(std::move(given.part));
    return is_taken;
  });
  for (; impl_->given.size() > kMostWaiting; impl_->given.pop_front()) {
    const Given& oldest = impl_->given.front();
    impl_->reader->refuse_from(oldest.by, fmt::format("a part of region {}", core::value_of(oldest.part.source)));
  }
  return taken;
}

const messages::WireErrors& CheckpointBus::refused() const { return impl_->reader->refused(); }

}  // namespace aurasim::dds
