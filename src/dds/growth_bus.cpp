#include "dds/growth_bus.h"

#include <utility>
#include <variant>

#include "aurasim.h"
#include "dds/codec.h"
#include "dds/command_codec.h"
#include "dds/endpoints.h"

namespace aurasim::dds {
struct GrowthWriter::Impl {
  Impl(Participant& participant, core::RegionId region_in)
      : region(region_in), writer(participant.domain(), in_world(TopicId::kOrders), bell) {}

  core::RegionId region;
  Bell bell;
  Writer writer;
  wire::AuraBatch sample;  // reused
};

GrowthWriter::GrowthWriter(Participant& participant, core::RegionId region)
    : impl_(std::make_unique<Impl>(participant, region)) {}

GrowthWriter::~GrowthWriter() = default;

void GrowthWriter::send(const Growth& growth) {
  core::AuraBatch batch;
  batch.source = impl_->region;
  batch.generation = growth.generation;
  batch.orders = growth.orders;
  batch.stamp = static_cast<core::Step>(growth.orders.size());
  encode(batch, impl_->sample);
  impl_->writer.write(&impl_->sample);
}

struct GrowthReader::Impl {
  explicit Impl(Participant& participant) : reader(participant.domain(), in_world(TopicId::kOrders), bell) {}

  Bell bell;
  Reader reader;
  wire::AuraBatch sample;  // reused
};

GrowthReader::GrowthReader(Participant& participant) : impl_(std::make_unique<Impl>(participant)) {}

GrowthReader::~GrowthReader() = default;

std::optional<Growth> GrowthReader::take() {
  std::optional<Growth> newest;
  const auto is_newer = [&newest](const core::AuraBatch& batch) {
    return !newest ||
           std::pair(batch.generation, batch.orders.size()) >= std::pair(newest->generation, newest->orders.size());
  };
  while (impl_->reader.take(&impl_->sample)) {
    auto decoded = decode(impl_->sample, {});
    auto* const batch = std::get_if<core::AuraBatch>(&decoded);
    if (batch != nullptr && is_newer(*batch)) newest = Growth{batch->generation, std::move(batch->orders)};
  }
  return newest;
}

struct MeshReader::Impl {
  explicit Impl(Participant& participant) : reader(participant.domain(), in_world(TopicId::kShape), bell) {}

  Bell bell;
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
