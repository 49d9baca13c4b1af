// Aura batches as wire types and back: exact, and whatever is not sound is refused for the right reason.
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "aurasim.h"
#include "messages/codec.h"
#include "messages/packed_rotation.h"
#include "messages/samples.h"
#include "messages/wire_bytes.h"

namespace aurasim::messages {
namespace {

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

TEST(AuraCodec, RoundTripKeepsAllButWhatRoundingTakes) {
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

/// With a body that has joined late, and has made up an earlier state.
core::AuraBatch batch_with_past() {
  core::AuraBatch batch = batch_of(1);
  batch.past = {testing::aura_of(8)};
  batch.past[0].flags = core::kAuraAsleep;
  batch.past[0].stamp = batch.stamp - 2;
  return batch;
}

TEST(AuraCodec, WhatTheCheckNeedsComesBackToTheBit) {
  const core::AuraBatch batch = batch_with_past();
  const auto decoded = decode(encoded(batch), expected());
  ASSERT_TRUE(std::holds_alternative<core::AuraBatch>(decoded));
  const core::AuraBatch& got = std::get<core::AuraBatch>(decoded);
  EXPECT_EQ(got.redo, 3u);
  ASSERT_EQ(got.alarms.size(), 1u);
  EXPECT_EQ(got.alarms[0].redo, 2u);
  EXPECT_EQ(got.alarms[0].step, 400);
  EXPECT_EQ(got.alarms[0].a, core::BodyId{5});
  EXPECT_EQ(got.alarms[0].b, core::BodyId{1'000'000'001});
  EXPECT_EQ(got.introductions, batch.introductions);
  ASSERT_EQ(got.past.size(), 1u);
  EXPECT_EQ(got.past[0].stamp, batch.past[0].stamp);
  EXPECT_EQ(got.past[0].flags, core::kAuraAsleep);
  EXPECT_EQ(got.past[0].pose.p_WB, batch.past[0].pose.p_WB) << "places are not rounded";
}

TEST(AuraCodec, AWordMayHaveTheStateInWhichTheRunStands) {
  core::AuraBatch word = batch_with_past();
  word.word = 2;
  word.past[0].stamp = word.stamp;
  const auto decoded = decode(encoded(word), expected());
  ASSERT_TRUE(std::holds_alternative<core::AuraBatch>(decoded));
  EXPECT_EQ(std::get<core::AuraBatch>(decoded).word, 2u);
  EXPECT_EQ(std::get<core::AuraBatch>(decoded).past[0].stamp, word.stamp);
  wire::AuraBatch later = encoded(word);
  later.past_stamp()[0] = later.stamp() + 1;
  EXPECT_TRUE(std::holds_alternative<WireError>(decode(later, expected())));
}

TEST(AuraCodec, ChecksThatMakeNoSenseAreRefused) {
  const auto refused = [](auto&& spoil) {
    wire::AuraBatch wrong = encoded(batch_with_past());
    spoil(wrong);
    const auto decoded = decode(wrong, expected());
    return std::holds_alternative<WireError>(decoded) ? std::optional(std::get<WireError>(decoded)) : std::nullopt;
  };
  EXPECT_EQ(refused([](auto& w) { w.alarm_a()[0] = w.alarm_b()[0]; }), WireError::kRange);
  EXPECT_EQ(refused([](auto& w) { w.alarm_step().push_back(1); }), WireError::kLength);
  EXPECT_EQ(refused([](auto& w) { w.introduction_b()[0] = 1000; }), WireError::kRange);
  EXPECT_EQ(refused([](auto& w) { w.introduction_a()[0] = w.introduction_b()[0]; }), WireError::kRange);
  EXPECT_EQ(refused([](auto& w) { w.past_stamp()[0] = w.stamp(); }), WireError::kRange);
  EXPECT_EQ(refused([](auto& w) { w.past_motion()[0] = NAN; }), WireError::kNotFinite);
  EXPECT_EQ(refused([](auto& w) { w.past_motion()[3] = 2; }), WireError::kRotation);
  EXPECT_EQ(refused([](auto& w) { w.past_motion().pop_back(); }), WireError::kLength);
}

/// Whoever is further out than grains reach takes doubles for its whole batch, and loses nothing.
TEST(AuraCodec, PlacesFarOutAreKeptToTheBit) {
  core::AuraBatch batch = batch_of(3);
  batch.updates[1].pose.p_WB = core::Vec3(0.1, -6e5 / 7, 1e6 / 3);
  EXPECT_TRUE(encoded(batch).p_WB().empty());
  batch.updates[1].pose.p_WB.x() = -1e7 / 3;
  const auto decoded = decode(encoded(batch), expected());
  ASSERT_TRUE(std::holds_alternative<core::AuraBatch>(decoded));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(std::get<core::AuraBatch>(decoded).updates[i].pose.p_WB, batch.updates[i].pose.p_WB);
  }
}

/// A receiver may think a body faster than it is, never slower.
TEST(AuraCodec, SpeedsAreRoundedUp) {
  core::AuraBatch batch = batch_of(1000);
  const auto decoded = decode(encoded(batch), expected());
  ASSERT_TRUE(std::holds_alternative<core::AuraBatch>(decoded));
  for (std::size_t i = 0; i < batch.updates.size(); ++i) {
    const core::AuraRecord& got = std::get<core::AuraBatch>(decoded).updates[i];
    EXPECT_GE(got.speed_m_s, batch.updates[i].speed_m_s);
  }
}

/// Only so many audiences have a number. What has none goes to all listeners.
TEST(AuraCodec, AudiencesBeyondThe255thGoToAllListeners) {
  core::AuraBatch batch = batch_of(400);
  for (std::size_t i = 0; i < batch.updates.size(); ++i) batch.updates[i].audience = i + 1;
  const auto decoded = decode(encoded(batch), expected());
  ASSERT_TRUE(std::holds_alternative<core::AuraBatch>(decoded));
  for (std::size_t i = 0; i < batch.updates.size(); ++i) {
    const core::Audience got = std::get<core::AuraBatch>(decoded).updates[i].audience;
    EXPECT_EQ(got, i < 255 ? core::Audience{i + 1} : core::kAllListeners) << i;
  }
}

TEST(AuraCodec, AudiencesThatMakeNoSenseAreRefused) {
  const auto refused = [](auto&& spoil) {
    wire::AuraBatch wrong = encoded(batch_of(5));
    spoil(wrong);
    const auto decoded = decode(wrong, expected());
    return std::holds_alternative<WireError>(decoded) ? std::optional(std::get<WireError>(decoded)) : std::nullopt;
  };
  EXPECT_EQ(refused([](auto& w) { w.audience()[3] = static_cast<std::uint8_t>(w.audience_regions().size()); }),
            WireError::kRange);
  EXPECT_EQ(refused([](auto& w) { w.audience().pop_back(); }), WireError::kLength);
  EXPECT_EQ(refused([](auto& w) { w.audience_regions().clear(); }), WireError::kRange);
  EXPECT_EQ(refused([](auto& w) { w.audience_regions().resize(257); }), WireError::kTooLarge);
}

std::size_t bytes_per_update(bool moving, bool one_speed, bool for_all = true) {
  const auto size = [&](std::size_t updates) {
    core::AuraBatch batch;
    batch.top_speed_m_s = 32;
    for (std::size_t i = 0; i < updates; ++i) {
      core::AuraRecord& aura = batch.updates.emplace_back(testing::aura_of(i));
      aura.host = batch.source;
      aura.stamp = batch.stamp;
      aura.birth = 0;
      if (!moving) aura.v_WB = aura.w_WB = core::Vec3::Zero();
      if (one_speed) aura.speed_m_s = 32;
      aura.audience = for_all ? core::kAllListeners : core::audience_of(core::RegionId{2});
    }
    return WireBytes().of(batch).size();
  };
  EXPECT_EQ((size(2001) - size(1001)) % 1000, 0U);
  return (size(2001) - size(1001)) / 1000;
}

TEST(AuraCodec, AnUpdateTakesFewBytes) {
  EXPECT_EQ(bytes_per_update(false, true), 37U) << "as with tight and thesis auras; 40 are allowed";
  EXPECT_EQ(bytes_per_update(true, false), 65U) << "as with swept auras; 80 are allowed";
  EXPECT_EQ(bytes_per_update(true, false, false), 66U) << "one more where not all are for all";
}

/// The first messages of a process, made on several threads at once.
[[noreturn]] void make_messages_on_threads() {
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 8; ++i) threads.emplace_back([] { WireBytes(); });
  }
  std::exit(0);
}

TEST(WireBytesDeathTest, MayBeMadeOnSeveralThreadsAtOnce) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // each in a process of its own
  for (int i = 0; i < 20; ++i) ASSERT_EXIT(make_messages_on_threads(), ::testing::ExitedWithCode(0), "") << i;
}

TEST(PackedRotation, IsWithinItsErrorForEveryRotation) {
  std::mt19937_64 random(3);
  const auto u = [&] { return static_cast<double>(random() >> 11U) * 0x1p-52 - 1; };
  for (int i = 0; i < 100'000; ++i) {
    const core::Quat q = core::Quat(u(), u(), u(), u()).normalized();
    const auto back = unpacked_rotation(packed(q));
    ASSERT_TRUE(back) << i;
    ASSERT_LE(q.angularDistance(*back), core::kRotationError_rad) << i;
    ASSERT_NEAR(back->norm(), 1, 1e-12);
  }
  for (const core::Quat& q : {core::Quat(1, 0, 0, 0), core::Quat(0, 0, -1, 0), core::Quat(0.5, -0.5, 0.5, -0.5),
                              core::Quat(0, std::sqrt(0.5), 0, -std::sqrt(0.5))}) {
    ASSERT_LE(q.angularDistance(*unpacked_rotation(packed(q))), core::kRotationError_rad);
  }
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
      [](wire::AuraBatch& b) { b.order_numbers()[0] = 1e300; },
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
    {"OtherVersion", [](Wire& w) { w.version(kProtocolVersion + 1); }, WireError::kVersion},
    {"OtherGeneration", [](Wire& w) { w.generation(8); }, WireError::kGeneration},
    {"OtherMap", [](Wire& w) { w.map_version(1); }, WireError::kMapVersion},
    {"OtherSource", [](Wire& w) { w.source(2); }, WireError::kSource},
    {"SourceNotInTheMap", [](Wire& w) { w.source(4); }, WireError::kRange},
    {"TooManyRows", [](Wire& w) { w.id().resize(kMaxRows + 1); }, WireError::kTooLarge},
    {"TooManyDeletes", [](Wire& w) { w.deleted().resize(kMaxRows + 1); }, WireError::kTooLarge},
    {"SpeedThatNoWorldBears", [](Wire& w) { w.v_WB()[0] = 1e30F; }, WireError::kRange},
    {"SpinThatNoWorldBears", [](Wire& w) { w.w_WB()[4] = -1e30F; }, WireError::kRange},
    {"ReachOutOfAnyWorld", [](Wire& w) { w.top_radius_m(1e300); }, WireError::kRange},
    {"TopSpeedOutOfAnyWorld", [](Wire& w) { w.top_speed_m_s(1e300); }, WireError::kRange},
    {"OwnSpeedOutOfAnyWorld", [](Wire& w) { w.speed_m_s()[0] = 1e30F; }, WireError::kRange},
    {"EpochFarAhead", [](Wire& w) { w.epoch()[0] = 0xffff'ffffU; }, WireError::kRange},
    {"StateOfTheFuture", [](Wire& w) { w.elsewhere_stamp()[0] = w.stamp() + 1; }, WireError::kRange},
    {"BirthFarAhead",
     [](Wire& w) {
       w.unborn_row().push_back(0);
       w.unborn_birth().push_back(w.stamp() + 1'000'000);
     },
     WireError::kRange},
    {"IdShort", [](Wire& w) { w.id().pop_back(); }, WireError::kLength},
    {"EpochShort", [](Wire& w) { w.epoch().pop_back(); }, WireError::kLength},
    {"HostLong", [](Wire& w) { w.elsewhere_host().push_back(0); }, WireError::kLength},
    {"PrototypeShort", [](Wire& w) { w.prototype().clear(); }, WireError::kLength},
    {"FlagsShort", [](Wire& w) { w.flags().pop_back(); }, WireError::kLength},
    {"StampShort", [](Wire& w) { w.elsewhere_stamp().pop_back(); }, WireError::kLength},
    {"BirthShort", [](Wire& w) { w.unborn_birth().pop_back(); }, WireError::kLength},
    {"PositionShortByOneNumber", [](Wire& w) { w.grains_WB().pop_back(); }, WireError::kLength},
    {"PositionsMissing", [](Wire& w) { w.grains_WB().clear(); }, WireError::kLength},
    {"PositionsTwice", [](Wire& w) { w.p_WB().resize(8 * 3); }, WireError::kLength},
    {"PositionsOfBothKinds",
     [](Wire& w) {
       w.grains_WB().resize(7 * 3);
       w.p_WB().resize(3);
     },
     WireError::kLength},
    {"RotationShort", [](Wire& w) { w.rotation_WB().pop_back(); }, WireError::kLength},
    {"VelocityShort", [](Wire& w) { w.v_WB().pop_back(); }, WireError::kLength},
    {"VelocityWithoutSpin", [](Wire& w) { w.w_WB().clear(); }, WireError::kLength},
    {"SpinLong", [](Wire& w) { w.w_WB().push_back(0); }, WireError::kLength},
    {"SpeedShort", [](Wire& w) { w.speed_m_s().pop_back(); }, WireError::kLength},
    {"MarksDiffer", [](Wire& w) { w.hand_off_last().pop_back(); }, WireError::kLength},
    {"AdoptedDiffer", [](Wire& w) { w.adopted_source().pop_back(); }, WireError::kLength},
    {"PositionNan",
     [](Wire& w) {
       w.grains_WB().clear();
       w.p_WB().assign(8 * 3, 0);
       w.p_WB()[23] = kNan;
     },
     WireError::kNotFinite},
    {"VelocityInfinite", [](Wire& w) { w.v_WB()[5] = -std::numeric_limits<float>::infinity(); }, WireError::kNotFinite},
    {"SpinInfinite", [](Wire& w) { w.w_WB()[5] = std::numeric_limits<float>::infinity(); }, WireError::kNotFinite},
    {"SpeedNan", [](Wire& w) { w.speed_m_s()[1] = std::numeric_limits<float>::quiet_NaN(); }, WireError::kNotFinite},
    {"TopSpeedInfinite", [](Wire& w) { w.top_speed_m_s(kInfinity); }, WireError::kNotFinite},
    {"TopRadiusNan", [](Wire& w) { w.top_radius_m(kNan); }, WireError::kNotFinite},
    {"UnknownFlag", [](Wire& w) { w.flags()[3] = 4; }, WireError::kEnum},
    {"RotationWithABitTooMany", [](Wire& w) { w.rotation_WB()[1] |= 1ULL << 62U; }, WireError::kRotation},
    {"RotationLongerThanOne",
     [](Wire& w) {
       const std::uint64_t most = 0x7'ffffU;  // 0.7 in each of the three components
       w.rotation_WB()[1] = most | most << 20U | most << 40U;
     },
     WireError::kRotation},
    {"NegativeStamp", [](Wire& w) { w.stamp(-1); }, WireError::kRange},
    {"NegativeStateStamp", [](Wire& w) { w.elsewhere_stamp()[0] = -1; }, WireError::kRange},
    {"NegativeBirth", [](Wire& w) { w.unborn_birth()[0] = -5; }, WireError::kRange},
    {"ElsewhereOfNoRow", [](Wire& w) { w.elsewhere_row()[0] = 8; }, WireError::kRange},
    {"UnbornOfNoRow", [](Wire& w) { w.unborn_row()[0] = 8; }, WireError::kRange},
    {"NegativeSpeed", [](Wire& w) { w.speed_m_s()[0] = -1; }, WireError::kRange},
    {"NegativeTopSpeed", [](Wire& w) { w.top_speed_m_s(-1); }, WireError::kRange},
    {"NegativeTopRadius", [](Wire& w) { w.top_radius_m(-1); }, WireError::kRange},
    {"HostNotInTheMap", [](Wire& w) { w.elsewhere_host()[2] = 4; }, WireError::kRange},
    {"PrototypeNotInTheScene", [](Wire& w) { w.prototype()[2] = 7; }, WireError::kRange},
    {"MarkNotInTheMap", [](Wire& w) { w.hand_off_destination()[0] = 9; }, WireError::kRange},
    {"AdoptedNotInTheMap", [](Wire& w) { w.adopted_source()[0] = 9; }, WireError::kRange},
    {"BodyIdAboveSigned", [](Wire& w) { w.id()[0] = 1ULL << 63U; }, WireError::kRange},
    {"DeletedIdAboveSigned", [](Wire& w) { w.deleted()[0] = 1ULL << 63U; }, WireError::kRange},
};
INSTANTIATE_TEST_SUITE_P(All, SpoiltAuraBatch, ::testing::ValuesIn(kSpoilt),
                         [](const auto& info) { return info.param.name; });

TEST(AuraCodec, AcceptsWhatNobodyExpectsOtherwise) {
  wire::AuraBatch sample = encoded(batch_of(8));
  sample.generation(9);
  sample.map_version(1);
  EXPECT_TRUE(std::holds_alternative<core::AuraBatch>(decode(sample, {})));
}

}  // namespace
}  // namespace aurasim::messages
