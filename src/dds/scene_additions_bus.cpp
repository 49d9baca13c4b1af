#include "dds/scene_additions_bus.h"

#include <utility>
#include <variant>

#include "aurasim.h"
#include "dds/codec.h"
#include "dds/command_codec.h"
#include "dds/endpoints.h"

namespace aurasim::dds {
struct SceneAdditionsWriter::Impl {
  Impl(Participant& participant, core::RegionId region_in)
      : region(region_in), writer(participant.domain(), in_world(TopicId::kOrders), wakeup) {}

  core::RegionId region;
  Wakeup wakeup;
  Writer writer;
  wire::AuraBatch sample;  // reused
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
  encode(batch, impl_->sample);
  impl_->writer.write(&impl_->sample);
}

struct SceneAdditionsReader::Impl {
  explicit Impl(Participant& participant) : reader(participant.domain(), in_world(TopicId::kOrders), wakeup) {}

  Wakeup wakeup;
  Reader reader;
  wire::AuraBatch sample;  // reused
};

SceneAdditionsReader::SceneAdditionsReader(Participant& participant) : impl_(std::make_unique<Impl>(participant)) {}

SceneAdditionsReader::~SceneAdditionsReader() = default;

std::optional<SceneAdditions> SceneAdditionsReader::take() {
  std::optional<SceneAdditions> newest;
  const auto is_newer = [&newest](const core::AuraBatch& batch) {
    return !newest ||
           std::pair(batch.generation, batch.orders.size()) >= std::pair(newest->generation, newest->orders.size());
  };
  while (impl_->reader.take(&impl_->sample)) {
    auto decoded = decode(impl_->sample, {});
    auto* const batch = std::get_if<core::AuraBatch>(&decoded);
    if (batch != nullptr && is_newer(*batch)) newest = SceneAdditions{batch->generation, std::move(batch->orders)};
  }
  return newest;
}

struct MeshReader::Impl {
  explicit Impl(Participant& participant) : reader(participant.domain(), in_world(TopicId::kShape), wakeup) {}

  Wakeup wakeup;
  Reader reader;
  wire::MeshShape sample;  // reused
  std::map<std::uint64_t, core::TriangleMesh> meshes;
  std::uint64_t refused = 0;
};

MeshReader::MeshReader(Participant& participant) : impl_(std::make_unique<Impl>(participant)) {}

MeshReader::~MeshReader() = default;

const core::TriangleMesh* MeshReader::mesh(std::uint64_t hash) {
  while (impl_->reader.take(&impl_->sample)) {
    auto decoded = decode(impl_->sample, {});
    if (auto* named = std::get_if<NamedMesh>(&decoded)) {
      impl_->meshes.try_emplace(named->hash, std::move(named->mesh));
    } else {
      ++impl_->refused;
    }
  }
  const auto found = impl_->meshes.find(hash);
  return found == impl_->meshes.end() ? nullptr : &found->second;
}

std::uint64_t MeshReader::refused() const { return impl_->refused; }

}  // namespace aurasim::dds
