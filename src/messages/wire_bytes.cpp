#include "messages/wire_bytes.h"

#include <stdexcept>

#include "aurasim.h"
#include "aurasimPubSubTypes.h"
#include "messages/type_tables.h"

namespace aurasim::messages {
namespace {

using eprosima::fastrtps::rtps::SerializedPayload_t;

template <class Type, class Sample>
std::vector<std::uint8_t> serialized(Type& type, Sample& sample) {
  SerializedPayload_t payload(type.getSerializedSizeProvider(&sample)());
  if (!type.serialize(&sample, &payload)) throw std::logic_error("a message does not fit into its own size");
  return {payload.data, payload.data + payload.length};
}

/// Deserializes a sample. Returns false when the bytes are not the type.
template <class Type, class Sample>
bool deserialize(Type& type, std::span<const std::uint8_t> bytes, Sample& sample) {
  SerializedPayload_t payload(static_cast<std::uint32_t>(bytes.size()));
  std::copy(bytes.begin(), bytes.end(), payload.data);
  payload.length = static_cast<std::uint32_t>(bytes.size());
  try {
    return type.deserialize(&payload, &sample);
  } catch (const std::exception&) {  // e.g. a boolean that is neither 0 nor 1
    return false;
  }
}

}  // namespace

struct WireBytes::Samples {
  wire::AuraBatch aura;
  wire::Migration migration;
  wire::MeshShape mesh;
  wire::Setpoints setpoints;
  wire::AuraBatchPubSubType aura_type;
  wire::MigrationPubSubType migration_type;
  wire::MeshShapePubSubType mesh_type;
  wire::SetpointsPubSubType setpoints_type;
};

WireBytes::WireBytes() {
  set_type_tables_up();
  samples_ = std::make_unique<Samples>();
}
WireBytes::~WireBytes() = default;

std::vector<std::uint8_t> WireBytes::of(const core::AuraBatch& batch) {
  encode(batch, samples_->aura);
  return serialized(samples_->aura_type, samples_->aura);
}

std::vector<std::uint8_t> WireBytes::of(const core::HandOff& hand_off) {
  encode(hand_off, samples_->migration);
  return serialized(samples_->migration_type, samples_->migration);
}

std::vector<std::uint8_t> WireBytes::of(const NamedMesh& mesh) {
  encode(mesh, samples_->mesh);
  return serialized(samples_->mesh_type, samples_->mesh);
}

std::vector<std::uint8_t> WireBytes::of(const core::Setpoints& setpoints) {
  encode(setpoints, 0, samples_->setpoints);
  return serialized(samples_->setpoints_type, samples_->setpoints);
}

Decoded<core::AuraBatch> WireBytes::aura(std::span<const std::uint8_t> bytes, const Expected& expected) {
  if (!deserialize(samples_->aura_type, bytes, samples_->aura)) return WireError::kMalformed;
  return decode(samples_->aura, expected);
}

Decoded<core::HandOff> WireBytes::hand_off(std::span<const std::uint8_t> bytes, const Expected& expected) {
  if (!deserialize(samples_->migration_type, bytes, samples_->migration)) return WireError::kMalformed;
  return decode(samples_->migration, expected);
}

Decoded<NamedMesh> WireBytes::mesh(std::span<const std::uint8_t> bytes) {
  if (!deserialize(samples_->mesh_type, bytes, samples_->mesh)) return WireError::kMalformed;
  return decode(samples_->mesh, {});
}

Decoded<core::Setpoints> WireBytes::setpoints(std::span<const std::uint8_t> bytes) {
  if (!deserialize(samples_->setpoints_type, bytes, samples_->setpoints)) return WireError::kMalformed;
  return decode(samples_->setpoints, {});
}

}  // namespace aurasim::messages
