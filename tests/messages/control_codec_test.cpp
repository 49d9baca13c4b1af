// Statuses, maps and commands as wire types and back.
#include "messages/control_codec.h"

#include <functional>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "aurasim.h"
#include "messages/control_samples.h"

namespace aurasim::messages {
namespace {

using testing::command_of;
using testing::map_of;
using testing::status_of;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// "accepted", or the reason why not.
template <class Wire>
std::string verdict(const Wire& sample, const Expected& expected = {}) {
  const auto decoded = decode(sample, expected);
  const auto* error = std::get_if<WireError>(&decoded);
  return error == nullptr ? "accepted" : std::string(name_of(*error));
}

TEST(StatusCodec, RoundTripKeepsEverything) {
  wire::NodeStatus sample;
  encode(status_of(1), sample);
  const auto decoded = decode(sample, {});
  ASSERT_TRUE(std::holds_alternative<Status>(decoded));
  wire::NodeStatus again;
  encode(std::get<Status>(decoded), again);
  EXPECT_EQ(again, sample);
  EXPECT_EQ(std::get<Status>(decoded).text, "all is well");
  EXPECT_EQ(std::get<Status>(decoded).holds_at, 1240);
  EXPECT_EQ(std::get<Status>(decoded).footprint.x0, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(std::get<Status>(decoded).violations.span, 5U);
  EXPECT_EQ(std::get<Status>(decoded).late_collisions, 6U);
  EXPECT_EQ(std::get<Status>(decoded).missed_collisions, 7U);
  EXPECT_EQ(std::get<Status>(decoded).transport.max_ms, 0.9);
  EXPECT_EQ(std::get<Status>(decoded).exchange_times.p99_ms, 0.06);
  EXPECT_EQ(std::get<Status>(decoded).exchange, ExchangeInUse::kCoupled);
  EXPECT_EQ(std::get<Status>(decoded).round_trip_ms, 0.12);
  EXPECT_EQ(std::get<Status>(decoded).listens_to, status_of(1).listens_to);
}

TEST(StatusCodec, LongTextsAreCutBetweenCharacters) {
  Status status = status_of(1);
  status.text = std::string(255, 'a') + "\xc3\xa9 and more";  // the é would be cut in two
  wire::NodeStatus sample;
  encode(status, sample);
  EXPECT_EQ(std::get<Status>(decode(sample, {})).text, std::string(255, 'a'));
}

TEST(StatusCodec, RefusesWhatIsNotSound) {
  const auto after = [](const std::function<void(wire::NodeStatus&)>& spoil) {
    wire::NodeStatus sample;
    encode(status_of(1), sample);
    spoil(sample);
    Expected expected;
    expected.region_count = 4;
    return verdict(sample, expected);
  };
  EXPECT_EQ(after([](auto&) {}), "accepted");
  EXPECT_EQ(after([](auto& w) { w.version(0); }), "malformed");
  EXPECT_EQ(after([](auto& w) { w.version(kProtocolVersion + 1); }), "version");
  EXPECT_EQ(after([](auto& w) { w.source(4); }), "range");
  EXPECT_EQ(after([](auto& w) { w.state(9); }), "enum");
  EXPECT_EQ(after([](auto& w) { w.holds_at(-1); }), "accepted");
  EXPECT_EQ(after([](auto& w) { w.holds_at(-2); }), "range");
  EXPECT_EQ(after([](auto& w) { w.frame_max_ms(kNan); }), "not_finite");
  EXPECT_EQ(after([](auto& w) { w.real_time_factor(-1); }), "not_finite");
  EXPECT_EQ(after([](auto& w) { w.footprint_x0(kNan); }), "range");
  EXPECT_EQ(after([](auto& w) { w.footprint_x0(21); }), "range");
  EXPECT_EQ(after([](auto& w) { w.lookahead(-1); }), "range");
  EXPECT_EQ(after([](auto& w) { w.exchange(3); }), "enum");
  EXPECT_EQ(after([](auto& w) { w.round_trip_ms(-1); }), "not_finite");
  EXPECT_EQ(after([](auto& w) { w.exchange_p99_ms(kNan); }), "not_finite");
  EXPECT_EQ(after([](auto& w) { w.dead({4}); }), "range");
  EXPECT_EQ(after([](auto& w) { w.listens_to()[0] = 4; }), "range");
  EXPECT_EQ(after([](auto& w) { w.listens_by()[0] = 4; }), "range");
  EXPECT_EQ(after([](auto& w) { w.listens_since()[0] = -1; }), "range");
  EXPECT_EQ(after([](auto& w) { w.listens_since().pop_back(); }), "length");
  EXPECT_EQ(after([](auto& w) { w.listens_by().pop_back(); }), "length");
  EXPECT_EQ(after([](auto& w) { w.part_region({4}), w.part_step({60}); }), "range");
  EXPECT_EQ(after([](auto& w) { w.part_region({3}), w.part_step({-60}); }), "range");
  EXPECT_EQ(after([](auto& w) { w.part_region({3}); }), "length");
  EXPECT_EQ(after([](auto& w) { w.meshes().resize(5000); }), "too_large");
  EXPECT_EQ(after([](auto& w) { w.saved().resize(5000); }), "too_large");
  EXPECT_EQ(after([](auto& w) { w.not_saved().resize(5000); }), "too_large");
}

TEST(MapCodec, RoundTripKeepsEverything) {
  wire::RegionMap sample;
  encode(map_of(77), sample);
  const auto decoded = decode(sample, {});
  ASSERT_TRUE(std::holds_alternative<WorldMap>(decoded));
  wire::RegionMap again;
  encode(std::get<WorldMap>(decoded), again);
  EXPECT_EQ(again, sample);
  EXPECT_EQ(std::get<WorldMap>(decoded).regions.at(1).x0, 0);
}

TEST(MapCodec, RefusesWhatIsNotSound) {
  const auto after = [](const std::function<void(wire::RegionMap&)>& spoil) {
    wire::RegionMap sample;
    encode(map_of(77), sample);
    spoil(sample);
    return verdict(sample);
  };
  EXPECT_EQ(after([](auto&) {}), "accepted");
  EXPECT_EQ(after([](auto& w) { w.y1().pop_back(); }), "length");
  EXPECT_EQ(after([](auto& w) { w.x1()[0] = kNan; }), "range");
  EXPECT_EQ(after([](auto& w) { w.x0(w.x1()); }), "range");
  EXPECT_EQ(after([](auto& w) {
              w.x0().clear();
              w.y0().clear();
              w.x1().clear();
              w.y1().clear();
            }),
            "range");
}

TEST(CommandCodec, RoundTripKeepsEverything) {
  for (const auto kind : {RunCommandKind::kStart, RunCommandKind::kStep, RunCommandKind::kStop}) {
    RunCommand command = command_of(kind);
    command.request = 5;
    command.after = {17, 4711};
    wire::RunControl sample;
    encode(command, 99, sample);
    const auto decoded = decode(sample, {});
    ASSERT_TRUE(std::holds_alternative<RunCommand>(decoded));
    wire::RunControl again;
    encode(std::get<RunCommand>(decoded), 99, again);
    EXPECT_EQ(again, sample);
    EXPECT_EQ(std::get<RunCommand>(decoded).kind, kind);
    EXPECT_EQ(std::get<RunCommand>(decoded).after, (core::ProgramWord{17, 4711}));
  }
}

TEST(CommandCodec, ARestoreNamesAProcessForEachRegion) {
  RunCommand restore = command_of(RunCommandKind::kRestore);
  restore.request = 5;
  restore.era = 2;
  restore.members = {{11, core::RegionId{0}, true}, {12, core::RegionId{0}, false}};
  wire::RunControl sample;
  encode(restore, 99, sample);
  const RunCommand again = std::get<RunCommand>(decode(sample, {}));
  EXPECT_EQ(again.era, 2U);
  ASSERT_EQ(again.members.size(), 2U);
  EXPECT_EQ(again.members[1].process, 12U);
  EXPECT_EQ(again.members[1].holder, core::RegionId{0});
  EXPECT_TRUE(again.members[0].survives);
  EXPECT_FALSE(again.members[1].survives);
  sample.member_holder()[1] = 2;
  EXPECT_EQ(verdict(sample), "range") << "there are two regions";
  sample.member_holder().pop_back();
  EXPECT_EQ(verdict(sample), "length");
}

TEST(CommandCodec, RefusesWhatIsNotSound) {
  const auto after = [](const std::function<void(wire::RunControl&)>& spoil) {
    RunCommand command = command_of(RunCommandKind::kPause);
    command.request = 5;
    wire::RunControl sample;
    encode(command, 99, sample);
    spoil(sample);
    Expected expected;
    expected.map_version = 77;
    return verdict(sample, expected);
  };
  EXPECT_EQ(after([](auto&) {}), "accepted");
  EXPECT_EQ(after([](auto& w) { w.map_version(0); }), "accepted");
  EXPECT_EQ(after([](auto& w) { w.map_version(78); }), "map_version");
  EXPECT_EQ(after([](auto& w) { w.kind(12); }), "enum");
  for (const double rate : {0.0, 1e-300, 0.009, 10.1, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    const auto ask = [rate](auto& w) {
      w.kind(6);
      w.rate(rate);
    };
    EXPECT_EQ(after(ask), "range") << rate;
  }
  EXPECT_EQ(after([](auto& w) { w.request(0); }), "range");
  EXPECT_EQ(after([](auto& w) { w.count(-1); }), "range");
  EXPECT_EQ(after([](auto& w) { w.epoch_ns(-1); }), "range");
}

}  // namespace
}  // namespace aurasim::messages
