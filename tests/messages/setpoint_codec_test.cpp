// Setpoints as a wire type and back; what is not sound is refused.
#include "messages/setpoint_codec.h"

#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "aurasim.h"
#include "messages/wire_bytes.h"

namespace aurasim::messages {
namespace {

using core::BodyId;
using core::Quantity;
using core::Setpoints;
using core::Vec3;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

Setpoints of_all_kinds() {
  Setpoints setpoints{7, 3, 2, 100, {}, {}};
  for (int i = 0; i < core::kQuantities; ++i) {
    setpoints.bodies.push_back({BodyId{5}, static_cast<Quantity>(i), Vec3(1.5, -2, i)});
  }
  setpoints.bodies.push_back({BodyId{6}, Quantity::kSpin, {}});
  setpoints.joints.push_back({core::JointId{1}, core::JointDrive{0.1, -2, 30, 4, 5, kInfinite}});
  setpoints.joints.push_back({core::JointId{0}, {}});
  setpoints.statics.push_back({core::StaticId{3}, {Vec3(1, -2.5, 0.1), core::Quat(0.6, 0, 0.8, 0)}, 12});
  return setpoints;
}

wire::Setpoints encoded() {
  wire::Setpoints out;
  encode(of_all_kinds(), 9, out);
  return out;
}

TEST(SetpointCodec, ComesBackAsItWas) {
  WireBytes wire;
  const Setpoints sent = of_all_kinds();
  const auto came = wire.setpoints(wire.of(sent));
  ASSERT_TRUE(std::holds_alternative<Setpoints>(came));
  const auto& back = std::get<Setpoints>(came);
  EXPECT_EQ(std::tuple(back.client, back.sequence, back.generation, back.at_step),
            std::tuple(sent.client, sent.sequence, sent.generation, sent.at_step));
  ASSERT_EQ(back.bodies.size(), sent.bodies.size());
  for (std::size_t i = 0; i < sent.bodies.size(); ++i) {
    EXPECT_EQ(back.bodies[i].id, sent.bodies[i].id);
    EXPECT_EQ(back.bodies[i].quantity, sent.bodies[i].quantity);
    EXPECT_EQ(back.bodies[i].value, sent.bodies[i].value);
  }
  ASSERT_EQ(back.joints.size(), 2u);
  EXPECT_EQ(back.joints[0].id, core::JointId{1});
  const core::JointDrive& drive = *back.joints[0].drive;
  EXPECT_EQ(std::tuple(drive.position, drive.speed, drive.stiffness, drive.damping, drive.effort, drive.max_effort),
            std::tuple(0.1, -2.0, 30.0, 4.0, 5.0, kInfinite));
  EXPECT_FALSE(back.joints[1].drive);
  ASSERT_EQ(back.statics.size(), 1u);
  EXPECT_EQ(back.statics[0].id, core::StaticId{3});
  EXPECT_EQ(back.statics[0].states, 12);
  EXPECT_EQ(back.statics[0].to.p_WB, sent.statics[0].to.p_WB);
  EXPECT_EQ(back.statics[0].to.q_WB.coeffs(), sent.statics[0].to.q_WB.coeffs());
}

struct Fault {
  const char* name;
  std::function<void(wire::Setpoints&)> make;
  WireError error;
};

class SetpointFaults : public testing::TestWithParam<Fault> {};

TEST_P(SetpointFaults, AreRefused) {
  wire::Setpoints sample = encoded();
  GetParam().make(sample);
  Expected expected;
  expected.joint_count = 10;
  const auto came = decode(sample, expected);
  ASSERT_TRUE(std::holds_alternative<WireError>(came));
  EXPECT_EQ(std::get<WireError>(came), GetParam().error);
}

using Wire = wire::Setpoints;
INSTANTIATE_TEST_SUITE_P(
    Kinds, SetpointFaults,
    testing::Values(Fault{"Nan", [](Wire& w) { w.value()[4] = kNan; }, WireError::kNotFinite},
                    Fault{"Infinite", [](Wire& w) { w.value()[4] = kInfinite; }, WireError::kNotFinite},
                    Fault{"Force1e30", [](Wire& w) { w.value()[0] = 1e30; }, WireError::kRange},
                    Fault{"UnknownQuantity", [](Wire& w) { w.quantity()[0] = core::kQuantities; }, WireError::kEnum},
                    Fault{"UnknownBit", [](Wire& w) { w.quantity()[0] = 64; }, WireError::kEnum},
                    Fault{"ValuesMissing", [](Wire& w) { w.value().pop_back(); }, WireError::kLength},
                    Fault{"QuantitiesMissing", [](Wire& w) { w.quantity().pop_back(); }, WireError::kLength},
                    Fault{"DrivesMissing", [](Wire& w) { w.drive().pop_back(); }, WireError::kLength},
                    Fault{"UnknownJoint", [](Wire& w) { w.joint()[0] = 10; }, WireError::kRange},
                    Fault{"DriveNan", [](Wire& w) { w.drive()[1] = kNan; }, WireError::kNotFinite},
                    Fault{"NegativeStiffness", [](Wire& w) { w.drive()[2] = -1; }, WireError::kRange},
                    Fault{"NegativeLargestEffort", [](Wire& w) { w.drive()[5] = -1; }, WireError::kRange},
                    Fault{"BodyBeyondAll", [](Wire& w) { w.body()[0] = ~0ULL; }, WireError::kRange},
                    Fault{"NegativeState", [](Wire& w) { w.stamp(-1); }, WireError::kRange},
                    Fault{"AnotherVersion", [](Wire& w) { w.version(3); }, WireError::kVersion},
                    Fault{"PlaceNan", [](Wire& w) { w.place()[2] = kNan; }, WireError::kNotFinite},
                    Fault{"PlaceTooFarOut", [](Wire& w) { w.place()[0] = 1e30; }, WireError::kRange},
                    Fault{"NoRotation", [](Wire& w) { w.place()[3] = 0; }, WireError::kRange},
                    Fault{"PlacesMissing", [](Wire& w) { w.place().pop_back(); }, WireError::kLength},
                    Fault{"SpansMissing", [](Wire& w) { w.states().clear(); }, WireError::kLength},
                    Fault{"NoSpan", [](Wire& w) { w.states()[0] = 0; }, WireError::kRange},
                    Fault{"SpanForEver", [](Wire& w) { w.states()[0] = 1LL << 62; }, WireError::kRange},
                    Fault{"TooManyStatics",
                          [](Wire& w) {
                            w.static_id().assign(65, 1);
                            w.states().assign(65, 1);
                            w.place().resize(65 * 7);
                          },
                          WireError::kTooLarge},
                    Fault{"TooMany",
                          [](Wire& w) {
                            w.body().assign(200'000, 1);
                            w.quantity().assign(200'000, 0);
                            w.value().assign(600'000, 0);
                          },
                          WireError::kTooLarge}),
    [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace aurasim::messages
