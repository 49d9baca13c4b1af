// Aura batches and acks as wire types and back: exact, and whatever is not sound is refused for the right reason.
#include <functional>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "aurasim.h"
#include "dds/codec.h"
#include "messages.h"

namespace aurasim::dds {
namespace {

using testing::ack_of;
using testing::batch_of;
using testing::same;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Expected expected() {
  Expected expected;
  expected.map_version = 0xfedc'ba98'7654'3210U;
  expected.generation = 7;
  expected.source = core::RegionId{1};
  expected.region_count = 4;
  expected.prototype_count = 7;
  return expected;
}

wire::AuraBatch encoded(const core::AuraBatch& batch) {
  wire::AuraBatch out;
  encode(batch, out);
  return out;
}

TEST(AuraCodec, RoundTripKeepsEveryBit) {
  for (const std::size_t auras : {0U, 1U, 1000U}) {
    const core::AuraBatch batch = batch_of(auras);
    const auto decoded = decode(encoded(batch), expected());
    ASSERT_TRUE(std::holds_alternative<core::AuraBatch>(decoded)) << auras;
    EXPECT_TRUE(same(std::get<core::AuraBatch>(decoded), batch)) << auras;
  }
}

/// A batch that is refused for its orders would stop the cluster: whatever can be announced can be read.
TEST(AuraCodec, OrdersOfEveryKindComeBack) {
  core::AuraBatch batch = batch_of(1);
  const wire::AuraBatch sent = encoded(batch);
  const auto decoded = decode(sent, expected());
  ASSERT_TRUE(std::holds_alternative<core::AuraBatch>(decoded));
  const core::AuraBatch& got = std::get<core::AuraBatch>(decoded);
  ASSERT_EQ(got.orders.size(), batch.orders.size());
  for (std::size_t i = 0; i < got.orders.size(); ++i) {
    EXPECT_EQ(got.orders[i].action.index(), batch.orders[i].action.index());
    EXPECT_EQ(got.orders[i].sequence, batch.orders[i].sequence);
    EXPECT_EQ(got.orders[i].request, batch.orders[i].request);
    EXPECT_EQ(got.orders[i].at_step, batch.orders[i].at_step);
  }
  EXPECT_EQ(encoded(got), sent) << "every number of every order";
}

TEST(AuraCodec, AReusedTargetKeepsNothingOfTheLastMessage) {
  wire::AuraBatch out;
  encode(batch_of(50), out);
  core::AuraBatch small;
  small.source = core::RegionId{1};
  small.generation = 7;
  small.map_version = 0xfedc'ba98'7654'3210U;
  encode(small, out);
  EXPECT_EQ(out, encoded(small));
}

TEST(AuraCodec, OrdersThatAreNotSoundAreRefused) {
  const std::vector<std::function<void(wire::AuraBatch&)>> spoilers = {
      [](wire::AuraBatch& b) { b.order_kind()[0] = 11; },
      [](wire::AuraBatch& b) { b.order_numbers()[0] = kNan; },
      [](wire::AuraBatch& b) { b.order_numbers()[0] = -1; },
      [](wire::AuraBatch& b) { b.order_number_count()[2] = 1'000'000; },
      [](wire::AuraBatch& b) { b.order_number_count()[6] = 12; },
      [](wire::AuraBatch& b) { b.order_text().clear(); },
      [](wire::AuraBatch& b) { b.order_step()[3] = -1; },
      [](wire::AuraBatch& b) { b.order_subject()[6] = ~0ULL; },
      [](wire::AuraBatch& b) { b.order_request().pop_back(); }};
  for (std::size_t i = 0; i < spoilers.size(); ++i) {
    wire::AuraBatch batch = encoded(batch_of(1));
    spoilers[i](batch);
    EXPECT_TRUE(std::holds_alternative<WireError>(decode(batch, expected()))) << i;
  }
}

struct Spoilt {
  std::string name;
  std::function<void(wire::AuraBatch&)> spoil;
  WireError error;
};

class SpoiltAuraBatch : public ::testing::TestWithParam<Spoilt> {};

TEST_P(SpoiltAuraBatch, IsRefusedForTheRightReason) {
  wire::AuraBatch sample = encoded(batch_of(8));
  ASSERT_TRUE(std::holds_alternative<core::AuraBatch>(decode(sample, expected())));
  GetParam().spoil(sample);
  const auto decoded = decode(sample, expected());
  ASSERT_TRUE(std::holds_alternative<WireError>(decoded));
  EXPECT_EQ(name_of(std::get<WireError>(decoded)), name_of(GetParam().error));
}

using Wire = wire::AuraBatch;
const Spoilt kSpoilt[] = {
    {"BytesThatAreNotTheType", [](Wire& w) { w.version(0); }, WireError::kMalformed},
    {"OtherVersion", [](Wire& w) { w.version(2); }, WireError::kVersion},
    {"OtherGeneration", [](Wire& w) { w.generation(8); }, WireError::kGeneration},
    {"OtherMap", [](Wire& w) { w.map_version(1); }, WireError::kMapVersion},
    {"OtherSource", [](Wire& w) { w.source(2); }, WireError::kSource},
    {"SourceNotInTheMap", [](Wire& w) { w.source(4); }, WireError::kRange},
    {"TooManyRows", [](Wire& w) { w.id().resize(kMaxRows + 1); }, WireError::kTooLarge},
    {"TooManyDeletes", [](Wire& w) { w.deleted().resize(kMaxRows + 1); }, WireError::kTooLarge},
    {"IdShort", [](Wire& w) { w.id().pop_back(); }, WireError::kLength},
    {"EpochShort", [](Wire& w) { w.epoch().pop_back(); }, WireError::kLength},
    {"HostLong", [](Wire& w) { w.host().push_back(0); }, WireError::kLength},
    {"PrototypeShort", [](Wire& w) { w.prototype().clear(); }, WireError::kLength},
    {"FlagsShort", [](Wire& w) { w.flags().pop_back(); }, WireError::kLength},
    {"StampShort", [](Wire& w) { w.state_stamp().pop_back(); }, WireError::kLength},
    {"BirthShort", [](Wire& w) { w.birth().pop_back(); }, WireError::kLength},
    {"PositionShortByOneNumber", [](Wire& w) { w.p_WB().pop_back(); }, WireError::kLength},
    {"QuaternionShort", [](Wire& w) { w.q_WB().resize(7 * 4); }, WireError::kLength},
    {"VelocityShort", [](Wire& w) { w.v_WB().pop_back(); }, WireError::kLength},
    {"SpinLong", [](Wire& w) { w.w_WB().push_back(0); }, WireError::kLength},
    {"SpeedShort", [](Wire& w) { w.speed_m_s().pop_back(); }, WireError::kLength},
    {"MarksDiffer", [](Wire& w) { w.hand_off_last().pop_back(); }, WireError::kLength},
    {"ClaimsDiffer", [](Wire& w) { w.claim_epoch().push_back(1); }, WireError::kLength},
    {"PositionNan", [](Wire& w) { w.p_WB()[23] = kNan; }, WireError::kNotFinite},
    {"QuaternionNan", [](Wire& w) { w.q_WB()[0] = kNan; }, WireError::kNotFinite},
    {"VelocityInfinite", [](Wire& w) { w.v_WB()[5] = -kInfinity; }, WireError::kNotFinite},
    {"SpinInfinite", [](Wire& w) { w.w_WB()[5] = kInfinity; }, WireError::kNotFinite},
    {"SpeedNan", [](Wire& w) { w.speed_m_s()[1] = kNan; }, WireError::kNotFinite},
    {"TopSpeedInfinite", [](Wire& w) { w.top_speed_m_s(kInfinity); }, WireError::kNotFinite},
    {"TopRadiusNan", [](Wire& w) { w.top_radius_m(kNan); }, WireError::kNotFinite},
    {"UnknownFlag", [](Wire& w) { w.flags()[3] = 4; }, WireError::kEnum},
    {"QuaternionTooLong",
     [](Wire& w) {
       w.q_WB()[4] += 0.01;
       w.q_WB()[5] *= 1.01;
       w.q_WB()[6] *= 1.01;
       w.q_WB()[7] *= 1.01;
     },
     WireError::kRotation},
    {"QuaternionZero",
     [](Wire& w) {
       for (int i = 0; i < 4; ++i) {
         w.q_WB()[i] = 0;
       }
     },
     WireError::kRotation},
    {"QuaternionWhoseSquareOverflows", [](Wire& w) { w.q_WB()[0] = 1e300; }, WireError::kRotation},
    {"NegativeStamp", [](Wire& w) { w.stamp(-1); }, WireError::kRange},
    {"NegativeStateStamp", [](Wire& w) { w.state_stamp()[0] = -1; }, WireError::kRange},
    {"NegativeBirth", [](Wire& w) { w.birth()[0] = -5; }, WireError::kRange},
    {"NegativeSpeed", [](Wire& w) { w.speed_m_s()[0] = -1; }, WireError::kRange},
    {"NegativeTopSpeed", [](Wire& w) { w.top_speed_m_s(-1); }, WireError::kRange},
    {"NegativeTopRadius", [](Wire& w) { w.top_radius_m(-1); }, WireError::kRange},
    {"HostNotInTheMap", [](Wire& w) { w.host()[2] = 4; }, WireError::kRange},
    {"PrototypeNotInTheScene", [](Wire& w) { w.prototype()[2] = 7; }, WireError::kRange},
    {"DeadNotInTheMap", [](Wire& w) { w.dead()[0] = 9; }, WireError::kRange},
    {"MarkNotInTheMap", [](Wire& w) { w.hand_off_destination()[0] = 9; }, WireError::kRange},
    {"BodyIdAboveSigned", [](Wire& w) { w.id()[0] = 1ULL << 63U; }, WireError::kRange},
    {"DeletedIdAboveSigned", [](Wire& w) { w.deleted()[0] = 1ULL << 63U; }, WireError::kRange},
    {"ClaimIdAboveSigned", [](Wire& w) { w.claim_id()[0] = 1ULL << 63U; }, WireError::kRange},
};
INSTANTIATE_TEST_SUITE_P(All, SpoiltAuraBatch, ::testing::ValuesIn(kSpoilt),
                         [](const auto& info) { return info.param.name; });

TEST(AuraCodec, AcceptsWhatNobodyExpectsOtherwise) {
  wire::AuraBatch sample = encoded(batch_of(8));
  sample.generation(9);
  sample.map_version(1);
  EXPECT_TRUE(std::holds_alternative<core::AuraBatch>(decode(sample, {})));
}

TEST(AckCodec, RoundTripKeepsEverything) {
  const core::HandOffAck ack = ack_of(3, core::RegionId{1}, core::RegionId{2});
  wire::MigrationAck out;
  encode(ack, 0xfedc'ba98'7654'3210U, out);
  Expected to_two = expected();
  to_two.destination = core::RegionId{2};
  const auto decoded = decode(out, to_two);
  ASSERT_TRUE(std::holds_alternative<core::HandOffAck>(decoded));
  EXPECT_TRUE(same(std::get<core::HandOffAck>(decoded), ack));
}

TEST(AckCodec, RefusesWhatIsNotSound) {
  const auto error_after = [](const std::function<void(wire::MigrationAck&)>& spoil) {
    wire::MigrationAck out;
    encode(ack_of(3, core::RegionId{1}, core::RegionId{2}), 0xfedc'ba98'7654'3210U, out);
    spoil(out);
    Expected to_two = expected();
    to_two.destination = core::RegionId{2};
    const auto decoded = decode(out, to_two);
    const auto* error = std::get_if<WireError>(&decoded);
    return error == nullptr ? "accepted" : std::string(name_of(*error));
  };
  EXPECT_EQ(error_after([](auto& w) { w.destination(3); }), "source");
  EXPECT_EQ(error_after([](auto& w) { w.destination(4); }), "range");
  EXPECT_EQ(error_after([](auto& w) { w.sequence_number(0); }), "range");
  EXPECT_EQ(error_after([](auto& w) { w.stamp(-1); }), "range");
  EXPECT_EQ(error_after([](auto& w) { w.map_version(2); }), "map_version");
  EXPECT_EQ(error_after([](auto& w) { w.generation(2); }), "generation");
}

}  // namespace
}  // namespace aurasim::dds
