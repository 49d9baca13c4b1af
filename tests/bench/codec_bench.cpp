// Encoding and decoding of aura and hand-off batches, with Fast CDR's bytes in between.
#include <aurasim.h>
#include <aurasimPubSubTypes.h>
#include <benchmark/benchmark.h>
#include <fastdds/rtps/common/SerializedPayload.h>

#include "messages/codec.h"

namespace aurasim {
namespace {

using namespace core;
using eprosima::fastrtps::rtps::SerializedPayload_t;

AuraBatch auras(std::size_t count) {
  AuraBatch batch;
  batch.stamp = 100;
  for (std::size_t i = 0; i < count; ++i) {
    AuraRecord record;
    record.id = BodyId{i};
    record.stamp = 100;
    record.pose.p_WB = {double(i), 1, 2};
    record.v_WB = {1, 2, 3};
    record.speed_m_s = 4;
    batch.updates.push_back(record);
  }
  return batch;
}

HandOff hand_off(std::size_t count) {
  HandOff h;
  h.source = RegionId{1};
  h.stamp = 100;
  h.sequence = 1;
  for (std::size_t i = 0; i < count; ++i) {
    BodyRecord body;
    body.id = BodyId{i};
    body.p_WB = {double(i), 1, 2};
    h.cluster.bodies.push_back(body);
    if (i == 0) continue;
    h.cluster.manifolds.push_back(
        {static_cast<ObjectRef>(i - 1), static_cast<ObjectRef>(i), static_cast<std::uint32_t>(4 * (i - 1)), 4});
    h.cluster.points.insert(h.cluster.points.end(), 4 * kContactPointDoubles, 0.5);
  }
  return h;
}

messages::Expected expected() {
  messages::Expected e;
  e.region_count = 4;
  return e;
}

template <class Wire, class Type, class Message>
void there(benchmark::State& state, const Message& message) {
  Wire wire;
  Type type;
  messages::encode(message, wire);
  SerializedPayload_t payload(static_cast<std::uint32_t>(type.getSerializedSizeProvider(&wire)()));
  for (auto _ : state) {
    messages::encode(message, wire);
    benchmark::DoNotOptimize(type.serialize(&wire, &payload));
  }
  state.counters["bytes"] = payload.length;
}

template <class Wire, class Type, class Message>
void back(benchmark::State& state, const Message& message) {
  Wire wire;
  Type type;
  messages::encode(message, wire);
  SerializedPayload_t payload(static_cast<std::uint32_t>(type.getSerializedSizeProvider(&wire)()));
  type.serialize(&wire, &payload);
  const messages::Expected e = expected();
  if (std::holds_alternative<messages::WireError>(messages::decode(wire, e))) state.SkipWithError("refused");
  for (auto _ : state) {
    type.deserialize(&payload, &wire);
    benchmark::DoNotOptimize(messages::decode(wire, e));
  }
}

void encode_auras(benchmark::State& state) {
  there<wire::AuraBatch, wire::AuraBatchPubSubType>(state, auras(static_cast<std::size_t>(state.range(0))));
}
void decode_auras(benchmark::State& state) {
  back<wire::AuraBatch, wire::AuraBatchPubSubType>(state, auras(static_cast<std::size_t>(state.range(0))));
}
void encode_hand_off(benchmark::State& state) {
  there<wire::Migration, wire::MigrationPubSubType>(state, hand_off(static_cast<std::size_t>(state.range(0))));
}
void decode_hand_off(benchmark::State& state) {
  back<wire::Migration, wire::MigrationPubSubType>(state, hand_off(static_cast<std::size_t>(state.range(0))));
}

BENCHMARK(encode_auras)->Arg(10)->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK(decode_auras)->Arg(10)->Arg(100)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK(encode_hand_off)->Arg(1)->Arg(20)->Arg(200)->Unit(benchmark::kMicrosecond);
BENCHMARK(decode_hand_off)->Arg(1)->Arg(20)->Arg(200)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace aurasim
