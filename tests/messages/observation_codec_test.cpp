// Interests and observations as wire types and back.
#include "messages/observation_codec.h"

#include <functional>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "aurasim.h"
#include "messages/interest_codec.h"
#include "messages/replica_messages.h"
#include "messages/samples.h"

namespace aurasim::messages {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

core::Interest some_interest() {
  core::Interest interest;
  interest.client = 0xfedc'ba98'0000'0001U;
  interest.sequence = 7;
  interest.every = 3;
  interest.contacts = true;
  interest.bodies = {core::BodyId{2}, core::BodyId{1'000'000'005}};
  interest.prototypes = {core::PrototypeId{0}, core::PrototypeId{4}};
  interest.boxes = {{{-1, -2, -3}, {4, 5, 6}}, {{0, 0, 0}, {0, 0, 0}}};
  return interest;
}

core::Observation some_observation(std::size_t bodies = 5) {
  core::Observation observation;
  observation.source = core::RegionId{1};
  observation.generation = 7;
  observation.redo = 2;
  observation.stamp = 99;
  observation.map_version = 0xfedc'ba98'7654'3210U;
  observation.sequence = 4;
  observation.previous = 96;
  observation.kind = core::Observation::Kind::kMadeUp;
  for (const core::ReplicaBody& row : testing::replica_of(bodies).bodies) {
    observation.bodies.push_back({row, core::value_of(row.id) % 2 == 0});
  }
  observation.outside = {core::BodyId{3}, core::BodyId{40}};
  observation.joints = {{core::JointId{0}, -0.25, 3}, {core::JointId{2}, 1e-9, 0}};
  observation.contacts = {{4, 7, {1, 2, 3}, {0, 0, 1}, 0.5}, {4, -3, {1, 2, 3}, {0, 0, -1}, 1e-12}};
  return observation;
}

template <class Wire>
std::string verdict(const Wire& sample, const Expected& expected) {
  const auto decoded = decode(sample, expected);
  const auto* error = std::get_if<WireError>(&decoded);
  return error == nullptr ? "accepted" : std::string(name_of(*error));
}

std::string interest_after(const std::function<void(wire::Interest&)>& spoil) {
  wire::Interest sample;
  encode(some_interest(), 0, sample);
  spoil(sample);
  return verdict(sample, {});
}

std::string observation_after(const std::function<void(wire::Observation&)>& spoil) {
  wire::Observation sample;
  encode(some_observation(), sample);
  spoil(sample);
  Expected expected;
  expected.map_version = 0xfedc'ba98'7654'3210U;
  expected.region_count = 4;
  expected.prototype_count = 7;
  expected.joint_count = 3;
  expected.static_count = 3;
  return verdict(sample, expected);
}

TEST(InterestCodec, RoundTripKeepsEverything) {
  wire::Interest sample, again;
  encode(some_interest(), 5, sample);
  const auto decoded = decode(sample, {});
  ASSERT_TRUE(std::holds_alternative<core::Interest>(decoded));
  encode(std::get<core::Interest>(decoded), 5, again);
  EXPECT_EQ(again, sample);
  EXPECT_EQ(std::get<core::Interest>(decoded).boxes.size(), 2U);
  core::Interest flags = some_interest();
  flags.all = flags.joints = flags.ended = true;
  encode(flags, 5, sample);
  EXPECT_TRUE(std::get<core::Interest>(decode(sample, {})).ended);
}

TEST(InterestCodec, RefusesWhatIsNotSound) {
  EXPECT_EQ(interest_after([](auto&) {}), "accepted");
  EXPECT_EQ(interest_after([](auto& w) { w.every(0); }), "accepted");
  EXPECT_EQ(interest_after([](auto& w) { w.version(0); }), "malformed");
  EXPECT_EQ(interest_after([](auto& w) { w.version(kProtocolVersion + 1); }), "version");
  EXPECT_EQ(interest_after([](auto& w) { w.client(0); }), "range");
  EXPECT_EQ(interest_after([](auto& w) { w.sequence_number(0); }), "range");
  EXPECT_EQ(interest_after([](auto& w) { w.every(core::kMostStatesBetween + 1); }), "range");
  EXPECT_EQ(interest_after([](auto& w) { w.flags(16); }), "enum");
  EXPECT_EQ(interest_after([](auto& w) { std::swap(w.body()[0], w.body()[1]); }), "range");
  EXPECT_EQ(interest_after([](auto& w) { w.body()[1] = std::uint64_t{1} << 63U; }), "range");
  EXPECT_EQ(interest_after([](auto& w) { w.prototype()[1] = w.prototype()[0]; }), "range");
  EXPECT_EQ(interest_after([](auto& w) { w.low().pop_back(); }), "length");
  EXPECT_EQ(interest_after([](auto& w) { w.high().resize(3); }), "length");
  EXPECT_EQ(interest_after([](auto& w) { w.low()[0] = kNan; }), "not_finite");
  EXPECT_EQ(interest_after([](auto& w) { w.high()[0] = kInfinity; }), "not_finite");
  EXPECT_EQ(interest_after([](auto& w) { w.low()[0] = w.high()[0] + 1; }), "range");
  EXPECT_EQ(interest_after([](auto& w) { w.high()[0] = 1e30; }), "range");
  EXPECT_EQ(interest_after([](auto& w) { w.body().resize(core::kMostWantedBodies + 1); }), "too_large");
  EXPECT_EQ(interest_after([](auto& w) { w.low().resize(3 * core::kMostWantedBoxes + 3); }), "too_large");
}

TEST(ObservationCodec, RoundTripKeepsEverything) {
  for (const std::size_t bodies : {0U, 1U, 1000U}) {
    wire::Observation sample, again;
    encode(some_observation(bodies), sample);
    const auto decoded = decode(sample, {});
    ASSERT_TRUE(std::holds_alternative<core::Observation>(decoded));
    encode(std::get<core::Observation>(decoded), again);
    EXPECT_EQ(again, sample);
    EXPECT_EQ(std::get<core::Observation>(decoded).bodies.size(), bodies);
  }
}

TEST(ObservationCodec, RefusesWhatIsNotSound) {
  EXPECT_EQ(observation_after([](auto&) {}), "accepted");
  EXPECT_EQ(observation_after([](auto& w) { w.version(0); }), "malformed");
  EXPECT_EQ(observation_after([](auto& w) { w.map_version(1); }), "map_version");
  EXPECT_EQ(observation_after([](auto& w) { w.source(4); }), "range");
  EXPECT_EQ(observation_after([](auto& w) { w.stamp(-1); }), "range");
  EXPECT_EQ(observation_after([](auto& w) { w.previous(-1); }), "accepted");
  EXPECT_EQ(observation_after([](auto& w) { w.previous(-2); }), "range");
  EXPECT_EQ(observation_after([](auto& w) { w.previous(99); }), "range");
  EXPECT_EQ(observation_after([](auto& w) { w.kind(2); }), "enum");
  EXPECT_EQ(observation_after([](auto& w) { w.flags()[0] = 4; }), "enum");
  EXPECT_EQ(observation_after([](auto& w) { w.id().pop_back(); }), "length");
  EXPECT_EQ(observation_after([](auto& w) { w.joint_speed().pop_back(); }), "length");
  EXPECT_EQ(observation_after([](auto& w) { w.contact_p().push_back(0); }), "length");
  EXPECT_EQ(observation_after([](auto& w) { w.p_WB()[1] = kNan; }), "not_finite");
  EXPECT_EQ(observation_after([](auto& w) { w.joint_position()[0] = kNan; }), "not_finite");
  EXPECT_EQ(observation_after([](auto& w) { w.contact_impulse()[0] = kInfinity; }), "not_finite");
  EXPECT_EQ(observation_after([](auto& w) { w.q_WB()[0] += 0.1F; }), "rotation");
  EXPECT_EQ(observation_after([](auto& w) { std::swap(w.outside()[0], w.outside()[1]); }), "range");
  EXPECT_EQ(observation_after([](auto& w) { w.joint()[1] = 3; }), "range");
  EXPECT_EQ(observation_after([](auto& w) { w.host()[0] = 4; }), "range");
  EXPECT_EQ(observation_after([](auto& w) { w.prototype()[0] = 7; }), "range");
  EXPECT_EQ(observation_after([](auto& w) { w.contact_impulse()[0] = -1; }), "range");
  EXPECT_EQ(observation_after([](auto& w) { w.contact_a()[0] = -1; }), "range");
  EXPECT_EQ(observation_after([](auto& w) { w.contact_b()[0] = w.contact_a()[0]; }), "range");
  EXPECT_EQ(observation_after([](auto& w) { w.contact_b()[1] = -5; }), "range");
  EXPECT_EQ(observation_after([](auto& w) { w.contact_normal()[0] = 2; }), "range");
}

}  // namespace
}  // namespace aurasim::messages
