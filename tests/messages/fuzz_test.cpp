// Bytes that are almost messages. Whatever arrives, reading it neither crashes nor throws nor asks for absurd memory.
// AURASIM_SEED replays a run.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "aurasimPubSubTypes.h"
#include "messages/codec.h"
#include "messages/command_codec.h"
#include "messages/control_codec.h"
#include "messages/control_samples.h"
#include "messages/guarded_type.h"
#include "messages/interest_codec.h"
#include "messages/observation_codec.h"
#include "messages/replica_codec.h"
#include "messages/replica_messages.h"
#include "messages/samples.h"

namespace aurasim::messages {
namespace {

using eprosima::fastrtps::rtps::SerializedPayload_t;
using Bytes = std::vector<unsigned char>;

constexpr int kMutations = 40'000;  // per type

std::uint32_t seed() {
  const char* text = std::getenv("AURASIM_SEED");
  return text == nullptr ? 20'240'611U : static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10));
}

template <class Guarded>
Bytes bytes_of(Guarded& type, typename Guarded::Message& message) {
  SerializedPayload_t payload(type.getSerializedSizeProvider(&message)());
  EXPECT_TRUE(type.serialize(&message, &payload));
  return {payload.data, payload.data + payload.length};
}

/// Numbers that lengths and reals trip over.
constexpr std::uint64_t kNasty[] = {0,
                                    1,
                                    0x7f,
                                    0xff,
                                    0x7fff'ffff,
                                    0x8000'0000,
                                    0xffff'ffff,
                                    0xffff'fffe,
                                    0x2000'0000,
                                    0x7ff0'0000'0000'0000,
                                    0x7ff8'0000'0000'0000,
                                    0x7fff'ffff'ffff'ffff,
                                    0x8000'0000'0000'0000,
                                    0x8000'0000'0000'0001};

void mutate(Bytes& bytes, std::mt19937& random) {
  const auto below = [&](std::size_t bound) {
    return std::uniform_int_distribution<std::size_t>(0, bound - 1)(random);
  };
  const std::size_t times = 1 + below(4);
  for (std::size_t i = 0; i < times && !bytes.empty(); ++i) {
    const std::size_t at = below(bytes.size());
    switch (below(6)) {
      case 0:
        bytes[at] = static_cast<unsigned char>(bytes[at] ^ (1U << below(8)));
        break;
      case 1:
        bytes[at] = static_cast<unsigned char>(below(256));
        break;
      case 2:
      case 3: {  // a number, where numbers start
        const std::uint64_t nasty = kNasty[below(std::size(kNasty))];
        const std::size_t start = at / 4 * 4;
        std::memcpy(bytes.data() + start, &nasty, std::min<std::size_t>(below(2) == 0 ? 4 : 8, bytes.size() - start));
        break;
      }
      case 4:
        bytes.resize(at);
        break;
      default:
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), 1 + below(9), 0xaa);
    }
  }
}

struct Verdicts {
  int accepted = 0;
  WireErrors refused;
};

/// Reads mutations of `message` as a reader would, into one reused sample.
template <class PubSubType>
Verdicts read_mutations(typename PubSubType::type message) {
  GuardedType<PubSubType> type;
  const Bytes original = bytes_of(type, message);
  std::mt19937 random(seed());
  Verdicts verdicts;
  typename PubSubType::type sample;
  for (int i = 0; i < kMutations; ++i) {
    Bytes bytes = original;
    mutate(bytes, random);
    SerializedPayload_t payload(static_cast<std::uint32_t>(bytes.size()));  // to the byte, so that ASan sees overruns
    std::copy(bytes.begin(), bytes.end(), payload.data);
    payload.length = static_cast<std::uint32_t>(bytes.size());
    EXPECT_TRUE(type.deserialize(&payload, &sample));
    const auto decoded = decode(sample, Expected{});
    if (const auto* error = std::get_if<WireError>(&decoded)) {
      verdicts.refused.add(*error);
    } else {
      ++verdicts.accepted;
    }
  }
  return verdicts;
}

void report(const char* name, const Verdicts& verdicts) {
  std::cout << name << ": seed " << seed() << ", " << kMutations << " mutations, " << verdicts.accepted << " accepted";
  for (std::size_t i = 0; i < kWireErrorKinds; ++i) {
    const auto error = static_cast<WireError>(i);
    std::cout << ", " << verdicts.refused.count(error) << ' ' << name_of(error);
  }
  std::cout << '\n';
  EXPECT_GT(verdicts.refused.count(WireError::kMalformed), 0U) << "the mutations are too tame";
  EXPECT_EQ(verdicts.accepted + static_cast<int>(verdicts.refused.total()), kMutations);
}

TEST(Fuzz, AuraBatches) {
  wire::AuraBatch message;
  encode(testing::batch_of(5), message);
  report("aura", read_mutations<wire::AuraBatchPubSubType>(message));
}

TEST(Fuzz, HandOffs) {
  wire::Migration message;
  encode(testing::hand_off_of(3), message);
  report("migration", read_mutations<wire::MigrationPubSubType>(message));
}

TEST(Fuzz, Statuses) {
  wire::NodeStatus message;
  encode(testing::status_of(1), message);
  report("node_status", read_mutations<wire::NodeStatusPubSubType>(message));
}

TEST(Fuzz, Maps) {
  wire::RegionMap message;
  encode(testing::map_of(1), message);
  report("region_map", read_mutations<wire::RegionMapPubSubType>(message));
}

TEST(Fuzz, Commands) {
  wire::RunControl message;
  RunCommand command = testing::command_of(RunCommandKind::kReset);
  command.request = 9;
  encode(command, 3, message);
  report("run_control", read_mutations<wire::RunControlPubSubType>(message));
}

TEST(Fuzz, Replicas) {
  wire::Replica message;
  encode(testing::replica_of(5), message);
  report("replica", read_mutations<wire::ReplicaPubSubType>(message));
}

TEST(Fuzz, Observations) {
  core::Observation observation;
  for (const core::ReplicaBody& row : testing::replica_of(5).bodies) observation.bodies.push_back({row, false});
  observation.outside = {core::BodyId{3}};
  observation.joints = {{core::JointId{1}, 0.5, 2}};
  observation.contacts = {{1, -1, {1, 2, 3}, {0, 0, 1}, 4}};
  wire::Observation message;
  encode(observation, message);
  report("observation", read_mutations<wire::ObservationPubSubType>(message));
}

TEST(Fuzz, Interests) {
  core::Interest interest;
  interest.client = 9;
  interest.bodies = {core::BodyId{1}, core::BodyId{5}};
  interest.prototypes = {core::PrototypeId{2}};
  interest.boxes = {{{0, 0, 0}, {1, 2, 3}}};
  wire::Interest message;
  encode(interest, 0, message);
  report("interest", read_mutations<wire::InterestPubSubType>(message));
}

TEST(Fuzz, ClientCommands) {
  wire::Command message;
  encode(core::Command{42, 100, core::NewStatic{core::Box{{1, 2, 3}}, {}}}, 9, 1, message);
  report("command", read_mutations<wire::CommandPubSubType>(message));
}

TEST(Fuzz, CommandReplies) {
  wire::CommandReply message;
  core::CommandReply reply;
  reply.outcome = core::Outcome::kSeen;
  reply.object = 3;
  encode(reply, 1, message);
  report("command_reply", read_mutations<wire::CommandReplyPubSubType>(message));
}

TEST(Fuzz, Meshes) {
  wire::MeshShape message;
  encode(NamedMesh{5, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}}}}, message);
  report("shape", read_mutations<wire::MeshShapePubSubType>(message));
}

TEST(Guard, AnAbsurdLengthAsksForNoMemory) {
  GuardedType<wire::AuraBatchPubSubType> type;
  wire::AuraBatch message;
  encode(testing::batch_of(0), message);
  Bytes bytes = bytes_of(type, message);
  const std::size_t id_length_at = 4 + 72;  // encapsulation, then the header up to `violations`
  const std::uint32_t absurd = 0xffff'ffffU;
  std::memcpy(bytes.data() + id_length_at, &absurd, sizeof absurd);
  SerializedPayload_t payload(static_cast<std::uint32_t>(bytes.size()));
  std::memcpy(payload.data, bytes.data(), bytes.size());
  payload.length = static_cast<std::uint32_t>(bytes.size());
  wire::AuraBatch sample;
  EXPECT_TRUE(type.deserialize(&payload, &sample));
  EXPECT_EQ(sample.version(), 0);
  EXPECT_LT(sample.id().capacity(), 1000U);
}

TEST(Guard, EmptyPayloadsAreMalformed) {
  GuardedType<wire::AuraBatchPubSubType> type;
  SerializedPayload_t empty;
  wire::AuraBatch sample;
  sample.version(1);
  EXPECT_TRUE(type.deserialize(&empty, &sample));
  EXPECT_EQ(sample.version(), 0);
}

}  // namespace
}  // namespace aurasim::messages
