#include "dds/scene_additions_bus.h"

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "core/mesh_hash.h"
#include "dds/typed_endpoints.h"

namespace aurasim::dds {
struct SceneAdditionsWriter::Impl {
  Impl(Participant& participant_in, core::RegionId region_in) : participant(participant_in), region(region_in) {
    if (core::value_of(region) == 0) make_writer();  // other tools find the topic by it
  }

  void make_writer() {
    if (!writer) writer.emplace(participant.domain(), on(TopicId::kOrders), wakeup);
  }

  Participant& participant;
  core::RegionId region;
  Wakeup wakeup;
  std::optional<TypedWriter<wire::AuraBatch>> writer;  ///< the node that becomes the lead makes one
};

SceneAdditionsWriter::SceneAdditionsWriter(Participant& participant, core::RegionId region)
    : impl_(std::make_unique<Impl>(participant, region)) {}

SceneAdditionsWriter::~SceneAdditionsWriter() = default;

void SceneAdditionsWriter::send(const SceneAdditions& additions) {
  core::AuraBatch batch;
  batch.source = impl_->region;
  batch.generation = additions.generation;
  batch.orders = additions.orders;
  batch.stamp = static_cast<core::Step>(additions.orders.size());
  impl_->make_writer();
  impl_->writer->send_newest(batch);
}

struct SceneAdditionsReader::Impl {
  explicit Impl(Participant& participant_in)
      : participant(participant_in), reader(participant.domain(), on(TopicId::kOrders), wakeup) {}

  Participant& participant;
  Wakeup wakeup;
  TypedReader<wire::AuraBatch> reader;
};

SceneAdditionsReader::SceneAdditionsReader(Participant& participant) : impl_(std::make_unique<Impl>(participant)) {}

SceneAdditionsReader::~SceneAdditionsReader() = default;

std::optional<SceneAdditions> SceneAdditionsReader::take() {
  std::optional<SceneAdditions> newest;
  const auto last_of = [](const std::vector<core::Order>& orders) {
    return orders.empty() ? 0 : orders.back().sequence;
  };
  const auto is_newer = [&](const core::AuraBatch& batch) {
    return !newest ||
           std::pair(batch.generation, last_of(batch.orders)) >= std::pair(newest->generation, last_of(newest->orders));
  };
  impl_->reader.take_each({}, [&](core::AuraBatch&& batch, const Origin& origin) {
    if (!impl_->participant.domain().speakers().may_speak(origin.writer, batch.source)) {
      impl_->reader.refuse_from(origin, "orders that are not its own");
    } else if (is_newer(batch)) {
      newest = SceneAdditions{batch.generation, std::move(batch.orders)};
    }
  });
  return newest;
}

struct MeshWriter::Impl {
  explicit Impl(Participant& participant) : writer(participant.domain(), on(TopicId::kShape), wakeup) {}

  Wakeup wakeup;
  TypedWriter<wire::MeshShape> writer;
};

MeshWriter::MeshWriter(Participant& participant) : impl_(std::make_unique<Impl>(participant)) {}

MeshWriter::~MeshWriter() = default;

bool MeshWriter::publish_again(std::uint64_t hash, const core::TriangleMesh& mesh) {
  return impl_->writer.send(messages::NamedMesh{hash, mesh, true}) != WriteResult::kFailed;
}

struct MeshReader::Impl {
  Impl(Participant& participant_in, const MeshCacheLimits& limits)
      : participant(participant_in), reader(participant.domain(), on(TopicId::kShape), wakeup), meshes(limits) {}

  /// True when the mesh has the hash that it is named by. Meshes that a node publishes again are not checked: it
  /// checked them on receipt, and worlds saved by others may use other names.
  bool is_what_it_is_called(const messages::NamedMesh& named, const Origin& origin) const {
    return core::content_hash(named.mesh) == named.hash ||
           (named.is_told_again && participant.domain().speakers().is_node(origin.writer));
  }

  Participant& participant;
  Wakeup wakeup;
  TypedReader<wire::MeshShape> reader;
  MeshCache meshes;
  std::uint64_t without_room = 0, misnamed = 0;
};

MeshReader::MeshReader(Participant& participant, const MeshCacheLimits& limits)
    : impl_(std::make_unique<Impl>(participant, limits)) {}

MeshReader::~MeshReader() = default;

MeshCache& MeshReader::meshes() {
  impl_->reader.take_each({}, [&](messages::NamedMesh&& named, const Origin& origin) {
    if (!impl_->is_what_it_is_called(named, origin)) {
      ++impl_->misnamed;
      return impl_->reader.refuse_from(origin, "a mesh that is not the one that it is called");
    }
    const std::uint64_t source = std::hash<std::string>()(text_of(origin.writer.guidPrefix));
    const bool added = named.is_told_again ? impl_->meshes.add_spare(named.hash, std::move(named.mesh), source)
                                           : impl_->meshes.add(named.hash, std::move(named.mesh), source);
    if (!added) ++impl_->without_room;
  });
  return impl_->meshes;
}

std::uint64_t MeshReader::refused() const {
  return impl_->reader.refused().total() + impl_->without_room + impl_->misnamed;
}

}  // namespace aurasim::dds
