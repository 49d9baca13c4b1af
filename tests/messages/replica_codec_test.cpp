// Replicas as wire types and back.
#include "messages/replica_codec.h"

#include <functional>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "aurasim.h"
#include "messages/replica_messages.h"

namespace aurasim::messages {
namespace {

using testing::replica_of;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::string verdict_after(const std::function<void(wire::Replica&)>& spoil) {
  wire::Replica sample;
  encode(replica_of(4), sample);
  spoil(sample);
  Expected expected;
  expected.map_version = 0xfedc'ba98'7654'3210U;
  expected.region_count = 4;
  expected.prototype_count = 7;
  const auto decoded = decode(sample, expected);
  const auto* error = std::get_if<WireError>(&decoded);
  return error == nullptr ? "accepted" : std::string(name_of(*error));
}

TEST(ReplicaCodec, RoundTripKeepsEverything) {
  for (const std::size_t bodies : {0U, 1U, 1000U}) {
    wire::Replica sample;
    encode(replica_of(bodies), sample);
    const auto decoded = decode(sample, {});
    ASSERT_TRUE(std::holds_alternative<core::Replica>(decoded));
    wire::Replica again;
    encode(std::get<core::Replica>(decoded), again);
    EXPECT_EQ(again, sample);
    EXPECT_EQ(std::get<core::Replica>(decoded).bodies.size(), bodies);
  }
}

TEST(ReplicaCodec, RefusesWhatIsNotSound) {
  EXPECT_EQ(verdict_after([](auto&) {}), "accepted");
  EXPECT_EQ(verdict_after([](auto& w) { w.version(0); }), "malformed");
  EXPECT_EQ(verdict_after([](auto& w) { w.version(kProtocolVersion + 1); }), "version");
  EXPECT_EQ(verdict_after([](auto& w) { w.map_version(1); }), "map_version");
  EXPECT_EQ(verdict_after([](auto& w) { w.source(4); }), "range");
  EXPECT_EQ(verdict_after([](auto& w) { w.stamp(-1); }), "range");
  EXPECT_EQ(verdict_after([](auto& w) { w.sequence_number(0); }), "range");
  EXPECT_EQ(verdict_after([](auto& w) { w.id().pop_back(); }), "length");
  EXPECT_EQ(verdict_after([](auto& w) { w.q_WB().push_back(0); }), "length");
  EXPECT_EQ(verdict_after([](auto& w) { w.removed_epoch().push_back(0); }), "length");
  EXPECT_EQ(verdict_after([](auto& w) { w.p_WB()[1] = kNan; }), "not_finite");
  EXPECT_EQ(verdict_after([](auto& w) { w.v_WB()[1] = kNan; }), "not_finite");
  EXPECT_EQ(verdict_after([](auto& w) { w.w_WB()[1] = std::numeric_limits<float>::infinity(); }), "not_finite");
  EXPECT_EQ(verdict_after([](auto& w) { w.q_WB()[0] += 0.1F; }), "rotation");
  EXPECT_EQ(verdict_after([](auto& w) { w.flags()[0] = 2; }), "enum");
  EXPECT_EQ(verdict_after([](auto& w) { w.host()[0] = 4; }), "range");
  EXPECT_EQ(verdict_after([](auto& w) { w.prototype()[0] = 7; }), "range");
  EXPECT_EQ(verdict_after([](auto& w) { w.id()[1] = w.id()[0]; }), "range");
  EXPECT_EQ(verdict_after([](auto& w) { std::swap(w.id()[1], w.id()[0]); }), "range");
}

}  // namespace
}  // namespace aurasim::messages
