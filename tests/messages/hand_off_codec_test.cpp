// Hand-offs as wire types and back: exact, and whatever physics could stumble over is refused.
#include <functional>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "aurasim.h"
#include "messages/codec.h"
#include "messages/samples.h"

namespace aurasim::messages {
namespace {

using testing::hand_off_of;
using testing::same;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Expected expected() {
  Expected expected;
  expected.map_version = 0xfedc'ba98'7654'3210U;
  expected.source = core::RegionId{1};
  expected.destination = core::RegionId{0};
  expected.region_count = 4;
  expected.prototype_count = 7;
  expected.static_count = 3;
  expected.joint_count = 6;
  expected.block_m = 16;
  return expected;
}

wire::Migration encoded(const core::HandOff& hand_off) {
  wire::Migration out;
  encode(hand_off, out);
  return out;
}

TEST(HandOffCodec, RoundTripKeepsEveryBit) {
  for (const std::size_t bodies : {1U, 2U, 300U}) {
    const core::HandOff hand_off = hand_off_of(bodies);
    const auto decoded = decode(encoded(hand_off), expected());
    ASSERT_TRUE(std::holds_alternative<core::HandOff>(decoded)) << bodies;
    EXPECT_TRUE(same(std::get<core::HandOff>(decoded), hand_off)) << bodies;
  }
}

TEST(HandOffCodec, MatricesTravelRowByRow) {
  const core::HandOff hand_off = hand_off_of(1);
  const wire::Migration sample = encoded(hand_off);
  EXPECT_EQ(sample.body_R_WB()[1], hand_off.cluster.bodies[0].R_WB(0, 1));
  EXPECT_EQ(sample.body_R_WB()[3], hand_off.cluster.bodies[0].R_WB(1, 0));
}

TEST(HandOffCodec, AReusedTargetKeepsNothingOfTheLastMessage) {
  wire::Migration out;
  encode(hand_off_of(50), out);
  encode(hand_off_of(2), out);
  EXPECT_EQ(out, encoded(hand_off_of(2)));
}

struct Spoilt {
  std::string name;
  std::function<void(wire::Migration&)> spoil;
  WireError error;
};

class SpoiltHandOff : public ::testing::TestWithParam<Spoilt> {};

TEST_P(SpoiltHandOff, IsRefusedForTheRightReason) {
  wire::Migration sample = encoded(hand_off_of(4));
  ASSERT_TRUE(std::holds_alternative<core::HandOff>(decode(sample, expected())));
  GetParam().spoil(sample);
  const auto decoded = decode(sample, expected());
  ASSERT_TRUE(std::holds_alternative<WireError>(decoded));
  EXPECT_EQ(name_of(std::get<WireError>(decoded)), name_of(GetParam().error));
}

using Wire = wire::Migration;
const Spoilt kSpoilt[] = {
    {"BytesThatAreNotTheType", [](Wire& w) { w.version(0); }, WireError::kMalformed},
    {"OtherVersion", [](Wire& w) { w.version(kProtocolVersion + 1); }, WireError::kVersion},
    {"OtherMap", [](Wire& w) { w.map_version(1); }, WireError::kMapVersion},
    {"OtherSource", [](Wire& w) { w.source(3); }, WireError::kSource},
    {"OtherDestination", [](Wire& w) { w.destination(3); }, WireError::kSource},
    {"DestinationNotInTheMap", [](Wire& w) { w.destination(4); }, WireError::kRange},
    {"TooManyBodies", [](Wire& w) { w.body_id().resize(kMaxRows + 1); }, WireError::kTooLarge},
    {"TooManyManifolds", [](Wire& w) { w.manifold_object0().resize(kMaxRows + 1); }, WireError::kTooLarge},
    {"TooManyJoints", [](Wire& w) { w.joint_id().resize(kMaxRows + 1); }, WireError::kTooLarge},
    {"IdLong", [](Wire& w) { w.body_id().push_back(1000); }, WireError::kLength},
    {"EpochShort", [](Wire& w) { w.body_epoch().pop_back(); }, WireError::kLength},
    {"PrototypeShort", [](Wire& w) { w.body_prototype().pop_back(); }, WireError::kLength},
    {"BirthShort", [](Wire& w) { w.body_birth().pop_back(); }, WireError::kLength},
    {"StateShort", [](Wire& w) { w.body_activation_state().pop_back(); }, WireError::kLength},
    {"TimeShort", [](Wire& w) { w.body_deactivation_time().pop_back(); }, WireError::kLength},
    {"PositionShort", [](Wire& w) { w.body_p_WB().pop_back(); }, WireError::kLength},
    {"RotationShort", [](Wire& w) { w.body_R_WB().pop_back(); }, WireError::kLength},
    {"VelocityShort", [](Wire& w) { w.body_v_WB().pop_back(); }, WireError::kLength},
    {"BlockShort", [](Wire& w) { w.body_block().pop_back(); }, WireError::kLength},
    {"BlockFarFromTheBody", [](Wire& w) { w.body_block()[0] = 100; }, WireError::kRange},
    {"BlockOutOfAnyWorld", [](Wire& w) { w.body_block()[1] = std::numeric_limits<std::int32_t>::min(); },
     WireError::kRange},
    {"SpinShort", [](Wire& w) { w.body_w_WB().pop_back(); }, WireError::kLength},
    {"ManifoldShort", [](Wire& w) { w.manifold_object1().pop_back(); }, WireError::kLength},
    {"FirstPointShort", [](Wire& w) { w.manifold_first_point().pop_back(); }, WireError::kLength},
    {"PointCountLong", [](Wire& w) { w.manifold_point_count().push_back(0); }, WireError::kLength},
    {"PartOfAPoint", [](Wire& w) { w.points().pop_back(); }, WireError::kLength},
    {"JointShort", [](Wire& w) { w.joint_first_value().clear(); }, WireError::kLength},
    {"PositionNan", [](Wire& w) { w.body_p_WB()[1] = kNan; }, WireError::kNotFinite},
    {"RotationNan", [](Wire& w) { w.body_R_WB()[1] = kNan; }, WireError::kNotFinite},
    {"TimeNan", [](Wire& w) { w.body_deactivation_time()[1] = kNan; }, WireError::kNotFinite},
    {"PointNan", [](Wire& w) { w.points()[77] = kNan; }, WireError::kNotFinite},
    {"JointValueNan", [](Wire& w) { w.joint_values()[0] = kNan; }, WireError::kNotFinite},
    {"PositionOutOfAnyWorld", [](Wire& w) { w.body_p_WB()[1] = -3e7; }, WireError::kRange},
    {"SpeedThatNoWorldBears", [](Wire& w) { w.body_v_WB()[0] = 1e308; }, WireError::kRange},
    {"SpinThatNoWorldBears", [](Wire& w) { w.body_w_WB()[2] = -1e300; }, WireError::kRange},
    {"EpochFarAhead", [](Wire& w) { w.body_epoch()[0] = 0xffff'ffffU; }, WireError::kRange},
    {"ContactOutOfAnyWorld", [](Wire& w) { w.points()[28] = 1e300; }, WireError::kRange},
    {"ContactOfAPartThatIsNoNumber", [](Wire& w) { w.points()[39] = 1e10; }, WireError::kRange},
    {"JointImpulseOutOfAnyWorld", [](Wire& w) { w.joint_values()[1] = 1e300; }, WireError::kRange},
    {"UnknownReason", [](Wire& w) { w.reason(2); }, WireError::kEnum},
    {"StateZero", [](Wire& w) { w.body_activation_state()[0] = 0; }, WireError::kEnum},
    {"StateSix", [](Wire& w) { w.body_activation_state()[0] = 6; }, WireError::kEnum},
    {"RotationScaled",
     [](Wire& w) {
       for (int i = 0; i < 9; ++i) {
         w.body_R_WB()[i] *= 1.01;
       }
     },
     WireError::kRotation},
    {"RotationMirrored",
     [](Wire& w) {
       for (int i = 0; i < 9; ++i) {
         w.body_R_WB()[i] *= -1;
       }
     },
     WireError::kRotation},
    {"RotationZero",
     [](Wire& w) {
       for (int i = 0; i < 9; ++i) {
         w.body_R_WB()[i] = 0;
       }
     },
     WireError::kRotation},
    {"NoBodies",
     [](Wire& w) {
       const Wire full = w;
       w = Wire();
       w.version(kProtocolVersion);
       w.source(1);
       w.map_version(full.map_version());
       w.sequence_number(1);
     },
     WireError::kRange},
    {"SequenceZero", [](Wire& w) { w.sequence_number(0); }, WireError::kRange},
    {"NegativeStamp", [](Wire& w) { w.stamp(-1); }, WireError::kRange},
    {"BodyTwice", [](Wire& w) { w.body_id()[1] = w.body_id()[0]; }, WireError::kRange},
    {"BodiesOutOfOrder", [](Wire& w) { std::swap(w.body_id()[0], w.body_id()[1]); }, WireError::kRange},
    {"BodyIdAboveSigned", [](Wire& w) { w.body_id()[3] = ~0ULL; }, WireError::kRange},
    {"PrototypeNotInTheScene", [](Wire& w) { w.body_prototype()[0] = 7; }, WireError::kRange},
    {"NegativeTime", [](Wire& w) { w.body_deactivation_time()[0] = -1; }, WireError::kRange},
    {"PointsBeyondTheEnd", [](Wire& w) { w.manifold_point_count().back() = 3; }, WireError::kRange},
    {"PointsThatOverflow", [](Wire& w) { w.manifold_first_point()[0] = 0xffff'ffffU; }, WireError::kRange},
    {"BodyNotInTheCluster", [](Wire& w) { w.manifold_object0()[0] = 5; }, WireError::kRange},
    {"StaticNotInTheScene", [](Wire& w) { w.manifold_object1()[0] = -4; }, WireError::kRange},
    {"StaticMinimum", [](Wire& w) { w.manifold_object1()[0] = std::numeric_limits<std::int64_t>::min(); },
     WireError::kRange},
    {"TwoStatics", [](Wire& w) { w.manifold_object0()[0] = -1; }, WireError::kRange},
    {"BodyAgainstItself", [](Wire& w) { w.manifold_object1()[0] = w.manifold_object0()[0]; }, WireError::kRange},
    {"JointNotInTheScene", [](Wire& w) { w.joint_id()[0] = 6; }, WireError::kRange},
    {"JointValuesBeyondTheEnd", [](Wire& w) { w.joint_value_count()[0] = 4; }, WireError::kRange},
};
INSTANTIATE_TEST_SUITE_P(All, SpoiltHandOff, ::testing::ValuesIn(kSpoilt),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace aurasim::messages
