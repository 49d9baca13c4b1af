// Commands, replies and meshes as wire types and back; what is not sound is refused.
#include "messages/command_codec.h"

#include <functional>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "aurasimPubSubTypes.h"
#include "messages/guarded_type.h"
#include "messages/samples.h"

namespace aurasim::messages {
namespace {

using core::Command;
using core::CommandReply;
using core::Vec3;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint64_t kMap = 0xfedc'ba98'7654'3210U;

Expected expected() {
  Expected expected;
  expected.map_version = kMap;
  return expected;
}

std::vector<core::Ask> one_of_each() {
  const core::Pose pose{Vec3(1, 2, 3), testing::turn(0.4)};
  core::NewBody named;
  named.prototype = "brick";
  named.pose = pose;
  named.v_WB = Vec3(1, 0, -1);
  core::NewBody own = named;
  own.prototype.clear();
  own.shape = core::MeshRef{~0ULL, core::MeshUse::kHull};
  own.mass_kg = 7;
  return {named,
          own,
          core::NewStatic{core::Box{{1, 2, 3}}, pose},
          core::RemoveBody{core::BodyId{5}},
          core::RemoveStatic{core::StaticId{6}},
          core::Impulse{core::BodyId{7}, Vec3(1, 2, 3), Vec3(4, 5, 6)},
          core::SetVelocity{core::BodyId{8}, Vec3(1, 2, 3), {}},
          core::SetRate{0.5},
          core::Repartition{{{-10, -10, 0, 10}, {0, -10, 10, 10}}},
          core::ChangeScene{"tower"},
          core::Save{"world.cut"},
          core::Load{"world.cut"},
          core::SendStatic{core::StaticId{9}, pose, 2.5},
          core::Ray{Vec3(0, 0, 10), Vec3(0, 0, -10), {core::RegionId{0}, core::RegionId{2}}}};
}

wire::Command encoded(const core::Ask& ask) {
  wire::Command out;
  encode(Command{42, 100, ask}, 9, kMap, out);
  return out;
}

TEST(CommandCodec, CommandsOfEveryKindComeBack) {
  for (const core::Ask& ask : one_of_each()) {
    const wire::Command sent = encoded(ask);
    const auto decoded = decode(sent, expected());
    ASSERT_TRUE(std::holds_alternative<Command>(decoded)) << ask.index();
    const auto& command = std::get<Command>(decoded);
    EXPECT_EQ(command.request, 42u);
    EXPECT_EQ(command.at_step, 100);
    EXPECT_EQ(command.ask.index(), ask.index());
    EXPECT_EQ(encoded(command.ask), sent) << "every field of kind " << ask.index();
  }
}

TEST(CommandCodec, WhatIsNotSoundIsRefused) {
  const std::vector<std::function<void(wire::Command&)>> spoilers = {
      [](wire::Command& c) { c.kind(99); },           [](wire::Command& c) { c.p({kNan, 0, 0}); },
      [](wire::Command& c) { c.p({1, 2}); },          [](wire::Command& c) { c.q({2, 0, 0, 0}); },
      [](wire::Command& c) { c.shape(9); },           [](wire::Command& c) { c.size({-1, 1, 1}); },
      [](wire::Command& c) { c.map_version(1); },     [](wire::Command& c) { c.version(0); },
      [](wire::Command& c) { c.stamp(-1); },          [](wire::Command& c) { c.subject(-3); },
      [](wire::Command& c) { c.size({1, 1, 1, 1}); }, [](wire::Command& c) { c.mass_kg(kNan); }};
  for (std::size_t i = 0; i < spoilers.size(); ++i) {
    wire::Command command = encoded(core::NewStatic{core::Box{{1, 2, 3}}, {}});
    spoilers[i](command);
    EXPECT_TRUE(std::holds_alternative<WireError>(decode(command, expected()))) << i;
  }
}

TEST(CommandCodec, RepliesComeBack) {
  CommandReply reply;
  reply.source = core::RegionId{3};
  reply.request = ~0ULL;
  reply.outcome = core::Outcome::kSeen;
  reply.at_step = 77;
  reply.object = -4;
  reply.p_W = Vec3(1, 2, 3);
  reply.normal_W = Vec3(0, 0, 1);
  reply.distance_m = 12.5;
  wire::CommandReply sent;
  encode(reply, kMap, sent);
  const auto decoded = decode(sent, {});
  ASSERT_TRUE(std::holds_alternative<CommandReply>(decoded));
  wire::CommandReply again;
  encode(std::get<CommandReply>(decoded), kMap, again);
  EXPECT_EQ(again, sent);
}

TEST(CommandCodec, MeshesComeBackAndBadOnesAreRefused) {
  const NamedMesh mesh{5, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{{0, 1, 2}}, {{0, 3, 1}}}}};
  wire::MeshShape sent;
  encode(mesh, sent);
  const auto decoded = decode(sent, {});
  ASSERT_TRUE(std::holds_alternative<NamedMesh>(decoded));
  EXPECT_EQ(std::get<NamedMesh>(decoded).mesh.points, mesh.mesh.points);
  EXPECT_EQ(std::get<NamedMesh>(decoded).mesh.triangles, mesh.mesh.triangles);
  const std::vector<std::function<void(wire::MeshShape&)>> spoilers = {
      [](wire::MeshShape& m) { m.triangles()[2] = 4; }, [](wire::MeshShape& m) { m.triangles().pop_back(); },
      [](wire::MeshShape& m) { m.points()[0] = kNan; }, [](wire::MeshShape& m) { m.points().clear(); }};
  for (std::size_t i = 0; i < spoilers.size(); ++i) {
    wire::MeshShape bad = sent;
    spoilers[i](bad);
    EXPECT_TRUE(std::holds_alternative<WireError>(decode(bad, {}))) << i;
  }
}

}  // namespace
}  // namespace aurasim::messages
